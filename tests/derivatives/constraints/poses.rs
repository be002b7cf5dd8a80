//! Values of constraints, beside relative poses of their frames and positions of their joints.

use super::{choices, closed, placed};
use costate::configuration::FreeKinematics;
use costate::constraints::Constraints;
use costate::robot::{ConstraintFrame, ConstraintKind, ConstraintRow, Robot};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases, free_cases};
use costate_test_support::rounding::{close, of_joints};
use nalgebra::{Rotation3, UnitQuaternion, Vector3};
use proptest::prelude::*;

/// Position of a joint of one degree of freedom.
fn position(case: &Case, i: usize) -> f64 {
    match case.mimicked(i).zip(case.parts[i].mimic) {
        Some((joint, (_, ratio, offset))) => ratio * position(case, joint) + offset,
        None => case.q[case.start(i).unwrap()[0]],
    }
}

/// Rows of frames are components of relative poses, by poses of frames and rotations of nalgebra.
fn are_relative_poses(robot: &Robot, case: &Case) -> Result<(), TestCaseError> {
    let mut constraints = Constraints::<f64>::new(robot);
    constraints.set_position(&case.q).unwrap();
    let mut kinematics = FreeKinematics::<f64>::new(robot);
    kinematics.set_position(&case.q).unwrap();
    let placed = |seat: &ConstraintFrame| placed(&kinematics, seat);
    let mut values = constraints.values().iter();
    // No sum along the joints is farther from the origin than the farthest frame.
    let places =
        (0..robot.frames().len()).map(|k| Vector3::from(kinematics.pose(k).unwrap().position).norm());
    let farthest = places.fold(0.0, f64::max);
    let far = |seat: &ConstraintFrame| farthest + seat.placement.translation.norm();
    for constraint in robot.constraints() {
        // The size of what is added: rotations have entries of at most 1, psi is twice a quaternion.
        let (expected, terms): (Vec<f64>, f64) = match &constraint.kind {
            ConstraintKind::Frames { frame, to, rows } => {
                let ((ra, xa), (rb, xb)) = (placed(frame), placed(to));
                let r = rb.transpose() * (xa - xb);
                let turned = Rotation3::from_matrix_unchecked(rb.transpose() * ra);
                let half = UnitQuaternion::from_rotation_matrix(&turned);
                let psi = half.imag() * if half.w < 0.0 { -2.0 } else { 2.0 };
                let component = |row: &ConstraintRow| match row {
                    ConstraintRow::X => r.x,
                    ConstraintRow::Y => r.y,
                    ConstraintRow::Z => r.z,
                    ConstraintRow::TurnX => psi.x,
                    ConstraintRow::TurnY => psi.y,
                    ConstraintRow::TurnZ => psi.z,
                };
                (rows.iter().map(component).collect(), 2.0 + far(frame) + far(to))
            }
            ConstraintKind::Distance { frame, to, length } => {
                let (xa, xb) = (placed(frame).1, placed(to).1);
                let square = (xa - xb).norm_squared();
                let size = (far(frame) + far(to)).powi(2) / length + length;
                (vec![(square - length * length) / (2.0 * length)], size)
            }
            ConstraintKind::Coupling { terms, constant } => {
                let number = |joint: usize| robot.joints()[joint].name[1..].parse().unwrap();
                let of = |&(joint, factor): &(usize, f64)| factor * position(case, number(joint));
                // The offset of a mimic joint is at most 1.
                let size = |term: &(usize, f64)| of(term).abs() + term.1.abs();
                let added = terms.iter().map(size).sum::<f64>() + constant.abs();
                (vec![terms.iter().map(of).sum::<f64>() - constant], added)
            }
            _ => (Vec::new(), 0.0),
        };
        for expected in expected {
            let found = values.next().unwrap();
            close(&constraint.name, &[*found], &[expected], of_joints(robot, terms))?;
        }
    }
    prop_assert!(values.next().is_none());
    Ok(())
}

properties! {
    96;

    #[test]
    fn values_are_relative_poses(case in cases(6), choices in choices(3)) {
        are_relative_poses(&closed(&case, &choices, true), &case)?;
    }

    #[test]
    fn values_are_relative_poses_with_free_joints(case in free_cases(5), choices in choices(3)) {
        are_relative_poses(&closed(&case, &choices, true), &case)?;
    }
}
