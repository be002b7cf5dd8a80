//! Several points at a time against one after the other.

use super::{LanePoints, RobotPoints};
use crate::direct::points::values::{PointDynamics, Points};
use costate::robot::Robot;
use costate_test_support::allocations::allocations;
use costate_test_support::properties;
use costate_test_support::proptest::prelude::TestCaseError;
use costate_test_support::random_robot::cases;
use costate_test_support::robots::file;
use costate_test_support::rounding::{InverseBounds, close};

/// Points of a robot around z = (q, v, a), and weights.
pub(in super::super) fn points(n: usize, count: usize, z: &[f64], weights: &[f64]) -> Points {
    let mut points = Points::default();
    points.resize(n, [0; 2], std::iter::once(count));
    let mut random = fastrand::Rng::with_seed(5);
    for (to, given) in [(&mut points.z, z), (&mut points.weights, weights)] {
        for (p, row) in to.chunks_exact_mut(given.len()).enumerate() {
            let mut near = |given: f64| if p > 0 { given + random.f64() - 0.5 } else { given };
            row.iter_mut().zip(given).for_each(|(to, given)| *to = near(*given));
        }
    }
    // Nothing of the past may remain.
    points.tau.fill(f64::NAN);
    points.tau_z.fill(f64::NAN);
    points.hessian.fill(f64::NAN);
    points
}

/// Another way against one point after the other, for so many points; the largest differences in parts of the
/// largest entry, for each point.
pub(in super::super) fn check(
    robot: &Robot,
    mut other: impl PointDynamics,
    count: usize,
    z: &[f64],
    weights: &[f64],
) {
    let n = robot.dof();
    let mut generic = RobotPoints::new(robot);
    let mut expected = points(n, count, z, weights);
    let mut found = expected.clone();
    generic.evaluate(&mut expected).unwrap();
    other.evaluate(&mut found).unwrap();
    alike(&expected.tau, &found.tau, n);
    generic.contract(&mut expected).unwrap();
    other.contract(&mut found).unwrap();
    alike(&expected.tau, &found.tau, n);
    alike(&expected.tau_z, &found.tau_z, 3 * n * n);
    alike(&expected.hessian, &found.hessian, 9 * n * n);
}

/// The same of a random robot, whose torques may cancel: by the bounds of their rounding errors at each
/// point.
pub(in super::super) fn check_rounding(
    robot: &Robot,
    mut other: impl PointDynamics,
    count: usize,
    z: &[f64],
    weights: &[f64],
) -> Result<(), TestCaseError> {
    let n = robot.dof();
    let mut expected = points(n, count, z, weights);
    let mut found = expected.clone();
    RobotPoints::new(robot).contract(&mut expected).unwrap();
    other.evaluate(&mut found).unwrap();
    let torques = found.tau.clone();
    other.contract(&mut found).unwrap();
    for p in 0..count {
        let of = |all: &[f64], size: usize| all[p * size..(p + 1) * size].to_vec();
        let (z, w) = (of(&found.z, 3 * n), of(&found.weights, n));
        let bounds = InverseBounds::new(robot, [&z[..n], &z[n..2 * n], &z[2 * n..], &w]);
        let tau = of(&expected.tau, n);
        close("tau alone", &of(&torques, n), &tau, bounds.tau)?;
        close("tau", &of(&found.tau, n), &tau, bounds.tau)?;
        let (tau_z, hessian) = (3 * n * n, 9 * n * n);
        close("tau_z", &of(&found.tau_z, tau_z), &of(&expected.tau_z, tau_z), bounds.tau_z)?;
        close("w'tau_zz", &of(&found.hessian, hessian), &of(&expected.hessian, hessian), bounds.w_tau_zz)?;
    }
    Ok(())
}

pub(in super::super) fn alike(expected: &[f64], found: &[f64], size: usize) {
    for (expected, found) in expected.chunks_exact(size).zip(found.chunks_exact(size)) {
        let largest = expected.iter().fold(1e-6, |most: f64, entry| most.max(entry.abs()));
        for (expected, found) in expected.iter().zip(found) {
            assert!((expected - found).abs() <= 1e-12 * largest, "{expected} {found} of {largest}");
        }
    }
}

/// For every length of the last group, near and far from zero.
pub(in super::super) fn check_lengths<D: PointDynamics>(dynamics: impl Fn(&Robot) -> D) {
    let robot = file("panda.urdf");
    let z: Vec<f64> = (0..21).map(|k| (0.9 * k as f64).sin()).collect();
    for count in [1, 2, 3, 4, 5, 8, 11] {
        check(&robot, dynamics(&robot), count, &z, &z[..7]);
    }
    let far: Vec<f64> = z.iter().enumerate().map(|(k, z)| if k < 7 { 1e6 * z } else { 1e3 * z }).collect();
    check(&robot, dynamics(&robot), 6, &far, &z[..7]);
}

properties! {
    48;

    #[test]
    fn random_robots_have_the_same_points_in_lanes(case in cases(6)) {
        let robot = case.robot();
        let n = robot.dof();
        let z = [&case.q[..n], &case.v[..n], &case.u[..n]].concat();
        check_rounding(&robot, LanePoints::new(&robot), 1 + case.parts.len(), &z, &case.y[..n])?;
    }
}

#[test]
fn every_length_of_the_last_group_is_right_in_lanes() {
    check_lengths(LanePoints::new);
}

/// A point that cannot be evaluated has the error of that point, and the points before it their values.
#[test]
fn errors_are_those_of_the_points() {
    let robot = file("two_link.toml");
    let (mut one, mut lanes) = (RobotPoints::new(&robot), LanePoints::new(&robot));
    let sound = points(2, 9, &[0.3, -0.8, 1.0, 0.5, 0.2, -4.0], &[1.0, -2.0]);
    for (at, value) in [(0, f64::NAN), (27, f64::INFINITY), (6 * 8 + 5, f64::NEG_INFINITY)] {
        let mut bad = sound.clone();
        bad.z[at] = value;
        let (mut expected, mut found) = (bad.clone(), bad);
        assert_eq!(lanes.evaluate(&mut found).unwrap_err(), one.evaluate(&mut expected).unwrap_err());
        let before = 2 * (at / 6);
        alike(&expected.tau[..before], &found.tau[..before], 2);
        assert_eq!(lanes.contract(&mut found).unwrap_err(), one.contract(&mut expected).unwrap_err());
    }
}

#[test]
fn nothing_is_allocated_in_lanes() {
    let robot = file("puma560.toml");
    let mut points = points(6, 10, &[0.1; 18], &[1.0; 6]);
    let mut lanes = LanePoints::new(&robot);
    let count = allocations(|| {
        lanes.evaluate(&mut points).unwrap();
        lanes.contract(&mut points).unwrap();
    });
    assert_eq!(count, 0);
}
