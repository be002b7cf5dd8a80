//! The generalised forces of wrenches from outside, in inverse and forward dynamics.
//!
//! They act as actuation does: inverse dynamics subtracts tau(q), and its derivatives those of tau.

use super::{Lagrangian, LagrangianSecondOrder, LegendreTransform};
use crate::error::EvalError;
use crate::matrix::{Panel, add_scaled};
use crate::scalar::Scalar;

impl<S: Scalar> Lagrangian<S> {
    /// Changes wrench `k` of [`Robot::wrenches`](crate::robot::Robot::wrenches) to this moment (N m) and
    /// force (N), in the axes that it was given in.
    ///
    /// # Errors
    /// [`EvalError::NoWrench`] or [`EvalError::BadWrench`].
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        match &mut self.external {
            Some(external) => external.set_wrench(k, moment, force),
            None => Err(EvalError::NoWrench { wrench: k, count: 0 }),
        }
    }

    /// Subtracts them from tau of inverse dynamics.
    pub(super) fn subtract_wrenches(&mut self, q: &[S]) {
        if let Some(external) = &mut self.external {
            self.tau.iter_mut().zip(external.force(q)).for_each(|(tau, &from_outside)| *tau -= from_outside);
        }
    }

    /// Subtracts their Jacobian from tau_q of inverse dynamics.
    pub(super) fn subtract_wrench_slopes(&mut self, q: &[S]) {
        if let Some(external) = &mut self.external {
            let slopes = external.slopes(q);
            for i in 0..q.len() {
                add_scaled(self.tau_q.row_mut(i), -S::one(), slopes.row(i));
            }
        }
    }

    /// Subtracts their Hessian, contracted with w, from the block (q, q) of that of inverse dynamics.
    pub(super) fn subtract_wrench_curvature(&mut self, q: &[S], w: &[S], w_tau_qq: &mut Panel<S>) {
        if let Some(external) = &mut self.external {
            let curvature = external.curvature(q, w);
            (0..q.len()).for_each(|i| w_tau_qq.subtract_row(i, curvature.row(i)));
        }
    }
}

impl<S: Scalar> LagrangianSecondOrder<S> {
    /// As [`Lagrangian::set_wrench`].
    ///
    /// # Errors
    /// [`EvalError::NoWrench`] or [`EvalError::BadWrench`].
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        self.first().set_wrench(k, moment, force)
    }
}

impl<S: Scalar> LegendreTransform<S> {
    /// As [`Lagrangian::set_wrench`].
    ///
    /// # Errors
    /// [`EvalError::NoWrench`] or [`EvalError::BadWrench`].
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        self.lagrangian.set_wrench(k, moment, force)
    }
}
