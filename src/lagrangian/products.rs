//! Products with the Jacobian of inverse dynamics, without a matrix.

use super::Lagrangian;
use super::routes::joint_slopes;
use crate::kernels::Sums;
use crate::matrix::{add_scaled, dot, filled};
use crate::robot::Tree;
use crate::scalar::Scalar;

/// Buffers of products with a direction.
#[derive(Clone, Debug)]
pub(super) struct Products<S> {
    pub sums: Sums<S>,
    /// The direction's part in a, n.
    pub in_a: Vec<S>,
    /// Parts of the product in q, v and a, n each.
    pub by: [Vec<S>; 3],
    /// The product, 3n.
    pub whole: Vec<S>,
}

impl<S: Scalar> Products<S> {
    pub fn new(tree: &Tree) -> Self {
        let vector = || filled(S::zero(), tree.dof());
        Self {
            sums: Sums::new(tree),
            in_a: vector(),
            by: [vector(), vector(), vector()],
            whole: filled(S::zero(), 3 * tree.dof()),
        }
    }
}

impl<S: Scalar> Lagrangian<S> {
    /// `tau_q x + tau_v y`, n, at the forces set last.
    pub(super) fn torque_product(
        &mut self,
        sums: &mut Sums<S>,
        [q, v]: [&[S]; 2],
        (x, y): (&[S], &[S]),
        product: &mut [S],
    ) {
        product.fill(S::zero());
        if let Some(world) = &self.world {
            world.add_torque_product(sums, [x, y], product);
        }
        joint_slopes(&self.tree, v, |i, in_q, in_v| {
            product[i] += in_q.mul_add(x[i], in_v * y[i]);
        });
        if let Some(external) = &mut self.external {
            let slopes = external.slopes(q);
            product.iter_mut().enumerate().for_each(|(i, entry)| *entry -= dot(slopes.row(i), x));
        }
    }

    /// `w'tau_q` and `w'tau_v`, n each, at the forces set last.
    pub(super) fn torque_adjoint(
        &mut self,
        sums: &mut Sums<S>,
        [q, v]: [&[S]; 2],
        w: &[S],
        [by_q, by_v]: [&mut [S]; 2],
    ) {
        by_q.fill(S::zero());
        by_v.fill(S::zero());
        if let Some(world) = &self.world {
            world.add_torque_adjoint(sums, w, [&mut *by_q, &mut *by_v]);
        }
        joint_slopes(&self.tree, v, |i, in_q, in_v| {
            by_q[i] = w[i].mul_add(in_q, by_q[i]);
            by_v[i] = w[i].mul_add(in_v, by_v[i]);
        });
        if let Some(external) = &mut self.external {
            let slopes = external.slopes(q);
            w.iter().enumerate().for_each(|(i, &w)| add_scaled(by_q, -w, slopes.row(i)));
        }
    }
}
