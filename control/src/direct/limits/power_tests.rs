//! Functions of rates and torques against central differences, and what they limit.

use super::super::side::Limited;
use super::{Function, Powers};
use crate::direct::points::generic_points::RobotPoints;
use crate::direct::points::values::{PointDynamics, Points};
use crate::problem::{MotionLimits, Objective, Problem};
use costate::robot::Robot;

const INF: f64 = f64::INFINITY;

fn problem(limits: MotionLimits) -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, 0.5], 1.0).with_limits(limits)
}

/// All functions at once.
fn all() -> Powers {
    let limits = MotionLimits::none().with_power_max(vec![5.0, INF]).with_total_power_max(7.0);
    let limits = limits.with_torque_max(vec![4.0, 3.0]).with_torque_speed(vec![1.0, INF], vec![3.0, INF]);
    Powers::new(&problem(limits))
}

#[test]
fn rows_and_sides_are_those_of_the_limits() {
    let powers = all();
    // Two powers, their sum, both sides of the line of one motor.
    assert_eq!(powers.rows(), 5);
    let joints: Vec<_> = (0..5).map(|row| powers.joint(row)).collect();
    assert_eq!(joints, [Some(0), Some(1), None, Some(0), Some(0)]);
    let found: Vec<_> =
        powers.sides().iter().map(|s| (s.limited, s.joint, s.sign * s.bound, s.range)).collect();
    let (power, line) = (Limited::Power, Limited::TorqueSpeed);
    let both = |row, most: f64| [(power, row, -most, 2.0 * most); 2];
    let expected = [both(0, 5.0), both(2, 7.0), [(line, 3, -6.0, 8.0), (line, 4, -6.0, 8.0)]];
    assert_eq!(found, expected.concat());
    assert!(Powers::new(&problem(MotionLimits::none().with_torque_max(vec![1.0; 2]))).rows() == 0);
    // A cost of energy needs the powers of the joints.
    let costly = problem(MotionLimits::none());
    let costly = costly.with_cost(Objective::new(0.0, vec![1.0; 2]).with_energy(vec![0.0, 1.0]));
    let powers = Powers::new(&costly);
    assert!(powers.rows() == 2 && powers.sides().is_empty());
}

#[test]
fn a_motor_loses_torque_where_it_drives_fast() {
    // 4 N m up to 1 rad/s, then less, none at 3 rad/s; when it brakes, all of it.
    let powers = all();
    for (v, tau, most) in [
        (0.5, 4.0, 0.0),
        (1.0, 4.0, 0.0),
        (2.0, 2.0, 0.0),
        (2.0, 2.4, 0.4),
        (3.0, 0.0, 0.0),
        (3.0, -4.0, 0.0),
        (-2.0, -2.4, 0.4),
        (-2.0, 4.0, 0.0),
        (-3.5, -1.0, 2.0),
    ] {
        let lines = powers.sides().iter().filter(|side| side.limited == Limited::TorqueSpeed);
        let excess = lines.map(|side| {
            let value = powers.functions[side.joint].value(&[v, 0.0], &[tau, 0.0]);
            // As a torque and its limit at this rate.
            let (of_rate, bound) = (powers.line(side.joint, &[v, 0.0]), side.bound);
            assert!((value - of_rate - tau).abs() < 1e-15);
            assert!((bound - of_rate + side.sign * 4.0 * (3.0 + side.sign * v) / 2.0).abs() < 1e-14);
            side.sign * (bound - value)
        });
        assert!((excess.fold(0.0, f64::max) - most).abs() < 1e-14, "{v} {tau}");
    }
    assert!((powers.violation(&[2.0, 0.0], &[2.4, 0.0]) - 0.05).abs() < 1e-14);
    // The power of the first joint, and that of both.
    assert!((powers.violation(&[-2.0, 1.0], &[4.0, 0.0]) - 3.0 / 10.0).abs() < 1e-14);
    assert!((powers.violation(&[1.0, -2.0], &[4.5, -6.0]) - 9.5 / 14.0).abs() < 1e-14);
    assert_eq!(powers.violation(&[0.5, 0.5], &[1.0, 1.0]), 0.0);
}

#[test]
fn asymmetric_torques_have_two_slopes() {
    let mut limited = problem(MotionLimits::none().with_torque_speed(vec![1.0, INF], vec![2.0, INF]));
    limited.bounds = Some(crate::problem::Bounds::new(vec![-2.0, -9.0], vec![6.0, 9.0]));
    let powers = Powers::new(&limited);
    assert_eq!(powers.functions, [Function::line(0, 6.0), Function::line(0, 2.0)]);
    assert_eq!(powers.sides().iter().map(|side| side.bound).collect::<Vec<_>>(), [12.0, -4.0]);
    // A motor that pulls to one side only has one line.
    limited.bounds = Some(crate::problem::Bounds::new(vec![1.0, -9.0], vec![6.0, 9.0]));
    assert_eq!(Powers::new(&limited).functions, [Function::line(0, 6.0)]);
}

#[test]
fn derivatives_along_a_motion_are_those_of_the_values() {
    let (powers, step) = (all(), 1e-5);
    let weights = [0.7, -1.3, 0.4, 2.0, -0.6];
    let mut dynamics = RobotPoints::new(&problem(MotionLimits::none()).robot);
    let mut at = |z: &[f64], h_weights: &[f64]| {
        let mut points = Points::default();
        points.resize(2, [0, 5], std::iter::once(1));
        points.z.copy_from_slice(z);
        dynamics.evaluate(&mut points).unwrap();
        points.h_weights.copy_from_slice(h_weights);
        powers.weigh_torques(&mut points);
        dynamics.contract(&mut points).unwrap();
        powers.contract(&mut points);
        points
    };
    let z = [0.3, -0.8, 1.4, -0.9, 0.6, 2.1];
    let middle = at(&z, &weights);
    for j in 0..6 {
        let [below, above] = [-step, step].map(|change| {
            let mut z = z;
            z[j] += change;
            at(&z, &weights)
        });
        for row in 0..5 {
            let difference = (above.h[row] - below.h[row]) / (2.0 * step);
            assert!((middle.h_z[6 * row + j] - difference).abs() < 1e-7, "{row} {j}");
        }
        for i in 0..6 {
            let slope = |points: &Points| -> f64 {
                weights.iter().enumerate().map(|(row, weight)| weight * points.h_z[6 * row + i]).sum()
            };
            let difference = (slope(&above) - slope(&below)) / (2.0 * step);
            assert!((middle.hessian[6 * i + j] - difference).abs() < 1e-6, "{i} {j}");
        }
    }
}
