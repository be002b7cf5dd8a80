//! Torques and powers at ends where nothing is left to choose.

use super::error::ProblemError;
use super::key::Key;
use super::limits::JointLimits;
use super::{BoundaryState, Problem};
use crate::constants::direct::VIOLATION_ACCEPTED;
use costate::lagrangian::Lagrangian;

impl Problem {
    /// Whether the torques of ends whose positions, rates and accelerations are all given keep the limits on
    /// torques and powers: no motion can change them.
    ///
    /// # Errors
    /// [`ProblemError::BeyondLimit`] with the joint, the value and the limit.
    pub(super) fn check_given_ends(&self) -> Result<(), ProblemError> {
        for (end, key) in [(&self.start, Key::START_A), (&self.end, Key::END_A)] {
            let BoundaryState { q, v, a: Some(a), q_free, v_free, .. } = end else { continue };
            if !q_free.is_empty() || !v_free.is_empty() {
                continue;
            }
            let mut dynamics = Lagrangian::<f64>::new(&self.robot);
            // What cannot be evaluated is told when the motion is.
            let Ok(tau) = dynamics.inverse_dynamics(q, v, a) else { continue };
            self.check_torques(v, tau, key)?;
        }
        Ok(())
    }

    fn check_torques(&self, v: &[f64], tau: &[f64], key: Key) -> Result<(), ProblemError> {
        let all = self.joint_limits();
        let ranges = all.iter().map(|limits| limits.torque[1] - limits.torque[0]);
        let largest = ranges.filter(|range| range.is_finite()).fold(0.0, f64::max);
        let beyond = |joint: Option<usize>, quantity, value: f64, [low, high]: [f64; 2], size: f64| {
            let limit = value.max(low).min(high);
            let is_kept = (value - limit).abs() <= VIOLATION_ACCEPTED * size;
            let joint = joint.map(|joint| self.name(joint));
            if is_kept {
                Ok(())
            } else {
                Err(ProblemError::BeyondLimit { key, joint, quantity, value, limit })
            }
        };
        for (j, ((limits, &v), &tau)) in all.iter().zip(v).zip(tau).enumerate() {
            // The unit of a joint without a motor is what the other motors give.
            let size = if largest > 0.0 { largest } else { 1.0 };
            beyond(Some(j), "torque", tau, torque_range(limits, v), size)?;
            beyond(Some(j), "power", tau * v, [-limits.power, limits.power], limits.power)?;
        }
        let total = self.limits.total_power_max.unwrap_or(f64::INFINITY);
        let power = tau.iter().zip(v).map(|(tau, v)| tau * v).sum();
        beyond(None, "power", power, [-total, total], total)
    }
}

/// Between which limits a torque must lie at a rate: where it drives, a fast motor gives less.
fn torque_range(limits: &JointLimits, v: f64) -> [f64; 2] {
    let ([low, high], [corner, no_load]) = (limits.torque, limits.speeds);
    if no_load.is_infinite() {
        return [low, high];
    }
    let part = ((no_load - v.abs()) / (no_load - corner)).clamp(0.0, 1.0);
    if v > 0.0 { [low, part * high] } else { [part * low, high] }
}

#[cfg(test)]
mod tests {
    use super::torque_range;
    use crate::problem::limits::JointLimits;

    #[test]
    fn motors_that_drive_fast_give_less() {
        let infinite = f64::INFINITY;
        let limits = JointLimits {
            q: [-infinite, infinite],
            v: infinite,
            a: infinite,
            torque: [-6.0, 8.0],
            jerk: infinite,
            torque_rate: infinite,
            power: infinite,
            speeds: [1.0, 3.0],
        };
        let cases = [
            (0.5, [-6.0, 8.0]),
            (2.0, [-6.0, 4.0]),
            (-2.0, [-3.0, 8.0]),
            (4.0, [-6.0, 0.0]),
            (0.0, [-6.0, 8.0]),
        ];
        for (v, expected) in cases {
            assert_eq!(torque_range(&limits, v), expected, "{v}");
        }
    }
}
