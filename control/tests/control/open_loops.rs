//! Starts and ends that leave loops open: how they are refused, and the positions that close them.

use super::loops::{FREE, crank, four_bar};
use costate::constraints::ConstraintError;
use costate::robot::{ConstraintRow, ConstraintSpec, Placement, Robot};
use costate_control::{LoopError, Method, Problem, ProblemError};

fn refused(
    problem: &Problem,
) -> (/* constraint */ String, f64, Result<Vec<f64>, ConstraintError>, /* text */ String) {
    let error = problem.check_for(Method::Direct).unwrap_err();
    let text = error.to_string();
    let ProblemError::Loop { cause: LoopError::Open { constraint, miss, closed, .. } } = error else {
        panic!("{text}")
    };
    (constraint, miss, *closed, text)
}

/// The position that a message tells.
fn told(text: &str) -> Vec<f64> {
    let list = text.split_once("close at q = [").unwrap().1.split_once(']').unwrap().0;
    list.split(", ").map(|q| q.parse().unwrap()).collect()
}

/// The linkage with its pivot this far ahead (m).
fn longer(ahead: f64) -> Robot {
    let pin = ConstraintSpec::rows("pin", "rocker_tip", "pivot", &[ConstraintRow::X, ConstraintRow::Y]);
    let pin = pin.to_placed(Placement::from_xyz_rpy([ahead, 0.0, 0.0], [0.0; 3]));
    four_bar().without_constraints().with_constraint(pin).unwrap()
}

/// The crank has a motor and stays where it is; the position that is told is one that is taken.
#[test]
fn a_position_that_closes_the_loops_is_told() {
    let mut open = crank(four_bar(), FREE);
    let end = open.end.q.clone();
    open.start.q[2] += 0.01;
    let (constraint, miss, closed, text) = refused(&open);
    assert_eq!(constraint, "rocker_pivot");
    assert!(miss > 1e-3 && miss < 1e-2, "{miss}");
    assert!(text.starts_with("start.q: constraint 'rocker_pivot' is missed by "), "{text}");
    let closed = closed.unwrap();
    assert_eq!(closed[0], open.start.q[0]);
    open.start.q = told(&text);
    assert!(open.start.q.iter().zip(&closed).all(|(told, q)| (told - q).abs() < 1e-9), "{text}");
    assert!(open.check_for(Method::Direct).is_ok(), "{text}");
    open.end.q[1] -= 0.02;
    let (_, _, closed, text) = refused(&open);
    assert!(text.starts_with("end.q: ") && closed.unwrap()[0] == end[0], "{text}");
}

#[test]
fn joints_with_motors_move_where_the_loops_do_not_close_otherwise() {
    let mut open = crank(four_bar(), FREE);
    // With the crank at 1.6 rad coupler and rocker do not reach the pivot.
    open.start.q = vec![1.6, -0.5, 0.2];
    open.robot = longer(0.95);
    let (_, _, closed, text) = refused(&open);
    assert!((closed.unwrap()[0] - 1.6).abs() > 0.1, "{text}");
    open.start.q = told(&text);
    // The end is open now.
    assert!(refused(&open).3.starts_with("end.q: "));
}

#[test]
fn loops_that_close_nowhere_say_why() {
    let mut open = crank(four_bar(), FREE);
    open.robot = longer(2.0);
    // The rods are 2.6 m long.
    let (_, _, closed, text) = refused(&open);
    assert!(
        text.contains("no position nearby was found that closes the loops: constraint 'pin' cannot"),
        "{text}"
    );
    let Err(ConstraintError::CannotClose { miss, .. }) = closed else { panic!("{closed:?}") };
    assert!((miss - 0.7).abs() < 1e-2, "{miss}");
    let elsewhere = ConstraintSpec::rows("elsewhere", "rocker_tip", "pivot", &[ConstraintRow::X]);
    let elsewhere = elsewhere.to_placed(Placement::from_xyz_rpy([0.1, 0.0, 0.0], [0.0; 3]));
    open.robot = four_bar().with_constraint(elsewhere).unwrap();
    let (constraint, _, closed, text) = refused(&open);
    assert_eq!(constraint, "elsewhere");
    let Err(ConstraintError::Contradiction { constraint, miss }) = closed else { panic!("{closed:?}") };
    assert_eq!(constraint, "elsewhere");
    assert!((miss - 0.1).abs() < 1e-9 && text.contains("contradicts those before it"), "{text}");
}
