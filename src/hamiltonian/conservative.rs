//! The part without friction and actuation: `x' = J grad H`, and Hess H.

use super::elimination::Elimination;
use super::world::{Change, World};
use crate::error::EvalError;
use crate::kernels::{Factor, LagrangianHessian};
use crate::matrix::{Left, Matrix, Panel, Part, Place, Source, Update, dot, filled, sized};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// `v = M^-1 p`, L_q and the blocks of F_x and Hess H.
#[derive(Clone, Debug)]
pub(super) struct Conservative<S: Scalar, K> {
    pub kernel: K,
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
    /// Kernel one in the axes of the world, and whether it was used last.
    world: Option<Box<World<S>>>,
    in_world: bool,
}

impl<S: Scalar, K: LagrangianHessian<S>> Conservative<S, K> {
    #[inline(never)]
    pub fn new(tree: &Tree) -> Self {
        let n = tree.dof();
        let (square, factor) = (Panel::zeros(n, n), Factor::new(tree));
        let blocks = if Panel::<S>::in_blocks(n) { n } else { 0 };
        Self {
            kernel: K::new(tree),
            tiles: Panel::<S>::for_blocks(n, || Elimination::new(&factor)),
            factor,
            v: filled(S::zero(), n),
            w: square.clone(),
            inverse: square.clone(),
            reduced: square.clone(),
            p: square.clone(),
            y: Panel::zeros(blocks, blocks),
            z: square,
            world: if K::WORLD_AXES { World::where_used(tree) } else { None },
            in_world: false,
        }
    }

    /// M(q) and its factors.
    #[inline(never)]
    pub fn factor(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        if let Some(world) = self.world.as_mut().filter(|_| !tree.free().is_empty()) {
            self.in_world = true;
            return world.factor(tree, q, &mut self.factor, false);
        }
        self.in_world = false;
        self.kernel.set_position(tree, q)?;
        self.factor_mass_matrix(tree)
    }

    /// The same without what [`first_order`](Self::first_order) needs.
    #[inline(never)]
    pub fn factor_alone(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        if !tree.free().is_empty() {
            return self.factor(tree, q);
        }
        self.set_mass_matrix(tree, q)?;
        self.factor_mass_matrix(tree)
    }

    /// M(q) alone.
    #[inline(never)]
    pub fn set_mass_matrix(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        if let Some(world) = self.world.as_mut().filter(|_| !tree.free().is_empty()) {
            self.in_world = true;
            world.set_mass_matrix(tree, q);
            return Ok(());
        }
        self.in_world = false;
        self.kernel.set_mass_matrix(tree, q)
    }

    fn factor_mass_matrix(&mut self, tree: &Tree) -> Result<(), EvalError> {
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: tree.name(k).into() };
        let size_of = |k| self.kernel.size_of_entry(tree, k);
        self.factor.factor(self.kernel.mass_matrix(), size_of).map_err(singular)
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
        match &mut self.world {
            Some(world) if self.in_world => world.first_order(tree, q, &self.v),
            _ => self.kernel.set_velocity(tree, &self.v)?,
        }
        Ok(())
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
        let Some(world) = &mut self.world else { return self.first_order(tree, q, p) };
        self.in_world = true;
        world.factor(tree, q, &mut self.factor, !second_order)?;
        if second_order && self.tiles.is_some() {
            // It needs U', which gives v in less time than a substitution.
            self.factor.invert();
        }
        self.v.copy_from_slice(p);
        self.factor.solve(&mut self.v);
        world.first_order(tree, q, &self.v);
        Ok(())
    }

    /// The kernel in the axes of the world, if it was used last.
    fn world(&self) -> Option<&World<S>> {
        self.world.as_deref().filter(|_| self.in_world)
    }

    /// Whether it was used last.
    #[cfg(test)]
    pub fn is_in_world(&self) -> bool {
        self.world().is_some()
    }

    /// Changes of M, P and L_qq along (dq, dv) in the axes of the world, after
    /// [`second_order`](Self::second_order) there.
    pub fn differentiate_in_world(&mut self, tree: &Tree, change: &mut Change<S>, direction: [&[S]; 2]) {
        let Self { world, v, .. } = self;
        if let Some(world) = world {
            world.differentiate(tree, change, v, direction);
        }
    }

    /// Buffers for that, where [`first_order_alone`](Self::first_order_alone) works in the axes of the world.
    pub fn change(&self) -> Option<Box<Change<S>>> {
        self.world.as_deref().map(|world| Box::new(Change::new(world)))
    }

    /// L_q, of either.
    pub fn l_q(&self) -> &[S] {
        self.world().map_or(self.kernel.l_q(), World::l_q)
    }

    /// M, of either.
    pub fn mass_matrix(&self) -> &Matrix<S> {
        self.world().map_or(self.kernel.mass_matrix(), World::mass_matrix)
    }

    /// `V d = M^-1 (d_p - P d_q)`: the change of v along d = (d_q, d_p). Needs the third stage of the kernel,
    /// or [`second_order`](Self::second_order) in the axes of the world.
    #[inline(never)]
    pub fn velocity_change(&self, d_q: &[S], d_p: &[S], change: &mut [S]) {
        if let Some(world) = self.world() {
            world.l_vq().times(d_q, change);
            change.iter_mut().zip(d_p).for_each(|(change, &d_p)| *change = d_p - *change);
        } else {
            for ((change, &d_p), i) in change.iter_mut().zip(d_p).zip(0..) {
                *change = d_p - dot(self.kernel.l_vq().row(i), d_q);
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
        match &mut self.world {
            Some(world) if self.in_world => world.second_order(tree),
            _ => self.kernel.second_order(tree),
        }
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
        let Self { kernel, factor, inverse, p, w, z, reduced, world, in_world, .. } = self;
        let [l_vq, l_qq] = blocks_of(kernel, world.as_deref().filter(|_| *in_world));
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
        let Self { kernel, inverse, p, w, reduced, world, in_world, .. } = self;
        let [l_vq, l_qq] = blocks_of(kernel, world.as_deref().filter(|_| *in_world));
        p.take::<N, W>(l_vq);
        reduced.take::<N, W>(l_qq);
        [&*inverse, p, w, reduced].into_iter().for_each(Panel::has_size::<N, W>);
        w.set_product::<N, W>(Left::Rows(inverse), p, Part::Whole);
        reduced.subtract_product::<N, W>(Left::Columns(p), w, Part::Lower);
        reduced.mirror_lower::<W>();
    }

    /// R' and `Y = R' P`.
    fn eliminate_by_blocks(&mut self, tiles: &Elimination) {
        let Self { kernel, factor, p, y, world, in_world, .. } = self;
        factor.invert();
        let p = match world {
            Some(world) if *in_world => world.l_vq(),
            _ => {
                p.read::<0>(kernel.l_vq());
                &*p
            }
        };
        y.set_tiles(&tiles.upper, Left::Rows(factor.root()), p);
    }

    /// The conservative part of F_x: `M^-1`, `-W = -R Y`, the transpose of W, and
    /// `L_qq - P' M^-1 P = L_qq - Y' Y`.
    #[inline(never)]
    pub fn place_blocks(&mut self, f_x: &mut Matrix<S>) {
        let Some(tiles) = self.tiles.take() else { return };
        let Self { kernel, factor, p, w, y, world, in_world, .. } = self;
        let n = y.rows();
        factor.inverse_by_blocks();
        w.set_tiles(&tiles.lower, Left::Columns(factor.root()), y);
        let update = match world {
            Some(world) if *in_world => Update::SubtractFrom(world.l_qq()),
            _ => {
                p.read::<0>(kernel.l_qq());
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

/// P and L_qq of the kernel that was used last.
#[inline(always)]
pub(crate) fn blocks_of<'a, S: Scalar, K: LagrangianHessian<S>>(
    kernel: &'a K,
    world: Option<&'a World<S>>,
) -> [Source<'a, S>; 2] {
    world.map_or([Source::Matrix(kernel.l_vq()), Source::Matrix(kernel.l_qq())], |world| {
        [Source::Panel(world.l_vq()), Source::Panel(world.l_qq())]
    })
}
