//! One step in time: `x_next = Phi(x, u, h)` with its first two derivatives.
//!
//! | scheme | order | state | implicit equations | symmetric | symplectic (no friction, u constant) |
//! |---|---|---|---|---|---|
//! | [`RungeKutta4`] | 4 | any | none | no | no |
//! | [`SemiImplicitEuler`] | 1 | (q, v) | none | no | where M is constant |
//! | [`StoermerVerlet`] | 2 | two halves, made for (q, p) | two of n numbers | yes | in (q, p) |
//! | [`ImplicitMidpoint`] | 2 | any | one of 2n numbers | yes | in (q, p) |
//! | [`RungeKutta`] of any [`Tableau`] | | any | those of its diagonal | | |
//! | [`AutomaticStep`] of any function of (x, u, h) | | any | | | |
//!
//! The control is constant along a step. Second derivatives come from the adjoint of the stages, those of an implicit
//! scheme from its equations at the solution: see [`RungeKutta`]. [`OneStep`] is a step as a function, for dual numbers
//! to judge; [`StepRoutes`] lets them.

mod automatic;
mod error;
mod hessian;
mod lu;
mod newton;
mod one_step;
mod outcome;
mod routes;
mod runge_kutta;
mod semi_implicit_euler;
mod stage;
mod tableau;

pub use automatic::AutomaticStep;
pub use error::StepError;
pub use one_step::{HamiltonianRobot, LagrangianRobot, ModelFamily, OneStep, Scheme, SemiImplicit};
pub use routes::StepRoutes;
pub use runge_kutta::RungeKutta;
pub use semi_implicit_euler::{SemiImplicitEuler, VelocityForm};
pub use tableau::{
    Classical, ImplicitMidpoint, Midpoint, Pair, RungeKutta4, StoermerVerlet, Tableau, Verlet,
};

use crate::dynamics::times;
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
    fn evaluate(&mut self, x: &[S], u: &[S], h: S) -> Result<&[S], Self::Error>;

    /// Phi, Phi_x, Phi_u and Phi_h.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    fn linearise(&mut self, x: &[S], u: &[S], h: S) -> Result<StepLinearisation<'_, S>, Self::Error>;

    /// Phi, its Jacobians, and the second derivatives of y'Phi in (x, u).
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    fn contract(&mut self, x: &[S], u: &[S], h: S, y: &[S]) -> Result<StepContraction<'_, S>, Self::Error>;
}

/// A step that is lent.
impl<S: Scalar, P: Step<S>> Step<S> for &mut P {
    type Error = P::Error;

    fn states(&self) -> usize {
        P::states(self)
    }

    fn controls(&self) -> usize {
        P::controls(self)
    }

    fn evaluate(&mut self, x: &[S], u: &[S], h: S) -> Result<&[S], Self::Error> {
        P::evaluate(self, x, u, h)
    }

    fn linearise(&mut self, x: &[S], u: &[S], h: S) -> Result<StepLinearisation<'_, S>, Self::Error> {
        P::linearise(self, x, u, h)
    }

    fn contract(&mut self, x: &[S], u: &[S], h: S, y: &[S]) -> Result<StepContraction<'_, S>, Self::Error> {
        P::contract(self, x, u, h, y)
    }
}

/// One step and its Jacobians; borrowed from a workspace.
#[derive(Clone, Copy, Debug)]
pub struct StepLinearisation<'a, S> {
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
///
/// Blocks in u that are zero by structure do not exist: those of a scheme that is as simple as its model.
#[derive(Clone, Copy, Debug)]
pub struct StepContraction<'a, S> {
    /// Phi, Phi_x, Phi_u, Phi_h.
    pub first: StepLinearisation<'a, S>,
    /// `sum_k y_k d2 Phi_k / dx dx`, states x states, symmetric.
    pub xx: Block<'a, S>,
    /// `sum_k y_k d2 Phi_k / du dx`, controls x as many of the first states as it has columns; zero in the others.
    pub ux: Option<Block<'a, S>>,
    /// `sum_k y_k d2 Phi_k / du du`, controls x controls, symmetric.
    pub uu: Option<Block<'a, S>>,
}

impl<S: Scalar> StepContraction<'_, S> {
    /// The second derivatives of y'Phi times (d_x, d_u), in the components of x and of u, as far as the slices reach.
    pub fn times(&self, d: [&[S]; 2], product: [&mut [S]; 2]) {
        times(self.xx, [self.ux, self.uu], d, product);
    }
}
