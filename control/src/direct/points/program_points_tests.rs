//! Machine code against the generic code.

use super::super::values::{PointDynamics, Points, RobotPoints};
use super::{LANES, ProgramPoints};
use crate::options::MachineCode;
use costate::EvalError;
use costate::robot::Robot;
use costate_test_support::allocations::allocations;
use costate_test_support::properties;
use costate_test_support::random_robot::cases;
use costate_test_support::robots::file;

/// Points of a robot around z = (q, v, a), and weights.
fn points(n: usize, count: usize, z: &[f64], weights: &[f64]) -> Points {
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

/// With programs from the first point on.
fn at_once(robot: &Robot) -> ProgramPoints {
    ProgramPoints::new(robot, MachineCode::AtOnce)
}

/// Both ways for so many points; the largest differences in parts of the largest entry, for each point.
fn check(robot: &Robot, count: usize, z: &[f64], weights: &[f64]) {
    let n = robot.dof();
    let (mut generic, mut programs) = (RobotPoints::new(robot), at_once(robot));
    let mut expected = points(n, count, z, weights);
    let mut found = expected.clone();
    generic.evaluate(&mut expected).unwrap();
    programs.evaluate(&mut found).unwrap();
    alike(&expected.tau, &found.tau, n);
    generic.contract(&mut expected).unwrap();
    programs.contract(&mut found).unwrap();
    alike(&expected.tau, &found.tau, n);
    alike(&expected.tau_z, &found.tau_z, 3 * n * n);
    alike(&expected.hessian, &found.hessian, 9 * n * n);
}

fn alike(expected: &[f64], found: &[f64], size: usize) {
    for (expected, found) in expected.chunks_exact(size).zip(found.chunks_exact(size)) {
        let largest = expected.iter().fold(1e-6, |most: f64, entry| most.max(entry.abs()));
        for (expected, found) in expected.iter().zip(found) {
            assert!((expected - found).abs() <= 1e-12 * largest, "{expected} {found} of {largest}");
        }
    }
}

properties! {
    48;

    #[test]
    fn random_robots_have_the_points_of_the_generic_code(case in cases(6)) {
        let robot = case.robot();
        let n = robot.dof();
        let z = [&case.q[..n], &case.v[..n], &case.u[..n]].concat();
        check(&robot, 1 + case.parts.len(), &z, &case.y[..n]);
    }
}

#[test]
fn every_length_of_the_last_group_is_right() {
    let robot = file("panda.urdf");
    let z: Vec<f64> = (0..21).map(|k| (0.9 * k as f64).sin()).collect();
    for count in [1, 2, 3, 4, 5, 8, 11] {
        check(&robot, count, &z, &z[..7]);
    }
    let far: Vec<f64> = z.iter().enumerate().map(|(k, z)| if k < 7 { 1e6 * z } else { 1e3 * z }).collect();
    check(&robot, 6, &far, &z[..7]);
}

/// Errors, and results that are too large for a number, of the generic code by either way.
#[test]
fn what_is_not_finite_is_that_of_the_generic_code() {
    let robot = file("two_link.toml");
    let (mut generic, mut programs) = (RobotPoints::new(&robot), at_once(&robot));
    let sound = points(2, 2 * LANES + 1, &[0.3, -0.8, 1.0, 0.5, 0.2, -4.0], &[1.0, -2.0]);
    for (at, value) in [(0, f64::NAN), (27, f64::INFINITY), (6 * 8 + 5, f64::NEG_INFINITY)] {
        let mut bad = sound.clone();
        bad.z[at] = value;
        let expected = generic.evaluate(&mut bad.clone()).unwrap_err();
        assert!(matches!(expected, EvalError::NonFinite { .. }));
        assert_eq!(programs.evaluate(&mut bad.clone()).unwrap_err(), expected);
        assert_eq!(programs.contract(&mut bad.clone()).unwrap_err(), generic.contract(&mut bad).unwrap_err());
    }
    let mut bad = sound.clone();
    bad.weights[7] = f64::NAN;
    assert_eq!(programs.contract(&mut bad.clone()).unwrap_err(), generic.contract(&mut bad).unwrap_err());
    // Rates whose squares overflow.
    let mut fast = sound.clone();
    fast.z[6 * 5 + 2] = 1e200;
    let mut found = fast.clone();
    generic.contract(&mut fast).unwrap();
    programs.contract(&mut found).unwrap();
    assert!(fast.tau.iter().any(|tau| !tau.is_finite()));
    let bits = |values: &[f64]| values[2 * 4..2 * 8].iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(bits(&found.tau), bits(&fast.tau), "the whole group is that of the generic code");
}

/// Whether two results have the same bits: rounding tells machine code from generic code.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits())
}

#[test]
fn programs_follow_after_the_first_points_and_nothing_is_allocated_then() {
    let robot = file("puma560.toml");
    let mut points = points(6, 60, &[0.1; 18], &[1.0; 6]);
    RobotPoints::new(&robot).contract(&mut points).unwrap();
    let expected = points.clone();
    let mut never = ProgramPoints::new(&robot, MachineCode::Never);
    let mut later = ProgramPoints::new(&robot, MachineCode::Later);
    let first = later.left;
    for _ in 0..first[1].div_ceil(60) {
        later.contract(&mut points).unwrap();
        assert!(same(&points.hessian, &expected.hessian));
    }
    assert_eq!(later.left, [first[0], 0]);
    never.contract(&mut points).unwrap();
    assert!(same(&points.hessian, &expected.hessian));
    later.contract(&mut points).unwrap();
    assert_eq!(!same(&points.hessian, &expected.hessian), costate_jit::supported().is_ok());
    alike(&expected.hessian, &points.hessian, 9 * 36);
    later.left = [0; 2];
    later.evaluate(&mut points).unwrap();
    assert_eq!(allocations(|| drop(points.clone())), 6);
    let count = allocations(|| {
        later.evaluate(&mut points).unwrap();
        later.contract(&mut points).unwrap();
    });
    assert_eq!(count, 0);
}
