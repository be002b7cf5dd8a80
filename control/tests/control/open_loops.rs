//! Starts and ends that leave loops open: how they are refused, and the positions that close them.

use super::loops::{FREE, closed, crank, four_bar};
use costate::constraints::{Conflict, ConstraintError};
use costate::robot::{ConstraintRow, ConstraintSpec, Placement, Robot};
use costate_control::{LoopError, Method, Problem, ProblemError};
use std::f64::consts::PI;

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
    let Err(ConstraintError::Contradiction { constraint, miss, because }) = closed else {
        panic!("{closed:?}")
    };
    assert_eq!(constraint, "elsewhere");
    assert!((miss - 0.1).abs() < 1e-9 && text.contains("contradicts those before it"), "{text}");
    assert_eq!(*because, Conflict::Earlier { constraints: vec!["rocker_pivot".into()] });
}

/// A rod that is too short by 1 m is told so, whatever its row of g is.
#[test]
fn misses_of_rods_are_lengths() {
    let mut open = crank(four_bar(), FREE);
    let to = Placement::from_xyz_rpy([3.3, 0.0, 0.0], [0.0; 3]);
    let rod = ConstraintSpec::distance("rod", "rocker_tip", "world", 1.0).to_placed(to);
    // The tip is at x = 1.3 m.
    open.robot = four_bar().without_constraints().with_constraint(rod).unwrap();
    let (constraint, miss, _, text) = refused(&open);
    assert!(constraint == "rod" && (miss - 1.0).abs() < 1e-6, "{text}");
}

/// What is wrong with rates at the end: the rates, and those that are told.
fn unfit(problem: &Problem) -> (/* joint */ String, f64, /* nearest */ Vec<f64>, /* text */ String) {
    let error = problem.check_for(Method::Direct).unwrap_err();
    let text = error.to_string();
    let ProblemError::Loop { cause: LoopError::Rates { unfit, .. } } = error else { panic!("{text}") };
    (unfit.joint, unfit.rate, unfit.nearest, text)
}

#[test]
fn rates_at_the_end_that_no_motion_of_the_loop_has_are_refused() {
    let problem = crank(four_bar(), FREE);
    let ending = |v: [f64; 3], free: &[usize]| {
        let mut problem = problem.clone();
        problem.end.v = v.to_vec();
        problem.end.v_free = free.to_vec();
        problem
    };
    let (joint, rate, nearest, text) = unfit(&ending([1.0, 5.0, 0.0], &[2]));
    assert!((&*joint, rate) == ("coupler", 5.0) || (&*joint, rate) == ("crank", 1.0), "{text}");
    assert!(text.starts_with("end.v: no motion that keeps the loops closed has the rates"), "{text}");
    assert!(text.contains(&format!("joint '{joint}' is {rate}, and ")), "{text}");
    // What is told is taken, with all rates given or some.
    let told = text.split_once("v = [").unwrap().1.split_once(']').unwrap().0;
    let told: Vec<f64> = told.split(", ").map(|v| v.parse().unwrap()).collect();
    assert!(told.iter().zip(&nearest).all(|(a, b)| (a - b).abs() < 1e-9), "{text}");
    for free in [&[][..], &[2], &[0, 1]] {
        assert!(ending([told[0], told[1], told[2]], free).check_for(Method::Direct).is_ok(), "{free:?}");
    }
    let (.., nearest, text) = unfit(&ending([0.0, 0.0, 1.0], &[0]));
    assert!(nearest.iter().all(|rate| rate.abs() > 1e-3 && rate.abs() < 1.0), "{text}");
    // One rate says where one degree of freedom goes.
    assert!(ending([0.0, 5.0, 0.0], &[0, 2]).check_for(Method::Direct).is_ok());
}

/// Positions that are given to some digits fit with some of them free as they do without.
#[test]
fn positions_at_the_end_may_be_rounded() {
    let mut problem = crank(four_bar(), FREE);
    problem.end.q.iter_mut().for_each(|q| *q = (*q * 1e8).round() / 1e8);
    assert!(problem.check_for(Method::Direct).is_ok());
    problem.end.q_free = vec![2];
    assert!(problem.check_for(Method::Direct).is_ok(), "{:?}", problem.check_for(Method::Direct));
}

/// With all rods in one line the row of x is missing for the whole motion.
#[test]
fn singular_poses_are_no_start() {
    let mut problem = crank(four_bar(), FREE);
    // The pivot is 0.8 m from the crank.
    problem.robot = longer(-0.5);
    problem.end.q_free = vec![1, 2];
    problem.end.v_free = vec![1, 2];
    for angle in [PI, PI + 5e-8] {
        problem.start.q = vec![0.0, 0.0, angle];
        let error = problem.check_for(Method::Direct).unwrap_err();
        let text = error.to_string();
        let ProblemError::Loop { cause: LoopError::Singular { constraint, row, .. } } = error else {
            panic!("{text}")
        };
        assert_eq!((&*constraint, row), ("pin", Some(ConstraintRow::X)));
        let says = "start.q: this is a singular pose: row x of constraint 'pin' counts nearby";
        assert!(text.starts_with(says), "{text}");
    }
    problem.start.q = closed(&problem.robot, &[0.5, 0.3, -2.0], &[true, false, false]);
    assert!(problem.check_for(Method::Direct).is_ok(), "{:?}", problem.check_for(Method::Direct));
}
