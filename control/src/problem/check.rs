//! Problems that can be solved at all.

use crate::options::Method;
use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::{Bounds, FinalTime, Penalty, Problem, Reference, ToolCost};
use crate::task::check::check_task;
use costate::robot::{RobotError, Warning};
use std::ops::Deref;

/// A problem whose fields fit together, from [`Problem::check`]. Dereferences to the problem.
#[derive(Clone, Copy, Debug)]
pub struct CheckedProblem<'a> {
    problem: &'a Problem,
}

impl<'a> CheckedProblem<'a> {
    /// The problem.
    pub fn problem(self) -> &'a Problem {
        self.problem
    }

    /// A problem that was made from one that was checked.
    pub(crate) fn made(problem: &'a Problem) -> Self {
        Self { problem }
    }
}

impl Deref for CheckedProblem<'_> {
    type Target = Problem;

    fn deref(&self) -> &Problem {
        self.problem
    }
}

impl Problem {
    /// Checks lengths, ranges, whether there is something to minimise, and whether every joint moves a mass.
    ///
    /// # Errors
    /// The first [`ProblemError`] found.
    pub fn check(&self) -> Result<CheckedProblem<'_>, ProblemError> {
        self.refuse_constraints()?;
        self.refuse_free_joints()?;
        let bounds = self.bounds.as_ref();
        self.check_lists(|j| {
            bounds.is_some_and(|Bounds { u_min, u_max }| u_min[j].is_finite() && u_max[j].is_finite())
        })
    }

    /// Checks what [`check`](Self::check) checks, the [limits](crate::MotionLimits) and the
    /// [task](crate::Task). The [direct method](Method::Direct) keeps them, so limits may bound a control
    /// that costs nothing.
    ///
    /// # Errors
    /// The first [`ProblemError`] found; [`ProblemError::FreeJoint`], [`ProblemError::LimitsNeedDirect`],
    /// [`ProblemError::TaskNeedsDirect`], [`ProblemError::EnergyNeedsDirect`],
    /// [`ProblemError::RatesNeedDirect`] and [`ProblemError::PhasesNeedDirect`] for limits, tasks, costs of
    /// energy, costs of jerks or rates of torques or given accelerations, and vias or periodic motions with
    /// another method.
    pub fn check_for(&self, method: Method) -> Result<CheckedProblem<'_>, ProblemError> {
        if method != Method::Direct {
            let checked = self.check()?;
            if let Some(key) = self.task.first_key() {
                return Err(ProblemError::TaskNeedsDirect { key });
            }
            if self.cost.has_energy() {
                return Err(ProblemError::EnergyNeedsDirect);
            }
            if self.limits.are_asked_for() {
                return Err(ProblemError::LimitsNeedDirect);
            }
            return match (self.first_of_rates(), self.first_of_phases()) {
                (Some(key), _) => Err(ProblemError::RatesNeedDirect { key }),
                (None, Some(key)) => Err(ProblemError::PhasesNeedDirect { key }),
                (None, None) => Ok(checked),
            };
        }
        let checked = self.check_lists(|j| {
            let limits = self.joint_limits();
            let limited = limits[j].torque.iter().all(|torque| torque.is_finite());
            let rates = limits[j].jerk.min(limits[j].torque_rate).is_finite();
            let weight = |list: &Option<Vec<f64>>| list.as_ref().map_or(0.0, |list| list[j]);
            limited
                || self.has_no_motor(j)
                || rates
                || weight(&self.cost.torque_rate).max(weight(&self.cost.jerk)) > 0.0
        })?;
        if !self.robot.free_joints().is_empty() {
            self.check_free_motion()?;
            return Ok(checked);
        }
        self.refuse_with_gait()?;
        self.check_vias()?;
        self.check_limits()?;
        self.check_given_ends()?;
        self.check_accelerations()?;
        self.check_leaving()?;
        check_task(self)?;
        if self.is_closed() {
            self.with_multipliers()?;
        }
        Ok(checked)
    }

    /// All fields; `bounded` tells whether the control of a joint has limits on both sides.
    fn check_lists(&self, bounded: impl Fn(usize) -> bool) -> Result<CheckedProblem<'_>, ProblemError> {
        let Self { start, end, .. } = self;
        self.finite_positions(Key::START_Q, &start.q)?;
        self.finite(Key::START_V, &start.v)?;
        self.finite_positions(Key::END_Q, &end.q)?;
        self.finite(Key::END_V, &end.v)?;
        for (key, a) in [(Key::START_A, &start.a), (Key::END_A, &end.a)] {
            a.as_ref().map_or(Ok(()), |a| self.finite(key, a))?;
        }
        self.exist(Key::START_Q_FREE, &start.q_free)?;
        self.exist(Key::START_V_FREE, &start.v_free)?;
        self.exist(Key::END_Q_FREE, &end.q_free)?;
        self.exist(Key::END_V_FREE, &end.v_free)?;
        self.check_costs()?;
        self.finite(Key::GAIN, &self.gain)?;
        if let Some(joint) = self.gain.iter().position(|&gain| gain == 0.0) {
            return Err(ProblemError::NoGain { joint: self.name(joint) });
        }
        self.check_limit_lists()?;
        self.check_bounds(bounded)?;
        self.check_masses()?;
        let costs = self.cost.effort.iter().any(|&r| r > 0.0) || self.cost.has_energy();
        let penalty = self.penalty.as_ref().is_some_and(|penalty| penalty.weight > 0.0);
        let costs = costs || self.cost.first_of_rates().is_some() || penalty || self.has_cost_of_states();
        if matches!(self.time, FinalTime::Fixed(_)) && !costs {
            return Err(ProblemError::NothingToMinimise);
        }
        if let Some(penalty) = &self.penalty {
            self.check_penalty(penalty)?;
        }
        Ok(CheckedProblem { problem: self })
    }

    /// Whether positions or rates cost anything all along the motion: terms, tools, references.
    fn has_cost_of_states(&self) -> bool {
        let tools = &self.task.tool_costs;
        let costs = |cost: &ToolCost| cost.position_weight.max(cost.orientation_weight) > 0.0;
        let references = self.task.references.iter().any(Reference::costs);
        !self.terms.is_empty() || tools.iter().any(costs) || references
    }

    /// Whether the robot rests at its end from the start on. Terms of the user may reward to wait.
    fn has_no_way(&self) -> bool {
        let Self { start, end, .. } = self;
        let given =
            [&start.q_free, &start.v_free, &end.q_free, &end.v_free].iter().all(|free| free.is_empty());
        let rests = start.v.iter().chain(&end.v).all(|&v| v == 0.0);
        let is_simple = self.terms.is_empty() && self.vias.is_empty() && self.periodic.is_none();
        is_simple && given && rests && start.q == end.q
    }

    /// Final time and weights.
    fn check_costs(&self) -> Result<(), ProblemError> {
        let (key, time) = match self.time {
            FinalTime::Fixed(time) => (Key::FINAL_TIME, time),
            FinalTime::Free { guess } => (Key::TIME_GUESS, guess),
        };
        if !(time > 0.0 && time.is_finite()) {
            return Err(ProblemError::NotPositive { key, value: time });
        }
        not_negative(Key::COST_TIME, self.cost.time)?;
        // A slow step is not a cheap one: the robot would have to stand on one foot.
        let is_free = matches!(self.time, FinalTime::Free { .. }) && self.gait.is_none();
        if is_free && self.cost.time == 0.0 && !self.has_cost_of_states() {
            return Err(ProblemError::FreeTimeWithoutCost);
        }
        if is_free && self.has_no_way() {
            return Err(ProblemError::NoWay);
        }
        self.weights(Key::EFFORT, &self.cost.effort)?;
        for (key, weights) in [(Key::TORQUE_RATE, &self.cost.torque_rate), (Key::JERK, &self.cost.jerk)] {
            weights.as_ref().map_or(Ok(()), |weights| self.weights(key, weights))?;
        }
        self.cost.energy.as_ref().map_or(Ok(()), |energy| self.weights(Key::ENERGY, energy))?;
        let (key, value) = (Key::ENERGY_SMOOTHING, self.cost.energy_smoothing);
        let positive = value > 0.0 && value.is_finite();
        if positive { Ok(()) } else { Err(ProblemError::NotPositive { key, value }) }
    }

    /// One finite number per joint that is not negative.
    fn weights(&self, key: Key, values: &[f64]) -> Result<(), ProblemError> {
        self.finite(key, values)?;
        match values.iter().position(|&weight| weight < 0.0) {
            Some(j) => {
                let (joint, value) = (Some(self.name(j)), values[j]);
                Err(ProblemError::Negative { key, joint, value })
            }
            None => Ok(()),
        }
    }

    /// Every joint moves something.
    fn check_masses(&self) -> Result<(), ProblemError> {
        let nothing = self.robot.warnings().iter().find_map(|warning| match warning {
            Warning::KinematicsOnly { joint } | Warning::MovesNothing { joint } => Some(joint.clone()),
            _ => None,
        });
        nothing.map_or(Ok(()), |joint| Err(ProblemError::NoMass { joint }))
    }

    /// Bounds are numbers with something between them, and finite on both sides where the control costs
    /// nothing.
    fn check_bounds(&self, bounded: impl Fn(usize) -> bool) -> Result<(), ProblemError> {
        if let Some(Bounds { u_min, u_max }) = &self.bounds {
            self.numbers(Key::U_MIN, u_min)?;
            self.numbers(Key::U_MAX, u_max)?;
            if let Some(joint) = (0..u_min.len()).find(|&j| u_min[j] >= u_max[j]) {
                let (u_min, u_max) = (u_min[joint], u_max[joint]);
                return Err(ProblemError::EmptyBounds { joint: self.name(joint), u_min, u_max });
            }
        }
        match (0..self.robot.dof()).find(|&j| self.cost.effort[j] == 0.0 && !bounded(j)) {
            Some(joint) => Err(ProblemError::UnboundedEffort { joint: self.name(joint) }),
            None => Ok(()),
        }
    }

    fn check_penalty(&self, penalty: &Penalty) -> Result<(), ProblemError> {
        let Penalty { weight, q_min, q_max, v_max } = penalty;
        not_negative(Key::PENALTY_WEIGHT, *weight)?;
        for (key, values) in [(Key::Q_MIN, q_min), (Key::Q_MAX, q_max), (Key::V_MAX, v_max)] {
            values.as_ref().map_or(Ok(()), |values| self.numbers(key, values))?;
        }
        if let Some(v_max) = v_max
            && let Some(j) = v_max.iter().position(|&limit| limit < 0.0)
        {
            let (joint, value) = (Some(self.name(j)), v_max[j]);
            return Err(ProblemError::Negative { key: Key::V_MAX, joint, value });
        }
        let entry = |list: &Option<Vec<f64>>, j: usize, none: f64| list.as_ref().map_or(none, |list| list[j]);
        let range = |j: usize| (entry(q_min, j, f64::NEG_INFINITY), entry(q_max, j, f64::INFINITY));
        match (0..self.robot.dof()).map(range).enumerate().find(|(_, (q_min, q_max))| q_min >= q_max) {
            Some((joint, (q_min, q_max))) => {
                Err(ProblemError::EmptyRange { joint: self.name(joint), q_min, q_max })
            }
            None => Ok(()),
        }
    }

    /// One entry per joint.
    fn length(&self, key: Key, values: &[f64]) -> Result<(), ProblemError> {
        let (expected, found) = (self.robot.dof(), values.len());
        if found == expected { Ok(()) } else { Err(ProblemError::WrongLength { key, expected, found }) }
    }

    /// One number per joint, possibly infinite.
    pub(super) fn numbers(&self, key: Key, values: &[f64]) -> Result<(), ProblemError> {
        self.length(key, values)?;
        match values.iter().position(|value| value.is_nan()) {
            Some(joint) => Err(ProblemError::NotANumber { key, joint: self.name(joint) }),
            None => Ok(()),
        }
    }

    /// One finite number per joint.
    pub(super) fn finite(&self, key: Key, values: &[f64]) -> Result<(), ProblemError> {
        self.length(key, values)?;
        match values.iter().position(|value| !value.is_finite()) {
            Some(joint) => Err(ProblemError::NotFinite { key, joint: self.name(joint) }),
            None => Ok(()),
        }
    }

    /// Indices of joints of the robot.
    pub(super) fn exist(&self, key: Key, indices: &[usize]) -> Result<(), ProblemError> {
        match indices.iter().find(|&&joint| joint >= self.robot.dof()) {
            Some(joint) => Err(self.unknown_joint(key, joint.to_string())),
            None => Ok(()),
        }
    }

    /// Of an index, or of a name in quotes.
    pub(crate) fn unknown_joint(&self, key: Key, joint: String) -> ProblemError {
        let all: Vec<String> = self.robot.independent_joints().map(|joint| joint.name.clone()).collect();
        let dof = all.len();
        let mut joints = match self.robot.joint_index(joint.trim_matches('\'')) {
            Err(RobotError::UnknownJoint { nearest, .. }) => nearest,
            _ => Vec::new(),
        };
        joints.retain(|name| all.contains(name));
        if joints.is_empty() {
            joints = all;
        }
        ProblemError::UnknownJoint { key, joint, joints, dof }
    }

    pub(super) fn name(&self, joint: usize) -> String {
        self.robot.joints()[self.robot.independent_indices()[joint]].name.clone()
    }
}

fn not_negative(key: Key, value: f64) -> Result<(), ProblemError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ProblemError::Negative { key, joint: None, value })
}
