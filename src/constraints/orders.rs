//! The steps of the constrained state equation: factors, velocities, and the blocks of its derivatives.

use super::ConstrainedHamiltonian;
use crate::error::EvalError;
use crate::kernels::friction_of;
use crate::matrix::{Panel, add_scaled, dot_packs};
use crate::scalar::Scalar;

impl<S: Scalar> ConstrainedHamiltonian<S> {
    /// M, J and the factors of their matrix.
    pub(super) fn factor(&mut self, q: &[S]) -> Result<(), EvalError> {
        self.in_world = false;
        let Self { tree, kernel, factor, .. } = self;
        kernel.set_position(tree, q)?;
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: tree.name(k).into() };
        factor.factor(kernel.mass_matrix(), |k| kernel.size_of_entry(tree, k)).map_err(singular)?;
        self.factor_rows(q);
        Ok(())
    }

    /// J and the factors of its matrix, where M is factored.
    fn factor_rows(&mut self, q: &[S]) {
        self.rows.place(q);
        let Self { kernel, factor, rows, kkt, elimination, world, in_world, .. } = self;
        let (mass_matrix, in_own_axes) = match world {
            Some(world) if *in_world => (world.mass_matrix(), true),
            _ => (kernel.mass_matrix(), false),
        };
        kkt.set_sizes(rows.sizes(), mass_matrix);
        let jacobian = if in_own_axes { rows.jacobian() } else { rows.chart_jacobian() };
        match elimination {
            Some(blocks) if !Panel::<S>::ONE_LANE => blocks.respond(factor, jacobian, kkt),
            _ => kkt.factor(factor, jacobian),
        }
    }

    pub(super) fn solve_velocity(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.factor(q)?;
        self.v.copy_from_slice(p);
        self.kkt.velocity(&self.factor, &mut self.v, &mut self.mu);
        Ok(())
    }

    pub(super) fn first_order(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.solve_velocity(q, p)?;
        self.kernel.set_velocity(&self.tree, &self.v)
    }

    /// All blocks of MM, PP and LL_qq.
    #[inline(never)]
    pub(super) fn prepare(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.first_order(q, p)?;
        self.kernel.second_order(&self.tree);
        self.moving.place(q, &self.v, &self.mu);
        for i in 0..self.dof() {
            let row = self.cross.row_mut(i);
            row.copy_from_slice(self.kernel.l_vq().row(i));
            add_scaled(row, -S::one(), self.moving.blocks.curvature.row(i));
        }
        Ok(())
    }

    /// Whether [`prepare_alone`](Self::prepare_alone) takes and gives displacements of floating joints along
    /// the axes of the moved frames.
    pub(super) fn has_own_axes(&self) -> bool {
        !Panel::<S>::ONE_LANE && self.world.is_some()
    }

    /// The same, where no kernel two and no product with P or L_qq is asked for.
    #[inline(never)]
    pub(super) fn prepare_alone(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        let Some(world) = self.world.as_mut().filter(|_| !Panel::<S>::ONE_LANE) else {
            return self.prepare(q, p);
        };
        self.in_world = true;
        world.factor(&self.tree, q, &mut self.factor, false)?;
        self.factor_rows(q);
        self.v.copy_from_slice(p);
        self.kkt.velocity(&self.factor, &mut self.v, &mut self.mu);
        if let Some(world) = &mut self.world {
            world.first_order(&self.tree, q, &self.v);
            world.second_order(&self.tree);
        }
        self.moving.place_in_own_axes(q, &self.v, &self.mu, &self.rows);
        Ok(())
    }

    /// F, after [`prepare`](Self::prepare).
    pub(super) fn rate(&mut self, q: &[S], u: &[S]) {
        let l_q = match &self.world {
            Some(world) if self.in_world => world.l_q(),
            _ => self.kernel.l_q(),
        };
        let f_p = self.f[self.v.len()..].iter_mut();
        for (i, (f_p, &l_q)) in f_p.zip(l_q).enumerate() {
            *f_p = l_q - dot_packs(self.moving.blocks.curvature.row(i), &self.v);
        }
        self.add_outer_forces(q, u);
    }

    /// v, and what friction, actuation and wrenches add to F^p.
    pub(super) fn add_outer_forces(&mut self, q: &[S], u: &[S]) {
        let (f_q, f_p) = self.f.split_at_mut(self.v.len());
        f_q.copy_from_slice(&self.v);
        f_p.iter_mut().zip(u).for_each(|(f, &u)| *f += u);
        for &i in self.tree.with_friction() {
            self.friction[i] = friction_of(&self.tree, i, self.v[i]);
            f_p[i] += self.friction[i].value;
        }
        if let Some(external) = &mut self.external {
            f_p.iter_mut().zip(external.force(q)).for_each(|(f, &tau)| *f += tau);
        }
    }
}
