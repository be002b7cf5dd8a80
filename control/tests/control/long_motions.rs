//! Motions that take much longer than they need: a fast way and a rest are a candidate.

use costate::lagrangian::Lagrangian;
use costate::robot::Robot;
use costate_control::{MotionLimits, Objective, Polish, Problem, Solution, Solver, SolverOptions, Status};

const FROM: [f64; 6] = [-0.12, 1.2, -1.7, 1.6, -1.5, -0.47];
const TO: [f64; 6] = [0.08, -0.14, -1.6, 0.3, -0.13, -0.7];
const EFFORT: [f64; 6] = [4.4e-5, 4.4e-5, 4.4e-5, 1.3e-3, 1.3e-3, 1.3e-3];

/// A UR5 with the inertias of its rotors.
fn arm() -> Robot {
    let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
    let rotors = [
        ("shoulder_pan_joint", 2.0),
        ("shoulder_lift_joint", 2.0),
        ("elbow_joint", 1.0),
        ("wrist_1_joint", 0.3),
        ("wrist_2_joint", 0.3),
        ("wrist_3_joint", 0.3),
    ];
    rotors.iter().fold(robot, |robot, (joint, inertia)| robot.with_joint_armature(joint, *inertia).unwrap())
}

fn solved(time: f64) -> Solution {
    let problem = Problem::rest_to_rest(arm(), &FROM, &TO, time)
        .with_cost(Objective::new(0.0, EFFORT.to_vec()))
        .with_limits(MotionLimits::none().with_from_robot(true));
    let options = SolverOptions::default().with_tolerance(1e-4).with_polish(Polish::Never);
    Solver::new(&problem, options).unwrap().solve()
}

/// What a second of rest costs.
fn rest(q: &[f64]) -> f64 {
    let mut model = Lagrangian::<f64>::new(&arm());
    let torques = model.gravity(q).unwrap();
    torques.iter().zip(EFFORT).map(|(tau, r)| 0.5 * r * tau * tau).sum()
}

/// A motion in less time with a rest at its cheaper end is a candidate.
#[test]
fn more_time_costs_no_more_than_a_rest() {
    let hold = rest(&FROM).min(rest(&TO));
    let mut before: Option<(f64, f64)> = None;
    for time in [4.0, 15.0, 40.0] {
        let solution = solved(time);
        let cost = solution.motion.cost;
        assert_eq!(solution.motion.status, Status::Converged, "{time} s");
        if let Some((shorter, least)) = before {
            let candidate = least + (time - shorter) * hold;
            assert!(cost <= candidate * (1.0 + 1e-3), "{time} s: {cost}, {least} and a rest: {candidate}");
        }
        before = Some((time, cost));
    }
}
