//! Hard limits of a motion.

use super::Problem;
use super::error::ProblemError;
use super::key::Key;

/// Limits that a motion keeps, one entry a joint each, infinite for none; `None` for no joint. They hold beside
/// [`Bounds`](crate::Bounds), which limit u.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionLimits {
    /// Lower limits of q (rad, m).
    pub q_min: Option<Vec<f64>>,
    /// Upper limits of q (rad, m).
    pub q_max: Option<Vec<f64>>,
    /// Limits of |v| (rad/s, m/s).
    pub v_max: Option<Vec<f64>>,
    /// Limits of |a| (rad/s^2, m/s^2).
    pub a_max: Option<Vec<f64>>,
    /// Limits of the torques and forces |tau| at the joints (N m, N): tau is u times its gain.
    pub torque_max: Option<Vec<f64>>,
    /// Whether the limits of the robot's joints are kept too: positions, rates and efforts.
    pub from_robot: bool,
}

impl Default for MotionLimits {
    /// Those of the robot alone.
    fn default() -> Self {
        Self { q_min: None, q_max: None, v_max: None, a_max: None, torque_max: None, from_robot: true }
    }
}

/// The limits of one joint, those of the robot included; infinite for none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointLimits {
    /// Least and largest q.
    pub q: [f64; 2],
    /// Largest |v|.
    pub v: f64,
    /// Largest |a|.
    pub a: f64,
    /// Least and largest torque: of `torque_max`, the robot and the bounds on u.
    pub torque: [f64; 2],
}

impl MotionLimits {
    /// No limits at all.
    pub fn none() -> Self {
        Self { from_robot: false, ..Self::default() }
    }

    /// Whether any limit is given beside those of the robot.
    pub fn any_given(&self) -> bool {
        let Self { q_min, q_max, v_max, a_max, torque_max, .. } = self;
        [q_min, q_max, v_max, a_max, torque_max].into_iter().any(Option::is_some)
    }

    /// With these lower limits of q (rad, m).
    #[must_use]
    pub fn with_q_min(self, q_min: Vec<f64>) -> Self {
        Self { q_min: Some(q_min), ..self }
    }

    /// With these upper limits of q (rad, m).
    #[must_use]
    pub fn with_q_max(self, q_max: Vec<f64>) -> Self {
        Self { q_max: Some(q_max), ..self }
    }

    /// With these limits of |v| (rad/s, m/s).
    #[must_use]
    pub fn with_v_max(self, v_max: Vec<f64>) -> Self {
        Self { v_max: Some(v_max), ..self }
    }

    /// With these limits of |a| (rad/s^2, m/s^2).
    #[must_use]
    pub fn with_a_max(self, a_max: Vec<f64>) -> Self {
        Self { a_max: Some(a_max), ..self }
    }

    /// With these limits of |tau| (N m, N).
    #[must_use]
    pub fn with_torque_max(self, torque_max: Vec<f64>) -> Self {
        Self { torque_max: Some(torque_max), ..self }
    }

    /// With or without the limits of the robot's joints.
    #[must_use]
    pub fn with_from_robot(self, from_robot: bool) -> Self {
        Self { from_robot, ..self }
    }
}

impl Problem {
    /// All limits of the joints, in their order.
    pub(crate) fn joint_limits(&self) -> Vec<JointLimits> {
        let own = &self.limits;
        let entry = |list: &Option<Vec<f64>>, i: usize| list.as_ref().map_or(f64::INFINITY, |list| list[i]);
        let joints = self.robot.independent_joints().enumerate();
        let limits = joints.map(|(i, joint)| {
            let mut limits = JointLimits {
                q: [own.q_min.as_ref().map_or(f64::NEG_INFINITY, |list| list[i]), entry(&own.q_max, i)],
                v: entry(&own.v_max, i),
                a: entry(&own.a_max, i),
                torque: [-entry(&own.torque_max, i), entry(&own.torque_max, i)],
            };
            if own.from_robot {
                let robot = &joint.limits;
                limits.q = intersection(limits.q, [robot.lower, robot.upper]);
                limits.v = limits.v.min(robot.velocity);
                limits.torque = intersection(limits.torque, [-robot.effort, robot.effort]);
            }
            if let Some(bounds) = &self.bounds {
                let ends = [bounds.u_min[i], bounds.u_max[i]].map(|u| self.gain[i] * u);
                limits.torque = intersection(limits.torque, [ends[0].min(ends[1]), ends[0].max(ends[1])]);
            }
            limits
        });
        limits.collect()
    }

    /// Limits are numbers; those of magnitudes are positive.
    pub(super) fn check_limit_lists(&self) -> Result<(), ProblemError> {
        let MotionLimits { q_min, q_max, v_max, a_max, torque_max, .. } = &self.limits;
        let lists = [
            (Key::LIMIT_Q_MIN, q_min),
            (Key::LIMIT_Q_MAX, q_max),
            (Key::LIMIT_V_MAX, v_max),
            (Key::LIMIT_A_MAX, a_max),
            (Key::LIMIT_TORQUE_MAX, torque_max),
        ];
        for (key, list) in lists {
            let Some(list) = list else { continue };
            self.numbers(key, list)?;
            let signed = key == Key::LIMIT_Q_MIN || key == Key::LIMIT_Q_MAX;
            if let Some(j) = list.iter().position(|&limit| limit <= 0.0).filter(|_| !signed) {
                return Err(ProblemError::NoRoom { key, joint: self.name(j), value: list[j] });
            }
        }
        Ok(())
    }

    /// Whether there is something between the limits, those of the robot included, and the given ends lie there.
    ///
    /// # Errors
    /// [`ProblemError::EmptyLimits`], [`ProblemError::OutsideLimits`], with the joint.
    pub(super) fn check_limits(&self) -> Result<(), ProblemError> {
        for (j, limits) in self.joint_limits().iter().enumerate() {
            for (key, [low, high]) in [(Key::LIMIT_Q_MIN, limits.q), (Key::LIMIT_TORQUE_MAX, limits.torque)] {
                if low >= high {
                    return Err(ProblemError::EmptyLimits { key, joint: self.name(j), low, high });
                }
            }
            let ends = [(&self.start, Key::START_Q, Key::START_V), (&self.end, Key::END_Q, Key::END_V)];
            for (end, key_q, key_v) in ends {
                let values = [
                    (key_q, end.q[j], limits.q, end.q_free.contains(&j)),
                    (key_v, end.v[j], [-limits.v, limits.v], end.v_free.contains(&j)),
                ];
                for (key, value, [low, high], free) in values {
                    if !free && !(low..=high).contains(&value) {
                        return Err(ProblemError::OutsideLimits {
                            key,
                            joint: self.name(j),
                            value,
                            low,
                            high,
                        });
                    }
                }
            }
        }
        Ok(())
    }
}

fn intersection(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}
