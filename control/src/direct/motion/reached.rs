//! Positions of tools that a motion begins with.

use super::phase_times::with_guesses;
use super::way_time::least_time;
use crate::constants::task::reach::OUTSIDE;
use crate::problem::Problem;
use crate::task::build::TaskRows;
use crate::task::check::phases_at;
use crate::task::functions::PathFunction;
use crate::task::reach::branches::{Branch, ranked};
use crate::task::reach::{reach, reach_near};
use std::borrow::Cow;

/// The problem with positions at the ends of its phases at which tools are where they shall be.
///
/// Each is near the place before it, unless the problem gives a guess of its own: an arm has several
/// positions for a pose, whole turns of its joints aside. Starts after the first one look for other ones.
pub(crate) fn with_tools_reached<'a>(
    problem: &'a Problem,
    rows: &TaskRows,
    number: usize,
) -> Cow<'a, Problem> {
    reached_from(problem, rows, number, None)
}

/// The same with another position at the end with this number; those before it as they are `reached`.
pub(crate) fn with_position_reached<'a>(
    problem: &'a Problem,
    rows: &TaskRows,
    reached: &Problem,
    (end, q): (usize, &[f64]),
) -> Cow<'a, Problem> {
    let mut known: Vec<_> = reached.ends().into_iter().take(end).map(|end| end.q).collect();
    known.push(q.to_vec());
    reached_from(problem, rows, 0, Some(known))
}

fn reached_from<'a>(
    problem: &'a Problem,
    rows: &TaskRows,
    number: usize,
    known: Option<Vec<Vec<f64>>>,
) -> Cow<'a, Problem> {
    let mut found = Cow::Borrowed(problem);
    let limits: Vec<[f64; 2]> = problem.joint_limits().iter().map(|limits| limits.q).collect();
    let last = problem.phases();
    for (end, rows) in rows.at_ends().enumerate() {
        if rows.is_empty() {
            continue;
        }
        // Places before this one are known now.
        let ends = with_guesses(&found);
        let state = &ends[end];
        let is_given = match end {
            0 => true,
            _ if end == last => problem.end.q != problem.start.q,
            _ => problem.vias[end - 1].q.is_some(),
        };
        let (free, mut q) = (&state.q_free, state.q.clone());
        if !is_given {
            free.iter().for_each(|&i| q[i] = ends[end - 1].q[i]);
        }
        let q = match known.as_ref().and_then(|known| known.get(end)) {
            Some(position) => position.clone(),
            None if is_given => reach(&mut rows.clone(), &q, free, &limits, number).q,
            None => reach_near(&mut rows.clone(), &q, free, &limits, number).q,
        };
        let q_free = free.clone();
        let problem = found.to_mut();
        match end {
            0 => problem.start.q = q,
            _ if end == last => problem.end.q = q,
            _ => (problem.vias[end - 1].q, problem.vias[end - 1].q_free) = (Some(q), q_free),
        }
    }
    found
}

/// Positions of the joints for the places of tools, each with the number of its end and the price that
/// `branch` finds: the best ones of all ends first, then the second best ones. Of each end so many are
/// `moved` along what its places leave free.
pub(crate) fn ranked_positions(
    reached: &Problem,
    rows: &TaskRows,
    moved: usize,
    mut branch: impl FnMut(usize, Vec<f64>) -> Branch,
) -> Vec<(usize, Branch)> {
    let limits: Vec<[f64; 2]> = reached.joint_limits().iter().map(|limits| limits.q).collect();
    let ends = with_guesses(reached);
    let mut found = Vec::new();
    for (end, rows) in rows.at_ends().enumerate() {
        let (free, q) = (&ends[end].q_free, &ends[end].q);
        if rows.is_empty() || free.is_empty() {
            continue;
        }
        let near = &ends[before(end)].q;
        let branches = ranked(&mut rows.clone(), (near, q), free, &limits, moved, |q| branch(end, q));
        found.extend(branches.into_iter().map(|branch| (end, branch)).enumerate());
    }
    found.sort_by_key(|(rank, _)| *rank);
    found.into_iter().map(|(_, found)| found).collect()
}

/// The end that positions of this one are reached from: the place before it; that after the start.
fn before(end: usize) -> usize {
    if end == 0 { 1 } else { end - 1 }
}

/// Prices positions by the least times of the joints (s), from the place before or to the place after the
/// start. Those that do not keep what is kept along the motion come last.
pub(crate) fn by_time(reached: &Problem, rows: &TaskRows) -> impl FnMut(usize, Vec<f64>) -> Branch {
    let (ends, last, limits) = (with_guesses(reached), reached.phases(), reached.joint_limits());
    let (mut along, still) = (rows.along.clone(), vec![0.0; limits.len()]);
    let mut g = vec![0.0; along.rows()];
    move |end, q| {
        // What must hold all along the motion holds here too, in the phases that meet here.
        let mut outside = 0.0_f64;
        for phase in phases_at(end, last) {
            along.enter(Some(phase));
            outside = match along.values(&q, &still, &mut g) {
                Err(_) => f64::INFINITY,
                Ok(()) => {
                    let rows = along.bounds().iter().zip(&g);
                    rows.map(|(row, g)| (row.lower - g).max(g - row.upper) / row.range)
                        .fold(outside, f64::max)
                }
            };
        }
        let price = least_time([&ends[before(end)], &ends[end]], &q, &limits);
        Branch { q, price, penalty: OUTSIDE * outside }
    }
}

/// Whether a place of tools has fewer rows than joints whose position is free there.
pub(crate) fn leaves_joints_free(reached: &Problem, rows: &TaskRows) -> bool {
    let ends = with_guesses(reached);
    let mut places = rows.at_ends().zip(&ends);
    places.any(|(rows, end)| !rows.is_empty() && rows.rows() < end.q_free.len())
}
