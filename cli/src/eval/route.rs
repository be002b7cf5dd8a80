//! Methods for the derivatives, and the interface of what computes by them.

use super::line::{Answer, Motion, State};
use std::error::Error;

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
pub enum Route {
    /// Derivatives by hand: Jacobian by closed formulas, second ones by the 2n+1 rule or pairs of joints
    Analytic,
    /// Dual numbers for first derivatives, dual numbers in dual numbers for second ones
    Dual,
    /// Hyper-dual numbers
    Hyperdual,
    /// Christoffel coefficients, with one dual pass for second derivatives (Hamiltonian coordinates only)
    Tensors,
    /// Machine code, compiled at the first state; falls back to `analytic` with a note on standard error
    #[cfg(feature = "jit")]
    Jit,
}

/// What computes the answers, for one choice of coordinates and method.
pub trait Evaluator {
    /// The answer to a state of the right lengths, with its motion.
    fn answer(&mut self, state: &State, motion: &Motion) -> Result<Answer, Box<dyn Error>>;
}
