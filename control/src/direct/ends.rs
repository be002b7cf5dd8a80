//! Start and end of a motion among the unknowns.

use crate::problem::{BoundaryState, FinalTime, Problem};

/// For each unknown (q, dq/ds, d2q/ds2) of the first and of the last node: `None` if it is free, else its
/// derivative in T: dq/ds = T v.
#[derive(Clone, Debug)]
pub(crate) struct Ends {
    pub start: Vec<Option<f64>>,
    pub end: Vec<Option<f64>>,
    /// Whether T is an unknown.
    pub free_time: bool,
}

impl Ends {
    pub fn new(problem: &Problem) -> Self {
        let n = problem.robot.dof();
        let fixed = |state: &BoundaryState| {
            let q = (0..n).map(|i| (!state.q_free.contains(&i)).then_some(0.0));
            let v = (0..n).map(|i| (!state.v_free.contains(&i)).then_some(state.v[i]));
            q.chain(v).chain((0..n).map(|_| None)).collect()
        };
        Self {
            start: fixed(&problem.start),
            end: fixed(&problem.end),
            free_time: matches!(problem.time, FinalTime::Free { .. }),
        }
    }

    /// Whether position (0) or rate (1) of a joint is given at this end of the motion.
    pub fn gives(end: &[Option<f64>], derivative: usize, joint: usize, n: usize) -> bool {
        derivative < 2 && end[derivative * n + joint].is_some()
    }
}
