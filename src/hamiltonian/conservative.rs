//! The part without friction and actuation: `x' = J grad H`, and Hess H.

use super::elimination::Elimination;
use super::kernels::FirstKernel;
use crate::error::EvalError;
use crate::kernels::{Factor, LagrangianHessian};
use crate::matrix::{Left, Matrix, Panel, Part, Place, Update, dot, filled, sized};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// `v = M^-1 p`, L_q and the blocks of F_x and Hess H.
#[derive(Clone, Debug)]
pub(super) struct Conservative<S: Scalar, K> {
    pub kernel: FirstKernel<S, K>,
    pub factor: Factor<S>,
    /// `v = M^-1 p`.
    pub v: Vec<S>,
    /// `W = M^-1 P = -F^q,q`.
    pub w: Panel<S>,
    /// `M^-1 = F^q,p`.
    pub inverse: Panel<S>,
    /// `L_qq - P' M^-1 P = F^p,q`.
    pub reduced: Panel<S>,
    p: Panel<S>,
    /// `Y = R' P`, `M^-1 = R R'`, of matrices that are computed block by block; `Z = D^-1 L'^-1 P` of those
    /// of scalars.
    pub y: Panel<S>,
    pub z: Panel<S>,
    tiles: Option<Box<Elimination>>,
}

impl<S: Scalar, K: LagrangianHessian<S>> Conservative<S, K> {
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let n = tree.dof();
        let (square, factor) = (Panel::zeros(n, n), Factor::new(tree));
        let blocks = if Panel::<S>::in_blocks(n) { n } else { 0 };
        Self {
            kernel: FirstKernel::new(tree),
            tiles: Panel::<S>::for_blocks(n, || Elimination::new(&factor)),
            factor,
            v: filled(S::zero(), n),
            w: square.clone(),
            inverse: square.clone(),
            reduced: square.clone(),
            p: square.clone(),
            y: Panel::zeros(blocks, blocks),
            z: square,
        }
    }

    /// M(q) and its factors.
    #[inline(never)]
    pub fn factor(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        self.kernel.factor(tree, q, &mut self.factor, [false, false])
    }

    /// The same without what [`first_order`](Self::first_order) needs.
    #[inline(never)]
    pub fn factor_alone(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        self.kernel.factor(tree, q, &mut self.factor, [false, true])
    }

    /// `v = M^-1 p` (17).
    pub fn solve_velocity(&mut self, tree: &Tree, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.factor(tree, q)?;
        self.v.copy_from_slice(p);
        self.factor.solve(&mut self.v);
        Ok(())
    }

    /// v and L_q (17).
    #[inline(never)]
    pub fn first_order(&mut self, tree: &Tree, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.solve_velocity(tree, q, p)?;
        self.kernel.set_velocity(tree, q, &self.v)
    }

    /// v and L_q, where neither kernel two nor products with P or L_qq are asked for: what follows is
    /// [`second_order`](Self::second_order) or, if that is false, nothing.
    #[inline(never)]
    pub fn first_order_alone(
        &mut self,
        tree: &Tree,
        [q, p]: [&[S]; 2],
        second_order: bool,
    ) -> Result<(), EvalError> {
        if self.kernel.world.is_none() {
            return self.first_order(tree, q, p);
        }
        self.kernel.factor(tree, q, &mut self.factor, [true, !second_order])?;
        if second_order && self.tiles.is_some() {
            // It needs U', which gives v in less time than a substitution.
            self.factor.invert();
        }
        self.v.copy_from_slice(p);
        self.factor.solve(&mut self.v);
        self.kernel.set_velocity(tree, q, &self.v)
    }

    /// L_q, of either.
    pub fn l_q(&self) -> &[S] {
        self.kernel.l_q()
    }

    /// M, of either.
    pub fn mass_matrix(&self) -> &Matrix<S> {
        self.kernel.mass_matrix()
    }

    /// `V d = M^-1 (d_p - P d_q)`: the change of v along d = (d_q, d_p). Needs the third stage of the kernel,
    /// or [`second_order`](Self::second_order) in the axes of the world.
    #[inline(never)]
    pub fn velocity_change(&self, d_q: &[S], d_p: &[S], change: &mut [S]) {
        if let Some(world) = self.kernel.world() {
            world.l_vq().times(d_q, change);
            change.iter_mut().zip(d_p).for_each(|(change, &d_p)| *change = d_p - *change);
        } else {
            for ((change, &d_p), i) in change.iter_mut().zip(d_p).zip(0..) {
                *change = d_p - dot(self.kernel.body.l_vq().row(i), d_q);
            }
        }
        self.factor.solve(change);
    }

    /// M^-1, `W = M^-1 P` and `L_qq - P' W` (21), after [`first_order`](Self::first_order).
    ///
    /// Packs of several lanes multiply by M^-1, whose rows are independent, up to 12 joints, and beyond by
    /// R', block by block and without what branches leave empty: only Y, with which
    /// [`place_blocks`](Self::place_blocks) gives the rest. Scalars use the factors of M.
    #[inline(never)]
    pub fn second_order(&mut self, tree: &Tree) {
        self.kernel.second_order(tree);
        if Panel::<S>::ONE_LANE {
            self.eliminate_by_factors();
        } else if let Some(tiles) = self.tiles.take() {
            self.eliminate_by_blocks(&tiles);
            self.tiles = Some(tiles);
        } else {
            sized!(S, tree.dof(), self.eliminate_by_products());
        }
    }

    /// With `Y = L'^-1 P` and `Z = D^-1 Y`: `P' M^-1 P = Y' Z`, `W = L^-1 Z`.
    fn eliminate_by_factors(&mut self) {
        let Self { kernel, factor, inverse, p, w, z, reduced, .. } = self;
        let [l_vq, l_qq] = kernel.blocks();
        factor.form_inverse::<0, 0>(inverse);
        p.take::<0, 0>(l_vq);
        reduced.take::<0, 0>(l_qq);
        factor.first_half(p);
        z.copy_from::<0, 0>(p);
        factor.divide_by_pivots(z);
        reduced.subtract_product::<0, 0>(Left::Columns(p), z, Part::Lower);
        reduced.mirror_lower::<0>();
        w.copy_from::<0, 0>(z);
        factor.second_half(w);
    }

    fn eliminate_by_products<const N: usize, const W: usize>(&mut self) {
        // The inverse comes first: P and L_qq were stored entry by entry just before, and reading them whole
        // would stall.
        self.factor.form_inverse::<N, W>(&mut self.inverse);
        let Self { kernel, inverse, p, w, reduced, .. } = self;
        let [l_vq, l_qq] = kernel.blocks();
        p.take::<N, W>(l_vq);
        reduced.take::<N, W>(l_qq);
        [&*inverse, p, w, reduced].into_iter().for_each(Panel::has_size::<N, W>);
        w.set_product::<N, W>(Left::Rows(inverse), p, Part::Whole);
        reduced.subtract_product::<N, W>(Left::Columns(p), w, Part::Lower);
        reduced.mirror_lower::<W>();
    }

    /// R' and `Y = R' P`.
    fn eliminate_by_blocks(&mut self, tiles: &Elimination) {
        let Self { kernel, factor, p, y, .. } = self;
        factor.invert();
        let [l_vq, _] = kernel.blocks();
        let p = p.of(l_vq);
        y.set_tiles(&tiles.upper, Left::Rows(factor.root()), p);
    }

    /// The conservative part of F_x: `M^-1`, `-W = -R Y`, the transpose of W, and
    /// `L_qq - P' M^-1 P = L_qq - Y' Y`.
    #[inline(never)]
    pub fn place_blocks(&mut self, f_x: &mut Matrix<S>) {
        let Some(tiles) = self.tiles.take() else { return };
        let Self { kernel, factor, p, w, y, .. } = self;
        let n = y.rows();
        factor.inverse_by_blocks();
        w.set_tiles(&tiles.lower, Left::Columns(factor.root()), y);
        let update = match kernel.world() {
            Some(world) => Update::SubtractFrom(world.l_qq()),
            None => {
                p.read::<0>(kernel.body.l_qq());
                Update::Subtract
            }
        };
        p.update_tiles(&tiles.square, Left::Columns(y), y, update);
        factor.place_formed_inverse(f_x, (0, n));
        f_x.place_panel(Place { at: (0, 0), across: (n, n), minus: [true, false] }, &tiles.lower, w);
        f_x.place_panel(Place::symmetric((n, 0), false), &tiles.square, p);
        self.tiles = Some(tiles);
    }

    /// Whether F_x is computed block by block.
    pub fn in_blocks(&self) -> bool {
        self.tiles.is_some()
    }
}
