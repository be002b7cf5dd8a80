//! The generalised forces of wrenches from outside in the state equation.
//!
//! They depend on q alone: `F^p` gains tau(q), F_x its Jacobian in the block (p, q), and y'F_xx the Hessian
//! of `y_p . tau` in (q, q).

use super::state::StateEquation;
use super::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use crate::error::EvalError;
use crate::kernels::Route;
use crate::matrix::{Matrix, add_scaled, dot};
use crate::scalar::Scalar;

impl<S: Scalar> StateEquation<S> {
    /// Adds tau to F.
    pub fn add_wrenches(&mut self, q: &[S]) {
        if let Some(external) = &mut self.external {
            let f_p = &mut self.f[q.len()..];
            f_p.iter_mut().zip(external.force(q)).for_each(|(f, &tau)| *f += tau);
        }
    }

    /// Adds tau_q to F_x.
    pub fn add_wrench_slopes(&mut self, q: &[S]) {
        let n = q.len();
        if let Some(external) = &mut self.external {
            let tau_q = external.slopes(q);
            for i in 0..n {
                add_scaled(&mut self.f_x.row_mut(n + i)[..n], S::one(), tau_q.row(i));
            }
        }
    }

    /// Adds `y_p . tau_q` to the first half of y'F_x.
    pub fn add_wrench_adjoint(&mut self, q: &[S], y_p: &[S], y_f_x: &mut [S]) {
        if let Some(external) = &mut self.external {
            let tau_q = external.slopes(q);
            for (i, &y) in y_p.iter().enumerate() {
                add_scaled(&mut y_f_x[..q.len()], y, tau_q.row(i));
            }
        }
    }

    /// Adds `y_p . tau_qq` to y'F_xx.
    pub fn add_wrench_curvature(&mut self, q: &[S], y_p: &[S], y_f_xx: &mut Matrix<S>) {
        if let Some(external) = &mut self.external {
            let curvature = external.curvature(q, y_p);
            for i in 0..q.len() {
                add_scaled(&mut y_f_xx.row_mut(i)[..q.len()], S::one(), curvature.row(i));
            }
        }
    }

    /// Adds `(y_p . tau_qq) d_q` to y'F_xx d.
    pub fn add_wrench_product(&mut self, q: &[S], y_p: &[S], d_q: &[S], product: &mut [S]) {
        if let Some(external) = &mut self.external {
            let curvature = external.curvature(q, y_p);
            for (i, entry) in product[..q.len()].iter_mut().enumerate() {
                *entry += dot(curvature.row(i), d_q);
            }
        }
    }
}

impl<S: Scalar, R: Route> Hamiltonian<S, R> {
    /// Changes wrench `k` of [`Robot::wrenches`](crate::robot::Robot::wrenches) to this moment (N m) and
    /// force (N), in the axes that it was given in.
    ///
    /// # Errors
    /// [`EvalError::NoWrench`] or [`EvalError::BadWrench`].
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        match &mut self.state.external {
            Some(external) => external.set_wrench(k, moment, force),
            None => Err(EvalError::NoWrench { wrench: k, count: 0 }),
        }
    }
}

impl<S: Scalar> HamiltonianSecondOrder<S> {
    /// As [`Hamiltonian::set_wrench`].
    ///
    /// # Errors
    /// [`EvalError::NoWrench`] or [`EvalError::BadWrench`].
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        self.first().set_wrench(k, moment, force)
    }
}

impl<S: Scalar, R: Route> DualPass<S, R> {
    /// As [`Hamiltonian::set_wrench`].
    ///
    /// # Errors
    /// [`EvalError::NoWrench`] or [`EvalError::BadWrench`].
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        self.first().set_wrench(k, moment, force)
    }
}

impl<S: Scalar> FullHessian<S> {
    /// As [`Hamiltonian::set_wrench`].
    ///
    /// # Errors
    /// [`EvalError::NoWrench`] or [`EvalError::BadWrench`].
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        self.second.set_wrench(k, moment, force)
    }
}
