//! How long a function of arrays takes in Rust, for the benchmark of calls from Python.

use crate::arrays::{Axes, Source, Target};
use crate::dynamics::Dynamics;
use crate::function::{Function, Settings};
use crate::quantities::Verb;
use pyo3::prelude::*;
use std::hint::black_box;
use std::time::Instant;

#[pymethods]
impl Dynamics {
    /// The least time of a method in Rust (s), without objects of Python: at so many states, which all have
    /// the numbers 0.3, with results in memory that is there already or, with `fresh`, that is allocated by
    /// each call. For the benchmark.
    fn _seconds(
        &self,
        py: Python<'_>,
        verb: &str,
        states: usize,
        repeats: usize,
        fresh: bool,
    ) -> PyResult<f64> {
        let function = self.function(py, Verb::of_name(py, verb)?)?;
        Ok(py.detach(|| least(function, self.settings(), states, repeats, fresh)))
    }
}

/// The least time of a call (s) in several rounds of `repeats` calls.
fn least(function: &Function, settings: Settings, states: usize, repeats: usize, fresh: bool) -> f64 {
    const ROUNDS: usize = 20;
    let plan = function.plan();
    let axes = if states == 1 { Axes::new(&[]) } else { Axes::new(&[states]) };
    let inputs: Vec<Vec<f64>> =
        plan.arguments.iter().map(|argument| vec![0.3; states * argument.length]).collect();
    let sources: Vec<Source> = inputs
        .iter()
        .zip(&plan.arguments)
        // SAFETY: the vectors have this many numbers for each state and live until the end.
        .map(|(input, argument)| unsafe { Source::dense(input.as_ptr().cast(), &axes, argument.length) })
        .collect();
    let new = || -> Vec<Vec<f64>> {
        plan.outputs.iter().map(|output| Vec::with_capacity(states * output.length)).collect()
    };
    let mut results = new();
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        for _ in 0..repeats {
            if fresh {
                results = new();
            }
            let targets: Vec<Target> = results
                .iter_mut()
                .zip(&plan.outputs)
                // SAFETY: as above; nobody else has these vectors.
                .map(|(result, output)| unsafe { Target::dense(result.as_mut_ptr(), output.length) })
                .collect();
            black_box(function.compute(&sources, &targets, axes, settings));
        }
        best = best.min(start.elapsed().as_secs_f64() / repeats as f64);
    }
    best
}
