//! F_x of the constrained state equation, accelerations and forces.

use super::ConstrainedHamiltonian;
use super::blocks::Blocks;
use super::linearisation::ConstrainedLinearisation;
use crate::matrix::{Panel, add_scaled, dot_packs};
use crate::scalar::Scalar;

impl<S: Scalar> ConstrainedHamiltonian<S> {
    /// F, F_x, mu_x, accelerations and lambda, after [`prepare`](Self::prepare).
    #[inline(never)]
    pub(super) fn assemble(&mut self, [q, p, u]: [&[S]; 3]) {
        self.rate([q, p, u]);
        self.conservative();
        self.add_slopes([q, p]);
        self.balance();
    }

    /// Adds the slopes of friction, of wrenches from outside and of brackets to F_x.
    pub(super) fn add_slopes(&mut self, [q, p]: [&[S]; 2]) {
        let n = self.dof();
        self.brackets.add_slopes([p, &self.v, &self.l_q], &mut self.f_x);
        for &i in self.tree.with_friction() {
            let slope = self.friction[i].first;
            let (row, v) = self.f_x.row_mut_and_above(n + i, i);
            add_scaled(row, slope, v);
        }
        if let Some(external) = &mut self.external {
            let slopes = external.slopes(q);
            for i in 0..n {
                add_scaled(&mut self.f_x.row_mut(n + i)[..n], S::one(), slopes.row(i));
            }
        }
    }

    /// F_x without friction and wrenches from outside, and mu_x.
    pub(super) fn conservative(&mut self) {
        let Self { kernel, factor, kkt, moving, cross, elimination, f_x, mu_x, .. } = self;
        let Blocks { curvature, bend, slope, .. } = &moving.blocks;
        match (elimination, kernel.world()) {
            (Some(blocks), Some(world)) if !Panel::<S>::ONE_LANE => {
                let take_p = |p: &mut Panel<S>| p.set_difference(world.l_vq(), curvature);
                let take_l_qq = |p: &mut Panel<S>| p.set_difference(world.l_qq(), bend);
                blocks.place((factor, kkt), [&take_p, &take_l_qq], slope, [f_x, mu_x]);
            }
            (Some(blocks), _) if !Panel::<S>::ONE_LANE => {
                let take_p = |p: &mut Panel<S>| p.read::<0>(cross);
                let take_l_qq = |p: &mut Panel<S>| {
                    p.read::<0>(kernel.body.l_qq());
                    (0..bend.rows()).for_each(|i| p.subtract_row(i, bend.row(i)));
                };
                blocks.place((factor, kkt), [&take_p, &take_l_qq], slope, [f_x, mu_x]);
            }
            _ => {
                self.responses();
                self.forces();
            }
        }
    }

    /// The rows of v and mu: a column of (v, mu)_x for each unit direction.
    fn responses(&mut self) {
        let n = self.dof();
        let [mut d_q, mut d_p] = std::mem::take(&mut self.direction);
        let [mut dv, mut dmu] = std::mem::take(&mut self.change);
        d_q.fill(S::zero());
        d_p.fill(S::zero());
        for j in 0..2 * n {
            let seed = if j < n { &mut d_q[j] } else { &mut d_p[j - n] };
            *seed = S::one();
            self.respond(&d_q, &d_p, [&mut dv, &mut dmu]);
            let seed = if j < n { &mut d_q[j] } else { &mut d_p[j - n] };
            *seed = S::zero();
            dv.iter().enumerate().for_each(|(i, &dv)| self.f_x[(i, j)] = dv);
            dmu.iter().enumerate().for_each(|(i, &dmu)| self.mu_x[(i, j)] = dmu);
        }
        self.direction = [d_q, d_p];
        self.change = [dv, dmu];
    }

    /// The conservative rows of p: `LL_qq + (P - (mu . J)_q)' v_q - (J v)_q' mu_q` and `-v_q'`, and v_p
    /// exactly symmetric.
    fn forces(&mut self) {
        let (n, blocks) = (self.dof(), &self.moving.blocks);
        let [_, l_qq] = self.kernel.blocks();
        for i in 0..n {
            for j in 0..=i {
                let mut entry = l_qq.entry(i, j) - blocks.bend[(i, j)];
                for l in 0..n {
                    entry += self.cross[(l, i)] * self.f_x[(l, j)];
                }
                for l in 0..self.mu.len() {
                    entry -= blocks.slope[(l, i)] * self.mu_x[(l, j)];
                }
                self.f_x[(n + i, j)] = entry;
                self.f_x[(n + j, i)] = entry;
                self.f_x[(j, n + i)] = self.f_x[(i, n + j)];
            }
            for j in 0..n {
                self.f_x[(n + i, n + j)] = -self.f_x[(j, i)];
            }
        }
    }

    /// `(a; lambda) = (v; mu)_x F`, all forces included.
    pub(super) fn balance(&mut self) {
        let [mut a, mut lambda] = std::mem::take(&mut self.rates);
        for (i, a) in a.iter_mut().enumerate() {
            *a = dot_packs(self.f_x.row(i), &self.f);
        }
        for (i, lambda) in lambda.iter_mut().enumerate() {
            *lambda = dot_packs(self.mu_x.row(i), &self.f);
        }
        self.rates = [a, lambda];
    }

    pub(super) fn linearisation(&self) -> ConstrainedLinearisation<'_, S> {
        let [acceleration, lambda] = &self.rates;
        ConstrainedLinearisation {
            f: &self.f,
            f_x: &self.f_x,
            f_u: &self.f_u,
            mu: &self.mu,
            mu_x: &self.mu_x,
            acceleration,
            lambda,
        }
    }
}
