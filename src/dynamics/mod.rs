//! The interface of a second-order optimiser: values, linearisations and costate-contracted Hessians of
//! models and costs.
//!
//! [`Dynamics`] is the continuous model dx/dt = f(x, u), [`Step`](crate::step::Step) one time step of it,
//! [`Cost`] a running or terminal cost. An optimiser written against these three traits works with every
//! robot in both coordinate systems, and with any function generic over the scalar:
//!
//! | implementation | of | derivatives |
//! |---|---|---|
//! | [`hamiltonian::HamiltonianSecondOrder`](crate::hamiltonian::HamiltonianSecondOrder) | [`Dynamics`], x = (q, p) | analytic |
//! | [`hamiltonian::DualPass`](crate::hamiltonian::DualPass) | the same by any route | analytic, one dual pass |
//! | [`lagrangian::LagrangianSecondOrder`](crate::lagrangian::LagrangianSecondOrder) | [`Dynamics`], x = (q, v) | analytic |
//! | [`QuaternionDynamics`] | [`Dynamics`], x = (q, p) or (q, v) with quaternions as plain numbers | analytic |
//! | [`Automatic`] | [`Dynamics`] of any [`Function`](crate::derivative::Function) of (x, u) | automatic |
//! | [`QuadraticCost`] | [`Cost`] | analytic |
//! | [`AutomaticCost`] | [`Cost`] of any function of (x, u) with one output | automatic |
//! | everything in [`step`](crate::step) | [`Step`](crate::step::Step) over any [`Dynamics`] | from those of the model |

mod automatic;
mod automatic_cost;
mod cost;
pub(crate) mod joined;
mod quadratic_cost;
mod quaternions;
mod robots;

pub use automatic::Automatic;
pub use automatic_cost::AutomaticCost;
pub use cost::{Cost, CostGradient, CostHessian};
pub use quadratic_cost::QuadraticCost;
pub(crate) use quaternions::{Local, Parts, Places, Plain, SecondHalf, Turn, plain_entries};
pub use quaternions::{QuaternionDynamics, TangentModel};

use crate::matrix::{Block, add_scaled, dot};
use crate::scalar::Scalar;

/// A model dx/dt = f(x, u) with its first two derivatives.
///
/// x holds [`states`](Self::states) numbers, u [`controls`](Self::controls); y, a costate, as many as x. An
/// implementation is a workspace: results are borrowed from it, and no call allocates.
pub trait Dynamics<S: Scalar> {
    /// The error of an evaluation.
    type Error: std::error::Error + 'static;

    /// Length of x.
    fn states(&self) -> usize;

    /// Length of u.
    fn controls(&self) -> usize;

    /// The derivatives that are constant or zero at every state.
    fn structure(&self) -> Structure;

    /// f(x, u).
    ///
    /// # Errors
    /// A wrong length, or the model's own error.
    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<&[S], Self::Error>;

    /// f, f_x and f_u.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    fn linearise(&mut self, x: &[S], u: &[S]) -> Result<Linearisation<'_, S>, Self::Error>;

    /// f, f_x, f_u and the second derivatives of y'f.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    fn contract(&mut self, x: &[S], u: &[S], y: &[S]) -> Result<Contraction<'_, S>, Self::Error>;

    /// y'f_x and y'f_u, as long as x and u: the products of a costate equation and of the gradient of a
    /// shooting method.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    fn adjoint(
        &mut self,
        x: &[S],
        u: &[S],
        y: &[S],
        y_f_x: &mut [S],
        y_f_u: &mut [S],
    ) -> Result<(), Self::Error> {
        self.linearise(x, u)?.adjoint(y, [y_f_x, y_f_u]);
        Ok(())
    }

    /// The second derivatives of y'f times (d_x, d_u), in the components of x and of u.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    fn hessian_product(
        &mut self,
        x: &[S],
        u: &[S],
        y: &[S],
        [d_x, d_u]: [&[S]; 2],
        [x_product, u_product]: [&mut [S]; 2],
    ) -> Result<(), Self::Error> {
        self.contract(x, u, y)?.times([d_x, d_u], [x_product, u_product]);
        Ok(())
    }
}

/// A borrowed model is a model.
impl<S: Scalar, D: Dynamics<S>> Dynamics<S> for &mut D {
    type Error = D::Error;

    fn states(&self) -> usize {
        D::states(self)
    }

    fn controls(&self) -> usize {
        D::controls(self)
    }

    fn structure(&self) -> Structure {
        D::structure(self)
    }

    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<&[S], Self::Error> {
        D::evaluate(self, x, u)
    }

    fn linearise(&mut self, x: &[S], u: &[S]) -> Result<Linearisation<'_, S>, Self::Error> {
        D::linearise(self, x, u)
    }

    fn contract(&mut self, x: &[S], u: &[S], y: &[S]) -> Result<Contraction<'_, S>, Self::Error> {
        D::contract(self, x, u, y)
    }

    fn adjoint(
        &mut self,
        x: &[S],
        u: &[S],
        y: &[S],
        y_f_x: &mut [S],
        y_f_u: &mut [S],
    ) -> Result<(), Self::Error> {
        D::adjoint(self, x, u, y, y_f_x, y_f_u)
    }

    fn hessian_product(
        &mut self,
        x: &[S],
        u: &[S],
        y: &[S],
        d: [&[S]; 2],
        product: [&mut [S]; 2],
    ) -> Result<(), Self::Error> {
        D::hessian_product(self, x, u, y, d, product)
    }
}

/// The derivatives of a model that are constant or zero at every state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Structure {
    /// f_u does not depend on x and u: then ux and uu of every [`Contraction`] are `None`.
    pub constant_f_u: bool,
    /// f_u does not depend on u: then uu of every [`Contraction`] is `None`.
    pub affine_in_u: bool,
    /// f_u depends at most on this many leading components of x: the number of columns of
    /// [`Contraction::ux`].
    pub f_u_depends_on: usize,
}

impl Structure {
    /// No structure: any derivative may be nonzero.
    pub fn general(states: usize) -> Self {
        Self { constant_f_u: false, affine_in_u: false, f_u_depends_on: states }
    }
}

/// f and its Jacobians; borrowed from a workspace.
#[derive(Clone, Copy, Debug)]
pub struct Linearisation<'a, S> {
    /// f(x, u), as long as x.
    pub f: &'a [S],
    /// df/dx, states x states.
    pub f_x: Block<'a, S>,
    /// df/du, states x controls.
    pub f_u: Block<'a, S>,
}

impl<S: Scalar> Linearisation<'_, S> {
    /// `[f_x f_u]`, states x (states + controls), row by row, truncated to the length of the slice.
    pub fn jacobian(&self, matrix: &mut [S]) {
        joined::jacobian(self.f_x, self.f_u, matrix);
    }

    /// y'f_x and y'f_u, truncated to the lengths of the slices.
    pub fn adjoint(&self, y: &[S], [y_f_x, y_f_u]: [&mut [S]; 2]) {
        y_f_x.fill(S::zero());
        y_f_u.fill(S::zero());
        for ((&y, f_x), f_u) in y.iter().zip(self.f_x.iter_rows()).zip(self.f_u.iter_rows()) {
            add_scaled(y_f_x, y, f_x);
            add_scaled(y_f_u, y, f_u);
        }
    }
}

/// f, its Jacobians, and the second derivatives of y'f; borrowed from a workspace.
///
/// Blocks in u that are zero by structure are `None`.
#[derive(Clone, Copy, Debug)]
pub struct Contraction<'a, S> {
    /// f, f_x, f_u.
    pub first: Linearisation<'a, S>,
    /// `sum_k y_k d2 f_k / dx dx`, states x states, symmetric.
    pub xx: Block<'a, S>,
    /// `sum_k y_k d2 f_k / du dx`, controls x the first [`Structure::f_u_depends_on`] states; zero in the
    /// others.
    pub ux: Option<Block<'a, S>>,
    /// `sum_k y_k d2 f_k / du du`, controls x controls, symmetric.
    pub uu: Option<Block<'a, S>>,
}

impl<S: Scalar> Contraction<'_, S> {
    /// The second derivatives of y'f in (x, u) as one symmetric matrix, (states + controls)^2 numbers.
    ///
    /// # Panics
    /// For a slice of another length.
    pub fn hessian(&self, matrix: &mut [S]) {
        let size = [self.xx.rows(), self.first.f_u.columns()];
        joined::hessian([Some(self.xx), self.ux, self.uu], size, matrix);
    }

    /// The second derivatives of y'f times (d_x, d_u), in the components of x and of u, truncated to the
    /// lengths of the slices.
    pub fn times(&self, d: [&[S]; 2], product: [&mut [S]; 2]) {
        times(self.xx, [self.ux, self.uu], d, product);
    }
}

/// `[ xx ux' ; ux uu ] (d_x ; d_u)`; ux is zero in the states beyond its columns.
pub(crate) fn times<S: Scalar>(
    xx: Block<'_, S>,
    [ux, uu]: [Option<Block<'_, S>>; 2],
    [d_x, d_u]: [&[S]; 2],
    [x_product, u_product]: [&mut [S]; 2],
) {
    x_product.iter_mut().zip(xx.iter_rows()).for_each(|(entry, row)| *entry = dot(row, d_x));
    u_product.fill(S::zero());
    if let Some(ux) = ux {
        for ((row, &d), entry) in ux.iter_rows().zip(d_u).zip(&mut *u_product) {
            add_scaled(x_product, d, row);
            *entry = dot(row, d_x);
        }
    }
    if let Some(uu) = uu {
        u_product.iter_mut().zip(uu.iter_rows()).for_each(|(entry, row)| *entry += dot(row, d_u));
    }
}
