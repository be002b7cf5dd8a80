//! How a solution ended.

use crate::iterate::KktError;
use std::error::Error;

/// How a solution ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Status {
    /// The conditions of optimality hold up to the tolerance.
    Solved,
    /// They hold up to rounding, which is above the tolerance.
    SolvedToRounding,
    /// The sum of all violations has a local minimum here that is not zero. Nothing is said about other
    /// points.
    LocallyInfeasible,
    /// No acceptable step was found.
    Stalled,
    /// The limit of iterations was reached.
    IterationLimit,
    /// The time limit was reached.
    TimeLimit,
    /// The observer asked to stop.
    Stopped,
}

/// What came of a solution; borrowed from the [`Solver`](crate::Solver).
#[derive(Clone, Copy, Debug)]
pub struct Solution<'a> {
    /// How it ended; [`Status::Stopped`] while it has not.
    pub status: Status,
    /// The last point; with [`Status::LocallyInfeasible`] that of the least violation. Where a solution ends
    /// in restoration there are no multipliers: they are zero.
    pub point: &'a [f64],
    /// Its cost.
    pub cost: f64,
    /// Multipliers y of the equations: `grad f + C'y + G'v = 0`.
    pub equalities: &'a [f64],
    /// Multipliers v of the functions with ranges: positive at the upper bound, negative at the lower one.
    pub ranges: &'a [f64],
    /// Equations that depend on others: their multipliers are not unique.
    pub dependent: &'a [usize],
    /// Error of the conditions of optimality, of the scaled program.
    pub error: KktError,
    /// Iterations, those of restoration too.
    pub iterations: usize,
}

/// What the next step promises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Promise {
    /// The Newton decrement of the barrier problem at the mu of the step: twice the decrease that its model
    /// promises.
    pub decrement: f64,
    /// Whether the Hessian of the program itself, without regularisation, has the inertia of a minimum of
    /// that problem.
    pub is_exact: bool,
}

/// One iteration, for an observer.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Iteration {
    /// Its number; those of restoration count too.
    pub number: usize,
    /// Cost, and the sum of all violations, of the scaled program.
    pub cost: f64,
    /// Likewise.
    pub violation: f64,
    /// Error of the conditions of optimality.
    pub error: KktError,
    /// The barrier parameter.
    pub mu: f64,
    /// The multiple of the metric that was added to W.
    pub regularisation: f64,
    /// Whether the step that led here was made with the exact Hessian, to which nothing was added; true where
    /// no step led here.
    pub is_exact: bool,
    /// Length of the step that led here.
    pub length: f64,
    /// The sum of all products of distances to bounds and their multipliers.
    pub gap: f64,
    /// Newton decrement of the barrier problem, `d' (W + G' Sigma G) d` of the step that led here, before
    /// centrality correctors and with W as it was used: about twice what the whole step promised. It may be
    /// negative while equations are violated, and is infinite where no step led here: at the start, and after
    /// restoration.
    pub decrement: f64,
    /// Whether it is one of restoration, whose cost is the violation.
    pub is_restoration: bool,
}

/// Why a solution could not be tried.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError<E: Error> {
    /// The program has another layout than the solver was made for.
    #[error("the program has another layout than the one that the solver was made for: make a new solver")]
    Layout,
    /// An argument has the wrong length.
    #[error("{what} has {found} entries, not {expected}")]
    Length {
        /// The argument.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The right one.
        expected: usize,
    },
    /// The functions are not finite at the start.
    #[error("{what} is not finite at the start")]
    NotFinite {
        /// The first one.
        what: &'static str,
    },
    /// A range is empty.
    #[error("range {row} is empty: no number lies between its bounds {lower} and {upper}")]
    EmptyRange {
        /// The row.
        row: usize,
        /// Its lower bound.
        lower: f64,
        /// Its upper bound.
        upper: f64,
    },
    /// The cost depends on both ends, and the layout does not say so.
    #[error("the cost depends on both ends: make the layout with `with_cost_of_ends`")]
    CostOfEnds,
    /// A typical size is not positive and finite.
    #[error("scale {index} of {what} is {value}: sizes are positive")]
    Scale {
        /// Whose sizes.
        what: &'static str,
        /// Which of them.
        index: usize,
        /// What it is.
        value: f64,
    },
    /// A setting is out of its range.
    #[error("the setting {name} is {value:?}, not between {least:?} and {most:?}")]
    Setting {
        /// Its name.
        name: &'static str,
        /// What it is.
        value: f64,
        /// Its least value.
        least: f64,
        /// Its largest value.
        most: f64,
    },
    /// The program itself.
    #[error(transparent)]
    Problem(#[from] E),
}

impl<E: Error> SolveError<E> {
    /// Whether an argument has as many entries as it should.
    pub(crate) fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), Self> {
        if expected == found { Ok(()) } else { Err(Self::Length { what, found, expected }) }
    }
}
