//! One step in time: `x_next = Phi(x, u, h)` with its first two derivatives.

mod error;

pub use error::StepError;

use crate::matrix::Block;
use crate::scalar::Scalar;

/// One step `Phi(x, u, h)` of duration h under constant control u, with its first two derivatives.
///
/// x holds [`states`](Self::states) numbers, u [`controls`](Self::controls); y, the costate of what comes next, as many
/// as x. A workspace, as [`Dynamics`](crate::dynamics::Dynamics): results are borrowed from it, no call allocates.
pub trait Step<S: Scalar> {
    /// Why a step may fail.
    type Error: std::error::Error + 'static;

    /// Length of x.
    fn states(&self) -> usize;

    /// Length of u.
    fn controls(&self) -> usize;

    /// Phi(x, u, h).
    ///
    /// # Errors
    /// Whatever the model has to say, or an implicit equation that was not solved.
    fn advance(&mut self, x: &[S], u: &[S], h: S) -> Result<&[S], Self::Error>;

    /// Phi, Phi_x, Phi_u and Phi_h.
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    fn linearise(&mut self, x: &[S], u: &[S], h: S) -> Result<StepFirstOrder<'_, S>, Self::Error>;

    /// Phi, its Jacobians, and the second derivatives of y'Phi in (x, u).
    ///
    /// # Errors
    /// As [`advance`](Self::advance).
    fn contract(&mut self, x: &[S], u: &[S], h: S, y: &[S]) -> Result<StepContraction<'_, S>, Self::Error>;
}

/// One step and its Jacobians; borrowed from a workspace.
#[derive(Clone, Copy, Debug)]
pub struct StepFirstOrder<'a, S> {
    /// Phi(x, u, h), as long as x.
    pub next: &'a [S],
    /// dPhi/dx, states x states.
    pub phi_x: Block<'a, S>,
    /// dPhi/du, states x controls.
    pub phi_u: Block<'a, S>,
    /// dPhi/dh, as long as x.
    pub phi_h: &'a [S],
}

/// One step, its Jacobians, and the second derivatives of y'Phi; borrowed from a workspace.
#[derive(Clone, Copy, Debug)]
pub struct StepContraction<'a, S> {
    /// Phi, Phi_x, Phi_u, Phi_h.
    pub first: StepFirstOrder<'a, S>,
    /// `sum_k y_k d2 Phi_k / dx dx`, states x states, symmetric.
    pub xx: Block<'a, S>,
    /// `sum_k y_k d2 Phi_k / du dx`, controls x states.
    pub ux: Block<'a, S>,
    /// `sum_k y_k d2 Phi_k / du du`, controls x controls, symmetric.
    pub uu: Block<'a, S>,
}
