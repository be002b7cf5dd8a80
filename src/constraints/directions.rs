//! Responses of (v, mu) to directions.

use super::ConstrainedHamiltonian;
use crate::error::EvalError;
use crate::kernels::friction_of;
use crate::matrix::dot;
use crate::scalar::Scalar;

impl<S: Scalar> ConstrainedHamiltonian<S> {
    /// v, mu and their Jacobians, the first rows of F_x and mu_x, for arguments that are not checked.
    pub(super) fn responses_at(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.prepare(q, p)?;
        self.conservative();
        Ok(())
    }

    /// `(dv; dmu) = MM^-1 (d_p - (P - (mu . J)_q) d_q ; (J v)_q d_q)`: the change of (v, mu) along
    /// (d_q, d_p).
    pub(super) fn respond(&mut self, d_q: &[S], d_p: &[S], [dv, dmu]: [&mut [S]; 2]) {
        for (i, dv) in dv.iter_mut().enumerate() {
            *dv = d_p[i] - dot(self.cross.row(i), d_q);
        }
        for (i, dmu) in dmu.iter_mut().enumerate() {
            *dmu = dot(self.moving.blocks.slope.row(i), d_q);
        }
        self.kkt.solve(&self.factor, dv, dmu);
    }

    /// The direction that belongs to `y . v + c . mu`, and the response to it: mu is the derivative of H_c by
    /// a right-hand side of `-J v = r`, as v is that by p.
    pub(super) fn set_weights(&mut self, y: &[S], c: &[S]) {
        let [w_q, w_p] = &mut self.direction;
        let [dv, dmu] = &mut self.change;
        w_q.fill(S::zero());
        w_p.copy_from_slice(y);
        dv.copy_from_slice(y);
        dmu.copy_from_slice(c);
        self.kkt.solve(&self.factor, dv, dmu);
    }

    /// The direction `w = (-y_p, y_q + D_v y_p)`, with brackets, and the response to it.
    pub(super) fn set_costate(&mut self, p: &[S], y: &[S]) {
        let [mut w_q, mut w_p] = std::mem::take(&mut self.direction);
        let [mut dv, mut dmu] = std::mem::take(&mut self.change);
        let (y_q, y_p) = y.split_at(w_q.len());
        w_q.iter_mut().zip(y_p).for_each(|(w, &y)| *w = -y);
        w_p.copy_from_slice(y_q);
        for &i in self.tree.with_friction() {
            w_p[i] += friction_of(&self.tree, i, self.v[i]).first * y_p[i];
        }
        self.brackets.add_weights(p, &w_q, &mut w_p);
        self.respond(&w_q, &w_p, [&mut dv, &mut dmu]);
        self.direction = [w_q, w_p];
        self.change = [dv, dmu];
    }
}
