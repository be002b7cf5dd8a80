//! First and second derivatives of the acceleration of a frame, by one dual number.

use super::{Kinematics, ReferenceFrame};
use crate::error::EvalError;
use crate::kernels::check_entries;
use crate::matrix::{Matrix, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::{Scalar, Tangent};
use crate::spatial::{Force, Motion, Vec3};

/// Workspace for the derivatives of accelerations of frames; no call allocates.
///
/// The acceleration `A = J a + Jdot v` is the derivative of the twist V(q, v) along (v, a). So one dual
/// number along the motion, carried through the second derivatives H of `h = W . V`, gives those of `W . A`:
///
/// ```text
/// (W . A)_qq = dH_qq/dt            (W . A)_vv = H_vq + H_vq'
/// (W . A)_vq = dH_vq/dt + H_qq     (W . A)_aq = H_vq
/// ```
///
/// all others are zero; and the first ones of A are
///
/// ```text
/// A_q = d(V_q)/dt        A_v = dJ/dt + V_q        A_a = J
/// ```
///
/// At W in axes of the world and without moment this is the second derivative of the
/// acceleration of a point; O(d^2) products for d joints on the path.
#[derive(Clone, Debug)]
pub struct KinematicsSecondOrder<S: Scalar> {
    kinematics: Kinematics<Tangent<S>>,
    q: Vec<Tangent<S>>,
    v: Vec<Tangent<S>>,
    jacobian: Matrix<S>,
    hessian: Matrix<S>,
}

impl<S: Scalar> KinematicsSecondOrder<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        let (n, zero) = (tree.dof(), Tangent::zero());
        Self {
            kinematics: Kinematics::from_tree(tree),
            q: filled(zero, n),
            v: filled(zero, n),
            jacobian: Matrix::zeros(6, 3 * n),
            hessian: Matrix::zeros(3 * n, 3 * n),
        }
    }

    /// Number of degrees of freedom, n.
    pub fn dof(&self) -> usize {
        self.q.len()
    }

    /// The model.
    pub fn tree(&self) -> &Tree {
        self.kinematics.tree()
    }

    /// Places the robot at q, v, a (rad/s^2, m/s^2; length n).
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn set_motion(&mut self, q: &[S], v: &[S], a: &[S]) -> Result<(), EvalError> {
        let tree = self.kinematics.tree();
        tree.refuse_free()?;
        for (what, values) in [("q", q), ("v", v), ("a", a)] {
            check_entries(tree, what, values, tree.dof())?;
        }
        for (i, ((&q, &v), &a)) in q.iter().zip(v).zip(a).enumerate() {
            (self.q[i], self.v[i]) = (Tangent::new(q, v), Tangent::new(v, a));
        }
        self.kinematics.set_state(&self.q, &self.v)
    }

    /// A (rad/s^2, m/s^2), as [`Kinematics::acceleration`].
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn acceleration(&self, frame: usize, axes: ReferenceFrame) -> Result<Motion<S>, EvalError> {
        let Motion { angular, linear } = self.kinematics.twist(frame, axes)?;
        let rate = |a: Vec3<Tangent<S>>| Vec3::from(a.to_array().map(|entry| entry.eps));
        Ok(Motion { angular: rate(angular), linear: rate(linear) })
    }

    /// The derivatives of A by (q, v, a), 6 x 3n: rows of the angular part, then of the linear one.
    ///
    /// # Errors
    /// See [`Kinematics`].
    #[inline(never)]
    pub fn acceleration_jacobian(
        &mut self,
        frame: usize,
        axes: ReferenceFrame,
    ) -> Result<&Matrix<S>, EvalError> {
        let n = self.q.len();
        let twist = self.kinematics.twist_jacobian(frame, axes)?;
        for i in 0..6 {
            for j in 0..n {
                self.jacobian[(i, j)] = twist[(i, j)].eps;
                self.jacobian[(i, n + j)] = twist[(i, j)].re;
            }
        }
        let by_rates = self.kinematics.jacobian(frame, axes)?;
        for i in 0..6 {
            for j in 0..n {
                self.jacobian[(i, n + j)] += by_rates[(i, j)].eps;
                self.jacobian[(i, 2 * n + j)] = by_rates[(i, j)].re;
            }
        }
        Ok(&self.jacobian)
    }

    /// The second derivatives of `W . A` in (q, v, a), 3n x 3n, symmetric, for a weight W = (moment; force)
    /// that is constant in the axes of the convention; A is the [`acceleration`](Kinematics::acceleration).
    ///
    /// # Errors
    /// See [`Kinematics`].
    #[inline(never)]
    pub fn acceleration_hessian(
        &mut self,
        frame: usize,
        axes: ReferenceFrame,
        weight: &Force<S>,
    ) -> Result<&Matrix<S>, EvalError> {
        let lift = |a: Vec3<S>| Vec3::from(a.to_array().map(|entry| Tangent::new(entry, S::zero())));
        let weight = Force { moment: lift(weight.moment), force: lift(weight.force) };
        let twist = self.kinematics.twist_hessian(frame, axes, &weight)?;
        let n = self.q.len();
        for i in 0..n {
            for j in 0..n {
                self.hessian[(i, j)] = twist[(i, j)].eps;
                self.hessian[(n + i, n + j)] = twist[(n + i, j)].re + twist[(n + j, i)].re;
                let mixed = twist[(n + i, j)].eps + twist[(i, j)].re;
                self.hessian[(n + i, j)] = mixed;
                self.hessian[(j, n + i)] = mixed;
                self.hessian[(2 * n + i, j)] = twist[(n + i, j)].re;
                self.hessian[(j, 2 * n + i)] = twist[(n + i, j)].re;
            }
        }
        Ok(&self.hessian)
    }
}
