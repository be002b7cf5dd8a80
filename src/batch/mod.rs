//! Many states at once: node-major arrays in and out, lanes over states, threads over chunks of them.
//!
//! A [`Batch`] evaluates what an [`Evaluator`] computes at N nodes. Arrays hold the entries of node 0, then those of node 1,
//! and so on, matrices row by row: x is N x 2n, f_x is N x 2n x 2n. They are the caller's, contiguous, and in the form that a
//! solver works on. The same driver runs
//!
//! | evaluator | of | quantities |
//! |---|---|---|
//! | [`Model`] | any [`Dynamics`](crate::dynamics::Dynamics): robots in both coordinates, functions differentiated automatically | f; f_x, f_u; y'f_x; y'f_xx: what collocation asks for |
//! | [`StepMap`] | any [`Step`](crate::step::Step) | Phi; its Jacobians; second derivatives of y'Phi: what multiple shooting asks for |
//! | [`NodeFunction`] | generated and compiled functions, closures | whatever they compute |
//! | yours | | |
//!
//! in any [`Packed`] number: `f64` takes one node at a time, `F64x4` and `F64x8` (feature `wide`) four and eight, dual numbers
//! over any of them carry derivatives along. [`Native`] is the widest that pays on the processor that is compiled for.
//! `Batch::parallel` (feature `rayon`) spreads the nodes over threads. Neither lanes nor threads change a result by more
//! than rounding, the number of threads not at all. `docs/batch.md` has the figures.
//!
//! ```
//! use costate::batch::{Batch, FirstOrderArrays, Model, Native, SecondOrderArrays};
//! use costate::hamiltonian::HamiltonianSecondOrder;
//! use costate::robot::Robot;
//!
//! # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
//! let robot = Robot::from_file("robots/ur5.urdf")?;
//! let mut batch = Batch::<Native, _>::new(Model(HamiltonianSecondOrder::new(&robot)));
//! let nodes = 101;
//! let (x, u, y) = (vec![0.2; nodes * 12], vec![0.0; nodes * 6], vec![1.0; nodes * 12]);
//! // The defects of a collocation need f and f_x at all nodes,
//! let (mut f, mut f_x) = (vec![0.0; nodes * 12], vec![0.0; nodes * 144]);
//! let into = FirstOrderArrays { f: &mut f, f_x: &mut f_x, ..Default::default() };
//! assert!(batch.linearise(&x, &u, into)?.is_empty());
//! // the Hessian of its Lagrange function y'f_xx with the multipliers of the defects.
//! let mut y_f_xx = vec![0.0; nodes * 144];
//! let into = SecondOrderArrays { xx: &mut y_f_xx, ..Default::default() };
//! let failed = batch.contract([&x, &u, &y], FirstOrderArrays::default(), into)?;
//! assert!(failed.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod evaluator;
mod function;
mod model;
mod packed;
mod step_map;
mod worker;

pub use error::{BatchError, Failure, NodeError};
pub use evaluator::{Argument, Evaluator, Layout};
pub use function::NodeFunction;
pub use model::{FirstOrderArrays, Model, ModelQuantity, SecondOrderArrays};
pub use packed::Packed;
pub use step_map::{StepArrays, StepMap, StepQuantity};

#[cfg(feature = "rayon")]
use std::sync::TryLockError;
use std::sync::{Mutex, MutexGuard, PoisonError};
use worker::{Nodes, Worker};

/// The number to take where nothing speaks for another: `F64x8` where the program is compiled for AVX-512, `F64x4` elsewhere.
#[cfg(all(feature = "wide", target_feature = "avx512f"))]
pub type Native = crate::scalar::F64x8;
/// The number to take where nothing speaks for another: `F64x8` where the program is compiled for AVX-512, `F64x4` elsewhere.
#[cfg(all(feature = "wide", not(target_feature = "avx512f")))]
pub type Native = crate::scalar::F64x4;
/// The number to take where nothing speaks for another: lanes with the feature `wide`, `f64` without.
#[cfg(not(feature = "wide"))]
pub type Native = f64;

/// Pieces that each thread gets: enough that all threads end together, few enough that sharing them costs little.
#[cfg(feature = "rayon")]
const PIECES: usize = 4;

/// Evaluates a quantity at many nodes; no call allocates as long as no node fails.
///
/// One workspace a thread, built with the batch. A node that cannot be evaluated is reported, its outputs are
/// not-a-number, and all others are computed.
pub struct Batch<S: Packed, E: Evaluator<S>> {
    layouts: Vec<(E::Quantity, Layout)>,
    workers: Vec<Mutex<Worker<S, E>>>,
    failures: Vec<Failure<E::Error>>,
}

impl<S: Packed, E: Evaluator<S>> Batch<S, E> {
    /// On the thread that calls.
    pub fn new(evaluator: E) -> Self {
        Self::with(vec![evaluator])
    }

    /// On the threads of the rayon pool that is current here; `build` makes an evaluator for each. Call it from that pool too.
    ///
    /// The pool may take memory for its own queue now and then where it is called from outside (`ThreadPool::install`
    /// moves inside). Evaluators must not use the pool themselves, and must all be alike.
    ///
    /// ```
    /// # use costate::{batch::{Batch, Model, Native}, hamiltonian::HamiltonianSecondOrder, robot::Robot};
    /// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    /// let robot = Robot::from_file("robots/ur5.urdf")?;
    /// let mut batch = Batch::<Native, _>::parallel(|| Model(HamiltonianSecondOrder::new(&robot)));
    /// # assert!(batch.evaluate(&[0.1; 36], &[0.0; 18], &mut [0.0; 36])?.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[cfg(feature = "rayon")]
    pub fn parallel(mut build: impl FnMut() -> E) -> Self {
        Self::with((0..rayon::current_num_threads()).map(|_| build()).collect())
    }

    /// One worker an evaluator.
    fn with(evaluators: Vec<E>) -> Self {
        let layouts = evaluators.first().map(E::layouts).unwrap_or_default();
        let worker = |evaluator| Mutex::new(Worker::new(evaluator, &layouts));
        Self { workers: evaluators.into_iter().map(worker).collect(), layouts, failures: Vec::new() }
    }

    /// Number of threads that share the work.
    pub fn threads(&self) -> usize {
        self.workers.len()
    }

    /// The arrays that belong to a quantity.
    pub fn layout(&self, quantity: E::Quantity) -> Option<&Layout> {
        self.layouts.iter().find(|(listed, _)| *listed == quantity).map(|(_, layout)| layout)
    }

    fn first_layout(&self) -> Option<&Layout> {
        self.layouts.first().map(|(_, layout)| layout)
    }

    /// Evaluates a quantity at so many nodes; returns those that failed, in order.
    ///
    /// Arrays as the [`layout`](Self::layout) names them, `nodes` times the length of each; an output that is empty is not
    /// written.
    ///
    /// # Errors
    /// [`BatchError`] where the arrays do not fit; nothing is evaluated then.
    pub fn run<const I: usize, const O: usize>(
        &mut self,
        quantity: E::Quantity,
        nodes: usize,
        inputs: [&[S::Lane]; I],
        outputs: [&mut [S::Lane]; O],
    ) -> Result<&[Failure<E::Error>], BatchError> {
        let layout = self.layout(quantity);
        let layout =
            layout.ok_or_else(|| BatchError::UnknownQuantity { quantity: format!("{quantity:?}") })?;
        for (what, expected, found) in
            [("inputs", layout.inputs.len(), I), ("outputs", layout.outputs.len(), O)]
        {
            if found != expected {
                return Err(BatchError::WrongNumber { what, expected, found });
            }
        }
        let lengths = inputs.iter().map(|input| input.len());
        for (argument, found) in layout.inputs.iter().zip(lengths) {
            check(argument, nodes, found)?;
        }
        let lengths = outputs.iter().map(|output| output.len());
        for (argument, found) in layout.outputs.iter().zip(lengths).filter(|(_, found)| *found != 0) {
            check(argument, nodes, found)?;
        }
        let all = Nodes { first: 0, count: nodes, inputs, outputs };
        // Those of a call that an evaluator left by a panic may be there still.
        self.workers.iter().for_each(|worker| free(worker).failures.clear());
        self.share((quantity, layout), all);
        self.failures.clear();
        for worker in &self.workers {
            self.failures.append(&mut free(worker).failures);
        }
        self.failures.sort_unstable_by_key(|failure| failure.node);
        Ok(&self.failures)
    }

    /// Evaluates all nodes on the workers there are.
    fn share<const I: usize, const O: usize>(
        &self,
        of: (E::Quantity, &Layout),
        nodes: Nodes<'_, S::Lane, I, O>,
    ) {
        #[cfg(feature = "rayon")]
        if self.workers.len() > 1 {
            let pieces = PIECES * self.workers.len();
            let most = nodes.count.div_ceil(S::LANES).div_ceil(pieces).max(2);
            return divide(&self.workers, of, nodes, most);
        }
        if let Some(worker) = self.workers.first() {
            free(worker).evaluate(of, nodes);
        }
    }
}

/// Halves the nodes until there are at most so many chunks; every chunk is the one it is on a single thread.
#[cfg(feature = "rayon")]
fn divide<S: Packed, E: Evaluator<S>, const I: usize, const O: usize>(
    workers: &[Mutex<Worker<S, E>>],
    of: (E::Quantity, &Layout),
    nodes: Nodes<'_, S::Lane, I, O>,
    most: usize,
) {
    let chunks = nodes.count.div_ceil(S::LANES);
    if chunks <= most {
        return any_free(workers).evaluate(of, nodes);
    }
    let (left, right) = nodes.split_at(of.1, chunks / 2 * S::LANES);
    rayon::join(|| divide(workers, of, left, most), || divide(workers, of, right, most));
}

/// A worker that nobody uses, that of this thread first.
#[cfg(feature = "rayon")]
fn any_free<W>(workers: &[Mutex<W>]) -> MutexGuard<'_, W> {
    let own = rayon::current_thread_index().unwrap_or(0) % workers.len();
    for worker in workers[own..].iter().chain(&workers[..own]) {
        match worker.try_lock() {
            Ok(worker) => return worker,
            Err(TryLockError::Poisoned(worker)) => return worker.into_inner(),
            Err(TryLockError::WouldBlock) => {}
        }
    }
    free(&workers[own])
}

/// A worker, once nobody uses it, also after a panic: buffers are written anew by every call.
fn free<W>(worker: &Mutex<W>) -> MutexGuard<'_, W> {
    worker.lock().unwrap_or_else(PoisonError::into_inner)
}

/// `nodes` times the length of the argument.
fn check(argument: &Argument, nodes: usize, found: usize) -> Result<(), BatchError> {
    let &Argument { name: what, length } = argument;
    if nodes.checked_mul(length) == Some(found) {
        return Ok(());
    }
    Err(BatchError::WrongLength { what, nodes, length, found })
}
