//! Limits of joints that change between two solves.

use super::motion_derivative::MotionParameter;
use super::resolve::Resolve;
use super::resolve_error::ResolveError;
use crate::direct::limits::side::Limited;
use crate::problem::limits::JointLimits;

impl Resolve {
    /// The next solve keeps another value of a limit that the problem has: the least or largest position of a
    /// joint (rad, m), or the largest magnitude of its rate, acceleration, jerk, torque, rate of torque or
    /// power, or of the power of all. Violations stay in parts of the range that the limit had at first.
    ///
    /// # Errors
    /// [`ResolveError::NoLimit`]: a joint without this limit, or with a torque that falls with its speed;
    /// [`ResolveError::BadLimit`]: a magnitude that is not positive, positions without room between them, no
    /// finite number; [`ResolveError::Outside`]: the start or end that is set lies outside;
    /// [`ResolveError::NotALimit`] for what is no limit of joints.
    pub fn set_limit(&mut self, limit: &MotionParameter, value: f64) -> Result<(), ResolveError> {
        let (sides, joint) = self.sides_of(limit)?;
        let (limited, kind) = (sides.limited, sides.limited.name());
        let bad = |remedy: &'static str| {
            let joint = joint.map_or_else(|| "all".into(), |joint| self.joint_name(joint));
            Err(ResolveError::BadLimit { kind, joint, value, remedy })
        };
        if !value.is_finite() {
            return bad("is not finite");
        }
        if limited != Limited::Position && value <= 0.0 {
            return bad("is not positive");
        }
        if let Some(joint) = joint {
            let limits = self.limits_with(limit, joint, value);
            if limits.q[0] >= limits.q[1] {
                return bad("leaves no room between the limits");
            }
            self.holds_ends(joint, [limits.q, [-limits.v, limits.v]])?;
            self.limits[joint] = limits;
        }
        self.interior.barrier.set_bounds(
            |side| sides.has(side),
            |side| if sides.sign == 0.0 { -side.sign * value } else { value },
        );
        Ok(())
    }

    /// The limits of a joint with another value of one of them.
    fn limits_with(&self, limit: &MotionParameter, joint: usize, value: f64) -> JointLimits {
        let mut limits = self.limits[joint];
        match limit {
            MotionParameter::PositionMin(_) => limits.q[0] = value,
            MotionParameter::PositionMax(_) => limits.q[1] = value,
            MotionParameter::VelocityMax(_) => limits.v = value,
            MotionParameter::AccelerationMax(_) => limits.a = value,
            MotionParameter::TorqueMax(_) => limits.torque = [-value, value],
            MotionParameter::PowerMax(_) => limits.power = value,
            MotionParameter::JerkMax(_) => limits.jerk = value,
            MotionParameter::TorqueRateMax(_) => limits.torque_rate = value,
            // No limits of one joint.
            _ => {}
        }
        limits
    }

    /// Whether what is given of a joint at both ends lies between these limits of its position and rate.
    fn holds_ends(&self, joint: usize, limits: [[f64; 2]; 2]) -> Result<(), ResolveError> {
        let n = self.dof();
        let names = [["q at the start", "v at the start"], ["q at the end", "v at the end"]];
        for (end, names) in names.into_iter().enumerate() {
            for (group, (what, [low, high])) in names.into_iter().zip(limits).enumerate() {
                let (entry, given) = (n * group + joint, &self.interior.ends.given[end]);
                let value = self.states[end][entry];
                if given[entry] && !(low..=high).contains(&value) {
                    return Err(ResolveError::Outside {
                        what,
                        joint: self.joint_name(joint),
                        value,
                        low,
                        high,
                    });
                }
            }
        }
        Ok(())
    }
}
