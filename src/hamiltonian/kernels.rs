//! Kernels one and two in body frames, or in the axes of the world.

use super::world::{Change, World};
use crate::error::EvalError;
use crate::kernels::{Factor, KernelOne, KernelTwo, LagrangianHessian};
use crate::matrix::{Matrix, Source, dot};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// Kernel one in both, and which of them was used last.
#[derive(Clone, Debug)]
pub(crate) struct FirstKernel<S: Scalar, K> {
    pub body: K,
    pub world: Option<Box<World<S>>>,
    in_world: bool,
}

impl<S: Scalar, K: LagrangianHessian<S>> FirstKernel<S, K> {
    pub fn new(tree: &Tree) -> Self {
        let world = if K::WORLD_AXES { World::where_used(tree) } else { None };
        Self { body: K::new(tree), world, in_world: false }
    }

    /// The kernel in the axes of the world, if it was used last.
    #[inline(always)]
    pub fn world(&self) -> Option<&World<S>> {
        self.world.as_deref().filter(|_| self.in_world)
    }

    /// The same from here on: with floating and spherical joints, and for others where asked for.
    fn choose(&mut self, tree: &Tree, fast: bool) -> Option<&mut World<S>> {
        self.in_world = self.world.is_some() && (fast || !tree.free().is_empty());
        self.current()
    }

    fn current(&mut self) -> Option<&mut World<S>> {
        let in_world = self.in_world;
        self.world.as_deref_mut().filter(|_| in_world)
    }

    /// M(q) alone.
    pub fn set_mass_matrix(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        if let Some(world) = self.choose(tree, false) {
            world.set_mass_matrix(tree, q);
            return Ok(());
        }
        self.body.set_mass_matrix(tree, q)
    }

    /// M(q) and its factors, `fast` in the axes of the world where there are such; these `alone`: without
    /// what the next stage needs in body frames, and without M in the axes of the world.
    pub fn factor(
        &mut self,
        tree: &Tree,
        q: &[S],
        factor: &mut Factor<S>,
        [fast, alone]: [bool; 2],
    ) -> Result<(), EvalError> {
        if let Some(world) = self.choose(tree, fast) {
            return world.factor(tree, q, factor, alone);
        }
        if alone {
            self.body.set_mass_matrix(tree, q)?;
        } else {
            self.body.set_position(tree, q)?;
        }
        let singular = |k: usize| EvalError::SingularMassMatrix { joint: tree.name(k).into() };
        factor.factor(self.body.mass_matrix(), |k| self.body.size_of_entry(tree, k)).map_err(singular)
    }

    /// L_q at v, after the factors at q.
    pub fn set_velocity(&mut self, tree: &Tree, q: &[S], v: &[S]) -> Result<(), EvalError> {
        match self.current() {
            Some(world) => world.first_order(tree, q, v),
            None => self.body.set_velocity(tree, v)?,
        }
        Ok(())
    }

    /// P and L_qq there.
    pub fn second_order(&mut self, tree: &Tree) {
        match self.current() {
            Some(world) => world.second_order(tree),
            None => self.body.second_order(tree),
        }
    }

    /// `p = M v`, n.
    pub fn momentum(&mut self, tree: &Tree, q: &[S], v: &[S], p: &mut [S]) -> Result<(), EvalError> {
        if let Some(world) = self.choose(tree, false) {
            world.set_mass_matrix(tree, q);
            p.iter_mut().zip(0..).for_each(|(p, i)| *p = dot(world.mass_matrix().row(i), v));
            return Ok(());
        }
        self.body.set_position(tree, q)?;
        self.body.set_velocity(tree, v)?;
        p.copy_from_slice(self.body.momentum());
        Ok(())
    }

    /// V after the factors at q.
    pub fn potential(&mut self, tree: &Tree, q: &[S]) -> Result<S, EvalError> {
        if self.in_world {
            self.body.set_position(tree, q)?;
        }
        Ok(self.body.potential(tree))
    }

    /// M.
    pub fn mass_matrix(&self) -> &Matrix<S> {
        self.world().map_or(self.body.mass_matrix(), World::mass_matrix)
    }

    /// L_q.
    pub fn l_q(&self) -> &[S] {
        self.world().map_or(self.body.l_q(), World::l_q)
    }

    /// P and L_qq.
    #[inline(always)]
    pub fn blocks(&self) -> [Source<'_, S>; 2] {
        match self.world() {
            Some(world) => [Source::Panel(world.l_vq()), Source::Panel(world.l_qq())],
            None => [Source::Matrix(self.body.l_vq()), Source::Matrix(self.body.l_qq())],
        }
    }
}

/// Kernel two in both.
#[derive(Clone, Debug)]
pub(crate) struct SecondKernel<S: Scalar> {
    pub body: KernelTwo<S>,
    world: Option<Box<Change<S>>>,
    in_world: bool,
}

impl<S: Scalar> SecondKernel<S> {
    pub fn new(tree: &Tree, kernel: &FirstKernel<S, KernelOne<S>>) -> Self {
        let world = kernel.world.as_deref().map(|world| Box::new(Change::new(world)));
        Self { body: KernelTwo::new(tree), world, in_world: false }
    }

    /// Changes of M, P and L_qq along (dq, dv), where kernel one was used last, after P and L_qq at v.
    pub fn differentiate(
        &mut self,
        tree: &Tree,
        kernel: &mut FirstKernel<S, KernelOne<S>>,
        v: &[S],
        [dq, dv]: [&[S]; 2],
    ) -> Result<(), EvalError> {
        self.in_world = kernel.in_world;
        match (kernel.current(), &mut self.world) {
            (Some(world), Some(change)) => world.differentiate(tree, change, v, [dq, dv]),
            _ => self.body.differentiate(tree, &kernel.body, dq, dv)?,
        }
        Ok(())
    }

    /// These changes.
    #[inline(always)]
    pub fn blocks(&self) -> [Source<'_, S>; 3] {
        match self.world.as_ref().filter(|_| self.in_world) {
            Some(change) => change.panels().each_ref().map(Source::Panel),
            None => [self.body.mass_matrix(), self.body.l_vq(), self.body.l_qq()].map(Source::Matrix),
        }
    }
}
