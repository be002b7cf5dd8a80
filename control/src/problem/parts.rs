//! The parts of a problem: ends, final time, weights, bounds, penalties.

use super::key::Key;

/// State at one end of a motion, some components possibly free.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct BoundaryState {
    /// Positions (rad, m), n entries. Those of free joints only shape the first guess.
    pub q: Vec<f64>,
    /// Rates (rad/s, m/s), n entries. Those of free joints only shape the first guess.
    pub v: Vec<f64>,
    /// Accelerations (rad/s^2, m/s^2), n entries; `None` for free ones. With given accelerations those of the
    /// whole motion are continuous. Needs [`Method::Direct`](crate::Method::Direct).
    pub a: Option<Vec<f64>>,
    /// Joints whose position is free: $(y_q + P^\top y_p)_j = 0$ here, $P = \partial(M v)/\partial q$.
    pub q_free: Vec<usize>,
    /// Joints whose rate is free: $(M y_p)_j = 0$ here.
    pub v_free: Vec<usize>,
}

impl BoundaryState {
    /// These positions and rates, free accelerations.
    pub fn fixed(q: &[f64], v: &[f64]) -> Self {
        Self { q: q.to_vec(), v: v.to_vec(), a: None, q_free: Vec::new(), v_free: Vec::new() }
    }

    /// With these accelerations.
    #[must_use]
    pub fn with_a(self, a: &[f64]) -> Self {
        Self { a: Some(a.to_vec()), ..self }
    }

    /// With the positions of these joints free.
    #[must_use]
    pub fn with_q_free(self, joints: &[usize]) -> Self {
        Self { q_free: joints.to_vec(), ..self }
    }

    /// With the rates of these joints free.
    #[must_use]
    pub fn with_v_free(self, joints: &[usize]) -> Self {
        Self { v_free: joints.to_vec(), ..self }
    }
}

/// Duration of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum FinalTime {
    /// T (s).
    Fixed(f64),
    /// Determined by $H^\ast(T) = 0$.
    Free {
        /// First guess of T (s).
        guess: f64,
    },
}

impl FinalTime {
    /// T or its guess (s).
    pub fn value(self) -> f64 {
        match self {
            Self::Fixed(time) | Self::Free { guess: time } => time,
        }
    }
}

/// Weights of
///
/// $$ c_t T + \int \sum_i \left( \frac12 r_i u_i^2 + e_i \phi(\tau_i v_i) + \frac12 w_i \dot\tau_i^2
///    + \frac12 \bar w_i \dddot q_i^2 \right) dt $$
///
/// where $\phi(p) = \frac12 (p + \sqrt{p^2 + s^2} - s)$ is the positive part of the mechanical power,
/// smoothed.
///
/// It is at most that, and at most s/2 less: with cost e per joule, a motion of T seconds costs up to
/// $\frac12 e s T$ less than with $s \to 0$. Braking gives back no more than that.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Objective {
    /// $c_t$, the cost of a second.
    pub time: f64,
    /// $r_i$, n entries. Zero only for a control that is bounded on both sides.
    pub effort: Vec<f64>,
    /// $e_i$, the cost of a joule of mechanical work that the actuator of a joint does, n entries; `None` for
    /// none. $\tau_i$ (N m, N) is the torque at the joint, after the gain. Needs
    /// [`Method::Direct`](crate::Method::Direct).
    pub energy: Option<Vec<f64>>,
    /// $w_i$, the weights of the squared rates of the torques and forces at the joints, after the gain
    /// ((N m/s)^2, (N/s)^2), n entries; `None` for none. Needs [`Method::Direct`](crate::Method::Direct).
    pub torque_rate: Option<Vec<f64>>,
    /// $\bar w_i$, the weights of the squared jerks ((rad/s^3)^2, (m/s^3)^2), n entries; `None` for none.
    /// Needs [`Method::Direct`](crate::Method::Direct).
    pub jerk: Option<Vec<f64>>,
    /// s (W), by default 1. Powers much smaller than this cost next to nothing; small values make corners
    /// which need more nodes.
    pub energy_smoothing: f64,
}

impl Objective {
    /// The cost of a second, and the weight of each control.
    pub fn new(time: f64, effort: Vec<f64>) -> Self {
        let (energy_smoothing, torque_rate, jerk) = (ENERGY_SMOOTHING, None, None);
        Self { time, effort, energy: None, torque_rate, jerk, energy_smoothing }
    }

    /// With this cost of a second.
    #[must_use]
    pub fn with_time(self, time: f64) -> Self {
        Self { time, ..self }
    }

    /// With these weights of the controls.
    #[must_use]
    pub fn with_effort(self, effort: Vec<f64>) -> Self {
        Self { effort, ..self }
    }

    /// With these costs of a joule, one for each joint.
    #[must_use]
    pub fn with_energy(self, energy: Vec<f64>) -> Self {
        Self { energy: Some(energy), ..self }
    }

    /// With this smoothing of the cost of energy (W).
    #[must_use]
    pub fn with_energy_smoothing(self, energy_smoothing: f64) -> Self {
        Self { energy_smoothing, ..self }
    }

    /// With these weights of the squared rates of torques and forces.
    #[must_use]
    pub fn with_torque_rate(self, torque_rate: Vec<f64>) -> Self {
        Self { torque_rate: Some(torque_rate), ..self }
    }

    /// With these weights of the squared jerks.
    #[must_use]
    pub fn with_jerk(self, jerk: Vec<f64>) -> Self {
        Self { jerk: Some(jerk), ..self }
    }

    /// The first cost of rates of torques or of jerks.
    pub(crate) fn first_of_rates(&self) -> Option<Key> {
        let costs =
            |list: &Option<Vec<f64>>| list.as_ref().is_some_and(|list| list.iter().any(|&w| w != 0.0));
        let lists = [(Key::TORQUE_RATE, &self.torque_rate), (Key::JERK, &self.jerk)];
        lists.into_iter().find(|(_, list)| costs(list)).map(|(key, _)| key)
    }

    /// Whether energy costs anything.
    pub fn has_energy(&self) -> bool {
        self.energy.as_ref().is_some_and(|energy| energy.iter().any(|&weight| weight != 0.0))
    }
}

/// Smoothing of the cost of energy (W), if none is given.
pub(crate) const ENERGY_SMOOTHING: f64 = 1.0;

/// `u_min <= u <= u_max` (N m or N, before the gain), n entries each. An infinite entry is no bound on that
/// side.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bounds {
    /// Lower bounds.
    pub u_min: Vec<f64>,
    /// Upper bounds.
    pub u_max: Vec<f64>,
}

impl Bounds {
    /// Lower and upper bounds; [`f64::NEG_INFINITY`] and [`f64::INFINITY`] for none.
    pub fn new(u_min: Vec<f64>, u_max: Vec<f64>) -> Self {
        Self { u_min, u_max }
    }

    /// The same limit in both directions: $|u_i| \le u_{max,i}$.
    pub fn symmetric(u_max: Vec<f64>) -> Self {
        Self { u_min: u_max.iter().map(|limit| -limit).collect(), u_max }
    }
}

/// Adds weight/2 times the squared violation of each limit to the running cost. An infinite entry is no
/// limit.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Penalty {
    /// Weight of all violations.
    pub weight: f64,
    /// Lower limits of q (rad, m).
    pub q_min: Option<Vec<f64>>,
    /// Upper limits of q (rad, m).
    pub q_max: Option<Vec<f64>>,
    /// Limits of |v| (rad/s, m/s).
    pub v_max: Option<Vec<f64>>,
}

impl Penalty {
    /// With this weight and no limits.
    pub fn new(weight: f64) -> Self {
        Self { weight, ..Self::default() }
    }

    /// With this weight of all violations.
    #[must_use]
    pub fn with_weight(self, weight: f64) -> Self {
        Self { weight, ..self }
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
}
