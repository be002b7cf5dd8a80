//! Start and end of a motion among the unknowns.

use crate::problem::{BoundaryState, FinalTime, Problem};

/// For each unknown (q, dq/ds) of the first and of the last node: `None` if it is free, else its
/// derivative in T: dq/ds = T v.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    /// Start and end.
    pub given: [Vec<Option<f64>>; 2],
    /// Whether T is an unknown.
    pub free_time: bool,
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
        }
    }

    /// All given unknowns among those of a mesh: node, place in its state, derivative in T.
    pub fn all(&self, intervals: usize) -> impl Iterator<Item = (usize, usize, f64)> {
        [0, intervals].into_iter().zip(&self.given).flat_map(|(k, given)| {
            given.iter().enumerate().filter_map(move |(i, tangent)| Some((k, i, (*tangent)?)))
        })
    }
}
