//! The problem that the tables of a file give.

use crate::problem::error::ProblemError;
use crate::problem::file::joints::indices;
use crate::problem::file::tables::{Energy, StateTable, Tables};
use crate::problem::key::Key;
use crate::problem::{BoundaryState, MotionLimits, Objective, Problem};
use costate::robot::Robot;

impl Tables {
    /// The problem of this robot.
    pub fn problem(&self, robot: Robot) -> Result<Problem, ProblemError> {
        let n = robot.dof();
        let fill = |list: &Option<Vec<f64>>, value: f64| list.clone().unwrap_or_else(|| vec![value; n]);
        let zeros = vec![0.0; n];
        let from = self.start.q.as_deref().unwrap_or(&zeros);
        let fixed = |table: &StateTable| BoundaryState {
            a: table.a.clone(),
            ..BoundaryState::fixed(table.q.as_deref().unwrap_or(from), &fill(&table.v, 0.0))
        };
        let (start, end) = (fixed(&self.start), fixed(&self.end));
        let mut cost = Objective::new(self.cost_time, fill(&self.effort, 0.0));
        (cost.torque_rate, cost.jerk) = (self.torque_rate.clone(), self.jerk.clone());
        cost.energy = self.energy.as_ref().map(|energy| energy.of_joints(n));
        if let Some(smoothing) = self.energy_smoothing {
            cost = cost.with_energy_smoothing(smoothing);
        }
        let mut problem = Problem {
            start,
            end,
            time: self.time,
            cost,
            terms: Vec::new(),
            gain: fill(&self.gain, 1.0),
            bounds: self.bounds.clone(),
            penalty: self.penalty.clone(),
            limits: self.limits.clone().unwrap_or_else(MotionLimits::unsaid),
            task: self.task.clone(),
            vias: Vec::new(),
            periodic: self.periodic.as_ref().map(|shift| match shift.is_empty() {
                true => vec![0.0; n],
                false => shift.clone(),
            }),
            gait: self.gait.clone(),
            loops: None,
            robot,
        };
        problem.start.q_free = self.start.free(&problem, Key::START_Q_FREE)?;
        problem.start.v_free = indices(&problem, Key::START_V_FREE, &self.start.v_free)?;
        problem.end.q_free = self.end.free(&problem, Key::END_Q_FREE)?;
        problem.end.v_free = indices(&problem, Key::END_V_FREE, &self.end.v_free)?;
        if self.periodic.is_some() {
            let all = || (0..n).collect();
            problem.start.q_free = if self.start.q.is_some() { problem.start.q_free } else { all() };
            problem.start.v_free = if self.start.v.is_some() { problem.start.v_free } else { all() };
            problem.end = problem.start.clone();
        }
        for (number, via) in self.vias.iter().enumerate() {
            let via = via.of(&problem, number)?;
            problem.vias.push(via);
        }
        Ok(problem)
    }
}

impl StateTable {
    /// The joints whose positions are free.
    fn free(&self, problem: &Problem, key: Key) -> Result<Vec<usize>, ProblemError> {
        match &self.q_free {
            Some(joints) => indices(problem, key, joints),
            None if self.has_tools => Ok((0..problem.robot.dof()).collect()),
            None => Ok(Vec::new()),
        }
    }
}

impl Energy {
    /// Those of n joints.
    fn of_joints(&self, n: usize) -> Vec<f64> {
        match self {
            Self::Each(weight) => vec![*weight; n],
            Self::Of(weights) => weights.clone(),
        }
    }
}
