//! What is asked of tools as functions with their rows.

use super::given::{Given, finite, frame_of};
use super::orient::oriented;
use super::placed::Carried;
use super::row::Row;
use super::tool::{Quantity, ToolFunction};
use crate::problem::error::ProblemError;
use crate::problem::references::ToolReference;
use crate::problem::task_error::TaskError;
use crate::problem::tools::{Tool, ToolOrientation, ToolPose};
use costate::robot::{FrameSpec, Placement, Robot};
use nalgebra::Vector3;

/// Functions of tools with their rows, before all frames of the robot are known.
pub(super) type Functions = Vec<(ToolFunction, Vec<Row>)>;

/// What a tool keeps: a function of (q, v), or its acceleration.
pub(super) enum KeptRows {
    OfState(ToolFunction, Vec<Row>),
    OfAcceleration { frame: usize, most: f64, row: Row },
}

/// The robot with a frame for each tool.
pub(super) struct Tools {
    pub robot: Robot,
}

impl Tools {
    /// The frame of a tool, added if it has an offset.
    pub fn carried(&mut self, at: Given, tool: &Tool) -> Result<Carried, ProblemError> {
        let key = at.key("frame");
        let mut frame = frame_of(&self.robot, key, &tool.frame)?;
        finite(at.key("offset"), &tool.offset)?;
        if tool.offset != [0.0; 3] {
            let count = self.robot.frames().len();
            // What begins with the prefix of a joint's frame is that frame.
            let mut name = format!("offset {count} of {}", tool.frame);
            while self.robot.frame(&name).is_ok() {
                name.push('\'');
            }
            let placement = Placement::from_xyz_rpy(tool.offset, [0.0; 3]);
            let spec = FrameSpec::new(name).on(tool.frame.clone()).placed(placement);
            let far = tool.offset.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
            let too_far = TaskError::OutOfRange { value: far, remedy: "must be 1e75 m at most" };
            self.robot = self.robot.with_frame(spec).map_err(|_| too_far.at(at.key("offset")))?;
            frame = count;
        }
        let carried = Carried::new(&self.robot, frame);
        if carried.path.is_empty() {
            return Err(TaskError::FixedFrame { frame: tool.frame.clone() }.at(key));
        }
        Ok(carried)
    }

    /// The functions of a pose that shall be reached.
    pub fn pose(&mut self, at: Given, pose: &ToolPose) -> Result<Functions, ProblemError> {
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
        if let Some(orientation) = &pose.orientation {
            let quantity = oriented(at, orientation)?;
            let what = if matches!(orientation, ToolOrientation::Yaw(_)) { "yaw" } else { "orientation" };
            functions.push(zero(tool, quantity, format!("{what} of the tool '{name}'")));
        }
        if functions.is_empty() {
            let remedy = "xyz, rpy, rotation, quaternion, along or yaw";
            return Err(TaskError::NothingAsked { frame: name.clone(), remedy }.at(at.key("frame")));
        }
        Ok(functions)
    }

    /// The functions of a tool that follows a reference: its coordinates that are given, its orientation.
    pub fn followed(&mut self, at: Given, reference: &ToolReference) -> Result<Functions, ProblemError> {
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
