//! The robot with other values of its parameters.

use super::error::ParameterError;
use super::parameter::{DisplacedIn, Displacement, Inertial, Parameter};
use super::set::ParameterSet;
use super::value::{link, seen, ten};
use crate::error::LengthError;
use crate::robot::{JointKind, Placement, Robot};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

impl ParameterSet {
    /// The same robot with these values of the parameters of the set, such as identified ones; with
    /// [`values`](Self::values) it is the robot of the set. Links that result are checked as those of a file.
    ///
    /// Displacements and rotations apply after translations, in the order of the set: `J(theta_1) J(theta_2)
    /// .. placement` in the frame of the parent, `placement J(theta_1) J(theta_2) ..` in the joint frame.
    ///
    /// # Errors
    /// [`ParameterError::WrongLength`]; [`ParameterError::Robot`] for what no robot can have, such as a
    /// negative mass, an indefinite inertia, or a number that is not finite.
    pub fn robot_with(&self, values: &[f64]) -> Result<Robot, ParameterError> {
        LengthError::check("values", self.len(), values.len())?;
        let robot = self.robot();
        let mut joints = robot.joints().to_vec();
        let (mut armature, mut gravity) = (robot.armature_matrix(), robot.gravity());
        let mut inertias: Vec<_> = joints.iter().map(|joint| ten(&joint.inertia)).collect();
        let mut shifts = vec![Placement::identity(); joints.len()];
        // Displacements and rotations follow the translations that the file has, wherever they are in the
        // set.
        for (parameter, &value) in self.parameters().iter().zip(values) {
            if let Parameter::Translation { joint, axis } = *parameter {
                joints[joint].placement.translation[axis as usize] = value;
            }
        }
        for (parameter, &value) in self.parameters().iter().zip(values) {
            match *parameter {
                Parameter::Link { joint, entry } => inertias[joint][entry as usize] = value,
                Parameter::Payload { .. } | Parameter::Translation { .. } => {}
                Parameter::Rotation { joint, axis } => {
                    let turn = Displacement::about(DisplacedIn::Joint, axis.unit());
                    joints[joint].placement = joints[joint].placement.then(&moved(&turn, value));
                }
                Parameter::Displacement { joint, displacement } => match displacement.frame {
                    DisplacedIn::Parent => shifts[joint] = shifts[joint].then(&moved(&displacement, value)),
                    DisplacedIn::Joint => {
                        joints[joint].placement = joints[joint].placement.then(&moved(&displacement, value));
                    }
                },
                Parameter::Stiffness { joint } => joints[joint].spring.stiffness = value,
                Parameter::Rest { joint } => joints[joint].spring.rest = value,
                Parameter::Viscous { joint } => joints[joint].friction.viscous = value,
                Parameter::Coulomb { joint } => joints[joint].friction.coulomb = value,
                Parameter::CoulombVelocity { joint } => joints[joint].friction.coulomb_velocity = value,
                Parameter::Armature { joints: [i, j] } => {
                    (armature[(i, j)], armature[(j, i)]) = (value, value);
                }
                Parameter::Gravity { axis } => gravity[axis as usize] = value,
            }
        }
        // What payloads add comes after the values of the links.
        for (parameter, &value) in self.parameters().iter().zip(values) {
            if let Parameter::Payload { joint, placement, entry } = *parameter {
                let unit = Inertial::ALL.map(|other| if other == entry { value } else { 0.0 });
                inertias[joint].iter_mut().zip(seen(&unit, &placement)).for_each(|(sum, part)| *sum += part);
            }
        }
        for (i, joint) in joints.iter_mut().enumerate() {
            joint.placement = shifts[i].then(&joint.placement);
            if inertias[i] != ten(&joint.inertia) {
                joint.inertia = link(&inertias[i]);
            }
        }
        Ok(robot.with_constants(joints, &armature, gravity)?)
    }
}

/// The placement of a frame that a displacement moves by theta.
fn moved(displacement: &Displacement, theta: f64) -> Placement {
    let axis = Unit::new_normalize(Vector3::from(displacement.axis));
    match displacement.kind {
        JointKind::Revolute => Placement {
            rotation: *Rotation3::from_axis_angle(&axis, theta).matrix(),
            translation: Vector3::zeros(),
        },
        JointKind::Prismatic => {
            Placement { rotation: Matrix3::identity(), translation: axis.into_inner() * theta }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{FrameSpec, JointSpec, LinkInertia, RobotError};

    #[test]
    fn translations_come_before_displacements_wherever_they_are_in_the_set() {
        let turned = Placement::from_xyz_rpy([0.3, -0.1, 0.2], [0.5, 1.0, -0.4]);
        let link = LinkInertia::point(1.0, [0.1, 0.2, 0.3]);
        let joint = JointSpec::revolute("a").placed(turned).carrying(link);
        let robot = Robot::builder("one").joint(joint).build().unwrap();
        let slid = Displacement::along(DisplacedIn::Joint, [0.0, 0.6, 0.8]);
        let early =
            ParameterSet::new(&robot).displacement("slid", "a", slid).and_then(|set| set.named("a.x"));
        let late = ParameterSet::new(&robot).named("a.x").and_then(|set| set.displacement("slid", "a", slid));
        let [early, late] = [early.unwrap().robot_with(&[0.1, 0.7]), late.unwrap().robot_with(&[0.7, 0.1])];
        let (early, late) = (early.unwrap().joints()[0].placement, late.unwrap().joints()[0].placement);
        assert_eq!(early, late);
        let expected = Vector3::new(0.7, -0.1, 0.2) + turned.rotation * Vector3::new(0.0, 0.06, 0.08);
        assert!((early.translation - expected).amax() < 1e-15);
    }

    #[test]
    fn a_payload_is_the_merged_body_and_values_of_the_model_change_nothing() {
        let body = LinkInertia::about_com(2.0, [0.1, 0.2, -0.3], Matrix3::from_diagonal_element(0.4));
        let tool = Placement::from_xyz_rpy([0.3, -0.1, 0.2], [0.5, 1.0, -0.4]);
        let robot = Robot::builder("one")
            .joint(JointSpec::revolute("a").carrying(body))
            .frame(FrameSpec::new("tool").on("a").placed(tool))
            .build()
            .unwrap();
        let set = ParameterSet::new(&robot).links().payload("load", "tool").unwrap();
        assert_eq!(set.robot_with(set.values()).unwrap(), robot);
        let load = LinkInertia::about_com(0.7, [0.05, -0.2, 0.1], Matrix3::from_diagonal_element(0.01));
        let values = [&ten(&body)[..], &ten(&load)].concat();
        let with = set.robot_with(&values).unwrap().joints()[0].inertia;
        let expected = body.merged(&load.placed(&tool));
        assert!((with.mass - expected.mass).abs() < 1e-15 && (with.com - expected.com).amax() < 1e-15);
        assert!((with.inertia - expected.inertia).amax() < 1e-15);
    }

    #[test]
    fn what_no_robot_can_have_is_refused() {
        let body = LinkInertia::about_com(2.0, [0.1, 0.0, 0.0], Matrix3::identity());
        let robot = Robot::builder("one").joint(JointSpec::revolute("a").carrying(body)).build().unwrap();
        let with = |name: &str, value| {
            ParameterSet::new(&robot).named(name).and_then(|set| set.robot_with(&[value])).unwrap_err()
        };
        let is = |error: ParameterError, found: fn(&RobotError) -> bool| match &error {
            ParameterError::Robot(cause) => assert!(found(cause), "{error}"),
            error => panic!("{error}"),
        };
        is(with("a.mass", -1.0), |error| matches!(error, RobotError::NegativeMass { .. }));
        is(with("a.mass", 0.0), |error| matches!(error, RobotError::NonFiniteInertia { .. }));
        is(with("a.J_xx", -1.0), |error| matches!(error, RobotError::IndefiniteInertia { .. }));
        is(with("a.x", f64::NAN), |error| matches!(error, RobotError::BadPlacement { .. }));
        is(with("a.viscous", -1.0), |error| matches!(error, RobotError::BadValue { .. }));
        is(with("a.armature", -1.0), |error| matches!(error, RobotError::BadArmature { .. }));
        is(with("gravity_z", f64::INFINITY), |error| matches!(error, RobotError::BadGravity));
        let set = ParameterSet::new(&robot).links();
        assert!(set.robot_with(&[1.0; 3]).unwrap_err().to_string().contains("values has 3 entries, not 10"));
    }
}
