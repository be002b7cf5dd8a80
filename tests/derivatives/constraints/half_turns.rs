//! Constraints whose frames are almost half a turn apart, and half a turn.

use super::{are_those_of_the_dense_equations, independence, placed};
use costate::configuration::FreeKinematics;
use costate::constraints::{ConstrainedHamiltonian, Constraints};
use costate::robot::{
    ConstraintKind, ConstraintRow, ConstraintSpec, JointSpec, LinkInertia, Placement, Robot,
};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases};
use costate_test_support::rounding::{close, terms};
use nalgebra::{Matrix3, Rotation3, Unit, UnitQuaternion, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

/// The rows that are held: two turns, of which a motion changes both, and in some a position.
const HELD: [&[ConstraintRow]; 4] = {
    use ConstraintRow::{TurnX, TurnY, TurnZ, X};
    [&[TurnX, TurnY], &[TurnY, TurnZ], &[TurnX, TurnZ], &[X, TurnX, TurnY]]
};

/// The robot with a constraint between two links whose frames are turned by `angle` (rad) about an axis at
/// its state; `None` where the rows depend on each other.
fn turned(case: &Case, choice: usize, axis: [f64; 3], angle: f64) -> Option<Robot> {
    let (robot, links) = (case.robot(), case.robot().joints().len() + 1);
    let name = |k: usize| if k == 0 { "world".into() } else { format!("j{}", k - 1) };
    let (frame, to) = (name(choice % links), name(choice / links % links));
    let spec = ConstraintSpec::rows("grip", &frame, &to, HELD[choice / (links * links) % HELD.len()]);
    let plain = robot.with_constraint(spec.clone()).ok()?;
    let mut kinematics = FreeKinematics::<f64>::new(&robot);
    kinematics.set_position(&case.q).unwrap();
    let ConstraintKind::Frames { frame, to, .. } = &plain.constraints()[0].kind else { return None };
    let [a, b] = [frame, to].map(|seat| placed(&kinematics, seat).0);
    let apart = Rotation3::from_axis_angle(&Unit::new_normalize(Vector3::from(axis)), angle);
    let rotation = a.transpose() * b * apart.matrix();
    let spec = spec.placed(Placement { rotation, translation: Vector3::from(axis) });
    let closed = robot.with_constraint(spec).unwrap();
    (independence(&closed, &case.q) > 1e-3).then_some(closed)
}

/// Operations on the way of an entry of psi, each with numbers of at most 2: rotations of three joints
/// and two frames, of five operations each, that by an axis and an angle, and the quaternion of a matrix,
/// of eight each.
const PSI: usize = 5 * 5 + 8 + 8;

properties! {
    96;

    #[test]
    fn accelerations_and_forces_are_right_just_before_half_a_turn(
        case in cases(6),
        choice in 0..1000_usize,
        axis in prop::array::uniform3(0.1..1.0),
        digits in 3..10_i32,
    ) {
        if let Some(robot) = turned(&case, choice, axis, PI - 10.0_f64.powi(-digits)) {
            are_those_of_the_dense_equations(&robot, &case)?;
        }
    }

    /// g of a whole orientation, whose rows depend on each other at half a turn alone.
    #[test]
    fn values_are_right_just_before_half_a_turn(
        axis in prop::array::uniform3(-1.0..1.0),
        digits in 3..10_i32,
    ) {
        let axis = Unit::new_normalize(Vector3::from(axis) + Vector3::new(0.0, 0.0, 1e-3));
        let angle = PI - 10.0_f64.powi(-digits);
        let mut constraints = Constraints::<f64>::new(&wrist(*Rotation3::from_axis_angle(&axis, angle).matrix()));
        constraints.set_position(&[0.0; 3]).unwrap();
        let expected = UnitQuaternion::from_axis_angle(&axis, angle).imag() * 2.0;
        close("psi", constraints.values(), expected.as_slice(), terms(PSI, &[2.0]))?;
    }
}

/// Three joints whose axes meet, and whose last link has an orientation to keep.
fn wrist(rotation: Matrix3<f64>) -> Robot {
    let body = LinkInertia::about_com(1.0, [0.2, 0.1, -0.3], Matrix3::identity());
    let joint = |name: &str, axis| JointSpec::revolute(name).axis(axis).carrying(body);
    let robot = Robot::builder("wrist")
        .joint(joint("a", [0.0, 0.0, 1.0]))
        .joint(joint("b", [0.0, 1.0, 0.0]).on("a"))
        .joint(joint("c", [1.0, 0.0, 0.0]).on("b"));
    let turns = [ConstraintRow::TurnX, ConstraintRow::TurnY, ConstraintRow::TurnZ];
    let spec = ConstraintSpec::rows("grip", "c", "world", &turns);
    let spec = spec.placed(Placement { rotation, translation: Vector3::zeros() });
    robot.build().unwrap().with_constraint(spec).unwrap()
}

/// At half a turn no motion changes the component of psi about its axis: that row is left out and told, and
/// nothing is infinite. Just before it all three hold.
#[test]
fn half_a_turn_is_a_singular_pose_that_is_told() {
    for (missing, rank) in [(0.0, 2), (1e-3, 3)] {
        let robot = wrist(*Rotation3::from_axis_angle(&Vector3::x_axis(), PI - missing).matrix());
        let mut closed = ConstrainedHamiltonian::<f64>::new(&robot);
        let (q, p) = ([0.0; 3], [0.3, -0.2, 0.5]);
        let f = closed.evaluate(&q, &p, &[0.0; 3]).unwrap().f.to_vec();
        assert!(f.iter().all(|f| f.is_finite()), "{f:?}");
        assert_eq!(closed.rank(), rank, "{missing}");
        assert_eq!(closed.redundant().collect::<Vec<_>>(), if rank == 2 { vec!["grip"] } else { vec![] });
        let held = closed.constraints().values().iter().map(|psi| psi * psi).sum::<f64>().sqrt();
        assert!((held - 2.0 * (0.5 * (PI - missing)).sin()).abs() < 4e-15, "{held}");
    }
}
