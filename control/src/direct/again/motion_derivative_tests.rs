//! Derivatives against solving again on the same mesh with the same final barrier.

use super::*;
use crate::options::{MachineCode, SolverOptions};
use crate::problem::{FinalTime, MotionLimits, Objective, Problem};
use costate::robot::Robot;

/// The two-link arm, a quarter turn of both joints.
fn arm(limits: MotionLimits) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let quarter = std::f64::consts::FRAC_PI_2;
    Problem::rest_to_rest(robot, &[0.0; 2], &[quarter; 2], 1.0).with_limits(limits)
}

fn in_free_time(mut problem: Problem) -> Problem {
    problem.time = FinalTime::Free { guess: 1.5 };
    problem.with_cost(Objective::new(20.0, vec![1.0; 2]))
}

/// On the central path at mu.
fn centred(problem: &Problem, mu: f64) -> Resolve {
    let options = SolverOptions::default().with_machine_code(MachineCode::Never);
    let mut motion = Resolve::new(problem, options.with_nodes(61).with_tolerance(1e-5)).unwrap();
    motion.solve().unwrap();
    assert!(motion.interior.go_to_centre(mu, 200).unwrap());
    motion
}

/// Cost, T, states and torques at all points.
fn values(problem: &Problem, mu: f64) -> [Vec<f64>; 4] {
    let motion = centred(problem, mu);
    let (points, n) = (&motion.interior.points, motion.dof());
    let states = (0..points.count()).flat_map(|p| points.z(p)[..2 * n].to_vec()).collect();
    let cost = motion.interior.figures.cost;
    [vec![cost], vec![motion.interior.spline.duration()], states, points.tau.clone()]
}

/// Largest differences from central differences, relative to the largest of each kind.
fn differences(problem: impl Fn(f64) -> Problem, parameter: &MotionParameter, mu: f64) -> [f64; 4] {
    const STEP: f64 = 1e-3;
    let found = centred(&problem(0.0), mu).derivative_by(parameter).unwrap().unwrap();
    // The cost of the barrier problem has another derivative: that of J alone is not compared.
    let found = [vec![found.cost], vec![found.final_time], found.states, found.torques];
    let (above, below) = (values(&problem(STEP), mu), values(&problem(-STEP), mu));
    std::array::from_fn(|kind| {
        let slope = above[kind].iter().zip(&below[kind]).map(|(above, below)| (above - below) / (2.0 * STEP));
        let slopes: Vec<f64> = slope.collect();
        let size = slopes.iter().fold(0.0, |most: f64, slope| most.max(slope.abs()));
        let far = slopes.iter().zip(&found[kind]).fold(0.0, |most: f64, (a, b)| most.max((a - b).abs()));
        if size > 0.0 { far / size } else { far }
    })
}

#[test]
fn on_one_mesh_with_one_barrier_derivatives_are_exact() {
    let torques = |fixed: bool| {
        move |step: f64| {
            let problem = arm(MotionLimits::none().with_torque_max(vec![12.0, 5.0 + step]));
            if fixed {
                arm(MotionLimits::none().with_torque_max(vec![16.0, 6.0 + step]))
            } else {
                in_free_time(problem)
            }
        }
    };
    let rates = |step: f64| {
        arm(MotionLimits::none().with_v_max(vec![2.2 + step, 10.0]).with_torque_max(vec![60.0, 30.0]))
    };
    for mu in [1e-2, 1e-4] {
        let all = [
            differences(torques(false), &MotionParameter::TorqueMax(1), mu),
            differences(torques(true), &MotionParameter::TorqueMax(1), mu),
            differences(rates, &MotionParameter::VelocityMax(0), mu),
        ];
        for found in all {
            eprintln!("mu {mu}: {found:?}");
            assert!(found[1..].iter().all(|&part| part < 1e-3), "{mu}: {found:?}");
        }
    }
}
