//! Steps that begin on both feet.
//!
//! The judges are a program of its own in other coordinates, and forward dynamics with constraints, contacts
//! and impacts of the library, none of which the solver uses.

use super::gaits::{
    ROWS, example, integrated, is_best_duration, keeps_its_limits, largest_difference, least_energy,
    lift_off, solved,
};
use super::walking::{CLEARANCE, FRICTION, LENGTH, N, exchanged};
use costate::constraints::{ConstrainedLagrangian, Impact};
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::Kinematics;
use costate::robot::{LoadOptions, Robot};
use costate_control::{
    GaitError, Problem, ProblemError, ProblemFile, Solution, Solver, SolverOptions, Status,
};
use std::sync::OnceLock;

const TIME: f64 = 0.7;
/// The foot that stands during the whole step, and the other one.
const FEET: [&str; 2] = ["right_foot", "left_foot"];

fn file() -> ProblemFile {
    example("rabbit_double_support")
}

/// The motion of the example, solved once for all tests.
fn walk() -> &'static (Problem, Solution) {
    static WALK: OnceLock<(Problem, Solution)> = OnceLock::new();
    WALK.get_or_init(|| {
        let file = file();
        let solution = solved(&file.problem, file.options.clone());
        (file.problem, solution)
    })
}

fn with(share: f64) -> Problem {
    let problem = file().problem;
    let gait = problem.gait.clone().unwrap().with_double_support(share);
    problem.with_gait(gait)
}

fn on(robot: &Robot, feet: &[&str]) -> Stance {
    let contacts: Vec<Contact> =
        feet.iter().map(|foot| Contact::point(*foot, foot).planar().friction(FRICTION)).collect();
    Stance::new(robot, &contacts).unwrap()
}

fn is_in_cone([x, _, z]: [f64; 3], off: f64) -> bool {
    z > -off && x.abs() <= FRICTION * z + off
}

#[test]
fn rabbit_walks_on_both_feet() {
    let (problem, solution) = walk();
    assert_eq!(solution.motion.status, Status::Converged);
    // benches/ocp/harness/walking.py, by CasADi and IPOPT: collocation at three Gauss points of 12 and 40
    // intervals in the two phases, in the angles of the five links of a robot that is pinned at its foot,
    // with a force on the other foot: 1757.187868318.
    assert!((solution.total() / 1757.187868318 - 1.0).abs() < 1e-6, "{}", solution.total());
    let gait = solution.gait.as_ref().unwrap();
    assert!((gait.double_support.unwrap() - 0.2 * TIME).abs() < 1e-12, "{gait:?}");
    assert!((lift_off(solution) - 0.2 * TIME).abs() < 1e-12);
    assert!((gait.speed - LENGTH / TIME).abs() < 1e-9 && gait.miss < 1e-6, "{gait:?}");
    // Nothing is lost at the landing: what motors add they take again.
    assert!((gait.work - gait.braking).abs() < 1e-5 * gait.work && gait.loss.abs() < 1e-9, "{gait:?}");
    assert!(solution.end_defect < 1e-3, "{}", solution.end_defect);
    let limits = &solution.limits;
    assert!(limits.ground_force.as_ref().is_some_and(|limit| limit.worst.is_none()), "{limits:?}");
    assert!(limits.landing_impulse.is_none() && limits.acceleration.is_none(), "{limits:?}");
    let motion = &solution.trajectory;
    keeps_its_limits(problem, motion);
}

/// In double support no foot moves, then the one behind clears the ground and lands at rest.
#[test]
fn both_feet_stand_and_then_one_swings() {
    let (problem, solution) = walk();
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let feet = FEET.map(|foot| problem.robot.frame_index(foot).unwrap());
    let times: Vec<f64> = (0..=1400).map(|k| TIME * f64::from(k) / 1400.0).collect();
    let samples = solution.sample_at(problem, &times).unwrap();
    let (mut most, mut moved) = (0.0_f64, [0.0_f64; 2]);
    for (t, q) in samples.t.iter().zip(&samples.q) {
        kinematics.set_position(q).unwrap();
        let [[x, _, z], [behind, _, height]] = feet.map(|foot| kinematics.pose(foot).unwrap().position);
        moved[0] = moved[0].max(x.abs()).max(z.abs());
        if *t <= lift_off(solution) {
            moved[1] = moved[1].max((behind + LENGTH).abs()).max(height.abs());
        } else {
            let part = behind / LENGTH;
            assert!(height - CLEARANCE * (1.0 - part * part) > -1e-6, "{t}: {behind} {height}");
            most = most.max(height);
        }
    }
    println!("moved {moved:?}");
    assert!(moved.iter().all(|moved| *moved < 1e-7), "{moved:?}");
    assert!(most > 0.9 * CLEARANCE, "{most}");
    let [front, behind] = &solution.constraints[..] else { panic!("{:?}", solution.constraints) };
    assert_eq!([&*front.name, &*behind.name], FEET);
    assert!(front.drift < 1e-7 && behind.drift < 1e-7, "{} {}", front.drift, behind.drift);
}

/// Forward dynamics on the feet that stand has the forces of the motion at the points of the mesh, and forces
/// in the friction cones between them too.
#[test]
fn the_ground_bears_both_feet() {
    let (problem, solution) = walk();
    let stances = [on(&problem.robot, &FEET), on(&problem.robot, &FEET[..1])];
    let mut models = stances.each_ref().map(|stance| ConstrainedLagrangian::<f64>::new(stance.robot()));
    let mut force = |phase: usize, q: &[f64], v: &[f64], u: &[f64]| {
        let u = [&[0.0; 3], &u[3..]].concat();
        let (_, lambda) = models[phase].evaluate(q, v, &u).unwrap();
        let behind = if phase == 0 { stances[0].wrench(1, lambda).0 } else { [0.0; 3] };
        [stances[phase].wrench(0, lambda).0, behind]
    };
    let motion = &solution.trajectory;
    let mut largest = [0.0_f64; 2];
    for k in 0..motion.t.len() {
        let is_point = (1..ROWS - 1).contains(&(k % ROWS));
        let phase = usize::from(motion.t[ROWS * (k / ROWS) + 2] > lift_off(solution));
        let found = force(phase, &motion.q[k], &motion.v[k], &motion.u[k]);
        for (foot, (told, found)) in solution.constraints.iter().zip(found).enumerate() {
            let told = told.force[k];
            assert!(
                largest_difference(&told, &found) < if is_point { 1e-3 } else { 0.5 },
                "{k}: {told:?} {found:?}"
            );
            assert!(is_in_cone(told, 1e-2), "{k}: {told:?}");
            largest[foot] = largest[foot].max(told[2]);
        }
    }
    // Each foot bears a part of the weight at least.
    assert!(largest.iter().all(|z| *z > 0.2 * 40.0 * 9.81), "{largest:?}");
    // No sample is a point, and none is at lift-off.
    let count = 2000;
    let times: Vec<f64> = (0..count).map(|k| TIME * (f64::from(k) + 0.5) / f64::from(count)).collect();
    let samples = solution.sample_at(problem, &times).unwrap();
    let mut lifted = 0.0;
    for (k, (q, (v, u))) in samples.q.iter().zip(samples.v.iter().zip(&samples.u)).enumerate() {
        let found = force(usize::from(times[k] > lift_off(solution)), q, v, u);
        assert!(found.iter().all(|force| is_in_cone(*force, 0.5)), "{k}: {found:?}");
        lifted += (found[0][2] + found[1][2]) * TIME / f64::from(count);
    }
    // Over a step the vertical momentum comes back.
    let weight = 40.0 * 9.81 * TIME;
    assert!((lifted / weight - 1.0).abs() < 1e-3, "{lifted} {weight}");
}

/// The landing, by the impact of the library with both feet on their contacts, has no impulse, and neither
/// has the release of the foot behind.
#[test]
fn neither_landing_nor_lift_off_has_an_impulse() {
    let (problem, solution) = walk();
    let (robot, motion) = (&problem.robot, &solution.trajectory);
    let last = motion.t.len() - 1;
    let (q, v) = (&motion.q[last], &motion.v[last]);
    let before = Hamiltonian::<f64>::new(robot).momentum(q, v).unwrap().to_vec();
    let landing = on(robot, &FEET);
    let mut impact = Impact::<f64>::new(landing.robot());
    let after = impact.evaluate(q, &before).unwrap();
    for foot in 0..2 {
        let impulse = landing.wrench(foot, after.impulse).0;
        assert!(largest_difference(&impulse, &[0.0; 3]) < 1e-6, "{impulse:?}");
    }
    let miss = largest_difference(&exchanged(after.velocity), &motion.v[0]);
    assert!(miss < 1e-6, "{miss}");
    let mut back = exchanged(q);
    back[0] -= LENGTH;
    assert!(largest_difference(&back, &motion.q[0]) < 1e-9, "{back:?}");
    let k = motion.t.iter().position(|t| *t == lift_off(solution)).unwrap();
    assert_eq!(
        (motion.t[k], &motion.q[k], &motion.v[k]),
        (motion.t[k + 1], &motion.q[k + 1], &motion.v[k + 1])
    );
    // The foot behind has no force from there on.
    let behind = &solution.constraints[1].force;
    assert!(behind[k + 1..].iter().flatten().all(|force| force.abs() < 1e-9));
}

/// Why a step with double support has no impulse: whichever way the foot that lands moves, the ground would
/// have to pull the foot behind, or it would have to slide.
#[test]
fn an_impulse_would_have_to_pull_the_foot_behind() {
    let (problem, solution) = walk();
    let (robot, motion) = (&problem.robot, &solution.trajectory);
    let last = motion.t.len() - 1;
    let (q, v) = (&motion.q[last], &motion.v[last]);
    let landing = on(robot, &FEET);
    let mut impact = Impact::<f64>::new(landing.robot());
    let mut model = Hamiltonian::<f64>::new(robot);
    let jacobian = {
        let mut rows = costate::constraints::Constraints::<f64>::new(landing.robot());
        rows.set_position(q).unwrap();
        rows.jacobian().clone()
    };
    let mut pulled = 0;
    for k in 0..720 {
        let (sin, cos) = (f64::from(k) / 720.0 * std::f64::consts::TAU).sin_cos();
        // Rates with which the foot behind is at rest and the other one moves along (cos, sin).
        let rows = jacobian.rows();
        let a = nalgebra::DMatrix::from_fn(rows, N, |i, j| jacobian[(i, j)]);
        let wanted = nalgebra::DVector::from_fn(rows, |i, _| [0.0, 0.0, cos, sin][i]);
        let change = a.clone().svd(true, true).solve(&wanted, 1e-12).unwrap();
        let v: Vec<f64> = v.iter().zip(change.iter()).map(|(v, change)| v + change).collect();
        let p = model.momentum(q, &v).unwrap().to_vec();
        let after = impact.evaluate(q, &p).unwrap();
        let impulses = [0, 1].map(|foot| landing.wrench(foot, after.impulse).0);
        assert!(impulses.iter().any(|impulse| !is_in_cone(*impulse, 0.0)), "{k}: {impulses:?}");
        pulled += usize::from(impulses[0][2] < 0.0);
    }
    assert!(pulled > 0);
}

/// The torques of the motion, integrated with forward dynamics on the feet that stand (classical Runge and
/// Kutta, eight steps to an interval), come back to the start.
#[test]
fn a_step_integrated_comes_back_to_its_start() {
    let (problem, solution) = walk();
    let motion = &solution.trajectory;
    let stances = [on(&problem.robot, &FEET), on(&problem.robot, &FEET[..1])];
    let mut models = stances.each_ref().map(|stance| ConstrainedLagrangian::<f64>::new(stance.robot()));
    let x = integrated(motion, |middle, q, v, tau| {
        let model = &mut models[usize::from(middle > lift_off(solution))];
        model.evaluate(q, v, tau).unwrap().0.to_vec()
    });
    let mut back = exchanged(&x[..N]);
    back[0] -= LENGTH;
    let miss = largest_difference(&back, &motion.q[0]);
    let miss = miss.max(largest_difference(&exchanged(&x[N..]), &motion.v[0]));
    println!("integrated: {miss:.1e}");
    assert!(miss < 1e-3, "{miss}");
}

/// A shorter phase costs less: the cheapest one would be none.
#[test]
fn shorter_double_support_costs_less() {
    let short = solved(&with(0.12), file().options);
    assert_eq!(short.motion.status, Status::Converged);
    assert!(short.total() < 0.75 * walk().1.total(), "{}", short.total());
    assert!((lift_off(&short) - 0.12 * TIME).abs() < 1e-12);
}

/// With a price of time, both phases stretch in proportion to the best duration.
#[test]
fn the_best_duration_is_found() {
    let (problem, options) = (least_energy(&walk().0, TIME), file().options.with_tolerance(1e-4));
    let free = solved(&problem, options.clone());
    assert_eq!(free.motion.status, Status::Converged);
    assert!(free.motion.final_time > 1.5 * TIME);
    assert!((lift_off(&free) - 0.2 * free.motion.final_time).abs() < 1e-12);
    is_best_duration(&problem, &options, &free);
}

#[test]
fn what_is_no_double_support_is_refused_by_name() {
    for share in [0.0, 1.0, -0.1, f64::NAN, f64::INFINITY] {
        let error = Solver::new(&with(share), SolverOptions::default()).unwrap_err();
        let ProblemError::Gait { key, cause } = error else { panic!("{error}") };
        let is_out_of_range = matches!(*cause, GaitError::OutOfRange { .. });
        assert!(key.to_string() == "gait.double_support" && is_out_of_range, "{cause}");
    }
    let text = file().text;
    let from = "double_support = 0.2";
    assert!(text.contains(from));
    let folder = "../examples/problems";
    for to in ["double_support = \"long\"", "double_support = [0.2]", "double_support = true"] {
        let read = ProblemFile::from_text(&text.replace(from, to), folder, LoadOptions::default());
        let message = read.unwrap_err().to_string();
        assert!(message.contains("gait.double_support") && message.contains("number"), "{to}: {message}");
    }
}
