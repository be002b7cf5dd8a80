//! The problem that the tables of a file give.

use crate::problem::error::ProblemError;
use crate::problem::file::joints::indices;
use crate::problem::file::per_joint::PerJoint;
use crate::problem::file::tables::{StateTable, Tables};
use crate::problem::key::Key;
use crate::problem::{BoundaryState, FinalTime, MotionLimits, Objective, Problem};
use costate::configuration::ConfigurationSpace;
use costate::robot::Robot;

impl Tables {
    /// The problem of this robot.
    pub fn problem(&self, robot: Robot) -> Result<Problem, ProblemError> {
        let n = robot.dof();
        let fill = |list: &Option<Vec<f64>>, value: f64| list.clone().unwrap_or_else(|| vec![value; n]);
        let of = |list: &Option<PerJoint>| list.as_ref().map(|list| list.of_joints(n));
        let neutral = ConfigurationSpace::new(&robot).neutral();
        let from = self.start.q.as_deref().unwrap_or(&neutral);
        let fixed = |table: &StateTable| BoundaryState {
            a: table.a.clone(),
            ..BoundaryState::fixed(table.q.as_deref().unwrap_or(from), &fill(&table.v, 0.0))
        };
        let (start, end) = (fixed(&self.start), fixed(&self.end));
        let mut cost = Objective::new(self.cost_time, fill(&of(&self.effort), 0.0));
        (cost.torque_rate, cost.jerk) = (of(&self.torque_rate), of(&self.jerk));
        cost.energy = of(&self.energy);
        if let Some(smoothing) = self.energy_smoothing {
            cost = cost.with_energy_smoothing(smoothing);
        }
        let mut problem = Problem {
            start,
            end,
            time: self.time.unwrap_or(FinalTime::Free { guess: 1.0 }),
            cost,
            terms: Vec::new(),
            gain: fill(&of(&self.gain), 1.0),
            bounds: self.bounds.as_ref().map(|bounds| bounds.of(&robot)),
            penalty: self.penalty.as_ref().map(|penalty| penalty.of_joints(n)),
            limits: (self.limits.as_ref()).map_or_else(MotionLimits::unsaid, |limits| limits.of(&robot)),
            task: self.task.clone(),
            vias: Vec::new(),
            periodic: self.periodic.as_ref().map(|shift| match shift.is_empty() {
                true => vec![0.0; n],
                false => shift.clone(),
            }),
            gait: self.gait.as_ref().map(|(gait, _)| gait.clone()),
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
        if self.gait.as_ref().is_some_and(|(_, symmetrise)| *symmetrise) {
            problem = problem.with_symmetric_robot()?;
        }
        if self.start.q.is_none() && self.start.has_tools && self.periodic.is_none() {
            problem = problem.with_guessed_start();
            if self.end.q.is_none() {
                problem.end.q.clone_from(&problem.start.q);
            }
        }
        if self.time.is_none() {
            problem = problem.with_guessed_time();
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
