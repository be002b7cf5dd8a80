//! Whether a task can be done at all.

use super::build::TaskRows;
use super::clearance::Held;
use super::functions::{PathFunction, TaskFunctions};
use super::given::frame_of;
use super::placed::Carried;
use super::reach::{immovable, reach};
use super::row::Row;
use crate::constants::task::reach::REACHED;
use crate::constants::task::{CLOSE, OFF};
use crate::problem::error::ProblemError;
use crate::problem::key::Key;
use crate::problem::limits::JointLimits;
use crate::problem::task_error::TaskError;
use crate::problem::{BoundaryState, Problem, ToolPose};
use costate::robot::{JointKind, Robot};
use nalgebra::Vector3;

/// Checks the task of a problem whose other fields are valid.
///
/// # Errors
/// [`ProblemError::Task`]: what [`TaskRows::new`] refuses; tools that fix more than what is free, or that
/// no position reaches; a given start
/// or end that does not keep what must hold along the motion.
pub(crate) fn check_task(problem: &Problem) -> Result<(), ProblemError> {
    if problem.task.is_empty() && problem.vias.iter().all(|via| via.tools.is_empty()) {
        return Ok(());
    }
    let rows = TaskRows::new(problem)?;
    let states = problem.ends();
    let last = states.len() - 1;
    // Table, key that frees joints, and number of each end of a phase.
    let place = |end: usize| match end {
        0 => ("start.tool", "start.q_free", 0),
        _ if end == last => ("end.tool", "end.q_free", 0),
        via => ("via", "via.q_free", via - 1),
    };
    for (end, (state, functions)) in states.iter().zip(rows.at_ends()).enumerate() {
        let (asked, free) = (functions.rows(), state.q_free.len());
        if asked > free {
            let (table, remedy, number) = place(end);
            let cause = TaskError::TooManyConditions { asked, free, remedy };
            return Err(ProblemError::Task { key: Key::entry(table, "frame", number), cause });
        }
    }
    let mut along = rows.along.clone();
    for (end, poses) in problem.tools_at_ends().enumerate() {
        let (table, _, number) = place(end);
        for (entry, pose) in poses.iter().enumerate() {
            let entry = if table == "via" { number } else { entry };
            within_reach(problem, table, entry, pose)?;
            for phase in phases_at(end, last) {
                along.enter(Some(phase));
                outside_obstacles(problem, &along, table, entry, pose)?;
            }
        }
    }
    let limits: Vec<[f64; 2]> = problem.joint_limits().iter().map(|limits| limits.q).collect();
    for (end, (state, functions)) in states.iter().zip(rows.at_ends()).enumerate() {
        if functions.is_empty() {
            continue;
        }
        let (table, _, number) = place(end);
        let functions = &mut functions.clone();
        let found = reach(functions, &state.q, &state.q_free, &limits, 0);
        let immovable = immovable(functions, &found.q, &state.q_free);
        let name = |row: usize| functions.bounds()[row].name.clone();
        let unit = functions.bounds()[found.worst].unit;
        let cause = match immovable {
            Some(row) => TaskError::Immovable { what: name(row) },
            None if !found.is_there() => {
                TaskError::OutOfReach { what: name(found.worst), by: found.miss, unit }
            }
            None => continue,
        };
        return Err(ProblemError::Task { key: Key::entry(table, "frame", number), cause });
    }
    states.iter().enumerate().try_for_each(|(end, state)| {
        let key = match place(end) {
            ("via", _, number) => Key::via("q", number),
            _ => [Key::START_Q, Key::END_Q][usize::from(end > 0)],
        };
        phases_at(end, last).try_for_each(|phase| {
            along.enter(Some(phase));
            kept_at(&mut along, state, key)
        })
    })
}

/// The phases that end or begin at an end of a phase, of which the motion has as many as `last`.
pub(crate) fn phases_at(end: usize, last: usize) -> std::ops::Range<usize> {
    end.saturating_sub(1)..(end + 1).min(last)
}

/// The given coordinates of a tool are no farther from its first joint than its links are long, with what
/// sliding joints add.
fn within_reach(
    problem: &Problem,
    table: &'static str,
    entry: usize,
    pose: &ToolPose,
) -> Result<(), ProblemError> {
    let (Some(position), robot) = (pose.position, &problem.robot) else { return Ok(()) };
    let frame = frame_of(robot, Key::entry(table, "frame", entry), &pose.tool.frame)?;
    let carried = Carried::new(robot, frame);
    let Some(&first) = carried.path.last() else { return Ok(()) };
    let placement = &robot.frames()[frame].placement;
    let own = (placement.translation + placement.rotation * Vector3::from(pose.tool.offset)).norm();
    let links: f64 = carried.lengths[1..].iter().sum();
    let limits = problem.joint_limits();
    let slides = carried.path.iter().map(|&joint| travel(robot, joint, &limits));
    let reach = own + links + slides.sum::<f64>();
    let from = &robot.joints()[first].placement.translation;
    let given = position.iter().zip(from.iter()).filter(|(x, _)| x.is_finite());
    let distance = given.map(|(x, from)| (x - from).powi(2)).sum::<f64>().sqrt();
    if distance <= reach + REACHED {
        return Ok(());
    }
    let (joint, frame) = (robot.joints()[first].name.clone(), pose.tool.frame.clone());
    let cause = TaskError::BeyondReach { frame, joint, distance, reach };
    Err(ProblemError::Task { key: Key::entry(table, "xyz", entry), cause })
}

/// No body of the link that carries a tool is in an obstacle wherever the tool is at its place.
fn outside_obstacles(
    problem: &Problem,
    along: &TaskFunctions,
    table: &'static str,
    entry: usize,
    pose: &ToolPose,
) -> Result<(), ProblemError> {
    let (Some(position), robot) = (pose.position, &problem.robot) else { return Ok(()) };
    let frame = &robot.frames()[frame_of(robot, Key::entry(table, "frame", entry), &pose.tool.frame)?];
    let Some(joint) = frame.joint else { return Ok(()) };
    let own = frame.placement.translation + frame.placement.rotation * Vector3::from(pose.tool.offset);
    let Some((row, by)) = along.violated_at(robot, &Held { joint, own, place: position.into() }) else {
        return Ok(());
    };
    if by <= OFF {
        return Ok(());
    }
    let cause = TaskError::InObstacle { frame: pose.tool.frame.clone(), what: row.name.clone(), by };
    Err(ProblemError::Task { key: Key::entry(table, "xyz", entry), cause })
}

/// How far a sliding joint goes from where its link is placed, at most; 0 for one that turns.
fn travel(robot: &Robot, joint: usize, limits: &[JointLimits]) -> f64 {
    let spec = &robot.joints()[joint];
    if spec.kind == JointKind::Revolute {
        return 0.0;
    }
    // A joint that mimics another one may go anywhere.
    let own = robot.independent_indices().iter().position(|&index| index == joint);
    own.map_or(f64::INFINITY, |i| limits[i].q.iter().fold(0.0, |most: f64, q| most.max(q.abs())))
}

/// The rows hold at an end that is given.
fn kept_at(along: &mut TaskFunctions, state: &BoundaryState, key: Key) -> Result<(), ProblemError> {
    let is_given = state.q_free.is_empty() && (state.v_free.is_empty() || !along.depends_on_rates());
    if !is_given || along.is_empty() {
        return Ok(());
    }
    match worst(along, &state.q, &state.v) {
        Some((row, by)) if by > if row.is_equation() { OFF } else { CLOSE * row.range } => {
            let cause = TaskError::NotKept { what: row.name.clone(), by, unit: row.unit };
            Err(ProblemError::Task { key, cause })
        }
        _ => Ok(()),
    }
}

/// The row that is farthest outside of its bounds, in parts of its range, and by how much; `None` if none is.
fn worst<'a>(functions: &'a mut TaskFunctions, q: &[f64], v: &[f64]) -> Option<(&'a Row, f64)> {
    let mut g = vec![0.0; functions.rows()];
    functions.values(q, v, &mut g).ok()?;
    let violations = functions.bounds().iter().zip(g).map(|(row, g)| (row, row.excess(g)));
    violations.filter(|&(_, by)| by > 0.0).max_by(|(a, x), (b, y)| (x / a.range).total_cmp(&(y / b.range)))
}
