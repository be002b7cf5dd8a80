//! What an error is about.

use super::RobotError;

impl RobotError {
    /// The joint, link or frame at fault, where there is one.
    pub fn culprit(&self) -> Option<&str> {
        match self {
            Self::InFile { error, .. } | Self::Unexpanded { error, .. } => error.culprit(),
            Self::UnknownParent { joint, .. }
            | Self::UnknownChild { joint, .. }
            | Self::UnknownMimic { joint, .. }
            | Self::UnknownJoint { joint, .. }
            | Self::StillJoint { joint }
            | Self::RepeatedJoint { joint }
            | Self::DependentJoint { joint, .. }
            | Self::NotMirrored { joint, .. }
            | Self::UnsupportedMimic { joint, .. }
            | Self::UnsupportedJoint { joint, .. }
            | Self::FreeJoint { joint, .. }
            | Self::BadAxis { joint }
            | Self::BadPlacement { joint }
            | Self::BadValue { joint, .. } => Some(joint),
            Self::TwoParents { second, .. } => Some(second),
            Self::Cycle { joints } | Self::MimicCycle { joints } | Self::AllLocked { joints } => {
                joints.first().map(String::as_str)
            }
            Self::SeveralRoots { second, .. } => Some(second),
            Self::NonFiniteInertia { body, .. }
            | Self::NegativeMass { body, .. }
            | Self::OutOfRange { body, .. }
            | Self::IndefiniteInertia { body, .. } => Some(body.name()),
            Self::DuplicateName { name, .. } | Self::BadName { name, .. } => Some(name),
            Self::UnknownFrame { frame, .. }
            | Self::FixedFrame { frame }
            | Self::BadFramePlacement { frame }
            | Self::BadWrench { frame } => Some(frame),
            Self::BadConstraint { constraint, .. }
            | Self::BadLoop { constraint, .. }
            | Self::Constrained { constraint, .. } => Some(constraint),
            _ => None,
        }
    }
}
