//! Newton steps.

use costate_control::Iteration;

/// A Newton step as Python gets it: phase, nodes, number, residual, step, final time, cost.
pub type Step = (&'static str, usize, usize, f64, f64, f64, f64);

/// The numbers of a Newton step.
pub fn step(iteration: &Iteration) -> Step {
    let Iteration { phase, nodes, number, residual, step, final_time, cost, .. } = iteration;
    (phase.name(), *nodes, *number, *residual, *step, *final_time, *cost)
}
