//! From the third derivatives of L along a direction to those of H.

use super::conservative::Conservative;
use crate::kernels::{Factor, KernelTwo};
use crate::matrix::{Matrix, Panel, sized, sum_rows};
use crate::scalar::Scalar;

/// `-E' [ A B' ; B C ] E` with `E = [ 1 0 ; -W M^-1 ]`, in the coordinates in which M is diagonal.
///
/// A, B, C: the derivatives of L_qq, P and M along a direction. With `U = L^-1`, `M^-1 = U D^-1 U'`, `W = U Z`:
///
/// ```text
/// C^ = U' C U      B^ = U' B      T^ = B^ - C^ Z
/// qq = -A + Z' T^ + B^' Z      pq = -U D^-1 T^      pp = -U D^-1 C^ D^-1 U'
/// ```
///
/// 4 n^3 products where all joints are on one branch: half for each congruence (symmetric) and each product with U
/// (triangular), one for C^ Z, one for qq (symmetric, two terms).
#[derive(Clone, Debug)]
pub(super) struct Congruence<S: Scalar> {
    b: Panel<S>,
    c: Panel<S>,
    t: Panel<S>,
    pq: Panel<S>,
    qq: Panel<S>,
}

impl<S: Scalar> Congruence<S> {
    /// Buffers for n joints.
    pub fn new(n: usize) -> Self {
        let square = Panel::zeros(n, n);
        Self { b: square.clone(), c: square.clone(), t: square.clone(), pq: square.clone(), qq: square }
    }

    /// Fills the 2n x 2n matrix h, both triangles; `flow` has come to its second order.
    pub fn apply<K>(&mut self, along: &KernelTwo<S>, flow: &Conservative<S, K>, h: &mut Matrix<S>) {
        let given = (&flow.factor, &flow.z);
        sized!(S, flow.z.columns(), self.apply_sized(along, given, h));
    }

    fn apply_sized<const N: usize, const W: usize>(
        &mut self,
        along: &KernelTwo<S>,
        (factor, z): (&Factor<S>, &Panel<S>),
        h: &mut Matrix<S>,
    ) {
        let (n, width) = (if N > 0 { N } else { z.rows() }, z.width::<W>());
        self.b.read::<N>(along.l_vq());
        factor.first_half::<N, W>(&mut self.b);
        self.c.read::<N>(along.mass_matrix());
        factor.reduce_symmetric::<N, W>(&mut self.c);
        for i in 0..n {
            let (_, target, _) = self.t.split_at_row::<W>(i);
            target.iter_mut().zip(self.b.sized_row::<W>(i)).for_each(|(to, &from)| *to = from);
            let row = (0..n).map(|k| (k, -self.c.splat::<W>(i, k)));
            sum_rows::<W, S::Pack>(target, z.packs(), width, row);
        }
        factor.divide_by_pivots::<W>(&self.t, &mut self.pq);
        factor.second_half::<N, W>(&mut self.pq);
        factor.expand_symmetric::<N, W>(&mut self.c);
        for i in 0..n {
            // Up to the diagonal, or all where that is free.
            let target = &mut self.qq.row_mut(i)[..Panel::<S>::width_up_to::<W>(i + 1)];
            target.fill(S::Pack::zero());
            sum_rows::<W, S::Pack>(target, self.t.packs(), width, (0..n).map(|k| (k, z.splat::<W>(k, i))));
            sum_rows::<W, S::Pack>(target, z.packs(), width, (0..n).map(|k| (k, self.b.splat::<W>(k, i))));
        }
        self.fill::<N, W>(along.l_qq(), h);
    }

    /// The blocks into their places.
    fn fill<const N: usize, const W: usize>(&self, a: &Matrix<S>, h: &mut Matrix<S>) {
        let n = if N > 0 { N } else { a.rows() };
        for i in 0..n {
            let (left, right) = h.row_mut(n + i)[..2 * n].split_at_mut(n);
            self.pq.write_row::<W>(i, left, |pq| -pq);
            self.c.write_row::<W>(i, right, |pp| -pp);
            self.qq.write_row::<W>(i, &mut h.row_mut(i)[..n], |qq| qq);
            h.row_mut(i)[..n].iter_mut().zip(&a.row(i)[..n]).for_each(|(entry, &a)| *entry -= a);
        }
        for i in 0..n {
            for j in 0..i {
                h[(j, i)] = h[(i, j)];
            }
            for j in 0..n {
                h[(i, n + j)] = h[(n + j, i)];
            }
        }
    }
}
