//! Hard limits of a motion.

/// Limits that a motion keeps, one entry a joint each, infinite for none; `None` for no joint. They hold
/// beside [`Bounds`](crate::Bounds), which limit u.
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
    /// Limits of the torques and forces |tau| at the joints (N m, N): tau is u times its gain. 0 for a joint
    /// without a motor.
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
    /// Whether a joint has no motor: its torque is limited to 0 here.
    pub(crate) fn has_no_motor(&self, joint: usize) -> bool {
        self.torque_max.as_ref().is_some_and(|list| list[joint] == 0.0)
    }

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
