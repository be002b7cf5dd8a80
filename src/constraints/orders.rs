//! The steps of the constrained state equation: factors, velocities, and the blocks of its derivatives.

use super::ConstrainedHamiltonian;
use crate::error::EvalError;
use crate::kernels::friction_of;
use crate::matrix::{Panel, add_scaled};
use crate::scalar::Scalar;

impl<S: Scalar> ConstrainedHamiltonian<S> {
    /// M, J and the factors of their matrix.
    pub(super) fn factor(&mut self, q: &[S]) -> Result<(), EvalError> {
        self.factor_in(q, false)
    }

    /// The same, `fast` in the axes of the world where these take less time.
    fn factor_in(&mut self, q: &[S], fast: bool) -> Result<(), EvalError> {
        let Self { tree, kernel, factor, rows, kkt, elimination, .. } = self;
        kernel.factor(tree, q, factor, [fast, false])?;
        rows.place(q);
        kkt.set_sizes(rows.sizes(), kernel.mass_matrix());
        match elimination {
            Some(blocks) if !Panel::<S>::ONE_LANE => blocks.respond(factor, rows.jacobian(), kkt),
            _ => kkt.factor(factor, rows.jacobian()),
        }
        Ok(())
    }

    pub(super) fn solve_velocity(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.factor(q)?;
        self.set_velocity(p);
        Ok(())
    }

    /// v and mu, after the factors.
    fn set_velocity(&mut self, p: &[S]) {
        self.v.copy_from_slice(p);
        self.kkt.velocity(&self.factor, &mut self.v, &mut self.mu);
    }

    pub(super) fn first_order(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.solve_velocity(q, p)?;
        self.kernel.set_velocity(&self.tree, q, &self.v)
    }

    /// All blocks of MM, PP and LL_qq.
    #[inline(never)]
    pub(super) fn prepare(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.first_order(q, p)?;
        self.kernel.second_order(&self.tree);
        self.moving.place(q, &self.v, &self.mu);
        let [l_vq, _] = self.kernel.blocks();
        let (curvature, n) = (&self.moving.blocks.curvature, self.v.len());
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            self.cross[(i, j)] = l_vq.entry(i, j) - curvature[(i, j)];
        }
        Ok(())
    }

    /// The same, where no kernel two and no product with P or L_qq is asked for.
    #[inline(never)]
    pub(super) fn prepare_alone(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        if self.kernel.world.is_none() || self.elimination.is_none() {
            return self.prepare(q, p);
        }
        self.factor_in(q, true)?;
        self.set_velocity(p);
        self.kernel.set_velocity(&self.tree, q, &self.v)?;
        self.kernel.second_order(&self.tree);
        self.moving.place(q, &self.v, &self.mu);
        Ok(())
    }

    /// F, after [`prepare`](Self::prepare), at the momentum p.
    pub(super) fn rate(&mut self, [q, p, u]: [&[S]; 3]) {
        self.l_q.copy_from_slice(self.kernel.l_q());
        let rows = (0..p.len()).map(|j| self.moving.blocks.curvature.row(j));
        rows.zip(&self.v).for_each(|(row, &v)| add_scaled(&mut self.l_q, -v, row));
        self.add_outer_forces([q, p, u]);
    }

    /// F, with friction, actuation, wrenches and brackets.
    pub(super) fn add_outer_forces(&mut self, [q, p, u]: [&[S]; 3]) {
        let (f_q, f_p) = self.f.split_at_mut(self.v.len());
        f_q.copy_from_slice(&self.v);
        f_p.iter_mut().zip(self.l_q.iter().zip(u)).for_each(|(f, (&l_q, &u))| *f = l_q + u);
        for &i in self.tree.with_friction() {
            self.friction[i] = friction_of(&self.tree, i, self.v[i]);
            f_p[i] += self.friction[i].value;
        }
        if let Some(external) = &mut self.external {
            f_p.iter_mut().zip(external.force(q)).for_each(|(f, &tau)| *f += tau);
        }
        self.brackets.add_rate(p, &mut self.f);
    }
}
