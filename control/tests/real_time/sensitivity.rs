//! Derivatives of the cost by parameters of the robot, against solving again.

use crate::solved::problem;
use costate::parameters::ParameterSet;
use costate::robot::{FrameSpec, Placement};
use costate_control::{
    CostDerivative, FinalTime, MotionLimits, Objective, Polish, Problem, SensitivityError, Solution, Solver,
    SolverOptions, Status, cost_by_parameters,
};

/// Of the direct method, close to the least cost.
pub fn direct(tolerance: f64) -> SolverOptions {
    SolverOptions::default().with_tolerance(tolerance).with_polish(Polish::Never)
}

pub fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    let solution = Solver::new(problem, options).unwrap().solve();
    assert!(solution.motion.status.is_solved(), "{}", solution.motion.status);
    solution
}

/// The two-link arm with a frame at its tip, and the mass there, the length of rod 1 and the inertia of a
/// body at the tip.
pub fn two_link() -> (Problem, ParameterSet) {
    let mut problem = problem("two_link").with_limits(MotionLimits::none());
    let tip = Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0; 3]);
    problem.robot = problem.robot.with_frame(FrameSpec::new("tip").on("elbow").placed(tip)).unwrap();
    let set = ParameterSet::new(&problem.robot).payload("tip", "tip");
    let set = set.and_then(|set| set.named("elbow.x")).unwrap();
    (problem, set)
}

fn named<'a>(found: &'a [CostDerivative], name: &str) -> &'a CostDerivative {
    found.iter().find(|one| one.name == name).unwrap()
}

/// The slope of the cost of solving again with one parameter more and less.
fn slope(problem: &Problem, set: &ParameterSet, name: &str, step: f64, options: &SolverOptions) -> f64 {
    let at = set.names().iter().position(|one| one == name).unwrap();
    let cost = |sign: f64| {
        let mut values = set.values().to_vec();
        values[at] += sign * step;
        let mut changed = problem.clone();
        changed.robot = set.robot_with(&values).unwrap();
        solve(&changed, options.clone()).total()
    };
    (cost(1.0) - cost(-1.0)) / (2.0 * step)
}

#[test]
fn the_two_link_arm_has_the_published_derivatives() {
    let (problem, set) = two_link();
    let set = set.link("shoulder").unwrap();
    for options in [SolverOptions::default().with_tolerance(1e-9), direct(1e-9)] {
        let solution = solve(&problem, options);
        let found = cost_by_parameters(&problem, &solution, &set).unwrap();
        let by = |name: &str| named(&found, name).derivative;
        // Rod 1 is uniform: a longer one carries the elbow, its first moment and its inertia farther out.
        let rod = by("elbow.x") + 0.5 * by("shoulder.h_x") + 2.0 / 3.0 * by("shoulder.J_zz");
        for (found, value) in
            [(by("tip.mass"), 121.36971718), (rod, 357.75366826), (by("tip.J_zz"), 271.71942099)]
        {
            assert!((found / value - 1.0).abs() < 1e-8, "{found} instead of {value}");
        }
    }
}

/// Compares with solving again; steps are this part of the value.
pub fn check_against_slopes(
    problem: &Problem,
    names: &[&str],
    options: &SolverOptions,
    within: f64,
) -> Solution {
    let set = problem.parameters();
    let solution = solve(problem, options.clone());
    let found = cost_by_parameters(problem, &solution, &set).unwrap();
    assert_eq!(found.len(), set.len());
    for &name in names {
        let one = named(&found, name);
        let step = 0.01 * one.value.abs().max(0.01);
        let expected = slope(problem, &set, name, step, options);
        let size = (solution.total() / one.value.abs().max(1.0)).max(expected.abs());
        assert!((one.derivative - expected).abs() < within * size, "{name}: {} {expected}", one.derivative);
    }
    solution
}

#[test]
fn derivatives_are_those_of_solving_again() {
    let names = ["shoulder.h_x", "elbow.x", "flange.mass", "elbow.J_zz", "shoulder.armature", "gravity_z"];
    let puma = problem("puma560_pick_and_place").with_limits(MotionLimits::none());
    check_against_slopes(&puma, &names, &direct(1e-8), 1e-4);
}

/// Whether limits of a kind are active.
fn is_active(solution: &Solution, kind: &str) -> bool {
    let mut kinds = solution.limits.kinds().filter(|(name, _)| *name == kind);
    kinds.next().unwrap().1.is_some_and(|usage| !usage.active.is_empty())
}

#[test]
fn active_limits_of_torques_and_rates_are_no_obstacle() {
    let arm = problem("ur5_limits");
    let names = ["elbow_joint.mass", "wrist_1_joint.z", "shoulder_lift_joint.J_zz", "gravity_z"];
    let solution = check_against_slopes(&arm, &names, &direct(1e-7), 1e-3);
    assert!(is_active(&solution, "rate") || is_active(&solution, "torque"), "{:?}", solution.limits);
    // With a free time, both at once.
    let mut arm = two_link().0.with_limits(MotionLimits::none().with_v_max(vec![f64::INFINITY, 3.0]));
    arm.limits = arm.limits.with_torque_max(vec![12.0, 5.0]);
    arm.time = FinalTime::Free { guess: 2.0 };
    arm.cost = Objective::new(20.0, vec![1.0; 2]);
    let names = ["elbow.mass", "elbow.x", "elbow.h_x", "shoulder.J_zz"];
    let solution = check_against_slopes(&arm, &names, &direct(1e-7), 1e-3);
    assert!(is_active(&solution, "rate") && is_active(&solution, "torque"), "{:?}", solution.limits);
}

/// The costate of the momenta is not what torques cost then: limits of accelerations are in it too.
#[test]
fn active_limits_of_accelerations_are_no_obstacle() {
    let mut arm = two_link().0.with_limits(MotionLimits::none().with_a_max(vec![8.0, f64::INFINITY]));
    arm.cost = Objective::new(0.0, vec![1.0; 2]);
    let names = ["elbow.mass", "elbow.x", "elbow.h_x", "shoulder.J_zz"];
    let solution = check_against_slopes(&arm, &names, &direct(1e-7), 1e-3);
    assert!(is_active(&solution, "acceleration"), "{:?}", solution.limits);
    let (of_torques, of_momenta) = (&solution.trajectory.y_tau, &solution.trajectory.y_p);
    assert!(of_torques.len() == of_momenta.len() && of_torques != of_momenta);
    // The same of a motion that was saved.
    let set = arm.parameters();
    let saved: Solution = serde_json::from_value(serde_json::to_value(&solution).unwrap()).unwrap();
    let of = |solution: &Solution| cost_by_parameters(&arm, solution, &set).unwrap();
    for (one, other) in of(&solution).iter().zip(of(&saved)) {
        let off = (one.derivative - other.derivative).abs();
        assert!(off < 1e-7 * solution.total().max(one.derivative.abs()), "{one:?} {other:?}");
    }
}

#[test]
fn polished_and_saved_motions_have_the_same_derivatives() {
    let arm = problem("two_link_bounded").with_limits(MotionLimits::none());
    let set = arm.parameters();
    let of = |solution: &Solution| cost_by_parameters(&arm, solution, &set).unwrap();
    let motion = solve(&arm, direct(1e-8));
    let found = of(&motion);
    let polished = solve(&arm, direct(1e-8).with_polish(Polish::Always));
    assert!(polished.polish.as_ref().unwrap().outcome.is_polished());
    let saved: Solution = serde_json::from_value(serde_json::to_value(&motion).unwrap()).unwrap();
    let largest = found.iter().fold(0.0, |most: f64, one| most.max(one.derivative.abs()));
    for (other, within) in [(of(&polished), 1e-5), (of(&saved), 1e-7)] {
        for (one, other) in found.iter().zip(&other) {
            let off = (one.derivative - other.derivative).abs();
            assert!(one.name == other.name && off < within * largest, "{one:?} {other:?}");
        }
    }
}

#[test]
fn what_has_no_derivative_is_refused_by_name() {
    let (mut arm, set) = two_link();
    let solution = solve(&arm, direct(1e-6));
    let wrong = |arm: &Problem, solution: &Solution, set: &ParameterSet| {
        cost_by_parameters(arm, solution, set).unwrap_err()
    };
    let mut unsolved = solution.clone();
    unsolved.motion.status = Status::IterationLimit;
    let error = wrong(&arm, &unsolved, &set);
    assert!(error.to_string().contains("its status is iteration_limit"), "{error}");
    let other = ParameterSet::new(&problem("pendulum_swing_up").robot);
    assert!(matches!(wrong(&arm, &solution, &other), SensitivityError::OtherRobot { .. }));
    arm = problem("pendulum_swing_up");
    assert!(wrong(&arm, &solution, &other).to_string().contains("the motion is that of another robot"));
}
