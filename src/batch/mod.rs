//! Evaluation at many states at once: node-major arrays, vector lanes over states, threads over chunks.
//!
//! A [`Batch`] runs an [`Evaluator`] at N nodes. Arrays hold the entries of node 0, then those of node 1, and
//! so on, matrices row by row: x is N x 2n, f_x is N x 2n x 2n. They belong to the caller and are contiguous.
//! The evaluators are
//!
//! | evaluator | of | quantities |
//! |---|---|---|
//! | [`Model`] | any [`Dynamics`](crate::dynamics::Dynamics): robots in both coordinates, functions differentiated automatically | f; f_x, f_u; y'f_x; y'f_xx: for collocation |
//! | [`StepMap`] | any [`Step`](crate::step::Step) | Phi; its Jacobians; second derivatives of y'Phi: for multiple shooting |
//! | [`NodeFunction`] | generated and compiled functions, closures | their outputs |
//! | your own | | |
//!
//! Each runs with any [`Packed`] scalar: `f64` evaluates one node at a time, `F64x4` and `F64x8` (feature
//! `wide`) four and eight; dual numbers over them carry derivatives. [`Native`] is the widest that pays off
//! on the target processor. `Batch::parallel` (feature `rayon`) distributes the nodes over threads. Lanes
//! change results by rounding only, the number of threads not at all. `docs/batch.md` has the figures.
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

pub use error::{ArrayRole, BatchError, Failure, NodeError};
pub use evaluator::{Evaluator, Layout, NodeArray};
pub use function::NodeFunction;
pub use model::{FirstOrderArrays, Model, ModelQuantity, SecondOrderArrays};
pub use packed::Packed;
pub use step_map::{StepArrays, StepMap, StepQuantity};

use crate::error::LengthError;
use std::fmt;
#[cfg(feature = "rayon")]
use std::sync::TryLockError;
use std::sync::{Mutex, MutexGuard, PoisonError};
use worker::{Nodes, Worker};

/// The recommended scalar: `F64x8` if the program is compiled for AVX-512, else `F64x4`.
#[cfg(all(feature = "wide", target_feature = "avx512f"))]
pub type Native = crate::scalar::F64x8;
/// The recommended scalar: `F64x8` if the program is compiled for AVX-512, else `F64x4`.
#[cfg(all(feature = "wide", not(target_feature = "avx512f")))]
pub type Native = crate::scalar::F64x4;
/// The recommended scalar: lanes with the feature `wide`, `f64` without.
#[cfg(not(feature = "wide"))]
pub type Native = f64;

/// Pieces of work per thread: enough to balance the load, few enough to keep the overhead small.
#[cfg(feature = "rayon")]
const PIECES: usize = 4;

/// Evaluates a quantity at many nodes; no call allocates as long as no node fails.
///
/// There is one workspace per thread. A node that cannot be evaluated is reported and its outputs are NaN;
/// all other nodes are computed.
pub struct Batch<S: Packed, E: Evaluator<S>> {
    layouts: Vec<(E::Quantity, Layout)>,
    workers: Vec<Mutex<Worker<S, E>>>,
    failures: Vec<Failure<E::Error>>,
}

impl<S: Packed, E: Evaluator<S>> fmt::Debug for Batch<S, E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Batch")
            .field("layouts", &self.layouts)
            .field("threads", &self.workers.len())
            .finish_non_exhaustive()
    }
}

impl<S: Packed, E: Evaluator<S>> Batch<S, E> {
    /// A batch on the calling thread.
    pub fn new(evaluator: E) -> Self {
        Self::with(vec![evaluator])
    }

    /// A batch on the threads of the current rayon pool; `build` makes an evaluator for each thread. Evaluate
    /// it from the same pool.
    ///
    /// A call from outside the pool may allocate in rayon's queue; `ThreadPool::install` avoids that.
    /// Evaluators must be identical, and must not use the pool themselves.
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

    /// One worker per evaluator.
    fn with(evaluators: Vec<E>) -> Self {
        let layouts = evaluators.first().map(E::layouts).unwrap_or_default();
        let worker = |evaluator| Mutex::new(Worker::new(evaluator, &layouts));
        Self { workers: evaluators.into_iter().map(worker).collect(), layouts, failures: Vec::new() }
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.workers.len()
    }

    /// The arrays of a quantity.
    pub fn layout(&self, quantity: E::Quantity) -> Option<&Layout> {
        self.layouts.iter().find(|(listed, _)| *listed == quantity).map(|(_, layout)| layout)
    }

    fn first_layout(&self) -> Option<&Layout> {
        self.layouts.first().map(|(_, layout)| layout)
    }

    /// Evaluates a quantity at `nodes` nodes; returns the failed nodes in order.
    ///
    /// The arrays follow the [`layout`](Self::layout), each `nodes` times its length; empty outputs are
    /// skipped.
    ///
    /// # Errors
    /// [`BatchError`] if the arrays do not fit; nothing is evaluated then.
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
        let numbers =
            [(ArrayRole::Input, layout.inputs.len(), I), (ArrayRole::Output, layout.outputs.len(), O)];
        for (role, expected, found) in numbers {
            if found != expected {
                return Err(BatchError::WrongNumber { role, expected, found });
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
        // Failures may be left over from a call in which an evaluator panicked.
        self.workers.iter().for_each(|worker| free(worker).failures.clear());
        self.share((quantity, layout), all);
        self.failures.clear();
        for worker in &self.workers {
            self.failures.append(&mut free(worker).failures);
        }
        self.failures.sort_unstable_by_key(|failure| failure.node);
        Ok(&self.failures)
    }

    /// Evaluates all nodes on the workers.
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

/// Halves the nodes until at most `most` chunks remain. Chunks are the same as on a single thread.
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

/// A free worker, preferably that of this thread.
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

/// Waits for a worker, also after a panic: every call overwrites its buffers.
fn free<W>(worker: &Mutex<W>) -> MutexGuard<'_, W> {
    worker.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Checks the length of an array.
fn check(array: &NodeArray, nodes: usize, found: usize) -> Result<(), BatchError> {
    let expected = nodes.saturating_mul(array.length);
    LengthError::check(array.name, expected, found)
        .map_err(|length| BatchError::WrongLength { nodes, length })
}
