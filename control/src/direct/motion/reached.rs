//! Positions of tools that a motion begins with.

use super::phase_times::with_guesses;
use crate::problem::Problem;
use crate::task::build::TaskRows;
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
        let reached = match is_given {
            true => reach(&mut rows.clone(), &q, free, &limits, number),
            false => reach_near(&mut rows.clone(), &q, free, &limits, number),
        };
        let q_free = free.clone();
        let problem = found.to_mut();
        match end {
            0 => problem.start.q = reached.q,
            _ if end == last => problem.end.q = reached.q,
            _ => (problem.vias[end - 1].q, problem.vias[end - 1].q_free) = (Some(reached.q), q_free),
        }
    }
    found
}
