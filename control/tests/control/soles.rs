//! Steps of a biped with feet that stand flat: the ground pushes heel and toe, and nothing sinks into it.
//!
//! The judges use the frames, the inverse dynamics and the impact of the library, none of which the solver
//! uses for this; forces are those that the base needs, which has no motors.

use super::gaits::{example, largest_difference, solved};
use costate::constraints::Impact;
use costate::contacts::{Contact, Stance};
use costate::hamiltonian::Hamiltonian;
use costate::kinematics::Kinematics;
use costate::lagrangian::Lagrangian;
use costate::robot::{LoadOptions, Robot};
use costate_control::{
    Gait, GaitError, Problem, ProblemError, ProblemFile, Solution, Solver, SolverOptions, Status,
};
use std::sync::OnceLock;

pub(super) const N: usize = 9;
/// Legs exchanged.
const EXCHANGE: [usize; N] = [0, 1, 2, 6, 7, 8, 3, 4, 5];

fn file() -> ProblemFile {
    example("seven_link_walk")
}

fn gait() -> Gait {
    file().problem.gait.unwrap()
}

fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    let solution = solved(problem, options);
    assert_eq!(solution.motion.status, Status::Converged);
    check(problem, &solution);
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

pub(super) fn exchanged(list: &[f64]) -> Vec<f64> {
    EXCHANGE.iter().map(|&i| list[i]).collect()
}

/// Whether a step keeps what the ground asks for, at 2000 instants that are no points of its mesh.
fn check(problem: &Problem, solution: &Solution) {
    let gait = problem.gait.as_ref().unwrap();
    let ([heel, toe], mu) = (gait.sole.unwrap(), gait.friction);
    let time = solution.motion.final_time;
    let times: Vec<f64> = (0..2000).map(|k| time * (f64::from(k) + 0.5) / 2000.0).collect();
    let samples = solution.sample_at(problem, &times).unwrap();
    let mut model = Lagrangian::<f64>::new(&problem.robot);
    let mut kinematics = Kinematics::<f64>::new(&problem.robot);
    let [stance, swing] =
        [&gait.stance[0], &gait.swing[0]].map(|foot| problem.robot.frame_index(foot).unwrap());
    let weight = solution.gait.as_ref().unwrap().weight_times_length / gait.length;
    let mut lowest = 0.0_f64;
    for ((q, v), a) in samples.q.iter().zip(&samples.v).zip(&samples.a) {
        // What the base needs is force and torque of the ground, about the hips at (q_0, q_1).
        let tau = model.inverse_dynamics(q, v, a).unwrap();
        let [f_x, f_z, torque] = [tau[0], tau[1], tau[2]];
        let small = 2e-3 * weight;
        assert!(f_z > -small && f_x.abs() < mu * f_z + small, "{f_x} {f_z}");
        // Shares of heel and toe, from the torque about the origin of the foot.
        let about_foot = torque + q[1] * f_x - q[0] * f_z;
        let on_heel = (toe * f_z + about_foot) / (toe - heel);
        // A small torque is a large share of a short sole.
        let share = small * (0.2 / (toe - heel)).max(1.0);
        assert!(on_heel > -share && f_z - on_heel > -share, "{on_heel} of {f_z}");
        kinematics.set_position(q).unwrap();
        let flat = kinematics.pose(stance).unwrap();
        assert!(flat.position.iter().all(|x| x.abs() < 1e-5), "{:?}", flat.position);
        assert!(flat.rotation[2][0].abs() < 1e-5, "{:?}", flat.rotation);
        let foot = kinematics.pose(swing).unwrap();
        for corner in [heel, toe] {
            let [x, z] = [0, 2].map(|row| foot.position[row] + corner * foot.rotation[row][0]);
            let part = (x - corner) / gait.length;
            lowest = lowest.min(z - gait.clearance * (1.0 - part * part));
        }
    }
    assert!(lowest > -1.1e-5, "{lowest}");
    // The state after the landing on the whole sole is the one at the start, legs exchanged.
    let (motion, last) = (&solution.trajectory, solution.trajectory.t.len() - 1);
    let (q, v) = (&motion.q[last], &motion.v[last]);
    let before = Hamiltonian::<f64>::new(&problem.robot).momentum(q, v).unwrap().to_vec();
    let landing = Stance::new(&problem.robot, &[Contact::foot("foot", &gait.swing[0]).planar()]).unwrap();
    let mut impact = Impact::<f64>::new(landing.robot());
    let after = impact.evaluate(q, &before).unwrap();
    let miss = largest_difference(&exchanged(after.velocity), &motion.v[0]);
    assert!(miss < 1e-6, "{miss}");
    let ([x, _, z], [_, moment, _]) = landing.wrench(0, after.impulse);
    let on_heel = (toe * z + moment) / (toe - heel);
    let small = 1e-6 * weight;
    assert!(x.abs() < mu * z + small && on_heel > -small && z - on_heel > -small, "{x} {z} {moment}");
    // The foot that lands is flat, one step ahead, and the one that stood does not sink.
    let mut back = exchanged(q);
    back[0] -= gait.length;
    assert!(largest_difference(&back, &motion.q[0]) < 1e-9);
    assert!(solution.end_defect < 1e-3, "{}", solution.end_defect);
}

#[test]
fn a_biped_with_feet_walks() {
    let (problem, solution) = walk();
    let gait = solution.gait.as_ref().unwrap();
    assert!((gait.weight_times_length - 70.0 * 9.81 * 0.4).abs() < 1e-9, "{gait:?}");
    assert!((gait.work - gait.braking - gait.loss).abs() < 1e-4 * gait.work, "{gait:?}");
    let [foot] = &solution.constraints[..] else { panic!("{:?}", solution.constraints) };
    assert_eq!(
        (&*foot.name, &*foot.frame, foot.moment.len()),
        ("right_foot", "right_foot", foot.force.len())
    );
    let [heel, toe] = problem.gait.as_ref().unwrap().sole.unwrap();
    let [least, most] = centres_of_pressure(solution);
    assert!(least > heel && most < toe && most - least > 0.02, "{least} {most}");
}

/// Least and largest x of the centre of pressure at the nodes, which are those of the foot's frame.
fn centres_of_pressure(solution: &Solution) -> [f64; 2] {
    let foot = &solution.constraints[0];
    let rows = foot.force.iter().zip(&foot.moment).filter(|([.., z], _)| *z > 1.0);
    let places: Vec<f64> = rows.map(|([.., z], [_, moment, _])| -moment / z).collect();
    let least = places.iter().fold(f64::INFINITY, |least, &x| least.min(x));
    [least, places.iter().fold(f64::NEG_INFINITY, |most, &x| most.max(x))]
}

/// From first meshes that are coarse and fine the motion is the same.
#[test]
fn first_meshes_lead_to_the_same_step() {
    let (problem, best) = walk();
    for nodes in [145, 193] {
        let other = solve(problem, file().options.with_nodes(nodes));
        assert!((other.total() / best.total() - 1.0).abs() < 1e-5, "{nodes}: {}", other.total());
    }
}

/// The centre of pressure goes from the heel of a short sole to its toe, and no farther.
#[test]
fn a_short_sole_is_used_from_heel_to_toe() {
    let (heel, toe) = (-0.01, 0.005);
    let short = walk().0.clone().with_gait(gait().with_sole(heel, toe));
    let [least, most] = centres_of_pressure(&solve(&short, file().options));
    assert!((least - heel).abs() < 1e-5 && (most - toe).abs() < 1e-5, "{least} {most}");
}

#[test]
fn what_is_no_sole_is_refused_by_name() {
    let problem = file().problem;
    let refused = |problem: &Problem| match Solver::new(problem, SolverOptions::default()).unwrap_err() {
        ProblemError::Gait { key, cause } => (key.to_string(), *cause),
        other => panic!("{other}"),
    };
    for [heel, toe] in [[0.1, 0.1], [0.1, -0.1], [f64::NAN, 0.1], [-0.1, f64::INFINITY]] {
        let (key, found) = refused(&problem.clone().with_gait(gait().with_sole(heel, toe)));
        assert!(key == "gait.sole" && matches!(found, GaitError::OutOfRange { .. }), "{found}");
    }
    let text = file().text;
    let from = "sole = [-0.0665, 0.125]";
    assert!(text.contains(from));
    for to in ["sole = [0.1]", "sole = 0.1", "sole = [0.0, \"toe\"]", "sole = [0.0, 0.1, 0.2]"] {
        let file =
            ProblemFile::from_text(&text.replace(from, to), "../examples/problems", LoadOptions::default());
        let message = file.unwrap_err().to_string();
        assert!(message.contains("gait.sole") && message.contains("two numbers"), "{to}: {message}");
    }
}

/// A frame whose x axis is not ahead cannot carry a sole.
#[test]
fn a_frame_that_is_turned_is_refused() {
    let text = std::fs::read_to_string("../robots/seven_link.toml").unwrap();
    let frame = "name = \"left_foot\"\nparent = \"left_ankle\"\nplacement = { xyz = [0.0, 0.0, -0.06825] }";
    let turned = frame.replace("-0.06825] }", "-0.06825], rpy = [0.0, 0.0, 3.0] }");
    assert!(text.contains(frame));
    let robot = Robot::from_toml_str(&text.replace(frame, &turned), LoadOptions::default()).unwrap();
    let mut problem = file().problem;
    problem.robot = robot;
    match Solver::new(&problem, SolverOptions::default()).unwrap_err() {
        ProblemError::Gait { key, cause } => {
            let expected = GaitError::Tilted { frame: "left_foot".into() };
            assert_eq!((key.to_string().as_str(), *cause), ("gait.swing", expected));
        }
        other => panic!("{other}"),
    }
}
