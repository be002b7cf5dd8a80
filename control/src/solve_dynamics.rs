//! Solves problems of any model.

use crate::extremal::dynamics::DynamicsExtremal;
use crate::options::SolverOptions;
use crate::result::motion::Motion;
use crate::search::solve_extremal;
use costate::dynamics::{Cost, Dynamics};

/// Solves the problem of `extremal` from a straight line between its ends. Another first guess can be given to
/// [`solve_extremal`].
pub fn solve_dynamics<D: Dynamics<f64>, C: Cost<f64>>(
    extremal: &mut DynamicsExtremal<D, C>,
    options: &SolverOptions,
) -> Motion {
    let time = extremal.problem().time;
    let nodes = options.nodes.max(2);
    let mut line = vec![vec![0.0; 2 * extremal.problem().start.x.len()]; nodes];
    for (i, z) in line.iter_mut().enumerate() {
        extremal.straight_line(i as f64 / (nodes - 1) as f64, z);
    }
    solve_extremal(extremal, time, options, |s, z| {
        let place = s.clamp(0.0, 1.0) * (nodes - 1) as f64;
        let i = (place as usize).min(nodes - 2);
        for ((z, from), to) in z.iter_mut().zip(&line[i]).zip(&line[i + 1]) {
            *z = from + (place - i as f64) * (to - from);
        }
    })
}
