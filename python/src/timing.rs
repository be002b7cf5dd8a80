//! How long a function of arrays takes in Rust, for the benchmark of calls from Python.

use crate::arrays::{Axes, Source};
use crate::dynamics::Dynamics;
use crate::errors::argument;
use crate::function::{Function, Settings};
use crate::quantities::Verb;
use crate::results::Target;
use costate::Coordinates;
use costate::batch::{Batch, FirstOrderArrays, Model, Packed, SecondOrderArrays};
use costate::dynamics::Dynamics as Equations;
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::LagrangianSecondOrder;
use costate::scalar::F64x4;
use costate_jit::JitModel;
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

    /// The least times (s) of the same results by `costate::batch` on one thread, as a user of Rust calls it,
    /// in arrays that are there: by machine code over lanes, where there is any, and by the generic code over
    /// lanes as it is compiled here. For the benchmark.
    fn _batch_seconds(
        &self,
        py: Python<'_>,
        verb: &str,
        states: usize,
        repeats: usize,
    ) -> PyResult<(Option<f64>, f64)> {
        let verb = match Verb::of_name(py, verb)? {
            verb @ (Verb::F
            | Verb::Jacobian
            | Verb::Linearise
            | Verb::Hessian
            | Verb::Contract
            | Verb::Adjoint) => verb,
            _ => return Err(argument(py, "verb", format!("'{verb}' is not timed by a batch"))),
        };
        let (robot, space) = (self.model(), self.space());
        Ok(py.detach(|| {
            let machine = JitModel::over_lanes(robot, space).ok().and_then(Result::ok);
            let machine = machine.map(|model| batch::<F64x4, _>(model, verb, states, repeats));
            let generic = match space {
                Coordinates::Lagrangian => {
                    batch::<F64x4, _>(LagrangianSecondOrder::new(robot), verb, states, repeats)
                }
                Coordinates::Hamiltonian => {
                    batch::<F64x4, _>(HamiltonianSecondOrder::new(robot), verb, states, repeats)
                }
            };
            (machine, generic)
        }))
    }
}

/// The least time of a call of a batch (s) in several rounds.
fn batch<S, D>(model: D, verb: Verb, states: usize, repeats: usize) -> f64
where
    S: Packed<Lane = f64>,
    D: Equations<S, Error: Send> + Send,
{
    let (n, m) = (model.states(), model.controls());
    let mut batch = Batch::<S, _>::new(Model(model));
    let [x, u, y] = [n, m, n].map(|length| vec![0.3; states * length]);
    let wanted = |is: bool, length: usize| vec![0.0; if is { states * length } else { 0 }];
    let (first, second) = match verb {
        Verb::F => (false, false),
        Verb::Hessian => (false, true),
        Verb::Contract => (true, true),
        _ => (true, false),
    };
    let mut f = wanted(!matches!(verb, Verb::Jacobian | Verb::Hessian | Verb::Adjoint), n);
    let (mut f_x, mut f_u) = (wanted(first, n * n), wanted(first, n * m));
    let (mut xx, mut ux, mut uu) = (wanted(second, n * n), wanted(second, m * n), wanted(second, m * m));
    let (mut y_f_x, mut y_f_u) = (wanted(verb == Verb::Adjoint, n), wanted(verb == Verb::Adjoint, m));
    let mut best = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        for _ in 0..repeats {
            let firsts = FirstOrderArrays { f: &mut f, f_x: &mut f_x, f_u: &mut f_u };
            let seconds = SecondOrderArrays { xx: &mut xx, ux: &mut ux, uu: &mut uu };
            let failures = match verb {
                Verb::F => batch.evaluate(&x, &u, firsts.f),
                Verb::Adjoint => batch.adjoint([&x, &u, &y], [&mut y_f_x, &mut y_f_u]),
                Verb::Hessian | Verb::Contract => batch.contract([&x, &u, &y], firsts, seconds),
                _ => batch.linearise(&x, &u, firsts),
            };
            black_box(failures.map(<[_]>::len)).ok();
        }
        best = best.min(start.elapsed().as_secs_f64() / repeats as f64);
    }
    best
}

/// Rounds of which the least time counts.
const ROUNDS: usize = 20;

/// The least time of a call (s) in several rounds of `repeats` calls.
fn least(function: &Function, settings: Settings, states: usize, repeats: usize, fresh: bool) -> f64 {
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
