//! The functions that a problem asks for.

use super::accelerations::ToolAccelerations;
use super::check_references::check_reference;
use super::collision;
use super::functions::{Part, TaskFunctions};
use super::given::{Given, positive_or_zero};
use super::tool::Quantity;
use super::tool_rows::{Functions, KeptRows, Tools};
use crate::constants::task::MOST_ENTRIES;
use crate::problem::Problem;
use crate::problem::error::ProblemError;
use crate::problem::references::Reference;
use crate::problem::task_error::TaskError;
use crate::problem::tools::ToolPose;

/// The functions of a task with their bounds, by where they must lie between them.
#[derive(Clone, Debug)]
pub(crate) struct TaskRows {
    /// At the start: equations.
    pub start: TaskFunctions,
    /// At each via: equations.
    pub vias: Vec<TaskFunctions>,
    /// At the end: equations.
    pub end: TaskFunctions,
    /// All along the motion, at both ends too.
    pub along: TaskFunctions,
    /// Running costs: `1/2 weight (g - lower)^2` for each row.
    pub costs: TaskFunctions,
    /// The weights of these rows.
    pub weights: Vec<f64>,
    /// Accelerations of tools, all along the motion.
    pub accelerations: ToolAccelerations,
    /// What references of tools are about, for [`References`](super::references::References).
    pub references: TaskFunctions,
}

impl TaskRows {
    /// The functions at the ends of the phases of the motion: its start, its vias, its end.
    pub fn at_ends(&self) -> impl Iterator<Item = &TaskFunctions> {
        [&self.start].into_iter().chain(&self.vias).chain([&self.end])
    }

    /// The functions of a problem.
    ///
    /// # Errors
    /// [`ProblemError::Task`] with the key: names that do not exist, numbers out of range, obstacles without
    /// bodies.
    pub fn new(problem: &Problem) -> Result<Self, ProblemError> {
        let task = &problem.task;
        let capsules = task.collision.as_ref().map_or(0, |collision| collision.capsules.len());
        let counts = [
            ("start.tool", "frame", task.start_tools.len()),
            ("end.tool", "frame", task.end_tools.len()),
            ("keep", "kind", task.keep.len()),
            ("cost.tool", "frame", task.tool_costs.len()),
            ("cost.reference", "times", task.references.len()),
            ("obstacle", "kind", task.obstacles.len()),
            ("collision.capsule", "frame", capsules),
        ];
        if let Some((table, name, found)) = counts.into_iter().find(|&(.., count)| count > MOST_ENTRIES) {
            let error = TaskError::TooMany { found, most: MOST_ENTRIES };
            return Err(error.at(Given { table, entry: MOST_ENTRIES }.key(name)));
        }
        let mut tools = Tools { robot: problem.robot.clone() };
        let mut poses = |table: &'static str, poses: &[ToolPose]| -> Result<Functions, ProblemError> {
            let mut functions = Vec::new();
            for (k, pose) in poses.iter().enumerate() {
                functions.extend(tools.pose(Given { table, entry: k }, pose)?);
            }
            Ok(functions)
        };
        let (start, end) = (poses("start.tool", &task.start_tools)?, poses("end.tool", &task.end_tools)?);
        let mut vias = Vec::new();
        for (number, via) in problem.vias.iter().enumerate() {
            let mut functions = Vec::new();
            for pose in via.tools.iter().take(MOST_ENTRIES) {
                functions.extend(tools.pose(Given { table: "via", entry: number }, pose)?);
            }
            vias.push(functions);
        }
        let (mut along, mut accelerations) = (Vec::new(), Vec::new());
        for (k, keep) in task.keep.iter().enumerate() {
            let at = Given { table: "keep", entry: k };
            match tools.keep(at, keep)? {
                KeptRows::OfState(function, rows) => along.push((function, rows)),
                KeptRows::OfAcceleration { frame, most, row } => accelerations.push((frame, most, row)),
            }
        }
        let (mut costs, mut weights) = (Vec::new(), Vec::new());
        for (k, cost) in task.tool_costs.iter().enumerate() {
            let at = Given { table: "cost.tool", entry: k };
            positive_or_zero(at.key("position_weight"), cost.position_weight)?;
            positive_or_zero(at.key("orientation_weight"), cost.orientation_weight)?;
            for (function, rows) in tools.pose(at, &cost.pose)? {
                let is_position = matches!(function.quantity, Quantity::Position(_));
                let weight = if is_position { cost.position_weight } else { cost.orientation_weight };
                weights.extend(rows.iter().map(|_| weight));
                costs.push((function, rows));
            }
        }
        let mut references = Vec::new();
        for (k, reference) in task.references.iter().enumerate() {
            let at = Given { table: "cost.reference", entry: k };
            let fault = |(name, cause): (&'static str, TaskError)| cause.at(at.key(name));
            check_reference(reference, problem.robot.dof()).map_err(fault)?;
            if let Reference::Tool(reference) = reference {
                references.extend(tools.followed(at, reference)?);
            }
        }
        let robot = tools.robot;
        let all = |functions: Functions| {
            let mut found = TaskFunctions::new(&robot);
            for (function, rows) in functions {
                found.push(&robot, Part::Tool(function), rows);
            }
            found
        };
        let vias = vias.into_iter().map(all).collect();
        let (start, end, along, costs) = (all(start), all(end), all(along), all(costs));
        let references = all(references);
        let accelerations = ToolAccelerations::new(&robot, accelerations);
        let mut rows = Self { start, vias, end, along, costs, weights, accelerations, references };
        collision::push(&robot, problem, &mut rows.along)?;
        Ok(rows)
    }
}

#[cfg(test)]
#[path = "build_tests.rs"]
mod tests;
