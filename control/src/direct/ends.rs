//! Start and end of a motion among the unknowns.

use super::side::Side;
use crate::problem::{BoundaryState, FinalTime, Problem, ToolPose};

/// For each unknown (q, dq/ds) of the first and of the last node: `None` if it is free, else its
/// derivative in T: dq/ds = T v.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    /// Start and end.
    pub given: [Vec<Option<f64>>; 2],
    /// Whether T is an unknown.
    pub free_time: bool,
    /// Whether an end has given rates and a given place: all positions, or those of tools.
    keeps: [bool; 2],
}

/// Whether rates are given, and a place by joints or by tools.
fn keeps(state: &BoundaryState, tools: &[ToolPose]) -> bool {
    state.v_free.is_empty() && (state.q_free.is_empty() || !tools.is_empty())
}

impl Ends {
    pub fn new(problem: &Problem) -> Self {
        let n = problem.robot.dof();
        let given = |state: &BoundaryState| {
            let q = (0..n).map(|i| (!state.q_free.contains(&i)).then_some(0.0));
            let v = (0..n).map(|i| (!state.v_free.contains(&i)).then_some(state.v[i]));
            q.chain(v).collect()
        };
        Self {
            given: [given(&problem.start), given(&problem.end)],
            free_time: matches!(problem.time, FinalTime::Free { .. }),
            keeps: [
                keeps(&problem.start, &problem.task.start_tools),
                keeps(&problem.end, &problem.task.end_tools),
            ],
        }
    }

    /// Whether what holds along the motion holds at an end (0 or 1) with its rate, whatever the motion is.
    pub fn keeps(&self, end: usize) -> bool {
        self.keeps[end]
    }

    /// Whether the position or rate of a side is given at an end.
    pub fn is_given(&self, end: usize, side: &Side) -> bool {
        let n = self.given[end].len() / 2;
        self.given[end][side.index(n)].is_some()
    }

    /// All given unknowns among those of a mesh: node, place in its state, derivative in T.
    pub fn all(&self, intervals: usize) -> impl Iterator<Item = (usize, usize, f64)> {
        [0, intervals].into_iter().zip(&self.given).flat_map(|(k, given)| {
            given.iter().enumerate().filter_map(move |(i, tangent)| Some((k, i, (*tangent)?)))
        })
    }
}
