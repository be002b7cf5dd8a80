//! What an optimal motion is asked for.

pub(crate) mod error;
pub(crate) mod running_cost;

use crate::problem::error::ProblemError;
use crate::problem::running_cost::UserTerm;
use costate::robot::Robot;

/// Find u(t) that takes a robot from its start to its end and makes
///
/// ```text
/// J = c_t T + integral of ( 1/2 sum_i r_i u_i^2 + terms + penalties ) dt ,      dx/dt = F(x) + (0, B u)
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
    /// Further terms l(q, v) of the running cost, each times 1.
    pub terms: Vec<UserTerm>,
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
    /// Positions (rad, m), n; those of free joints only shape the first guess.
    pub q: Vec<f64>,
    /// Rates (rad/s, m/s), n; those of free joints only shape the first guess.
    pub v: Vec<f64>,
    /// Joints whose position at the start is free: `(y_q + P'y_p)_j = 0` there.
    pub q_free: Vec<usize>,
    /// Joints whose rate at the start is free: `(M y_p)_j = 0` there.
    pub v_free: Vec<usize>,
}

impl Start {
    /// At these positions and rates, nothing free.
    pub fn fixed(q: &[f64], v: &[f64]) -> Self {
        Self { q: q.to_vec(), v: v.to_vec(), q_free: Vec::new(), v_free: Vec::new() }
    }
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
    /// r_i, n; zero only for a joint whose control is bounded on both sides.
    pub effort: Vec<f64>,
}

/// `u_min <= u <= u_max` (N m, N before the gain), n each; an infinite entry is no bound on that side.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// Smallest u.
    pub u_min: Vec<f64>,
    /// Largest u.
    pub u_max: Vec<f64>,
}

/// Adds weight/2 times the squared violation of each limit given to the running cost; an infinite entry is no limit.
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
            start: Start::fixed(from, &vec![0.0; n]),
            end: End { q: to.to_vec(), v: vec![0.0; n], q_free: Vec::new(), v_free: Vec::new() },
            time: Time::Fixed(time),
            cost: Cost { time: 0.0, effort: vec![1.0; n] },
            terms: Vec::new(),
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
        let Self { start, end, .. } = self;
        let of_start = [("start.q_free", &start.q_free), ("start.v_free", &start.v_free)];
        for (key, joints) in
            of_start.into_iter().chain([("end.q_free", &end.q_free), ("end.v_free", &end.v_free)])
        {
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
        if matches!(self.time, Time::Free { .. }) && self.cost.time == 0.0 && self.terms.is_empty() {
            return Err(ProblemError::FreeTimeWithoutCost);
        }
        self.not_negative("cost.effort", &self.cost.effort)?;
        self.vector("actuation.gain", &self.gain)?;
        if let Some(joint) = self.gain.iter().position(|&gain| gain == 0.0) {
            return Err(ProblemError::NoGain { joint: self.name(joint) });
        }
        self.check_bounds()?;
        let costs = self.cost.effort.iter().any(|&r| r > 0.0) || !self.terms.is_empty();
        if matches!(self.time, Time::Fixed(_)) && !costs {
            return Err(ProblemError::NothingToMinimise);
        }
        self.penalty.as_ref().map_or(Ok(()), |penalty| self.check_penalty(penalty))
    }

    /// Whether an easier problem may have weaker user terms: not where they are the price of time.
    pub(crate) fn terms_may_be_weaker(&self) -> bool {
        !self.terms.is_empty() && (self.cost.time > 0.0 || matches!(self.time, Time::Fixed(_)))
    }

    /// Bounds are numbers with something between them, and both finite where the control costs nothing.
    fn check_bounds(&self) -> Result<(), ProblemError> {
        if let Some(Bounds { u_min, u_max }) = &self.bounds {
            self.limits("bounds.u_min", u_min)?;
            self.limits("bounds.u_max", u_max)?;
            if let Some(joint) = (0..u_min.len()).find(|&j| u_min[j] >= u_max[j]) {
                let (u_min, u_max) = (u_min[joint], u_max[joint]);
                return Err(ProblemError::EmptyBounds { joint: self.name(joint), u_min, u_max });
            }
        }
        let bounded = |j: usize| {
            self.bounds
                .as_ref()
                .is_some_and(|Bounds { u_min, u_max }| u_min[j].is_finite() && u_max[j].is_finite())
        };
        match (0..self.robot.len()).find(|&j| self.cost.effort[j] == 0.0 && !bounded(j)) {
            Some(joint) => Err(ProblemError::UnboundedEffort { joint: self.name(joint) }),
            None => Ok(()),
        }
    }

    fn check_penalty(&self, penalty: &Penalty) -> Result<(), ProblemError> {
        if !(penalty.weight >= 0.0 && penalty.weight.is_finite()) {
            return Err(ProblemError::Negative { key: "penalty.weight", joint: None, value: penalty.weight });
        }
        let Penalty { q_min, q_max, v_max, .. } = penalty;
        for (key, values) in [("penalty.q_min", q_min), ("penalty.q_max", q_max), ("penalty.v_max", v_max)] {
            values.as_ref().map_or(Ok(()), |values| self.limits(key, values))?;
        }
        if let Some(v_max) = v_max
            && let Some(j) = v_max.iter().position(|&limit| limit < 0.0)
        {
            let (key, joint) = ("penalty.v_max", Some(self.name(j)));
            return Err(ProblemError::Negative { key, joint, value: v_max[j] });
        }
        let entry = |list: &Option<Vec<f64>>, j: usize, none: f64| list.as_ref().map_or(none, |list| list[j]);
        let range = |j: usize| (entry(q_min, j, f64::NEG_INFINITY), entry(q_max, j, f64::INFINITY));
        match (0..self.robot.len()).map(range).enumerate().find(|(_, (q_min, q_max))| q_min >= q_max) {
            Some((joint, (q_min, q_max))) => {
                Err(ProblemError::EmptyRange { joint: self.name(joint), q_min, q_max })
            }
            None => Ok(()),
        }
    }

    /// n entries, each a number or infinite.
    fn limits(&self, key: &'static str, values: &[f64]) -> Result<(), ProblemError> {
        let n = self.robot.len();
        if values.len() != n {
            return Err(ProblemError::WrongLength { key, expected: n, found: values.len() });
        }
        match values.iter().position(|value| value.is_nan()) {
            Some(joint) => Err(ProblemError::NotANumber { key, joint: self.name(joint) }),
            None => Ok(()),
        }
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
