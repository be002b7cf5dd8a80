//! A solution in words: what is minimised, how it ended, rows of tables.

pub use crate::criterion::criterion;
use crate::numbers::{scientific, short};
use costate_control::{Iteration, PolishOutcome, Solution, StartResult, Status};

/// A status in words.
pub fn status(status: &Status) -> String {
    match status {
        Status::ConvergedSmoothed => "converged, smoothed control".into(),
        status => spaced(status.name()),
    }
}

/// A name without underscores.
pub fn spaced(name: &str) -> String {
    name.replace('_', " ")
}

/// Header of the table of iterations.
pub const ITERATION_HEADER: [&str; 7] =
    ["phase", "nodes", "iteration", "residual", "step", "final time (s)", "cost"];

/// A row of the table of iterations.
pub fn iteration_row(iteration: &Iteration) -> Vec<String> {
    vec![
        iteration.phase.to_string(),
        iteration.nodes.to_string(),
        iteration.number.to_string(),
        scientific(iteration.residual),
        short(iteration.step, 3),
        short(iteration.final_time, 7),
        short(iteration.cost, 9),
    ]
}

/// Header of the table of starts. Of motions that were polished the costs are those before: each start is
/// solved roughly, and the best one is polished. Where that turns out not to apply, only the best one is
/// solved to the tolerance.
pub fn start_header(solution: &Solution) -> [&'static str; 3] {
    let outcome = solution.polish.as_ref().map(|report| report.outcome);
    let cost = match outcome {
        Some(PolishOutcome::Polished) => "cost and penalties, rough, before the polish",
        Some(PolishOutcome::Limited) => "cost and penalties; all but the best may be rough",
        _ => "cost and penalties",
    };
    ["start", "status", cost]
}

/// A row of the table of starts; `index` counts from 0.
pub fn start_row(index: usize, start: &StartResult) -> Vec<String> {
    vec![(index + 1).to_string(), status(&start.status), short(start.total, 12)]
}

/// With a capital letter.
pub fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
