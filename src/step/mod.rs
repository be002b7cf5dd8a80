//! One step in time: `x_next = Phi(x, u, h)` with its first two derivatives.
//!
//! | scheme | order | state | implicit equations | symmetric | symplectic (no friction, constant u) |
//! |---|---|---|---|---|---|
//! | [`RungeKutta4`] | 4 | any | none | no | no |
//! | [`SemiImplicitEuler`] | 1 | (q, v) | none | no | if M is constant |
//! | [`StoermerVerlet`] | 2 | two halves, meant for (q, p) | two of n numbers | yes | in (q, p) |
//! | [`ImplicitMidpoint`] | 2 | any | one of 2n numbers | yes | in (q, p) |
//! | [`RungeKutta`] of any [`Tableau`] | | any | one per nonzero diagonal entry | | |
//! | [`FreeStep`] of any but semi-implicit Euler | | q with quaternions | | | as above |
//! | [`AutomaticStep`] of any function of (x, u, h) | | any | | | |
//!
//! The control is constant during a step. Second derivatives come from the adjoint equations of the stages,
//! for implicit schemes by the implicit function theorem: see [`RungeKutta`]. [`OneStep`] is a step as a
//! function for automatic differentiation; [`StepRoutes`] compares the derivatives of every scheme with it.

mod automatic;
mod error;
mod free;
mod hessian;
mod lu;
mod newton;
mod one_step;
mod outcome;
mod routes;
mod runge_kutta;
mod schemes;
mod semi_implicit_euler;
mod stage;
mod tableau;

pub use automatic::AutomaticStep;
pub use error::StepError;
pub use free::FreeStep;
pub use one_step::{HamiltonianRobot, LagrangianRobot, ModelFamily, OneStep, Scheme, SemiImplicit};
pub use routes::StepRoutes;
pub use runge_kutta::RungeKutta;
pub use schemes::{ImplicitMidpoint, RungeKutta4, StoermerVerlet};
pub use semi_implicit_euler::{SemiImplicitEuler, VelocityForm};
pub use tableau::{Classical, Midpoint, Pair, Tableau, Verlet};

use crate::dynamics::{joined, times};
use crate::matrix::Block;
use crate::scalar::Scalar;

/// One step `Phi(x, u, h)` of duration h under constant control u, with its first two derivatives.
///
/// x holds [`states`](Self::states) numbers, u [`controls`](Self::controls); y, the costate of the next
/// state, as many as x. An implementation is a workspace, like [`Dynamics`](crate::dynamics::Dynamics):
/// results are borrowed from it, and no call allocates.
pub trait Step<S: Scalar> {
    /// The error of a step.
    type Error: std::error::Error + 'static;

    /// Length of x.
    fn states(&self) -> usize;

    /// Length of u.
    fn controls(&self) -> usize;

    /// Phi(x, u, h).
    ///
    /// # Errors
    /// A wrong length, the model's own error, or an implicit equation that was not solved.
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

/// A step that is borrowed or in a box is a step.
macro_rules! step_behind {
    ($pointer:ty) => {
        impl<S: Scalar, P: Step<S> + ?Sized> Step<S> for $pointer {
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

            fn contract(
                &mut self,
                x: &[S],
                u: &[S],
                h: S,
                y: &[S],
            ) -> Result<StepContraction<'_, S>, Self::Error> {
                P::contract(self, x, u, h, y)
            }
        }
    };
}

step_behind!(&mut P);
step_behind!(Box<P>);

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

impl<S: Scalar> StepLinearisation<'_, S> {
    /// `[Phi_x Phi_u]`, states x (states + controls), row by row, truncated to the length of the slice.
    pub fn jacobian(&self, matrix: &mut [S]) {
        joined::jacobian(self.phi_x, self.phi_u, matrix);
    }
}

/// One step, its Jacobians, and the second derivatives of y'Phi; borrowed from a workspace.
///
/// Blocks in u that are zero by structure are `None`.
#[derive(Clone, Copy, Debug)]
pub struct StepContraction<'a, S> {
    /// Phi, Phi_x, Phi_u, Phi_h.
    pub first: StepLinearisation<'a, S>,
    /// `sum_k y_k d2 Phi_k / dx dx`, states x states, symmetric.
    pub xx: Block<'a, S>,
    /// `sum_k y_k d2 Phi_k / du dx`, controls x leading states; zero in the states beyond its columns.
    pub ux: Option<Block<'a, S>>,
    /// `sum_k y_k d2 Phi_k / du du`, controls x controls, symmetric.
    pub uu: Option<Block<'a, S>>,
}

impl<S: Scalar> StepContraction<'_, S> {
    /// The second derivatives of y'Phi in (x, u) as one symmetric matrix, (states + controls)^2 numbers.
    ///
    /// # Panics
    /// For a slice of another length.
    pub fn hessian(&self, matrix: &mut [S]) {
        let size = [self.xx.rows(), self.first.phi_u.columns()];
        joined::hessian([Some(self.xx), self.ux, self.uu], size, matrix);
    }

    /// The second derivatives of y'Phi times (d_x, d_u), in the components of x and of u, truncated to the
    /// lengths of the slices.
    pub fn times(&self, d: [&[S]; 2], product: [&mut [S]; 2]) {
        times(self.xx, [self.ux, self.uu], d, product);
    }
}
