//! Machine code against the generic code.

use super::super::generic_points::RobotPoints;
use super::super::generic_points::tests::{alike, check_lengths, check_rounding, points};
use super::super::values::PointDynamics;
use super::{LANES, ProgramPoints};
use crate::options::MachineCode;
use costate::EvalError;
use costate::robot::Robot;
use costate_test_support::allocations::allocations;
use costate_test_support::properties;
use costate_test_support::random_robot::cases;
use costate_test_support::robots::file;

/// With programs from the first point on.
fn at_once(robot: &Robot) -> ProgramPoints {
    ProgramPoints::new(robot, MachineCode::AtOnce)
}

properties! {
    48;

    #[test]
    fn random_robots_have_the_points_of_the_generic_code(case in cases(6)) {
        let robot = case.robot();
        let n = robot.dof();
        let z = [&case.q[..n], &case.v[..n], &case.u[..n]].concat();
        check_rounding(&robot, at_once(&robot), 1 + case.parts.len(), &z, &case.y[..n])?;
    }
}

#[test]
fn every_length_of_the_last_group_is_right() {
    check_lengths(at_once);
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
    if costate_jit::supported().is_ok() {
        assert_eq!(bits(&found.tau), bits(&fast.tau), "the whole group is that of the generic code");
    }
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
    alike(&expected.hessian, &points.hessian, 9 * 36);
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
