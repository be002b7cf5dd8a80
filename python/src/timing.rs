//! How long functions of arrays take in Rust, for the benchmark of calls from Python.

use crate::arrays::read_all;
use crate::dynamics::Dynamics;
use crate::errors::argument;
use crate::quantities::Verb;
use crate::results::{Target, given};
use costate::Coordinates;
use costate::batch::{Batch, FirstOrderArrays, Model, Packed, SecondOrderArrays};
use costate::dynamics::Dynamics as Equations;
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::LagrangianSecondOrder;
use costate::scalar::F64x4;
use costate_jit::JitModel;
use pyo3::prelude::*;
use std::hint::black_box;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

#[pymethods]
impl Dynamics {
    /// The time of a call of a method in Rust (s), without objects of Python: the mean of so many calls at
    /// the states of these arrays, with results in `out` or, without it, in vectors that each call allocates.
    /// For the benchmark.
    #[pyo3(signature = (verb, arguments, out, calls))]
    fn _seconds(
        &self,
        py: Python<'_>,
        verb: &str,
        arguments: Vec<Bound<'_, PyAny>>,
        out: Option<&Bound<'_, PyAny>>,
        calls: usize,
    ) -> PyResult<f64> {
        let verb = Verb::of_name(py, verb)?;
        match arguments.as_slice() {
            [a, b, c] => self.seconds(py, verb, [a, b, c], out, calls),
            [a, b, c, d] => self.seconds(py, verb, [a, b, c, d], out, calls),
            _ => Err(argument(py, "arguments", "three or four arguments are timed".into())),
        }
    }

    /// The same results by `costate::batch` as a user of Rust calls it, a batch on each thread with its share
    /// of the states, which all have the numbers 0.3: by machine code over lanes, or by the generic code
    /// where there is none. For the benchmark.
    fn _batch(&self, py: Python<'_>, verb: &str, states: usize, threads: usize) -> PyResult<BatchTimes> {
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
        let run: Run = py.detach(|| match JitModel::over_lanes(robot, space).ok().and_then(Result::ok) {
            Some(machine) => batches::<F64x4, _>(|| machine.clone(), verb, states, threads),
            None if space == Coordinates::Lagrangian => {
                batches::<F64x4, _>(|| LagrangianSecondOrder::new(robot), verb, states, threads)
            }
            None => batches::<F64x4, _>(|| HamiltonianSecondOrder::new(robot), verb, states, threads),
        });
        Ok(BatchTimes { run: Mutex::new(run) })
    }
}

impl Dynamics {
    fn seconds<const N: usize>(
        &self,
        py: Python<'_>,
        verb: Verb,
        arguments: [&Bound<'_, PyAny>; N],
        out: Option<&Bound<'_, PyAny>>,
        calls: usize,
    ) -> PyResult<f64> {
        let (function, settings) = (self.function(py, verb)?, self.settings());
        let plan = function.plan();
        let (held, sources, axes) = read_all(py, arguments, &plan.arguments)?;
        let arrays = out.map(|out| given(out, &axes, &plan.outputs, (&plan.arguments, &held))).transpose()?;
        let given: Option<Vec<Target>> = arrays.map(|arrays| arrays.iter().map(|array| array.1).collect());
        Ok(py.detach(|| {
            let call = |targets: &[Target]| {
                black_box(function.compute(&sources, targets, axes, settings));
            };
            let fresh = || {
                let lengths = plan.outputs.iter().map(|output| output.length);
                let mut new: Vec<(usize, Vec<f64>)> =
                    lengths.map(|length| (length, Vec::with_capacity(axes.states() * length))).collect();
                // SAFETY: each vector has room for the results of all states, nobody else has it, and it
                // lives until the call has ended.
                let target = |(length, new): &mut (usize, Vec<f64>)| unsafe {
                    Target::dense(new.as_mut_ptr(), *length)
                };
                call(&new.iter_mut().map(target).collect::<Vec<_>>());
                black_box(new);
            };
            let start = Instant::now();
            match &given {
                Some(targets) => (0..calls).for_each(|_| call(targets)),
                None => (0..calls).for_each(|_| fresh()),
            }
            start.elapsed().as_secs_f64() / calls as f64
        }))
    }
}

/// A call of batches: its time (s), with arrays that are there or new ones.
type Run = Box<dyn FnMut(bool) -> f64 + Send>;

/// Batches of `costate::batch` with their arrays.
#[pyclass(module = "costate._costate")]
struct BatchTimes {
    run: Mutex<Run>,
}

#[pymethods]
impl BatchTimes {
    /// The time of a call (s), with arrays for its results that are there or, with `fresh`, that it
    /// allocates.
    fn seconds(&self, py: Python<'_>, fresh: bool) -> f64 {
        py.detach(|| (self.run.lock().unwrap_or_else(PoisonError::into_inner))(fresh))
    }
}

/// Results of a batch at all states; those that are not asked for are empty.
struct Arrays {
    f: Vec<f64>,
    firsts: [Vec<f64>; 2],
    seconds: [Vec<f64>; 3],
    products: [Vec<f64>; 2],
}

impl Arrays {
    fn new(verb: Verb, [states, n, m]: [usize; 3]) -> Self {
        let wanted = |is: bool, length: usize| vec![0.0; if is { states * length } else { 0 }];
        let value = !matches!(verb, Verb::Jacobian | Verb::Hessian | Verb::Adjoint);
        let first = matches!(verb, Verb::Jacobian | Verb::Linearise | Verb::Contract);
        let second = matches!(verb, Verb::Hessian | Verb::Contract);
        Self {
            f: wanted(value, n),
            firsts: [n * n, n * m].map(|length| wanted(first, length)),
            seconds: [n * n, m * n, m * m].map(|length| wanted(second, length)),
            products: [n, m].map(|length| wanted(verb == Verb::Adjoint, length)),
        }
    }
}

/// The part of an array behind those that were taken, `length` numbers of it or what there is.
fn next<'a>(rest: &mut &'a mut [f64], length: usize) -> &'a mut [f64] {
    let length = length.min(rest.len());
    let (here, behind) = std::mem::take(rest).split_at_mut(length);
    *rest = behind;
    here
}

fn batches<S, D>(model: impl Fn() -> D, verb: Verb, states: usize, threads: usize) -> Run
where
    S: Packed<Lane = f64> + 'static,
    D: Equations<S, Error: Send> + Send + 'static,
{
    let models: Vec<D> = (0..threads).map(|_| model()).collect();
    let [n, m] = models.first().map_or([0; 2], |model| [model.states(), model.controls()]);
    let mut batches: Vec<_> = models.into_iter().map(|model| Batch::<S, _>::new(Model(model))).collect();
    let [x, u, y] = [n, m, n].map(|length| vec![0.3; states * length]);
    let mut kept = Arrays::new(verb, [states, n, m]);
    let share = states.div_ceil(threads);
    Box::new(move |fresh| {
        let start = Instant::now();
        let mut new = fresh.then(|| Arrays::new(verb, [states, n, m]));
        let Arrays { f, firsts, seconds, products } = new.as_mut().unwrap_or(&mut kept);
        let mut f = f.as_mut_slice();
        let [mut f_x, mut f_u] = firsts.each_mut().map(Vec::as_mut_slice);
        let [mut xx, mut ux, mut uu] = seconds.each_mut().map(Vec::as_mut_slice);
        let [mut y_f_x, mut y_f_u] = products.each_mut().map(Vec::as_mut_slice);
        std::thread::scope(|scope| {
            for (k, batch) in batches.iter_mut().enumerate() {
                let part = (k * share).min(states)..((k + 1) * share).min(states);
                let all = [(&x, n), (&u, m), (&y, n)];
                let [x, u, y] = all.map(|(all, length)| &all[part.start * length..part.end * length]);
                let count = part.len();
                let first = FirstOrderArrays {
                    f: next(&mut f, count * n),
                    f_x: next(&mut f_x, count * n * n),
                    f_u: next(&mut f_u, count * n * m),
                };
                let second = SecondOrderArrays {
                    xx: next(&mut xx, count * n * n),
                    ux: next(&mut ux, count * m * n),
                    uu: next(&mut uu, count * m * m),
                };
                let product = [next(&mut y_f_x, count * n), next(&mut y_f_u, count * m)];
                scope.spawn(move || {
                    let failures = match verb {
                        Verb::F => batch.evaluate(x, u, first.f),
                        Verb::Adjoint => batch.adjoint([x, u, y], product),
                        Verb::Hessian | Verb::Contract => batch.contract([x, u, y], first, second),
                        _ => batch.linearise(x, u, first),
                    };
                    black_box(failures.map(<[_]>::len)).ok();
                });
            }
        });
        black_box(new);
        start.elapsed().as_secs_f64()
    })
}
