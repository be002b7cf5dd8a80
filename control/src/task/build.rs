//! The functions that a problem asks for.

use super::accelerations::ToolAccelerations;
use super::check_references::check_reference;
use super::collision;
use super::functions::{Part, TaskFunctions};
use super::given::{Given, direction, finite, frame_of, positive_or_zero};
use super::placed::Carried;
use super::row::Row;
use super::tool::{Quantity, ToolFunction};
use crate::constants::task::MOST_ENTRIES;
use crate::problem::Problem;
use crate::problem::error::ProblemError;
use crate::problem::references::{Reference, ToolReference};
use crate::problem::task_error::TaskError;
use crate::problem::tools::{Tool, ToolOrientation, ToolPose};
use costate::robot::{FrameSpec, Placement, Robot};
use nalgebra::Vector3;

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

/// Functions of tools with their rows, before all frames of the robot are known.
type Functions = Vec<(ToolFunction, Vec<Row>)>;

/// What a tool keeps: a function of (q, v), or its acceleration.
pub(super) enum KeptRows {
    OfState(ToolFunction, Vec<Row>),
    OfAcceleration { frame: usize, most: f64, row: Row },
}

/// The robot with a frame for each tool.
pub(super) struct Tools {
    robot: Robot,
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
        let counts = [
            ("start.tool", task.start_tools.len()),
            ("end.tool", task.end_tools.len()),
            ("keep", task.keep.len()),
            ("cost.tool", task.tool_costs.len()),
            ("cost.reference", task.references.len()),
            ("obstacle", task.obstacles.len()),
            ("collision.capsule", task.collision.as_ref().map_or(0, |collision| collision.capsules.len())),
        ];
        if let Some((table, found)) = counts.into_iter().find(|&(_, count)| count > MOST_ENTRIES) {
            let error = TaskError::TooMany { found, most: MOST_ENTRIES };
            return Err(error.at(Given { table, entry: MOST_ENTRIES }.key("frame")));
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
                found.push(Part::Tool(function), rows);
            }
            found
        };
        let vias = vias.into_iter().map(all).collect();
        let (start, end, along, costs) = (all(start), all(end), all(along), all(costs));
        let references = all(references);
        let accelerations = ToolAccelerations::new(&robot, accelerations);
        let mut rows = Self { start, vias, end, along, costs, weights, accelerations, references };
        collision::push(&robot, task, &mut rows.along)?;
        Ok(rows)
    }
}

impl Tools {
    /// The frame of a tool, added if it has an offset.
    pub(super) fn carried(&mut self, at: Given, tool: &Tool) -> Result<Carried, ProblemError> {
        let key = at.key("frame");
        let mut frame = frame_of(&self.robot, key, &tool.frame)?;
        finite(at.key("offset"), &tool.offset)?;
        if tool.offset != [0.0; 3] {
            let count = self.robot.frames().len();
            let mut name = format!("{} with offset {count}", tool.frame);
            while self.robot.frame(&name).is_ok() {
                name.push('\'');
            }
            let placement = Placement::from_xyz_rpy(tool.offset, [0.0; 3]);
            let spec = FrameSpec::new(name).on(tool.frame.clone()).placed(placement);
            self.robot =
                self.robot.with_frame(spec).map_err(|_| TaskError::NotFinite.at(at.key("offset")))?;
            frame = count;
        }
        let carried = Carried::new(&self.robot, frame);
        if carried.path.is_empty() {
            return Err(TaskError::FixedFrame { frame: tool.frame.clone() }.at(key));
        }
        Ok(carried)
    }

    /// The functions of a pose that shall be reached.
    fn pose(&mut self, at: Given, pose: &ToolPose) -> Result<Functions, ProblemError> {
        let tool = self.carried(at, &pose.tool)?;
        let name = &pose.tool.frame;
        let mut functions = Vec::new();
        if let Some(position) = pose.position {
            let key = at.key("xyz");
            if position.iter().any(|x| x.is_nan() || *x == f64::NEG_INFINITY) {
                return Err(TaskError::NotFinite.at(key));
            }
            let given: Vec<usize> = (0..3).filter(|&k| position[k].is_finite()).collect();
            let row = |&k: &usize| {
                Row::equal(position[k], 1.0, "m", format!("{} of the tool '{name}'", ["x", "y", "z"][k]))
            };
            let rows: Vec<Row> = given.iter().map(row).collect();
            let quantity = Quantity::Position(given.iter().map(|&k| Vector3::ith(k, 1.0)).collect());
            if !rows.is_empty() {
                functions.push((ToolFunction { tool: tool.clone(), quantity }, rows));
            }
        }
        let orientation = pose.orientation.as_ref().map(|orientation| match orientation {
            ToolOrientation::Full(rotation) => Ok(Quantity::Orientation(*rotation)),
            ToolOrientation::Axis { axis, along } => Ok(Quantity::direction(
                direction(at.key("axis"), *axis)?,
                direction(at.key("along"), *along)?,
            )),
        });
        if let Some(quantity) = orientation.transpose()? {
            if matches!(&quantity, Quantity::Orientation(r) if !r.matrix().iter().all(|entry| entry.is_finite()))
            {
                return Err(TaskError::NotARotation.at(at.key("rotation")));
            }
            functions.push(zero(tool, quantity, format!("orientation of the tool '{name}'")));
        }
        if functions.is_empty() {
            return Err(TaskError::NothingAsked { frame: name.clone() }.at(at.key("frame")));
        }
        Ok(functions)
    }

    /// The functions of a tool that follows a reference: its coordinates that are given, its orientation.
    fn followed(&mut self, at: Given, reference: &ToolReference) -> Result<Functions, ProblemError> {
        let first = |rows: &Option<Vec<[f64; 3]>>| rows.as_ref().and_then(|rows| rows.first().copied());
        let rotation = reference.orientations.as_ref().and_then(|rotations| rotations.first().copied());
        self.pose(
            at,
            &ToolPose {
                tool: reference.tool.clone(),
                position: first(&reference.positions),
                orientation: rotation.map(ToolOrientation::Full),
            },
        )
    }
}

/// All rows are zero.
pub(super) fn zero(tool: Carried, quantity: Quantity, name: String) -> (ToolFunction, Vec<Row>) {
    let function = ToolFunction { tool, quantity };
    let rows = (0..function.rows()).map(|_| Row::equal(0.0, 1.0, "rad", name.clone())).collect();
    (function, rows)
}

#[cfg(test)]
#[path = "build_tests.rs"]
mod tests;
