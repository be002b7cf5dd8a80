//! Steps of walking robots.
//!
//! The judges are a program of its own in other coordinates, and the impact of the library on its contacts.

use costate::constraints::Impact;
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::Kinematics;
use costate::robot::{LoadOptions, Robot};
use costate_control::{
    FinalTime, Gait, GaitError, Problem, ProblemError, ProblemFile, Solution, Solver, SolverOptions, Status,
};
use std::sync::OnceLock;

const N: usize = 7;
const LENGTH: f64 = 0.5;
const TIME: f64 = 0.7;
const FRICTION: f64 = 0.6;
/// Legs exchanged.
const EXCHANGE: [usize; N] = [0, 1, 2, 5, 6, 3, 4];

fn file() -> ProblemFile {
    ProblemFile::read("../examples/problems/rabbit_walk.toml", LoadOptions::default()).unwrap()
}

fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    let solution = Solver::new(problem, options).unwrap().solve();
    println!(
        "{} J {:.9} T {:.4} gait {:?} end {:.1e} nodes {} steps {} drift {:?} errors {:?}",
        solution.motion.status,
        solution.total(),
        solution.motion.final_time,
        solution.gait,
        solution.end_defect,
        solution.nodes(),
        solution.newton_iterations,
        solution.constraints.iter().map(|one| one.drift).collect::<Vec<_>>(),
        solution.motion.errors,
    );
    solution
}

/// The motion of the example, solved once for all tests.
fn walk() -> &'static (Problem, Solution) {
    static WALK: OnceLock<(Problem, Solution)> = OnceLock::new();
    WALK.get_or_init(|| {
        let file = file();
        let solution = solve(&file.problem, file.options.clone());
        (file.problem, solution)
    })
}

fn exchanged(list: &[f64]) -> Vec<f64> {
    EXCHANGE.iter().map(|&i| list[i]).collect()
}

fn on(robot: &Robot, foot: &str) -> Stance {
    Stance::new(robot, &[Contact::point("foot", foot).planar().friction(FRICTION)]).unwrap()
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

#[test]
fn rabbit_walks() {
    let (problem, solution) = walk();
    assert_eq!(solution.motion.status, Status::Converged);
    // benches/ocp/harness/walking.py, by CasADi and IPOPT: collocation at three Gauss points of 20 intervals,
    // in the angles of the five links of a robot that is pinned at its foot, and with the impact in seven
    // coordinates: 195.395269664.
    assert!((solution.total() - 195.3952697).abs() < 2e-5, "{}", solution.total());
    let gait = solution.gait.as_ref().unwrap();
    let [impulse] = gait.impulses[..] else { panic!("{gait:?}") };
    assert!(largest_difference(&impulse, &[-13.950956, 0.0, 29.055444]) < 1e-3, "{impulse:?}");
    assert!((gait.speed - LENGTH / TIME).abs() < 1e-9, "{gait:?}");
    assert!(gait.miss < 1e-6, "{gait:?}");
    assert!(gait.loss > 0.0 && gait.cost_of_transport > 0.0, "{gait:?}");
    // 40 kg.
    assert!((gait.weight_times_length - 40.0 * 9.81 * LENGTH).abs() < 1e-9, "{gait:?}");
    assert!(solution.end_defect < 1e-3, "{}", solution.end_defect);
    let motion = &solution.trajectory;
    let (first, last) = (0, motion.t.len() - 1);
    let mut back = exchanged(&motion.q[last]);
    back[0] -= LENGTH;
    assert!(largest_difference(&back, &motion.q[first]) < 1e-9, "{back:?} {:?}", motion.q[first]);
    // Joints without a motor have no torque; knees do not bend forward.
    let [least, most] = [problem.limits.q_min.as_ref().unwrap(), problem.limits.torque_max.as_ref().unwrap()];
    for k in 0..motion.t.len() {
        assert!(motion.u[k][..3].iter().all(|u| u.abs() < 1e-5), "{k}: {:?}", motion.u[k]);
        assert!(motion.q[k].iter().zip(least).all(|(q, least)| *q > least - 1e-6), "{k}: {:?}", motion.q[k]);
        assert!(motion.u[k].iter().zip(most).all(|(u, most)| u.abs() <= most * (1.0 + 1e-6) + 1e-5));
    }
}

#[test]
fn the_ground_bears_what_the_feet_press() {
    let (_, solution) = walk();
    let [foot] = &solution.constraints[..] else { panic!("{:?}", solution.constraints) };
    assert_eq!((&*foot.name, &*foot.frame), ("right_foot", "right_foot"));
    assert!(foot.drift < 1e-6, "{}", foot.drift);
    let motion = &solution.trajectory;
    let mut impulse = 0.0;
    for (k, [x, y, z]) in foot.force.iter().enumerate() {
        assert!(*y == 0.0 && *z > -1e-3 && x.abs() <= FRICTION * z + 1e-2, "{k}: {x} {y} {z}");
        if k > 0 {
            impulse += 0.5 * (motion.t[k] - motion.t[k - 1]) * (z + foot.force[k - 1][2]);
        }
    }
    let [x, _, z] = solution.gait.as_ref().unwrap().impulses[0];
    assert!(z > 0.0 && x.abs() <= FRICTION * z * (1.0 + 1e-6), "{x} {z}");
    // Over a step the vertical momentum comes back: landing and standing bear the weight.
    let weight = 40.0 * 9.81 * TIME;
    assert!((impulse + z - weight).abs() < 1e-2 * weight, "{impulse} {z} {weight}");
}

#[test]
fn the_foot_that_swings_clears_the_ground() {
    let (problem, solution) = walk();
    let clearance = problem.gait.as_ref().unwrap().clearance;
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let swing = problem.robot.frame_index("left_foot").unwrap();
    let mut most = 0.0_f64;
    for q in &solution.trajectory.q {
        kinematics.set_position(q).unwrap();
        let [x, _, z] = kinematics.pose(swing).unwrap().position;
        let part = x / LENGTH;
        assert!(z - clearance * (1.0 - part * part) > -1e-5, "{x} {z}");
        most = most.max(z);
    }
    assert!(most > clearance * 0.9, "{most}");
}

/// The state after the other foot has landed on a contact of the library is the one at the start, with the
/// legs exchanged; what the ground gives to the foot is all that changes the momentum.
#[test]
fn the_gait_closes() {
    let (problem, solution) = walk();
    let (robot, motion) = (&problem.robot, &solution.trajectory);
    let last = motion.t.len() - 1;
    let (q, v) = (&motion.q[last], &motion.v[last]);
    // The foot that stands lets go before the other one lands.
    let before = Hamiltonian::<f64>::new(robot).momentum(q, v).unwrap().to_vec();
    let landing = on(robot, "left_foot");
    let mut impact = Impact::<f64>::new(landing.robot());
    let after = impact.evaluate(q, &before).unwrap();
    let miss = largest_difference(&exchanged(after.velocity), &motion.v[0]);
    assert!(miss < 1e-6, "{miss}");
    let force = landing.wrench(0, after.impulse).0;
    let jump = after.momentum[1] - before[1];
    assert!((jump - force[2]).abs() < 1e-9, "{jump} {force:?}");
}

/// Less friction costs more, and is kept.
#[test]
fn slippery_ground_costs_more() {
    let (problem, best) = walk();
    let used = |solution: &Solution| {
        let forces = solution.constraints[0].force.iter().filter(|[_, _, z]| *z > 1.0);
        forces.map(|[x, _, z]| x.abs() / z).fold(0.0_f64, f64::max)
    };
    let least = 0.8 * used(best);
    let gait = problem.gait.clone().unwrap().with_friction(least);
    let slippery = problem.clone().with_gait(gait);
    let solution = solve(&slippery, file().options);
    assert_eq!(solution.motion.status, Status::Converged);
    assert!(solution.total() > best.total() * (1.0 + 1e-6), "{} {}", solution.total(), best.total());
    assert!(used(&solution) < least * 1.02, "{} {least}", used(&solution));
}

/// A free time is that of the best speed.
#[test]
fn a_step_of_free_time_has_the_best_speed() {
    let (problem, _) = walk();
    let free = problem.clone().with_time(FinalTime::Free { guess: TIME });
    let best = solve(&free, file().options);
    assert_eq!(best.motion.status, Status::Converged);
    let time = best.motion.final_time;
    assert!((best.gait.as_ref().unwrap().speed - LENGTH / time).abs() < 1e-9);
    for factor in [0.97, 1.03] {
        let fixed = problem.clone().with_time(FinalTime::Fixed(factor * time));
        let other = solve(&fixed, file().options);
        assert_eq!(other.motion.status, Status::Converged);
        assert!(other.total() > best.total(), "{factor}: {} {}", other.total(), best.total());
    }
}

#[test]
fn what_is_no_step_is_refused_by_name() {
    let problem = file().problem;
    let gait = problem.gait.clone().unwrap();
    let refused = |problem: &Problem| Solver::new(problem, SolverOptions::default()).unwrap_err();
    let with = |change: &dyn Fn(&mut Gait)| {
        let mut gait = gait.clone();
        change(&mut gait);
        refused(&problem.clone().with_gait(gait))
    };
    let cause = |error: ProblemError| match error {
        ProblemError::Gait { key, cause } => (key.to_string(), *cause),
        other => panic!("{other}"),
    };
    let (key, found) = cause(with(&|gait| gait.stance = vec!["right_fot".into()]));
    let GaitError::UnknownFrame { frame, nearest } = found else { panic!("{found}") };
    assert_eq!((&*key, &*frame, &*nearest[0]), ("gait.stance", "right_fot", "right_foot"));
    let (key, found) = cause(with(&|gait| gait.swing = vec!["right_foot".into()]));
    assert_eq!((&*key, found), ("gait.swing", GaitError::OneFoot { frame: "right_foot".into() }));
    let (key, found) = cause(with(&|gait| gait.swing.clear()));
    assert_eq!((&*key, found), ("gait.swing", GaitError::Unpaired { stance: 1, swing: 0 }));
    for value in [0.0, -0.1, f64::NAN] {
        let (key, found) = cause(with(&|gait| gait.length = value));
        assert!(key == "gait.length" && matches!(found, GaitError::OutOfRange { .. }), "{found}");
        let (key, found) = cause(with(&|gait| gait.friction = value));
        assert!(key == "gait.friction" && matches!(found, GaitError::OutOfRange { .. }), "{found}");
    }
    assert_eq!(cause(with(&|gait| gait.clearance = -1.0)).0, "gait.clearance");
    let (key, found) = cause(with(&|gait| gait.along = "base_z".into()));
    assert_eq!((&*key, found), ("gait.along", GaitError::NotAlong { joint: "base_z".into() }));
    let (key, found) = cause(with(&|gait| gait.length = 3.0));
    assert!(key == "start.q" && matches!(found, GaitError::CannotStand { .. }), "{found}");
    let (key, found) = cause(with(&|gait| gait.mirror.truncate(1)));
    assert!(key == "gait.mirror" && matches!(found, GaitError::NotSymmetric { .. }), "{found}");
    let twice = with(&|gait| gait.mirror[1] = gait.mirror[0].clone());
    assert!(matches!(twice, ProblemError::GivenTwice { .. }), "{twice}");
    let unknown = with(&|gait| gait.mirror[1][0] = "left_kne".into());
    assert!(unknown.to_string().contains("left_knee"), "{unknown}");
}

#[test]
fn problem_files_say_what_is_wrong_with_a_step() {
    let text = file().text;
    let folder = "../examples/problems";
    let refused = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        ProblemFile::from_text(&text.replace(from, to), folder, LoadOptions::default())
            .unwrap_err()
            .to_string()
    };
    assert!(refused("length = 0.5", "lenght = 0.5").contains("lenght"));
    assert!(refused("length = 0.5", "").contains("gait.length"));
    assert!(refused("[time]", "[end]\nq = [0.0]\n[time]").contains("remove [end] or [gait]"));
    let mirror =
        refused("[[\"left_hip\", \"right_hip\"], [\"left_knee\", \"right_knee\"]]", "[\"left_hip\"]");
    assert!(mirror.contains("a list of pairs of joint names"), "{mirror}");
}
