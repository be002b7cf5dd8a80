//! Frames and wrenches of a robot in TOML.

use super::explain;
use super::rows::{FrameRow, JointRow, RobotFile, RowAxes, TableConvention, WrenchRow};
use crate::robot::error::RobotError;
use crate::robot::frame::FrameSpec;
use crate::robot::link::Placement;
use crate::robot::model::Robot;
use crate::robot::wrench::{Wrench, WrenchAxes};
use std::collections::HashMap;

/// Adds the frames of a file to its robot, in their order, then the wrenches.
///
/// # Errors
/// Those of [`Robot::with_frame`] and [`Robot::with_wrench`], with the line of the row.
pub(super) fn attach(
    robot: Robot,
    file: &RobotFile,
    row_of: &HashMap<&str, &JointRow>,
    text: &str,
) -> Result<Robot, RobotError> {
    let at = |error: RobotError, start: usize| error.at(Some(explain::line(text, start)));
    let specs: Vec<FrameSpec> = file.frames.iter().map(|row| row.spec(file.convention, row_of)).collect();
    let robot = robot.with_frames(specs).map_err(|(k, error)| at(error, file.frames[k].name.span().start))?;
    file.wrenches.iter().try_fold(robot, |robot, row| {
        robot
            .with_wrench(row.frame.get_ref(), row.wrench())
            .map_err(|error| at(error, row.frame.span().start))
    })
}

impl FrameRow {
    /// In a standard table a joint moves the far frame of its link, in which masses are given, too.
    fn spec(&self, convention: TableConvention, row_of: &HashMap<&str, &JointRow>) -> FrameSpec {
        let own = Placement::from_xyz_rpy(self.placement.xyz, self.placement.rpy);
        let spec = FrameSpec::new(self.name.get_ref());
        let Some(parent) = self.parent.as_deref().filter(|&parent| parent != "world") else {
            return spec.placed(own);
        };
        let far = row_of.get(parent).filter(|_| convention == TableConvention::StandardDh);
        let placement = far.map_or(own, |row| row.dh_row().far_frame().then(&own));
        spec.on(parent).placed(placement)
    }
}

impl WrenchRow {
    fn wrench(&self) -> Wrench {
        let axes = match self.axes {
            RowAxes::Frame => WrenchAxes::Frame,
            RowAxes::World => WrenchAxes::World,
        };
        Wrench { moment: self.moment, force: self.force, axes }
    }
}
