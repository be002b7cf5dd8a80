//! The steps of the constrained state equation: factors, velocities, and the blocks of its derivatives.

use super::ConstrainedHamiltonian;
use crate::error::EvalError;
use crate::hamiltonian::blocks_of;
use crate::kernels::friction_of;
use crate::matrix::{Panel, add_scaled};
use crate::scalar::Scalar;

impl<S: Scalar> ConstrainedHamiltonian<S> {
    /// M, J and the factors of their matrix.
    pub(super) fn factor(&mut self, q: &[S]) -> Result<(), EvalError> {
        self.factor_in(q, !self.tree.free().is_empty())
    }

    /// The same in the axes of the world, or in body frames.
    fn factor_in(&mut self, q: &[S], in_world: bool) -> Result<(), EvalError> {
        let Self { tree, kernel, factor, world, .. } = self;
        self.in_world = in_world;
        match world {
            Some(world) if in_world => world.factor(tree, q, factor, false)?,
            _ => {
                kernel.set_position(tree, q)?;
                let singular = |k: usize| EvalError::SingularMassMatrix { joint: tree.name(k).into() };
                factor.factor(kernel.mass_matrix(), |k| kernel.size_of_entry(tree, k)).map_err(singular)?;
            }
        }
        self.rows.place(q);
        let Self { kernel, factor, rows, kkt, elimination, world, .. } = self;
        let mass_matrix = match world {
            Some(world) if in_world => world.mass_matrix(),
            _ => kernel.mass_matrix(),
        };
        kkt.set_sizes(rows.sizes(), mass_matrix);
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
        match &mut self.world {
            Some(world) if self.in_world => world.first_order(&self.tree, q, &self.v),
            _ => self.kernel.set_velocity(&self.tree, &self.v)?,
        }
        Ok(())
    }

    /// All blocks of MM, PP and LL_qq.
    #[inline(never)]
    pub(super) fn prepare(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.first_order(q, p)?;
        match &mut self.world {
            Some(world) if self.in_world => world.second_order(&self.tree),
            _ => self.kernel.second_order(&self.tree),
        }
        self.moving.place(q, &self.v, &self.mu);
        let [l_vq, _] = blocks_of(&self.kernel, self.world.as_deref().filter(|_| self.in_world));
        let (curvature, n) = (&self.moving.blocks.curvature, self.v.len());
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            self.cross[(i, j)] = l_vq.entry(i, j) - curvature[(i, j)];
        }
        Ok(())
    }

    /// The same, where no kernel two and no product with P or L_qq is asked for.
    #[inline(never)]
    pub(super) fn prepare_alone(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        if self.world.is_none() || self.elimination.is_none() {
            return self.prepare(q, p);
        }
        self.factor_in(q, true)?;
        self.set_velocity(p);
        if let Some(world) = &mut self.world {
            world.first_order(&self.tree, q, &self.v);
            world.second_order(&self.tree);
        }
        self.moving.place(q, &self.v, &self.mu);
        Ok(())
    }

    /// F, after [`prepare`](Self::prepare), at the momentum p.
    pub(super) fn rate(&mut self, [q, p, u]: [&[S]; 3]) {
        self.set_gradient();
        let rows = (0..p.len()).map(|j| self.moving.blocks.curvature.row(j));
        rows.zip(&self.v).for_each(|(row, &v)| add_scaled(&mut self.l_q, -v, row));
        self.add_outer_forces([q, p, u]);
    }

    /// L_q, of the open tree.
    pub(super) fn set_gradient(&mut self) {
        self.l_q.copy_from_slice(match &self.world {
            Some(world) if self.in_world => world.l_q(),
            _ => self.kernel.l_q(),
        });
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
