//! Where the positions and orientations of tools are among the rows of a task.

use super::resolve_error::ResolveError;
use crate::problem::{Task, ToolOrientation, ToolPose};

/// For each tool at the start, at the end and of the costs: its rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Goals {
    rows: [Vec<Rows>; 3],
}

/// The rows of a tool.
#[derive(Clone, Copy, Debug)]
struct Rows {
    /// Of its coordinates, `None` for free ones.
    position: [Option<usize>; 3],
    /// The first one of its orientation.
    orientation: Option<usize>,
}

impl Goals {
    /// Those of a task: each tool has the rows of the coordinates of its position, then those of its
    /// orientation.
    pub fn of(task: &Task) -> Self {
        let costs = task.tool_costs.iter().map(|cost| &cost.pose);
        Self { rows: [rows(task.start_tools.iter()), rows(task.end_tools.iter()), rows(costs)] }
    }

    /// The rows of a tool of the start (0), the end (1) or the costs (2), for this position.
    pub fn rows(
        &self,
        table: &'static str,
        list: usize,
        tool: usize,
        position: &[f64; 3],
    ) -> Result<[Option<usize>; 3], ResolveError> {
        let found = self.rows[list].get(tool).map(|rows| rows.position);
        let Some(rows) = found.filter(|rows| rows.iter().any(Option::is_some)) else {
            return Err(ResolveError::NoTool { table, entry: tool });
        };
        match (0..3).find(|&k| rows[k].is_some() && !position[k].is_finite()) {
            Some(entry) => Err(ResolveError::NotFinite { what: table, entry }),
            None => Ok(rows),
        }
    }

    /// The first row of the orientation of such a tool.
    pub fn orientation(&self, table: &'static str, list: usize, tool: usize) -> Result<usize, ResolveError> {
        let found = self.rows[list].get(tool).and_then(|rows| rows.orientation);
        found.ok_or(ResolveError::NoOrientation { table, entry: tool })
    }
}

fn rows<'a>(poses: impl Iterator<Item = &'a ToolPose>) -> Vec<Rows> {
    let mut count = 0;
    let mut of = |pose: &ToolPose| {
        let position = pose.position.unwrap_or([f64::INFINITY; 3]);
        let position = position.map(|x| {
            count += usize::from(x.is_finite());
            x.is_finite().then(|| count - 1)
        });
        let orientation = pose.orientation.as_ref().map(|_| count);
        count += match pose.orientation {
            None => 0,
            Some(ToolOrientation::Yaw(_)) => 1,
            Some(ToolOrientation::Axis { .. }) => 2,
            Some(ToolOrientation::Full(_)) => 3,
        };
        Rows { position, orientation }
    };
    poses.map(&mut of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::Problem;
    use crate::task::build::TaskRows;
    use costate::robot::Robot;

    #[test]
    fn rows_are_those_of_the_functions() {
        let free = f64::INFINITY;
        let pose = || ToolPose::of("tool0");
        let task = Task::default()
            .with_end_tool(pose().with_position([0.1, free, 0.3]).with_axis([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
            .with_end_tool(pose().with_axis([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]))
            .with_end_tool(pose().with_position([free, 0.5, 0.6]));
        let task =
            task.with_end_tool(pose().with_yaw(0.4)).with_end_tool(pose().with_position([0.7, free, free]));
        let goals = Goals::of(&task);
        let found = |tool: usize| goals.rows("end.tool", 1, tool, &[0.0; 3]);
        assert_eq!(found(0), Ok([Some(0), None, Some(1)]));
        assert_eq!(found(2), Ok([None, Some(6), Some(7)]));
        assert_eq!((goals.orientation("end.tool", 1, 3), found(4)), (Ok(8), Ok([Some(9), None, None])));
        for tool in [1, 3] {
            assert_eq!(found(tool), Err(ResolveError::NoTool { table: "end.tool", entry: tool }));
        }
        assert_eq!(
            (goals.orientation("end.tool", 1, 0), goals.orientation("end.tool", 1, 1)),
            (Ok(2), Ok(4))
        );
        let none = ResolveError::NoOrientation { table: "end.tool", entry: 2 };
        assert_eq!(goals.orientation("end.tool", 1, 2), Err(none));
        assert!(goals.rows("end.tool", 1, 2, &[free, f64::NAN, 0.0]).is_err());
        let robot = Robot::from_file("../robots/ur5.urdf").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0; 6], &[0.0; 6], 1.0).with_task(task);
        let rows = TaskRows::new(&problem).unwrap();
        let values: Vec<f64> = rows.end.bounds().iter().map(|row| row.lower).collect();
        assert_eq!((values[0], values[1], values[6], values[7], values[9]), (0.1, 0.3, 0.5, 0.6, 0.7));
    }
}
