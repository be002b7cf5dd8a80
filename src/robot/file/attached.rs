//! Frames, wrenches and constraints of a robot in TOML.

use super::explain;
use super::rows::{FrameRow, RobotFile, RowAxes, WrenchRow};
use crate::robot::error::RobotError;
use crate::robot::frame::FrameSpec;
use crate::robot::link::Placement;
use crate::robot::model::Robot;
use crate::robot::options::LoadOptions;
use crate::robot::wrench::{Wrench, WrenchAxes};

/// Adds the frames of a file to its robot, in their order, then the wrenches and constraints.
///
/// # Errors
/// Those of [`Robot::with_frame`], [`Robot::with_wrench`] and [`Robot::with_constraint`], with the line of
/// the row;
/// [`RobotError::Strict`] for wrenches without effect, if the options refuse warnings.
pub(super) fn attach(
    robot: Robot,
    file: &RobotFile,
    text: &str,
    options: LoadOptions,
) -> Result<Robot, RobotError> {
    let at = |error: RobotError, start: usize| error.at(Some(explain::line(text, start)));
    let specs = file.frames.iter().map(FrameRow::spec);
    let robot = robot.with_frames(specs).map_err(|(k, error)| at(error, file.frames[k].name.span().start))?;
    let wrenches = file.wrenches.iter().map(|row| (row.frame.get_ref().as_str(), row.wrench()));
    let robot =
        robot.with_wrenches(wrenches).map_err(|(k, error)| at(error, file.wrenches[k].frame.span().start))?;
    let start = |k: usize| file.constraints[k].name.span().start;
    let specs = file.constraints.iter().enumerate();
    let specs = specs.map(|(k, table)| table.spec().map_err(|error| at(error, start(k))));
    let specs = specs.collect::<Result<Vec<_>, RobotError>>()?;
    let robot = robot.with_constraints(specs.into_iter()).map_err(|(k, error)| at(error, start(k)))?;
    options.refuse(robot.warnings())?;
    Ok(robot)
}

impl FrameRow {
    fn spec(&self) -> FrameSpec {
        let placement = Placement::from_xyz_rpy(self.placement.xyz, self.placement.rpy);
        let spec = FrameSpec::new(self.name.get_ref()).placed(placement);
        match self.parent.as_deref().filter(|&parent| parent != "world") {
            None => spec,
            Some(parent) => spec.on(parent),
        }
    }
}

impl WrenchRow {
    fn wrench(&self) -> Wrench {
        let axes = match self.axes {
            RowAxes::Local => WrenchAxes::Local,
            RowAxes::Aligned => WrenchAxes::Aligned,
        };
        Wrench { moment: self.moment, force: self.force, axes }
    }
}
