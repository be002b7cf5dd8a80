//! The sides of a limit that a motion depends on.

use super::motion_derivative::MotionParameter;
use super::resolve::Resolve;
use super::resolve_error::ResolveError;
use crate::direct::limits::side::{Limited, Side};

/// The sides of a limit of one joint, or of a power of all.
#[derive(Clone, Copy, Debug)]
pub(super) struct LimitSides {
    pub limited: Limited,
    /// The joint, or the row of powers.
    row: usize,
    /// The sign of the side, 0 for both.
    pub sign: f64,
}

impl LimitSides {
    /// Whether a side is one of them.
    pub fn has(&self, side: &Side) -> bool {
        let same = side.limited == self.limited && side.joint == self.row;
        same && !side.is_equation && (self.sign == 0.0 || side.sign == self.sign)
    }
}

impl Resolve {
    /// The sides of a limit, and its joint; `None` for all joints.
    ///
    /// # Errors
    /// [`ResolveError::NoLimit`]: a joint without this limit, or with a torque that falls with its speed;
    /// [`ResolveError::NotALimit`].
    pub(super) fn sides_of(
        &self,
        limit: &MotionParameter,
    ) -> Result<(LimitSides, Option<usize>), ResolveError> {
        use MotionParameter as Of;
        let (limited, joint, sign) = match limit {
            Of::PositionMin(joint) => (Limited::Position, Some(*joint), 1.0),
            Of::PositionMax(joint) => (Limited::Position, Some(*joint), -1.0),
            Of::VelocityMax(joint) => (Limited::Rate, Some(*joint), 0.0),
            Of::AccelerationMax(joint) => (Limited::Acceleration, Some(*joint), 0.0),
            Of::TorqueMax(joint) => (Limited::Torque, Some(*joint), 0.0),
            Of::JerkMax(joint) => (Limited::Jerk, Some(*joint), 0.0),
            Of::TorqueRateMax(joint) => (Limited::TorqueRate, Some(*joint), 0.0),
            Of::PowerMax(joint) => (Limited::Power, Some(*joint), 0.0),
            Of::TotalPowerMax => (Limited::Power, None, 0.0),
            Of::PayloadMass(_)
            | Of::CornerSpeed(_)
            | Of::NoLoadSpeed(_)
            | Of::KeepMax(_)
            | Of::ObstacleRadius(_)
            | Of::CollisionMargin => return Err(ResolveError::NotALimit),
        };
        let (sides, powers) = (|| self.interior.barrier.all_sides(), &self.interior.model.powers);
        let is_of = |side: &Side, joint: Option<usize>| match side.limited {
            Limited::Power | Limited::TorqueSpeed => powers.joint(side.joint) == joint,
            _ => Some(side.joint) == joint,
        };
        let falls = limited == Limited::Torque
            && sides().any(|side| side.limited == Limited::TorqueSpeed && is_of(side, joint));
        let found = sides().find(|side| side.limited == limited && is_of(side, joint)).filter(|_| !falls);
        let of = found.map(|side| LimitSides { limited, row: side.joint, sign });
        match of.filter(|of| sides().any(|side| of.has(side))) {
            Some(of) => Ok((of, joint)),
            None => {
                let joint = joint.map_or_else(|| "all".into(), |joint| self.joint_name(joint));
                Err(ResolveError::NoLimit { kind: limited.name(), joint })
            }
        }
    }
}
