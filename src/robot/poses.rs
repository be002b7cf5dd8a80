//! `X_i(q) = X_parent(q) X_i(0) J_i(q_i)`: the joint frames in the world.

use super::free::FreeJoint;
use super::free_entries;
use super::joint::JointKind;
use super::link::Placement;
use super::model::Robot;
use crate::EvalError;
use nalgebra::{Matrix3, Rotation3, RowVector3, Unit, Vector3};

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

impl FreeJoint {
    /// The rotation of its quaternion.
    fn turn(&self, q: &[f64]) -> Placement {
        let rows = self.quaternion_in(q).rotation().rows.map(|row| RowVector3::from(row.to_array()));
        Placement { rotation: Matrix3::from_rows(&rows), ..Placement::identity() }
    }
}

impl Robot {
    /// `X_i(q) = X_parent(q) X_i(0) J_i(q_i)`: the joint frames in the world, each moved by its own joint.
    ///
    /// `q` has [`nq`](Self::nq) entries (rad, m, unit quaternions); there is one placement (m) for each of
    /// the [`joints`](Self::joints). The frames are those of the description: a link does not move in the
    /// frame of its joint, its centre of mass at `joints()[i].inertia.com`. Of a floating or spherical joint
    /// the three parts that turn have one pose, that of the link which it moves.
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
    /// [`EvalError::WrongLength`], [`EvalError::NonFinite`], [`EvalError::NotUnit`]; [`EvalError::FreeJoint`]
    /// where q has n entries, none for a quaternion.
    pub fn poses(&self, q: &[f64]) -> Result<Vec<Placement>, EvalError> {
        let name = |index| self.joint_of_position(index).unwrap_or_default().to_owned();
        free_entries::check(q, self.dof(), self.free.iter(), name)?;
        let mut chart = vec![0.0; self.dof()];
        free_entries::chart_coordinates(q, self.free.iter(), &mut chart);
        let mut free = self.free.iter().peekable();
        let mut poses: Vec<Placement> = Vec::with_capacity(self.joints.len());
        for (i, (joint, position)) in self.joints.iter().zip(self.all_positions(&chart)).enumerate() {
            let mut standing = joint.parent.map_or(joint.placement, |p| poses[p].then(&joint.placement));
            if let Some(free) = free.next_if(|free| free.turned == i) {
                standing = standing.then(&free.turn(q));
            }
            poses.push(standing.then(&joint.kind.motion(&joint.axis, position)));
        }
        Ok(poses)
    }
}

#[cfg(test)]
mod tests {
    use crate::EvalError;
    use crate::configuration::{ConfigurationSpace, FreeKinematics};
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

    /// A hinge, a floating body on it, a slide, a finger that follows it, a link on a ball joint, and a last
    /// one.
    fn flying() -> Robot {
        let body = |joint: JointSpec| joint.carrying(LinkInertia::point(1.0, [0.1, 0.2, 0.3]));
        let placed = |x: f64| Placement::from_xyz_rpy([x, -0.4, 0.7 - x], [0.4 + x, -1.1, 2.0 * x]);
        let slide = |name: &str| JointSpec::prismatic(name).on("base").axis([0.0, 0.6, 0.8]);
        Robot::builder("flying")
            .joint(body(JointSpec::revolute("hinge")).placed(placed(0.1)))
            .joint(body(JointSpec::floating("base")).on("hinge").placed(placed(0.2)))
            .joint(body(slide("slide")).placed(placed(0.3)))
            .joint(body(slide("finger")).placed(placed(0.6)).mimicking("slide", -2.0, 0.4))
            .joint(body(JointSpec::spherical("ball")).on("slide").placed(placed(0.4)))
            .joint(body(JointSpec::revolute("last")).on("ball").placed(placed(0.5)))
            .build()
            .unwrap()
    }

    #[test]
    fn poses_of_quaternions_are_those_of_kinematics() {
        let robot = flying();
        let mut q: Vec<f64> = (0..14).map(|k| (1.3 * f64::from(k) + 0.4).sin()).collect();
        ConfigurationSpace::new(&robot).normalize(&mut q).unwrap();
        let mut kinematics = FreeKinematics::<f64>::new(&robot);
        kinematics.set_position(&q).unwrap();
        let poses = robot.poses(&q).unwrap();
        assert_eq!(poses.len(), 13);
        for (i, found) in poses.iter().enumerate() {
            // The parts that turn are the link of the joint, and have no frame but the last one.
            let part = robot.joints()[i].free.as_ref().filter(|part| part.place >= part.kind.slides());
            let last = part.map_or(i, |part| i + part.kind.dof() - 1 - part.place);
            let Some(frame) = robot.frame_of_joint(last) else { continue };
            let expected = kinematics.pose(frame).unwrap();
            for row in 0..3 {
                assert!((found.translation[row] - expected.position[row]).abs() < 1e-14, "{i}");
                for column in 0..3 {
                    let (a, b) = (found.rotation[(row, column)], expected.rotation[row][column]);
                    assert!((a - b).abs() < 1e-14, "{i}: {a} {b}");
                }
            }
        }
        // Along the axes of its frame at q = 0 a floating joint slides before it turns.
        let start = poses[0].then(&robot.joints()[1].placement);
        let slid = start
            .then(&Placement { translation: Vector3::from_column_slice(&q[1..4]), ..Placement::identity() });
        assert!((poses[3].translation - slid.translation).norm() < 1e-14);
        assert!((poses[3].rotation - slid.rotation).norm() < 1e-14);
    }

    #[test]
    fn what_is_no_configuration_is_refused_by_joint() {
        let robot = flying();
        let q = ConfigurationSpace::new(&robot).neutral();
        let with = |entry: usize, value: f64| {
            let mut q = q.clone();
            q[entry] = value;
            robot.poses(&q).unwrap_err()
        };
        assert!(robot.poses(&q).is_ok());
        assert!(matches!(robot.poses(&q[2..]), Err(EvalError::FreeJoint { joint, .. }) if joint == "base"));
        assert!(matches!(robot.poses(&q[1..]), Err(EvalError::WrongLength(error)) if error.expected == 14));
        assert!(matches!(with(12, 1.1), EvalError::NotUnit { joint, .. } if joint == "ball"));
        assert!(matches!(with(5, f64::NAN), EvalError::NonFinite { joint, index: 5, .. } if joint == "base"));
        assert!(matches!(with(13, f64::INFINITY), EvalError::NonFinite { joint, .. } if joint == "last"));
    }
}
