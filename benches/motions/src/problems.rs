//! The problems: chains of joints with all limits, and motions of known robots.

use crate::robots::chain;
use costate::lagrangian::Lagrangian;
use costate::robot::{Joint, LoadOptions, Robot};
use costate_control::{MotionLimits, Objective, Problem, ProblemFile};
use fastrand::Rng;
use nalgebra::DMatrix;
use std::error::Error;

/// What a run may end with.
pub type Failure = Box<dyn Error>;

/// The folder of the project.
pub const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Largest distance of a joint (rad), and duration (s).
const DISTANCE: f64 = 1.0;
const DURATION: f64 = 1.0;
/// Limits in parts of the peaks of the cubic motion: rates are below them, torques above.
const RATE: f64 = 0.85;
const TORQUE: f64 = 1.2;
/// Where a Panda turns from, and to.
const PANDA: [[f64; 7]; 2] = [[0.0, -0.5, 0.0, -2.2, 0.0, 1.7, 0.8], [0.9, 0.1, 0.3, -1.6, -0.4, 2.0, 0.2]];
/// Places at which its torques are looked at.
const PLACES: usize = 50;

/// A chain of n joints with general axes moves from rest to rest, all rates and torques limited. The price of
/// a torque is 1/s^2, s the peak of the cubic motion.
pub fn of_chain(n: usize, seed: u64) -> Result<Problem, Failure> {
    let robot = chain(n)?;
    let mut random = Rng::with_seed(1000 * n as u64 + seed);
    let mut draw = |most: f64| -> Vec<f64> { (0..n).map(|_| most * (2.0 * random.f64() - 1.0)).collect() };
    let from = draw(DISTANCE);
    let to: Vec<f64> = from.iter().zip(draw(DISTANCE)).map(|(q, step)| q + step).collect();
    let peaks = peaks(&robot, &from, &to)?;
    // A joint that hardly moves has room to.
    let rate = |(from, to): (&f64, &f64)| RATE * 1.5 * (to - from).abs().max(0.2) / DURATION;
    let rates = from.iter().zip(&to).map(rate).collect();
    let limits = MotionLimits::none()
        .with_v_max(rates)
        .with_torque_max(peaks.iter().map(|peak| TORQUE * peak).collect());
    let effort = peaks.iter().map(|peak| 1.0 / (peak * peak)).collect();
    let problem = Problem::rest_to_rest(robot, &from, &to, DURATION);
    Ok(problem.with_cost(Objective::new(0.0, effort)).with_limits(limits))
}

/// Largest torques of the cubic motion (N m).
fn peaks(robot: &Robot, from: &[f64], to: &[f64]) -> Result<Vec<f64>, Failure> {
    let mut model = Lagrangian::<f64>::new(robot);
    let mut peaks = vec![0.0_f64; from.len()];
    for k in 0..=PLACES {
        let s = k as f64 / PLACES as f64;
        let [way, rate, bend] = [s * s * (3.0 - 2.0 * s), 6.0 * s * (1.0 - s), 6.0 - 12.0 * s];
        let of = |factor: f64, order: i32| -> Vec<f64> {
            from.iter().zip(to).map(|(from, to)| factor * (to - from) / DURATION.powi(order)).collect()
        };
        let q: Vec<f64> = from.iter().zip(of(way, 0)).map(|(from, step)| from + step).collect();
        let tau = model.inverse_dynamics(&q, &of(rate, 1), &of(bend, 2))?;
        peaks.iter_mut().zip(tau).for_each(|(peak, tau)| *peak = peak.max(tau.abs()));
    }
    Ok(peaks)
}

/// A file of `examples/problems`.
pub fn of_file(file: &str) -> Result<Problem, Failure> {
    Ok(ProblemFile::read(format!("{ROOT}/examples/problems/{file}"), LoadOptions::default())?.problem)
}

/// A Panda turns to its side in 1 s and keeps the limits of its file: position, rate and torque.
pub fn panda() -> Result<Problem, Failure> {
    let robot = Robot::from_file(format!("{ROOT}/robots/panda.urdf"))?;
    let [from, to] = PANDA;
    let effort = [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0].map(|most: f64| 1.0 / (most * most));
    let problem = Problem::rest_to_rest(robot, &from, &to, DURATION);
    Ok(problem
        .with_cost(Objective::new(0.0, effort.to_vec()))
        .with_limits(MotionLimits::none().with_from_robot(true)))
}

/// The same turn [`between`] rests, with the inertias of rotors.
pub fn panda_with_rotors() -> Result<Problem, Failure> {
    let [from, to] = PANDA;
    between("panda.urdf", from, to)
}

/// A robot with the inertias of rotors turns from rest to rest in 1 s, at the price of its torques in parts
/// of their limits.
pub fn between<const N: usize>(file: &str, from: [f64; N], to: [f64; N]) -> Result<Problem, Failure> {
    let robot = Robot::from_file(format!("{ROOT}/robots/{file}"))?;
    let rotor = |i: usize| if i < 3 { 1.0 } else { 0.2 };
    let rotors = DMatrix::from_fn(N, N, |i, j| if i == j { rotor(i) } else { 0.0 });
    let price = |joint: &Joint| 1.0 / (joint.limits.effort * joint.limits.effort);
    let effort = robot.independent_joints().map(price).collect();
    let problem = Problem::rest_to_rest(robot.with_armature(rotors)?, &from, &to, DURATION);
    Ok(problem.with_cost(Objective::new(0.0, effort)))
}
