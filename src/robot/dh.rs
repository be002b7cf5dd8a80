//! Denavit-Hartenberg tables, modified and standard.
//!
//! Both conventions describe a joint by four numbers; they differ in where frame i is on link i.
//!
//! | | transform from frame i to frame i - 1 | axis of joint i | frame i |
//! |---|---|---|---|
//! | modified (Khalil-Kleinfinger, Craig; (A1.2)) | `Rx(alpha) Tx(a) Rz(theta) Tz(d)` | z_i | at the near end of link i |
//! | standard (Paul) | `Rz(theta) Tz(d) Tx(a) Rx(alpha)` | z_(i-1) | at the far end of link i |
//!
//! The joint variable adds to theta (revolute) or to d (prismatic). Masses are given in frame i.

use super::builder::RobotBuilder;
use super::joint::JointSpec;
use super::link::{Placement, rotation_x, rotation_z};
use super::model::Robot;
use nalgebra::Vector3;

/// Which Denavit-Hartenberg convention a table follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Convention {
    /// `Rx(alpha) Tx(a) Rz(theta) Tz(d)`.
    Modified,
    /// `Rz(theta) Tz(d) Tx(a) Rx(alpha)`.
    Standard,
}

/// One row of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DhRow {
    /// Angle about x (rad).
    pub alpha: f64,
    /// Distance along x (m), r in the paper.
    pub a: f64,
    /// Distance along z (m), lambda in the paper; the offset of a prismatic joint.
    pub d: f64,
    /// Angle about z (rad), phi in the paper; the offset of a revolute joint.
    pub theta: f64,
}

impl DhRow {
    /// `Rx(alpha) Tx(a)`, the same in both orders.
    fn along_x(&self) -> Placement {
        Placement { rotation: rotation_x(self.alpha), translation: Vector3::new(self.a, 0.0, 0.0) }
    }

    /// `Rz(theta) Tz(d)`, the same in both orders.
    fn along_z(&self) -> Placement {
        Placement { rotation: rotation_z(self.theta), translation: Vector3::new(0.0, 0.0, self.d) }
    }

    /// The far frame of a standard table, in which masses are given, in the joint frame.
    pub(super) fn far_frame(&self) -> Placement {
        self.along_x()
    }
}

/// Places a joint by its row and, for a standard table, that of its parent; moves its link inertia, given in
/// frame i, to the joint frame.
pub fn place(spec: JointSpec, convention: Convention, row: &DhRow, parent: Option<&DhRow>) -> JointSpec {
    let spec = spec.axis([0.0, 0.0, 1.0]);
    match convention {
        Convention::Modified => spec.placed(row.along_x().then(&row.along_z())),
        Convention::Standard => {
            let near = parent.map_or(Placement::identity(), DhRow::far_frame);
            let inertia = spec.inertia.placed(&row.far_frame());
            spec.placed(near.then(&row.along_z())).carrying(inertia)
        }
    }
}

/// A serial chain from a table: each joint is attached to the one before.
///
/// ```
/// use costate::robot::{JointSpec, LinkInertia, dh};
/// let rod = LinkInertia::about_com(1.0, [0.5, 0.0, 0.0], nalgebra::Matrix3::identity() / 12.0);
/// let row = |a| dh::DhRow { a, ..Default::default() };
/// let arm = dh::chain("arm", dh::Convention::Modified, [
///     (JointSpec::revolute("shoulder").carrying(rod), row(0.0)),
///     (JointSpec::revolute("elbow").carrying(rod), row(1.0)),
/// ]).build()?;
/// assert_eq!(arm.joints()[1].placement.translation.x, 1.0);
/// # Ok::<(), costate::robot::RobotError>(())
/// ```
pub fn chain(
    name: impl Into<String>,
    convention: Convention,
    rows: impl IntoIterator<Item = (JointSpec, DhRow)>,
) -> RobotBuilder {
    let mut builder = Robot::builder(name);
    let mut before: Option<(String, DhRow)> = None;
    for (mut spec, row) in rows {
        if let Some((parent, _)) = &before {
            spec = spec.on(parent.clone());
        }
        let name = spec.name.clone();
        builder = builder.joint(place(spec, convention, &row, before.as_ref().map(|(_, row)| row)));
        before = Some((name, row));
    }
    builder
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::LinkInertia;
    use nalgebra::Matrix3;

    /// `R(i-1 <- i)` as the paper prints it.
    fn rotation_a1_2(alpha: f64, phi: f64) -> Matrix3<f64> {
        let ((sa, ca), (sp, cp)) = (alpha.sin_cos(), phi.sin_cos());
        Matrix3::new(cp, -sp, 0.0, ca * sp, ca * cp, -sa, sa * sp, sa * cp, ca)
    }

    #[test]
    fn a_modified_row_is_equation_a1_2() {
        let row = DhRow { alpha: 0.4, a: 0.3, d: -0.7, theta: 1.9 };
        let placement = place(JointSpec::revolute("j"), Convention::Modified, &row, None).placement;
        assert!((placement.rotation - rotation_a1_2(0.4, 1.9)).amax() < 1e-15);
        let expected = Vector3::new(0.3, 0.7 * 0.4_f64.sin(), -0.7 * 0.4_f64.cos());
        assert!((placement.translation - expected).amax() < 1e-15);
    }

    #[test]
    fn standard_rows_chain_as_their_definition_says() {
        let rows = [
            DhRow { alpha: 1.1, a: 0.2, d: 0.3, theta: -0.4 },
            DhRow { alpha: -0.6, a: 0.5, d: -0.1, theta: 2.0 },
            DhRow { alpha: 0.9, a: -0.3, d: 0.7, theta: 0.8 },
        ];
        let point = LinkInertia::point(1.0, [0.1, 0.2, 0.3]);
        let specs = ["a", "b", "c"].map(|name| JointSpec::revolute(name).carrying(point));
        let robot = chain("r", Convention::Standard, specs.into_iter().zip(rows)).build().unwrap();
        let (mut frame, mut joint_frame) = (Placement::identity(), Placement::identity());
        for (row, joint) in rows.iter().zip(robot.joints()) {
            frame = frame.then(&row.along_z()).then(&row.along_x());
            joint_frame = joint_frame.then(&joint.placement);
            let expected = frame.rotation * Vector3::new(0.1, 0.2, 0.3) + frame.translation;
            let found = joint_frame.rotation * joint.inertia.com + joint_frame.translation;
            assert!((found - expected).amax() < 1e-15);
        }
    }
}
