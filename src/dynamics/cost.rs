//! Costs, which an optimiser minimises.

use crate::matrix::Block;
use crate::scalar::Scalar;

/// A cost l(x, u) with its first two derivatives: running with controls, terminal without (`controls() == 0`,
/// u = `&[]`).
///
/// A workspace, like [`Dynamics`](super::Dynamics).
pub trait Cost<S: Scalar> {
    /// The error of an evaluation.
    type Error: std::error::Error + 'static;

    /// Length of x.
    fn states(&self) -> usize;

    /// Length of u; 0 for a terminal cost.
    fn controls(&self) -> usize;

    /// l(x, u).
    ///
    /// # Errors
    /// A wrong length, or the cost's own error.
    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<S, Self::Error>;

    /// l, l_x and l_u.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    fn gradient(&mut self, x: &[S], u: &[S]) -> Result<CostGradient<'_, S>, Self::Error>;

    /// l, its gradient and its Hessian.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    fn hessian(&mut self, x: &[S], u: &[S]) -> Result<CostHessian<'_, S>, Self::Error>;
}

/// A borrowed cost is a cost.
impl<S: Scalar, C: Cost<S>> Cost<S> for &mut C {
    type Error = C::Error;

    fn states(&self) -> usize {
        C::states(self)
    }

    fn controls(&self) -> usize {
        C::controls(self)
    }

    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<S, Self::Error> {
        C::evaluate(self, x, u)
    }

    fn gradient(&mut self, x: &[S], u: &[S]) -> Result<CostGradient<'_, S>, Self::Error> {
        C::gradient(self, x, u)
    }

    fn hessian(&mut self, x: &[S], u: &[S]) -> Result<CostHessian<'_, S>, Self::Error> {
        C::hessian(self, x, u)
    }
}

/// A cost and its gradient; borrowed from a workspace.
#[derive(Clone, Copy, Debug)]
pub struct CostGradient<'a, S> {
    /// l(x, u).
    pub value: S,
    /// dl/dx.
    pub x: &'a [S],
    /// dl/du.
    pub u: &'a [S],
}

/// A cost, its gradient and its Hessian; borrowed from a workspace.
#[derive(Clone, Copy, Debug)]
pub struct CostHessian<'a, S> {
    /// l, l_x and l_u.
    pub gradient: CostGradient<'a, S>,
    /// d2l/dx dx, states x states, symmetric.
    pub xx: Block<'a, S>,
    /// d2l/du dx, controls x states; `None` if it is zero at every state.
    pub ux: Option<Block<'a, S>>,
    /// d2l/du du, controls x controls, symmetric.
    pub uu: Block<'a, S>,
}
