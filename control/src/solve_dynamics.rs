//! Solves problems of any model.

use crate::extremal::dynamics::DynamicsExtremal;
use crate::options::SolverOptions;
use crate::result::motion::ExtremalSolution;
use crate::search::solve_extremal;
use costate::dynamics::{Cost, Dynamics};

/// Solves the problem of `extremal` from a straight line between its ends with costates of zero. Another first guess can be
/// given to [`solve_extremal`].
pub fn solve_dynamics<D: Dynamics<f64>, C: Cost<f64>>(
    extremal: &mut DynamicsExtremal<D, C>,
    options: &SolverOptions,
) -> ExtremalSolution {
    let problem = extremal.problem().clone();
    let (start, end) = (&problem.start.x, &problem.end.x);
    solve_extremal(extremal, problem.time, options, |s, z| {
        z.fill(0.0);
        for (z, (from, to)) in z.iter_mut().zip(start.iter().zip(end)) {
            *z = from + s * (to - from);
        }
    })
}
