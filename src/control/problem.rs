//! What an optimal motion is asked for.

use super::error::ProblemError;
use crate::robot::Robot;

/// Find u(t) that takes a robot from its start to its end and makes
///
/// ```text
/// J = c_t T + integral of ( 1/2 sum_i r_i u_i^2 + penalties ) dt ,      dx/dt = F(x) + (0, B u)
/// ```
///
/// least, x = (q, p). `H*(x, y) = max_u [ y'f - l ]` is the maximised Hamiltonian, l = dJ/dt, and `y' = -H*_x`: so
/// `u_i = r_i^-1 b_i y_p,i`, cut to the bounds; `dJ/dT = -H*` and `y(0) = -dJ/dx(0)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The robot.
    pub robot: Robot,
    /// Where it starts.
    pub start: Start,
    /// Where it must arrive.
    pub end: End,
    /// When.
    pub time: Time,
    /// The criterion.
    pub cost: Cost,
    /// Diagonal of B, n.
    pub gain: Vec<f64>,
    /// Bounds on u, if any.
    pub bounds: Option<Bounds>,
    /// Penalties on positions and rates, if any.
    pub penalty: Option<Penalty>,
}

/// State at the start.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Positions (rad, m), n.
    pub q: Vec<f64>,
    /// Rates (rad/s, m/s), n.
    pub v: Vec<f64>,
}

/// State at the end.
#[derive(Clone, Debug, PartialEq)]
pub struct End {
    /// Positions (rad, m), n; those of free joints only shape the first guess.
    pub q: Vec<f64>,
    /// Rates (rad/s, m/s), n; those of free joints only shape the first guess.
    pub v: Vec<f64>,
    /// Joints whose position at the end is free: `(y_q + P'y_p)_j = 0` there.
    pub q_free: Vec<usize>,
    /// Joints whose rate at the end is free: `(M y_p)_j = 0` there.
    pub v_free: Vec<usize>,
}

/// Duration of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Time {
    /// T (s).
    Fixed(f64),
    /// To be found, H*(T) = 0.
    Free {
        /// Where to begin (s).
        guess: f64,
    },
}

impl Time {
    /// T or its guess (s).
    pub fn value(self) -> f64 {
        match self {
            Self::Fixed(time) | Self::Free { guess: time } => time,
        }
    }
}

/// `c_t T + integral of 1/2 sum_i r_i u_i^2`.
#[derive(Clone, Debug, PartialEq)]
pub struct Cost {
    /// c_t, weight of T.
    pub time: f64,
    /// r_i, n; zero only for a bounded joint.
    pub effort: Vec<f64>,
}

/// `u_min <= u <= u_max` (N m, N before the gain), n each.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest u.
    pub u_min: Vec<f64>,
    /// Largest u.
    pub u_max: Vec<f64>,
}

/// Adds weight/2 times the squared violation of each limit given to the running cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Penalty {
    /// Weight, the same for all.
    pub weight: f64,
    /// Smallest q (rad, m).
    pub q_min: Option<Vec<f64>>,
    /// Largest q (rad, m).
    pub q_max: Option<Vec<f64>>,
    /// Largest |v| (rad/s, m/s).
    pub v_max: Option<Vec<f64>>,
}

impl Problem {
    /// From rest to rest in the time T, criterion `1/2 |u|^2`, no bounds.
    pub fn rest_to_rest(robot: Robot, from: &[f64], to: &[f64], time: f64) -> Self {
        let n = robot.len();
        Self {
            robot,
            start: Start { q: from.to_vec(), v: vec![0.0; n] },
            end: End { q: to.to_vec(), v: vec![0.0; n], q_free: Vec::new(), v_free: Vec::new() },
            time: Time::Fixed(time),
            cost: Cost { time: 0.0, effort: vec![1.0; n] },
            gain: vec![1.0; n],
            bounds: None,
            penalty: None,
        }
    }

    /// Whether the problem can be posed at all.
    ///
    /// # Errors
    /// The first [`ProblemError`] met; it names the key as in a problem file, and the joint.
    pub fn check(&self) -> Result<(), ProblemError> {
        let n = self.robot.len();
        self.vector("start.q", &self.start.q)?;
        self.vector("start.v", &self.start.v)?;
        self.vector("end.q", &self.end.q)?;
        self.vector("end.v", &self.end.v)?;
        for (key, joints) in [("end.q_free", &self.end.q_free), ("end.v_free", &self.end.v_free)] {
            if let Some(&joint) = joints.iter().find(|&&joint| joint >= n) {
                return Err(ProblemError::UnknownJoint { key, joint, n });
            }
        }
        let (key, time) = match self.time {
            Time::Fixed(time) => ("time.final", time),
            Time::Free { guess } => ("time.guess", guess),
        };
        if !(time > 0.0 && time.is_finite()) {
            return Err(ProblemError::NotPositive { key, value: time });
        }
        if !(self.cost.time >= 0.0 && self.cost.time.is_finite()) {
            return Err(ProblemError::Negative { key: "cost.time", joint: None, value: self.cost.time });
        }
        if matches!(self.time, Time::Free { .. }) && self.cost.time == 0.0 {
            return Err(ProblemError::FreeTimeWithoutCost);
        }
        self.not_negative("cost.effort", &self.cost.effort)?;
        self.vector("actuation.gain", &self.gain)?;
        if let Some(joint) = self.gain.iter().position(|&gain| gain == 0.0) {
            return Err(ProblemError::NoGain { joint: self.name(joint) });
        }
        if let Some(Bounds { u_min, u_max }) = &self.bounds {
            self.vector("bounds.u_min", u_min)?;
            self.vector("bounds.u_max", u_max)?;
            if let Some(joint) = (0..n).find(|&j| u_min[j] >= u_max[j]) {
                let (u_min, u_max) = (u_min[joint], u_max[joint]);
                return Err(ProblemError::EmptyBounds { joint: self.name(joint), u_min, u_max });
            }
        } else if let Some(joint) = self.cost.effort.iter().position(|&r| r == 0.0) {
            return Err(ProblemError::UnboundedEffort { joint: self.name(joint) });
        }
        if matches!(self.time, Time::Fixed(_)) && self.cost.effort.iter().all(|&r| r == 0.0) {
            return Err(ProblemError::NothingToMinimise);
        }
        self.penalty.as_ref().map_or(Ok(()), |penalty| self.check_penalty(penalty))
    }

    fn check_penalty(&self, penalty: &Penalty) -> Result<(), ProblemError> {
        if !(penalty.weight >= 0.0 && penalty.weight.is_finite()) {
            return Err(ProblemError::Negative { key: "penalty.weight", joint: None, value: penalty.weight });
        }
        let both = [("penalty.q_min", &penalty.q_min), ("penalty.q_max", &penalty.q_max)];
        for (key, values) in both {
            values.as_ref().map_or(Ok(()), |values| self.vector(key, values))?;
        }
        if let Some(v_max) = &penalty.v_max {
            self.not_negative("penalty.v_max", v_max)?;
        }
        if let (Some(q_min), Some(q_max)) = (&penalty.q_min, &penalty.q_max)
            && let Some(joint) = (0..q_min.len()).find(|&j| q_min[j] >= q_max[j])
        {
            let (q_min, q_max) = (q_min[joint], q_max[joint]);
            return Err(ProblemError::EmptyRange { joint: self.name(joint), q_min, q_max });
        }
        Ok(())
    }

    /// n finite entries.
    fn vector(&self, key: &'static str, values: &[f64]) -> Result<(), ProblemError> {
        let n = self.robot.len();
        if values.len() != n {
            return Err(ProblemError::WrongLength { key, expected: n, found: values.len() });
        }
        match values.iter().position(|value| !value.is_finite()) {
            Some(joint) => Err(ProblemError::NotFinite { key, joint: self.name(joint) }),
            None => Ok(()),
        }
    }

    /// n finite entries, none below zero.
    fn not_negative(&self, key: &'static str, values: &[f64]) -> Result<(), ProblemError> {
        self.vector(key, values)?;
        match values.iter().position(|&value| value < 0.0) {
            Some(j) => Err(ProblemError::Negative { key, joint: Some(self.name(j)), value: values[j] }),
            None => Ok(()),
        }
    }

    fn name(&self, joint: usize) -> String {
        self.robot.joints()[joint].name.clone()
    }
}
