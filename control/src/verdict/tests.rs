//! Remarks in words.

use super::advice::advice;
use super::laws::not_kept;
use super::remark::{RemarkKey, Severity};
use super::settled;
use crate::options::{Polish, SolverOptions, Verify};
use crate::problem::file::ProblemFile;
use crate::problem::{FinalTime, MotionLimits, Objective, Problem};
use crate::result::limit_use::LimitViolation;
use crate::result::motion::Certificate;
use crate::result::polish_report::PolishOutcome;
use crate::result::solution::Solution;
use crate::result::verification::Check;
use crate::solve::recorder::Interruption;
use crate::solver::Solver;
use crate::status::Status;
use costate::robot::{LoadOptions, Robot};
use serde_json::json;

fn remarks(problem: &Problem, solution: &Solution) -> Vec<String> {
    solution.remarks(problem).into_iter().map(|remark| remark.text).collect()
}

#[test]
fn laws_are_distinguished_from_limits() {
    let file = "../examples/problems/four_bar.toml";
    let problem = ProblemFile::read(file, LoadOptions::default()).unwrap().problem;
    let law = |joint: &str, kind: &str, limit: f64| {
        let worst = json!({
            "joint": joint, "time": 0.5, "excess": 3.0, "unit": "N m", "value": 3.0 + limit, "limit": limit,
        });
        let worst: LimitViolation = serde_json::from_value(worst).unwrap();
        not_kept(&problem, kind, &worst)
    };
    let constraint = law("rocker_pivot", "torque", 0.0);
    assert_eq!(constraint.unwrap(), "the constraint 'rocker_pivot' is not kept at t = 0.5 s");
    let joint = law("coupler", "torque", 0.0);
    assert_eq!(joint.unwrap(), "joint 'coupler', which has no motor, would need 3 N m at t = 0.5 s");
    assert!(law("crank", "torque", 8.0).is_none() && law("crank", "rate", 0.0).is_none());
}

fn arm(robot: Robot, cost: Objective) -> Problem {
    Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0).with_cost(cost)
}

/// With another status.
fn ended(solution: &Solution, status: Status) -> Solution {
    let mut solution = solution.clone();
    solution.motion.status = status;
    solution
}

#[test]
fn what_helps_depends_on_costs_and_rotors() {
    let light = Robot::from_file("../robots/two_link.toml").unwrap();
    let heavy = ["shoulder", "elbow"]
        .iter()
        .fold(light.clone(), |robot, joint| robot.with_joint_armature(joint, 0.1).unwrap());
    let effort = || Objective::new(0.0, vec![1.0; 2]);
    let solved = Solver::new(&arm(light.clone(), effort()), SolverOptions::default()).unwrap().solve();
    let helps = |robot: &Robot, cost: Objective, status: Status| {
        let problem = arm(robot.clone(), cost).with_time(FinalTime::Free { guess: 1.0 });
        advice(&problem, &ended(&solved, status))
    };
    assert_eq!(helps(&light, effort(), Status::Converged), None);
    assert_eq!(helps(&heavy, effort(), Status::IterationLimit), None);
    let least_time = helps(&heavy, Objective::new(1.0, vec![0.0; 2]), Status::MeshLimit).unwrap();
    assert!(least_time.ends_with("what may help: a little cost.effort beside cost.time"), "{least_time}");
    let energy = Objective::new(0.0, vec![0.0; 2]).with_energy(vec![1.0; 2]);
    let energy = helps(&light, energy, Status::IterationLimit).unwrap();
    for part in ["beside cost.energy", "cost.energy_smoothing", "robot.armature", "all joints are without"] {
        assert!(energy.contains(part), "{energy}");
    }
    let one = light.with_joint_armature("shoulder", 0.1).unwrap();
    let drifts = helps(&one, effort(), Status::NotVerified).unwrap();
    assert!(drifts.contains("joint 'elbow' is without") && drifts.ends_with("a smaller solver.tolerance"));
    let fine = helps(&light, effort(), Status::MeshLimit).unwrap();
    assert!(fine.contains("a larger solver.tolerance") && !fine.contains("cost.effort"), "{fine}");
    let mut coarse = ended(&solved, Status::MeshLimit);
    coarse.motion.errors = vec![0.64];
    let coarse = advice(&arm(light.clone(), effort()), &coarse).unwrap();
    assert!(
        coarse.contains("do not resolve the motion: the error of its cost is estimated at 0.64"),
        "{coarse}"
    );
    assert!(!coarse.contains("larger solver.tolerance") && !coarse.contains("armature"), "{coarse}");
    let file = "../examples/problems/satellite_arm.toml";
    let satellite = ProblemFile::read(file, LoadOptions::default()).unwrap();
    let turned = Solver::new(&satellite.problem, satellite.options).unwrap().solve();
    for status in [Status::IterationLimit, Status::NewtonFailed] {
        let helps = advice(&satellite.problem, &ended(&turned, status)).unwrap();
        assert!(
            helps.ends_with("what may help: another start (solver.starts), another time (time.final)"),
            "{helps}"
        );
    }
    let mut cut = ended(&solved, Status::NotVerified);
    cut.motion.verification = Verify::Factors;
    let cut = advice(&arm(light, effort()), &cut).unwrap();
    assert!(cut.contains("cut off") && cut.contains("nothing was integrated"), "{cut}");
}

#[test]
fn the_check_that_failed_is_named() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = arm(robot, Objective::new(0.0, vec![1.0; 2]));
    let solved = Solver::new(&problem, SolverOptions::default()).unwrap().solve();
    let mut solution = ended(&solved, Status::NotVerified);
    let mut verified = solution.verified.take().unwrap_or_default();
    verified.optimality = Check::of(2e-4, 1e-5).at(Some(0.25), Some("elbow".into()));
    solution.verified = Some(verified.clone());
    let remark = solution.remarks(&problem).swap_remove(0);
    let text = &remark.text;
    assert!(text.contains("optimality: 2.0e-4 relative, 1.0e-5 allowed, elbow at 0.250000 s"), "{text}");
    assert!(text.ends_with("what may help: more solver.nodes; another start (solver.starts)"), "{text}");
    assert_eq!((remark.kind.as_deref(), remark.time), (Some("optimality"), Some(0.25)));
    assert_eq!((remark.value, remark.limit), (Some(2e-4), Some(1e-5)));
    verified.limits = Check::of(1e-3, 2e-4).at(Some(0.5), Some("rate of joint 'elbow'".into()));
    solution.verified = Some(verified.clone());
    let text = advice(&problem, &solution).unwrap();
    assert!(text.contains("limits: 1.0e-3") && text.contains("optimality: 2.0e-4"), "{text}");
    assert!(text.contains("a wider limit (rate of joint 'elbow')") && !text.contains("armature"), "{text}");
    verified.dynamics = Check::of(0.5, 1e-2);
    solution.verified = Some(verified);
    let text = advice(&problem, &solution).unwrap();
    assert!(text.contains("dynamics: 5.0e-1") && text.contains("robot.armature"), "{text}");
    assert!(text.ends_with("a smaller solver.tolerance"), "{text}");
}

#[test]
fn accelerations_of_arms_without_rotors_are_reported() {
    let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
    let [start, end] = [[0.0, -1.6, 1.8, -1.8, -1.57, 0.0], [0.8, -1.0, 1.2, -1.5, -1.57, 0.5]];
    let mut problem = Problem::rest_to_rest(robot, &start, &end, 1.0);
    problem.cost.effort = vec![1e-4; 6];
    let remarks_of = |problem: &Problem| {
        let solution = Solver::new(problem, SolverOptions::default()).unwrap().solve();
        assert!(solution.motion.status.is_solved(), "{}", solution.motion.status);
        remarks(problem, &solution).join("; ")
    };
    let sudden = "more than arms with gears do";
    assert!(remarks_of(&problem).contains(sudden));
    problem.limits.a_max = Some(vec![40.0; 6]);
    assert!(!remarks_of(&problem).contains(sudden));
}

/// A body turns 2.5 rad in 0.2 s: with a hinge a rotor would slow it down, a ball joint cannot have one.
#[test]
fn bodies_that_turn_freely_are_not_advised_to_have_rotors() {
    let turns = |kind: &str, start: &[f64], end: &[f64]| {
        let text = format!(
            "name = 'body'\ngravity = [0, 0, 0]\nconvention = 'placements'\n[[joint]]\nname = 'pivot'\n\
             type = '{kind}'\nmass = 1\ninertia = {{ xx = 0.01, yy = 0.01, zz = 0.01 }}\n"
        );
        let robot = Robot::from_toml_str(&text, LoadOptions::default()).unwrap();
        let torques = vec![100.0; robot.dof()];
        let problem = Problem::rest_to_rest(robot, start, end, 0.2);
        let mut problem = problem.with_limits(MotionLimits::none().with_torque_max(torques));
        problem.limits.from_robot = Some(true);
        let solution = Solver::new(&problem, SolverOptions::default()).unwrap().solve();
        assert!(solution.motion.status.is_solved(), "{}", solution.motion.status);
        let rate = solution.trajectory.v.iter().flatten().fold(0.0_f64, |most, v| most.max(v.abs()));
        assert!(rate > 15.0, "{rate}");
        remarks(&problem, &solution).join("; ")
    };
    let hinge = turns("revolute", &[0.0], &[2.5]);
    let (sin, cos) = 1.25_f64.sin_cos();
    let ball = turns("spherical", &[0.0, 0.0, 0.0, 1.0], &[0.0, 0.0, sin, cos]);
    assert!(hinge.contains("give robot.armature or limits.a_max"), "{hinge}");
    assert!(!ball.contains("armature"), "{ball}");
}

#[test]
fn a_saddle_is_reported() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0);
    let mut solution = Solver::new(&problem, SolverOptions::default()).unwrap().solve();
    // It needs more than the 1 N m of the robot's file, which it is not asked to keep.
    assert!(solution.remarks(&problem).iter().all(|remark| remark.key == RemarkKey::RobotLimit));
    solution.motion.certificate = Certificate::SaddleOnMesh;
    let text = remarks(&problem, &solution).join("; ");
    assert!(text.contains("a saddle") && text.contains("solver.starts"), "{text}");
}

/// A motion that leads elsewhere, or whose verification was not done, is not converged; what stopped the
/// search is its status then.
#[test]
fn only_verified_motions_are_converged() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let problem = arm(robot, Objective::new(0.0, vec![1.0; 2]));
    let options = SolverOptions::default().with_polish(Polish::Never);
    let solved = Solver::new(&problem, options).unwrap().solve();
    assert_eq!(settled(solved.clone(), None).motion.status, Status::Converged);
    let limit = Some(Interruption::TimeLimit);
    assert_eq!(settled(solved.clone(), limit).motion.status, Status::Converged);
    let mut stopped = solved.clone();
    stopped.motion.verification = Verify::None;
    assert_eq!(settled(stopped.clone(), limit).motion.status, Status::TimeLimit);
    assert_eq!(settled(stopped, None).motion.status, Status::NotVerified);
    let mut lost = solved;
    lost.motion.shooting_defect = 0.5;
    let lost = settled(lost, None);
    assert!(lost.motion.status == Status::NotVerified && lost.check(&problem).is_err());
}

/// A polish that is left is a note beside a solution.
#[test]
fn a_polish_that_was_left_is_a_note() {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let mut problem = arm(robot, Objective::new(0.0, vec![1.0; 2]));
    problem.limits.from_robot = Some(false);
    let mut solution = Solver::new(&problem, SolverOptions::default()).unwrap().solve();
    let is_note = |solution: &Solution| {
        let remarks = solution.remarks(&problem);
        let note = remarks.into_iter().find(|remark| remark.key == RemarkKey::PolishLeft);
        note.map(|note| (note.severity, note.text.contains("the extremal is not verified (cost")))
    };
    assert_eq!(is_note(&solution), None);
    let report = solution.polish.as_mut().unwrap();
    report.outcome = PolishOutcome::NotVerified;
    report.cause = Some("the extremal is not verified (cost: 1.0e-3 relative, 1.0e-4 allowed)".into());
    assert_eq!(is_note(&solution), Some((Severity::Note, true)));
    assert!(solution.check(&problem).is_ok());
}
