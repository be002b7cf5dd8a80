//! `X_i(q) = X_parent(q) X_i(0) J_i(q_i)`: the joint frames in the world.

use super::joint::JointKind;
use super::link::Placement;
use super::model::Robot;
use crate::EvalError;
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

impl JointKind {
    /// `J(q)`: the joint frame at q in the joint frame at q = 0, for a unit axis; q in rad or m.
    pub(super) fn motion(self, axis: &Vector3<f64>, q: f64) -> Placement {
        match self {
            JointKind::Revolute => {
                let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(*axis), q);
                Placement { rotation: turn.into_inner(), ..Placement::identity() }
            }
            JointKind::Prismatic => Placement { rotation: Matrix3::identity(), translation: axis * q },
        }
    }
}

impl Robot {
    /// `X_i(q) = X_parent(q) X_i(0) J_i(q_i)`: the joint frames in the world, each moved by its own joint.
    ///
    /// `q` has n entries (rad, m); there is one placement (m) for each of the [`joints`](Self::joints). The
    /// frames are those of the description: a link does not move in the frame of its joint, its centre of
    /// mass at `joints()[i].inertia.com`.
    ///
    /// ```
    /// use costate::robot::{JointSpec, LinkInertia, Robot};
    ///
    /// let hinge = JointSpec::revolute("hinge").axis([0.0, 1.0, 0.0]);
    /// let link = LinkInertia::point(1.0, [0.0, 0.0, -1.0]);
    /// let pendulum = Robot::builder("pendulum").joint(hinge.carrying(link)).build()?;
    /// let pose = pendulum.poses(&[std::f64::consts::FRAC_PI_2])?[0];
    /// let mass = pose.rotation * link.com + pose.translation;
    /// assert!((mass.x + 1.0).abs() < 1e-15 && mass.z.abs() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`EvalError::WrongLength`].
    pub fn poses(&self, q: &[f64]) -> Result<Vec<Placement>, EvalError> {
        let positions = self.joint_positions(q)?;
        let mut poses: Vec<Placement> = Vec::with_capacity(positions.len());
        for (joint, &q) in self.joints().iter().zip(&positions) {
            let standing = joint.parent.map_or(joint.placement, |p| poses[p].then(&joint.placement));
            poses.push(standing.then(&joint.kind.motion(&joint.axis, q)));
        }
        Ok(poses)
    }
}

#[cfg(test)]
mod tests {
    use crate::hamiltonian::Hamiltonian;
    use crate::robot::{Friction, JointSpec, LinkInertia, Placement, Robot, Spring};
    use nalgebra::Vector3;

    #[test]
    fn the_potential_energy_is_that_of_the_masses_where_the_poses_put_them() {
        let placed = |x: f64| Placement::from_xyz_rpy([x, -0.4, 0.7 - x], [0.4 + x, -1.1, 2.0 * x]);
        let mut builder = Robot::builder("chain").gravity([1.0, -2.0, -9.81]);
        for i in 0..4 {
            let name = format!("j{i}");
            let joint = if i == 2 { JointSpec::prismatic(name) } else { JointSpec::revolute(name) };
            let joint = joint.placed(placed(0.3 * f64::from(i))).axis([0.3, -0.5, 0.8]).armature(1.0);
            let joint = joint.spring(Spring::default()).friction(Friction::none());
            let joint = joint.carrying(LinkInertia::point(1.0 + f64::from(i), [0.2, 0.1, -0.3]));
            builder = builder.joint(if i == 0 { joint } else { joint.on(format!("j{}", i - 1)) });
        }
        let robot = builder.build().unwrap();
        let potential = |q: &[f64]| -> f64 {
            let poses = robot.poses(q).unwrap();
            let height = |(joint, pose): (&crate::robot::Joint, &Placement)| {
                let com: Vector3<f64> = pose.rotation * joint.inertia.com + pose.translation;
                -joint.inertia.mass * robot.gravity().dot(&com)
            };
            robot.joints().iter().zip(&poses).map(height).sum()
        };
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        for q in [[0.0; 4], [0.3, -1.2, 0.4, 2.0], [-3.0, 0.7, -0.2, 1.0]] {
            let expected = hamiltonian.potential(&q).unwrap();
            assert!((potential(&q) - expected).abs() < 1e-12 * expected.abs().max(1.0), "{q:?}");
        }
        assert!(robot.poses(&[0.0; 3]).is_err());
    }
}
