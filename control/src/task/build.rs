//! The functions that a problem asks for.

use super::collision;
use super::functions::{Part, TaskFunctions};
use super::given::{Given, direction, finite, frame_of, positive_or_zero};
use super::placed::Carried;
use super::row::{Measure, Row};
use super::tool::{Quantity, ToolFunction};
use crate::constants::task::MOST_ENTRIES;
use crate::problem::Problem;
use crate::problem::error::ProblemError;
use crate::problem::task_error::TaskError;
use crate::problem::tools::{Keep, Kept, Tool, ToolOrientation, ToolPose};
use costate::robot::{FrameSpec, Placement, Robot};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;

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
}

/// Functions of tools with their rows, before all frames of the robot are known.
type Functions = Vec<(ToolFunction, Vec<Row>)>;

/// The robot with a frame for each tool.
struct Tools {
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
        let mut along = Vec::new();
        for (k, keep) in task.keep.iter().enumerate() {
            along.push(tools.keep(Given { table: "keep", entry: k }, keep)?);
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
        let mut rows = Self { start, vias, end, along, costs, weights };
        collision::push(&robot, task, &mut rows.along)?;
        Ok(rows)
    }
}

impl Tools {
    /// The frame of a tool, added if it has an offset.
    fn carried(&mut self, at: Given, tool: &Tool) -> Result<Carried, ProblemError> {
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
            return Err(TaskError::NothingAsked {
                frame: name.clone(),
                remedy: "xyz, rpy, rotation or along",
            }
            .at(at.key("frame")));
        }
        Ok(functions)
    }

    /// The function of what is kept.
    fn keep(&mut self, at: Given, keep: &Keep) -> Result<(ToolFunction, Vec<Row>), ProblemError> {
        let tool = self.carried(at, &keep.tool)?;
        let name = |what: &str| format!("{what} of the tool '{}'", keep.tool.frame);
        let point = |name: &'static str, x: &[f64; 3]| {
            finite(at.key(name), x)?;
            Ok::<_, ProblemError>(Vector3::from(*x))
        };
        let distance_key = at.key("distance");
        Ok(match &keep.kept {
            Kept::Plane { through, normal, distance } => {
                let (x, n) = (point("through", through)?, direction(at.key("normal"), *normal)?);
                positive_or_zero(distance_key, *distance)?;
                let (height, range) = (n.dot(&x), if *distance > 0.0 { *distance } else { 1.0 });
                let (lower, upper) = (height - distance, height + distance);
                let row = Row {
                    lower,
                    upper,
                    range,
                    name: name("distance from the plane"),
                    unit: "m",
                    measure: Measure::Plain,
                };
                (ToolFunction { tool, quantity: Quantity::Position(vec![n]) }, vec![row])
            }
            Kept::Line { through, along, distance } => {
                let (x, d) = (point("through", through)?, direction(at.key("along"), *along)?);
                positive_or_zero(distance_key, *distance)?;
                let label = name("distance from the line");
                if *distance > 0.0 {
                    let projector = Matrix3::identity() - d * d.transpose();
                    let quantity = Quantity::Distance { from: x, projector, radius: *distance };
                    (
                        ToolFunction { tool, quantity },
                        vec![Row::at_most(Measure::Square(*distance), "m", label)],
                    )
                } else {
                    let across = Quantity::across(d);
                    let rows =
                        across.iter().map(|n| Row::equal(n.dot(&x), 1.0, "m", label.clone())).collect();
                    (ToolFunction { tool, quantity: Quantity::Position(across.to_vec()) }, rows)
                }
            }
            Kept::Box { min, max } => box_rows(at, tool, min, max, &keep.tool.frame)?,
            Kept::Axis { axis, along, angle } => {
                let (axis, along) = (direction(at.key("axis"), *axis)?, direction(at.key("along"), *along)?);
                let label = name("direction");
                match tolerance(at, *angle)? {
                    None => zero(tool, Quantity::direction(axis, along), label),
                    Some(angle) => leaning(tool, Quantity::leaning(axis, along, angle), angle, label),
                }
            }
            Kept::Orientation { rotation, angle } => {
                if !rotation.matrix().iter().all(|entry| entry.is_finite()) {
                    return Err(TaskError::NotARotation.at(at.key("rotation")));
                }
                let label = name("orientation");
                match tolerance(at, *angle)? {
                    None => zero(tool, Quantity::Orientation(*rotation), label),
                    Some(angle) => leaning(tool, Quantity::turned(rotation, angle), angle, label),
                }
            }
            Kept::Speed { max } => {
                let remedy = "must be positive and finite";
                if !(*max > 0.0 && max.is_finite()) {
                    return Err(TaskError::OutOfRange { value: *max, remedy }.at(at.key("speed")));
                }
                let row = Row::at_most(Measure::Square(*max), "m/s", name("speed"));
                (ToolFunction { tool, quantity: Quantity::Speed(*max) }, vec![row])
            }
        })
    }
}

/// All rows are zero.
fn zero(tool: Carried, quantity: Quantity, name: String) -> (ToolFunction, Vec<Row>) {
    let function = ToolFunction { tool, quantity };
    let rows = (0..function.rows()).map(|_| Row::equal(0.0, 1.0, "rad", name.clone())).collect();
    (function, rows)
}

/// At most this angle: `(1 - cos angle) / sin limit <= tan(limit / 2)`.
fn leaning(tool: Carried, quantity: Quantity, limit: f64, name: String) -> (ToolFunction, Vec<Row>) {
    (ToolFunction { tool, quantity }, vec![Row::at_most(Measure::Angle(limit), "rad", name)])
}

/// The largest angle, `None` for zero.
fn tolerance(at: Given, angle: f64) -> Result<Option<f64>, ProblemError> {
    if !(0.0..PI).contains(&angle) {
        let remedy = "must be at least 0 and less than a half turn, 3.14159 rad";
        return Err(TaskError::OutOfRange { value: angle, remedy }.at(at.key("angle")));
    }
    Ok((angle > 0.0).then_some(angle))
}

/// A row for each coordinate with a bound.
fn box_rows(
    at: Given,
    tool: Carried,
    min: &[f64; 3],
    max: &[f64; 3],
    name: &str,
) -> Result<(ToolFunction, Vec<Row>), ProblemError> {
    for (key, corner) in [("min", min), ("max", max)] {
        if let Some(&value) = corner.iter().find(|x| x.is_nan()) {
            return Err(TaskError::OutOfRange { value, remedy: "must be a number" }.at(at.key(key)));
        }
    }
    let (mut directions, mut rows) = (Vec::new(), Vec::new());
    for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
        let (lower, upper) = (min[k], max[k]);
        if !(lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY) {
            let remedy = "must not be less than the entry of min";
            return Err(TaskError::OutOfRange { value: upper, remedy }.at(at.key("max")));
        }
        if lower.is_finite() || upper.is_finite() {
            let room = upper - lower;
            let range = if room > 0.0 && room.is_finite() { room } else { 1.0 };
            directions.push(Vector3::ith(k, 1.0));
            let name = format!("{axis} of the tool '{name}'");
            rows.push(Row { lower, upper, range, name, unit: "m", measure: Measure::Plain });
        }
    }
    if rows.is_empty() {
        return Err(TaskError::NothingAsked { frame: name.into(), remedy: "min or max" }.at(at.key("frame")));
    }
    Ok((ToolFunction { tool, quantity: Quantity::Position(directions) }, rows))
}

#[cfg(test)]
#[path = "build_tests.rs"]
mod tests;
