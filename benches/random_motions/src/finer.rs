//! The same problem on a mesh with nodes where rates cross the transitions of dry friction and at the knots
//! of references, or else on a mesh that is eight times finer; from the motion that was found.

use crate::cost::{crossings, knots};
use crate::moving::Moving;
use costate_control::{Polish, Solution, Solver, SolverOptions, Trajectory, Verify};
use std::time::Duration;

/// Parts of an interval of a mesh without crossings.
const PARTS: usize = 8;
/// Intervals of the finer mesh at most: with more the parts are fewer.
const MOST: usize = 1200;
/// Places of the rows of an interval of the direct method: its ends and Gauss's points.
const ROWS: [f64; 5] = [0.0, 0.112_701_665_379_258_31, 0.5, 0.887_298_334_620_741_7, 1.0];
/// Nodes closer than this part of the motion are one.
const SAME: f64 = 1e-9;

/// How the finer mesh was made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finer {
    Crossings,
    Parts(usize),
}

/// Solves on the finer mesh; `None` where there is none.
pub fn solve(moving: &mut Moving<'_>, options: &SolverOptions, limit: Duration) -> Option<(Finer, Solution)> {
    let problem = moving.problem;
    let mut options = options.clone();
    options.starts = Some(1);
    options = options.with_verify(Verify::Factors).with_polish(Polish::Never).with_time_limit(limit);
    let (nodes, finer) = nodes(moving)?;
    let is_plain = problem.robot.free_joints().is_empty();
    let trajectory = match is_plain {
        true => on_nodes(moving, &nodes)?,
        false => moving.solution.trajectory.clone(),
    };
    // Where the solver takes no mesh from a saved motion it takes equal intervals: as many as asked for
    // here.
    options.nodes = if is_plain { 4 * (nodes.len() - 1) + 1 } else { nodes.len() };
    // Not much finer than that.
    options.max_nodes = 2 * options.nodes;
    let solver = Solver::new(problem, options).ok()?.with_start(&trajectory).ok()?;
    Some((finer, solver.solve()))
}

/// The nodes of the mesh of a solution (s): those rows of the direct method that are ends of intervals.
fn mesh(moving: &Moving<'_>) -> Vec<f64> {
    let rows = &moving.solution.trajectory.t;
    let count = moving.solution.intervals();
    let mut once = rows.clone();
    once.dedup();
    // Five rows for each interval where accelerations jump, else four and one more; or every row a node.
    match once.len() - 1 {
        all if all == 4 * count => once.into_iter().step_by(4).collect(),
        _ => once,
    }
}

fn nodes(moving: &mut Moving<'_>) -> Option<(Vec<f64>, Finer)> {
    let mut nodes = mesh(moving);
    let (start, end) = (moving.start(), moving.end());
    let length = end - start;
    let mut added: Vec<f64> = crossings(moving)?.iter().map(|crossing| crossing.t).collect();
    added.extend(knots(moving.problem));
    let near = |nodes: &[f64], t: f64| nodes.iter().any(|node| (node - t).abs() < 1e-7 * length);
    added.retain(|&t| t > start && t < end && !near(&nodes, t));
    let finer = if added.is_empty() {
        let parts = (MOST / (nodes.len() - 1).max(1)).clamp(2, PARTS);
        nodes = nodes
            .windows(2)
            .flat_map(|pair| (0..parts).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / parts as f64))
            .chain([end])
            .collect();
        Finer::Parts(parts)
    } else {
        nodes.extend(added);
        nodes.sort_by(f64::total_cmp);
        // The gaps between crossings are divided too, as long as the mesh stays of a reasonable size.
        let parts = (MOST / nodes.len()).clamp(1, 3);
        nodes = nodes
            .windows(2)
            .flat_map(|pair| (0..parts).map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / parts as f64))
            .chain([end])
            .collect();
        Finer::Crossings
    };
    nodes.dedup_by(|later, earlier| (*later - *earlier).abs() < SAME * length);
    if let Some(last) = nodes.last_mut() {
        *last = end;
    }
    Some((nodes, finer))
}

/// The motion with the rows of a mesh that has these nodes.
fn on_nodes(moving: &Moving<'_>, nodes: &[f64]) -> Option<Trajectory> {
    let old = &moving.solution.trajectory;
    let mut new = Trajectory::default();
    new.via_times.clone_from(&old.via_times);
    for pair in nodes.windows(2) {
        for (k, place) in ROWS.iter().enumerate() {
            let t = if k == 4 { pair[1] } else { pair[0] + place * (pair[1] - pair[0]) };
            // Beside a node the motion of this interval counts.
            let inside =
                t.clamp(pair[0] + 1e-12 * (pair[1] - pair[0]), pair[1] - 1e-12 * (pair[1] - pair[0]));
            let point = old.at(if k == 0 || k == 4 { t } else { inside })?;
            new.t.push(t);
            new.q.push(point.q);
            new.v.push(point.v);
            new.p.push(point.p);
            new.u.push(point.u);
            new.y_q.push(point.y_q);
            new.y_p.push(point.y_p);
        }
    }
    Some(new)
}
