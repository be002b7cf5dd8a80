//! Orientations of tools that change between two solves.

use super::resolve::Resolve;
use super::resolve_error::ResolveError;
use crate::problem::{TaskError, ToolOrientation};

impl Resolve {
    /// The next solve has this orientation in [`Task::start_tools`](crate::Task::start_tools)`[tool]`, of the
    /// kind that the problem has there: all axes, or one axis along a direction.
    ///
    /// # Errors
    /// [`ResolveError::NoOrientation`]; [`ResolveError::Task`]: an orientation of the other kind, or one that
    /// is not finite.
    pub fn set_start_orientation(&mut self, tool: usize, to: &ToolOrientation) -> Result<(), ResolveError> {
        let row = self.goals.orientation("start.tool", 0, tool)?;
        self.interior.model.tasks.orient_end(0, row, to).map_err(refused("start.tool", tool))
    }

    /// The same of [`Task::end_tools`](crate::Task::end_tools).
    ///
    /// # Errors
    /// As [`set_start_orientation`](Self::set_start_orientation).
    pub fn set_end_orientation(&mut self, tool: usize, to: &ToolOrientation) -> Result<(), ResolveError> {
        let row = self.goals.orientation("end.tool", 1, tool)?;
        self.interior.model.tasks.orient_end(1, row, to).map_err(refused("end.tool", tool))
    }

    /// The same of [`Task::tool_costs`](crate::Task::tool_costs).
    ///
    /// # Errors
    /// As [`set_start_orientation`](Self::set_start_orientation).
    pub fn set_tool_cost_orientation(
        &mut self,
        cost: usize,
        to: &ToolOrientation,
    ) -> Result<(), ResolveError> {
        let row = self.goals.orientation("cost.tool", 2, cost)?;
        self.interior.running.orient_tool(row, to).map_err(refused("cost.tool", cost))
    }
}

fn refused(table: &'static str, entry: usize) -> impl Fn(TaskError) -> ResolveError {
    move |cause| ResolveError::Task { table, entry, cause }
}
