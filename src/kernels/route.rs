//! Routes to the Hessian of the Lagrangian.

use super::KernelOne;
use crate::error::EvalError;
use crate::matrix::Matrix;
use crate::robot::Tree;
use crate::scalar::Scalar;
use std::fmt::Debug;

/// Value, gradient and Hessian of `L(q, v) = 1/2 v' M v - V`, in three stages, each building on the one
/// before.
///
/// The interface between the state equations and a route: [`KernelOne`] contracts with v first;
/// [`tensors`](crate::tensors) computes the derivatives of M one by one, as in the paper.
pub trait LagrangianHessian<S: Scalar>: Clone + Debug {
    /// Whether it takes floating and spherical joints.
    const FREE_JOINTS: bool = false;

    /// Whether F and F_x may be computed in the axes of the world where that takes less time.
    const WORLD_AXES: bool = false;

    /// Buffers for a tree.
    fn new(tree: &Tree) -> Self;

    /// First stage: M and V at q (rad, m; length nq).
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    fn set_position(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError>;

    /// M at q alone (rad, m; length n): the second stage needs [`set_position`](Self::set_position) instead.
    ///
    /// # Errors
    /// As [`set_position`](Self::set_position).
    fn set_mass_matrix(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        self.set_position(tree, q)
    }

    /// Second stage: `p = M v` and L_q at the position set last and v (rad/s, m/s; length n).
    ///
    /// # Errors
    /// [`EvalError::WrongLength`]. Values are not checked here.
    fn set_velocity(&mut self, tree: &Tree, v: &[S]) -> Result<(), EvalError>;

    /// Third stage: `P = L_vq` and L_qq at the position and velocity set last.
    fn second_order(&mut self, tree: &Tree);

    /// Mass matrix M, armature included, n x n, symmetric (kg m^2, kg m, kg).
    fn mass_matrix(&self) -> &Matrix<S>;

    /// The scale of the rounding error of `M_kk`.
    fn size_of_entry(&self, tree: &Tree, k: usize) -> S;

    /// Potential energy V (J) at the position set last: gravity (zero at the origin of the world) and
    /// springs.
    fn potential(&self, tree: &Tree) -> S;

    /// Conjugate momentum p = M v, n.
    fn momentum(&self) -> &[S];

    /// `L_q = 1/2 v' M,q v - V,q` at fixed v, n.
    fn l_q(&self) -> &[S];

    /// `P = d(M v)/dq` at fixed v, n x n: `P_ij = sum_l M_il,j v_l` (21a).
    fn l_vq(&self) -> &Matrix<S>;

    /// `L_qq = 1/2 v' M,ij v - V,ij`, n x n, symmetric (21c).
    fn l_qq(&self) -> &Matrix<S>;
}

/// A route to the Hessian of the Lagrangian, for every scalar.
pub trait Route: Clone + Debug {
    /// The kernel for one scalar type.
    type Hessian<S: Scalar>: LagrangianHessian<S>;
}

/// The default route: contracts with the velocity before differentiating.
#[derive(Clone, Copy, Debug)]
pub struct Contracted;

impl Route for Contracted {
    type Hessian<S: Scalar> = KernelOne<S>;
}

impl<S: Scalar> LagrangianHessian<S> for KernelOne<S> {
    const FREE_JOINTS: bool = true;
    const WORLD_AXES: bool = true;

    fn new(tree: &Tree) -> Self {
        Self::new(tree).with_world_axes(tree)
    }
    fn set_position(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        self.set_position(tree, q)
    }
    fn set_mass_matrix(&mut self, tree: &Tree, q: &[S]) -> Result<(), EvalError> {
        self.set_mass_matrix(tree, q)
    }
    fn set_velocity(&mut self, tree: &Tree, v: &[S]) -> Result<(), EvalError> {
        self.set_velocity(tree, v)
    }
    fn second_order(&mut self, tree: &Tree) {
        self.second_order(tree);
    }
    fn mass_matrix(&self) -> &Matrix<S> {
        self.mass_matrix()
    }
    fn size_of_entry(&self, tree: &Tree, k: usize) -> S {
        self.size_of_entry(tree, k)
    }
    fn potential(&self, tree: &Tree) -> S {
        self.potential(tree)
    }
    fn momentum(&self) -> &[S] {
        self.momentum()
    }
    fn l_q(&self) -> &[S] {
        self.l_q()
    }
    fn l_vq(&self) -> &Matrix<S> {
        self.l_vq()
    }
    fn l_qq(&self) -> &Matrix<S> {
        self.l_qq()
    }
}
