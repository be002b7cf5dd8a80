//! Joints that move faster than a mesh follows.

use costate::robot::{LoadOptions, Robot};
use costate_control::{MotionLimits, Objective, Polish, Problem, Solution, Solver, SolverOptions, Verify};

/// A two-link arm whose elbow carries next to nothing hangs from a joint at the tip: a wrist with this
/// inertia.
fn with_wrist(inertia: f64) -> Robot {
    let text = format!(
        r#"
name = "light_wrist"
convention = "placements"
[[joint]]
name = "shoulder"
placement = {{ xyz = [0.0, 0.0, 0.0] }}
axis = [0.0, 0.0, 1.0]
mass = 5.0
com = [0.5, 0.0, 0.0]
inertia = {{ xx = 0.1, yy = 0.5, zz = 0.5 }}
[[joint]]
name = "wrist"
placement = {{ xyz = [1.0, 0.0, 0.0] }}
axis = [0.0, 0.0, 1.0]
mass = {mass}
com = [0.01, 0.0, 0.0]
inertia = {{ xx = {inertia}, yy = {inertia}, zz = {inertia} }}
"#,
        mass = 1e4 * inertia
    );
    Robot::from_toml_str(&text, LoadOptions::default()).unwrap()
}

fn solved(robot: &Robot, nodes: usize) -> (Problem, Solution) {
    let problem = Problem::rest_to_rest(robot.clone(), &[0.0, 0.0], &[1.5, 0.4], 0.5)
        .with_cost(Objective::new(0.0, vec![1.0, 1.0]))
        .with_limits(MotionLimits::none());
    let options = SolverOptions::default()
        .with_tolerance(1e-6)
        .with_nodes(nodes)
        .with_max_nodes(nodes)
        .with_polish(Polish::Never)
        .with_verify(Verify::None);
    let solution = Solver::new(&problem, options).unwrap().solve();
    (problem, solution)
}

/// A wrist on a short pendulum: its rate in the field of the centrifugal acceleration a is sqrt(a m c / (I +
/// m c^2)).
#[test]
fn a_light_wrist_on_a_coarse_mesh_is_named() {
    let robot = with_wrist(1e-6);
    let (problem, coarse) = solved(&robot, 7);
    let fast =
        coarse.fastest_joint(&problem).unwrap().expect("two intervals do not follow a pendulum of 1 cm");
    assert_eq!(fast.joint, 1);
    assert!((fast.interval - 0.25).abs() < 1e-9, "{}", fast.interval);
    // The pendulum of length (I + m c^2)/(m c) = 0.02 m, in the acceleration of its pivot and of gravity in
    // the plane (none): some m/s^2.
    assert!(fast.time_constant > 0.005 && fast.time_constant < 0.0625, "{}", fast.time_constant);
    let inertia = fast.armature.expect("the other joint is slow");
    let slower = robot.with_joint_armature("wrist", 1.1 * inertia).unwrap();
    let mut other = problem;
    other.robot = slower;
    assert_eq!(
        coarse.fastest_joint(&other).unwrap().map(|fast| fast.joint),
        None,
        "with a rotor of {inertia}"
    );
    let (problem, fine) = solved(&robot, 601);
    assert_eq!(fine.fastest_joint(&problem).unwrap(), None);
}
