//! From the third derivatives of L along a direction to those of H.

use super::conservative::Conservative;
use crate::kernels::KernelTwo;
use crate::matrix::{Matrix, add_rows};
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
pub(super) struct Congruence<S> {
    b: Matrix<S>,
    c: Matrix<S>,
    t: Matrix<S>,
    pq: Matrix<S>,
}

impl<S: Scalar> Congruence<S> {
    /// Buffers for n joints.
    pub fn new(n: usize) -> Self {
        let square = Matrix::zeros(n, n);
        Self { b: square.clone(), c: square.clone(), t: square.clone(), pq: square }
    }

    /// Fills the 2n x 2n matrix h, both triangles; `flow` has come to its second order.
    pub fn apply<K>(&mut self, along: &KernelTwo<S>, flow: &Conservative<S, K>, h: &mut Matrix<S>) {
        let Conservative { factor, z, .. } = flow;
        let n = z.rows();
        self.b.copy_from(along.l_vq());
        factor.solve_first_half(&mut self.b);
        self.c.copy_from(along.mass_matrix());
        factor.reduce_symmetric(&mut self.c);
        self.t.copy_from(&self.b);
        for i in 0..n {
            let row = self.c.row(i).iter().enumerate().map(|(k, &c)| (k, -c));
            add_rows(self.t.row_mut(i), z.as_slice(), n, row);
        }
        factor.divide_by_pivots(&self.t, &mut self.pq);
        factor.solve_second_half(&mut self.pq);
        factor.expand_symmetric(&mut self.c);
        self.fill(along.l_qq(), z, h);
    }

    /// The blocks into their places.
    fn fill(&self, a: &Matrix<S>, z: &Matrix<S>, h: &mut Matrix<S>) {
        let n = z.rows();
        for i in 0..n {
            let (left, right) = h.row_mut(n + i).split_at_mut(n);
            left.iter_mut().zip(self.pq.row(i)).for_each(|(entry, &pq)| *entry = -pq);
            right.iter_mut().zip(self.c.row(i)).for_each(|(entry, &pp)| *entry = -pp);
            let target = &mut h.row_mut(i)[..=i];
            target.iter_mut().zip(a.row(i)).for_each(|(entry, &a)| *entry = -a);
            add_rows(target, self.t.as_slice(), n, (0..n).map(|k| (k, z[(k, i)])));
            add_rows(target, z.as_slice(), n, (0..n).map(|k| (k, self.b[(k, i)])));
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
