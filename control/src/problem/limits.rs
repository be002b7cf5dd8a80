//! Hard limits of a motion.

use super::key::Key;

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
    /// Limits of the jerks |dddot q| (rad/s^3, m/s^3). With them accelerations are continuous.
    pub jerk_max: Option<Vec<f64>>,
    /// Limits of the rates of the torques and forces at the joints, |d tau/dt| (N m/s, N/s). With them
    /// torques are continuous.
    pub torque_rate_max: Option<Vec<f64>>,
    /// Limits of the mechanical power |tau v| of each joint (W).
    pub power_max: Option<Vec<f64>>,
    /// Limit of the power of all joints together, $|\sum_i \tau_i v_i|$ (W).
    pub total_power_max: Option<f64>,
    /// Rates $v_c$ above which a motor gives less than its largest torque (rad/s, m/s). Together with
    /// [`no_load_speed`](Self::no_load_speed), and for joints with a torque limit: where the motor drives,
    /// its largest torque falls in a straight line from $\tau_{max}$ at $v_c$ to zero at $v_0$,
    /// $\pm\tau \le \tau_{max} (v_0 \mp v) / (v_0 - v_c)$. It brakes with all of $\tau_{max}$.
    pub corner_speed: Option<Vec<f64>>,
    /// Rates $v_0$ at which a motor gives no torque any more (rad/s, m/s).
    pub no_load_speed: Option<Vec<f64>>,
    /// Whether the limits of the robot's joints are kept too: positions, rates and efforts. `None`: if all of
    /// its joints have limits of rate and effort and the problem has neither bounds nor penalties, or if
    /// something else in the problem needs the direct method, such as a limit or a tool; a motion that
    /// exceeds them gets [warnings](crate::Problem::limit_warnings) otherwise.
    pub from_robot: Option<bool>,
}

impl Default for MotionLimits {
    /// Those of the robot alone.
    fn default() -> Self {
        Self {
            q_min: None,
            q_max: None,
            v_max: None,
            a_max: None,
            torque_max: None,
            jerk_max: None,
            torque_rate_max: None,
            power_max: None,
            total_power_max: None,
            corner_speed: None,
            no_load_speed: None,
            from_robot: Some(true),
        }
    }
}

/// The limits of one joint, those of the robot included; infinite for none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct JointLimits {
    /// Least and largest q.
    pub q: [f64; 2],
    /// Largest |v|.
    pub v: f64,
    /// Largest |a|.
    pub a: f64,
    /// Least and largest torque: of `torque_max`, the robot and the bounds on u.
    pub torque: [f64; 2],
    /// Largest |q'''|.
    pub jerk: f64,
    /// Largest |d tau/dt|.
    pub torque_rate: f64,
    /// Largest |tau v|.
    pub power: f64,
    /// Corner speed and no-load speed.
    pub speeds: [f64; 2],
}

impl MotionLimits {
    /// Whether a joint has no motor: its torque is limited to 0 here.
    pub(crate) fn has_no_motor(&self, joint: usize) -> bool {
        self.torque_max.as_ref().is_some_and(|list| list[joint] == 0.0)
    }

    /// No limits at all.
    pub fn none() -> Self {
        Self { from_robot: Some(false), ..Self::default() }
    }

    /// Nothing is said about limits.
    pub(crate) fn unsaid() -> Self {
        Self { from_robot: None, ..Self::default() }
    }

    /// Whether any limit is given beside those of the robot.
    pub fn any_given(&self) -> bool {
        self.lists().iter().any(|(_, list)| list.is_some()) || self.total_power_max.is_some()
    }

    /// Whether any limit is asked for, those of the robot included.
    pub(crate) fn are_asked_for(&self) -> bool {
        self.any_given() || self.from_robot == Some(true)
    }

    /// All lists with their keys.
    pub(crate) fn lists(&self) -> [(Key, &Option<Vec<f64>>); 10] {
        [
            (Key::LIMIT_Q_MIN, &self.q_min),
            (Key::LIMIT_Q_MAX, &self.q_max),
            (Key::LIMIT_V_MAX, &self.v_max),
            (Key::LIMIT_A_MAX, &self.a_max),
            (Key::LIMIT_TORQUE_MAX, &self.torque_max),
            (Key::LIMIT_JERK_MAX, &self.jerk_max),
            (Key::LIMIT_TORQUE_RATE_MAX, &self.torque_rate_max),
            (Key::LIMIT_POWER_MAX, &self.power_max),
            (Key::LIMIT_CORNER_SPEED, &self.corner_speed),
            (Key::LIMIT_NO_LOAD_SPEED, &self.no_load_speed),
        ]
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

    /// With these limits of the jerks (rad/s^3, m/s^3).
    #[must_use]
    pub fn with_jerk_max(self, jerk_max: Vec<f64>) -> Self {
        Self { jerk_max: Some(jerk_max), ..self }
    }

    /// With these limits of the rates of torques and forces (N m/s, N/s).
    #[must_use]
    pub fn with_torque_rate_max(self, torque_rate_max: Vec<f64>) -> Self {
        Self { torque_rate_max: Some(torque_rate_max), ..self }
    }

    /// The first limit of jerks or rates of torques.
    pub(crate) fn first_of_rates(&self) -> Option<Key> {
        let limits =
            |list: &Option<Vec<f64>>| list.as_ref().is_some_and(|list| list.iter().any(|l| l.is_finite()));
        let lists =
            [(Key::LIMIT_JERK_MAX, &self.jerk_max), (Key::LIMIT_TORQUE_RATE_MAX, &self.torque_rate_max)];
        lists.into_iter().find(|(_, list)| limits(list)).map(|(key, _)| key)
    }

    /// With these limits of |tau v| (W).
    #[must_use]
    pub fn with_power_max(self, power_max: Vec<f64>) -> Self {
        Self { power_max: Some(power_max), ..self }
    }

    /// With this limit of the power of all joints together (W).
    #[must_use]
    pub fn with_total_power_max(self, total_power_max: f64) -> Self {
        Self { total_power_max: Some(total_power_max), ..self }
    }

    /// With motors whose torque falls from its limit at `corner_speed` to zero at `no_load_speed` (rad/s,
    /// m/s).
    #[must_use]
    pub fn with_torque_speed(self, corner_speed: Vec<f64>, no_load_speed: Vec<f64>) -> Self {
        Self { corner_speed: Some(corner_speed), no_load_speed: Some(no_load_speed), ..self }
    }

    /// With or without the limits of the robot's joints.
    #[must_use]
    pub fn with_from_robot(self, from_robot: bool) -> Self {
        Self { from_robot: Some(from_robot), ..self }
    }
}
