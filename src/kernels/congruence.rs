//! Congruence transformations of symmetric matrices by the factors of the mass matrix.

use super::Factor;
use crate::matrix::{Matrix, add_rows};
use crate::scalar::Scalar;

impl<S: Scalar> Factor<S> {
    /// `C <- L'^-1 C L^-1` for a symmetric matrix, n x n.
    ///
    /// Row by row from the last; symmetry saves half of the products, which leaves n^3/2.
    pub fn reduce_symmetric(&self, c: &mut Matrix<S>) {
        let stride = c.columns();
        for i in (0..c.rows()).rev() {
            let terms = self.column_terms(i);
            let (target, after) = c.row_mut_and_after(i);
            add_rows(target, after, stride, terms.clone().map(|(k, factor)| (k - i - 1, factor)));
            complete(c, i, terms);
        }
    }

    /// `C <- U D^-1 C D^-1 U'`, `U = L^-1`, for a symmetric matrix, n x n: after
    /// [`reduce_symmetric`](Self::reduce_symmetric) the product M^-1 C M^-1.
    pub fn expand_symmetric(&self, c: &mut Matrix<S>) {
        let (n, stride) = (c.rows(), c.columns());
        for i in 0..n {
            for j in 0..=i {
                let entry = c[(i, j)] * self.inverse_pivots()[i] * self.inverse_pivots()[j];
                c[(i, j)] = entry;
                c[(j, i)] = entry;
            }
        }
        for k in 0..n {
            let terms = self.row_terms(k);
            let (target, before) = c.row_mut_and_before(k);
            add_rows(target, before, stride, terms.clone());
            complete(c, k, terms);
        }
    }
}

/// `C <- E C E'`, E the identity but for row i with `terms` (k, E_ik), once row i has got its terms: the diagonal, which
/// gets them twice, and column i, the mirror image of row i. Rows still to come find in it what they need of row i.
fn complete<S: Scalar>(c: &mut Matrix<S>, i: usize, terms: impl Iterator<Item = (usize, S)>) {
    let diagonal = terms.fold(c[(i, i)], |sum, (k, factor)| sum + factor * c[(i, k)]);
    c[(i, i)] = diagonal;
    for k in 0..c.rows() {
        c[(k, i)] = c[(i, k)];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{JointSpec, LinkInertia, Robot, Tree};
    use nalgebra::DMatrix;

    /// Two branches of two joints each on a common stem.
    fn tree() -> Tree {
        let mut builder = Robot::builder("fork");
        for (name, parent) in
            [("a", None), ("b", Some("a")), ("c", Some("b")), ("d", Some("a")), ("e", Some("d"))]
        {
            let link = LinkInertia::about_com(1.0, [0.1, 0.0, 0.2], nalgebra::Matrix3::identity());
            let joint = JointSpec::revolute(name).axis([0.0, 1.0, 0.3]).carrying(link);
            builder = builder.joint(if let Some(parent) = parent { joint.on(parent) } else { joint });
        }
        Tree::from(&builder.build().unwrap())
    }

    #[test]
    fn both_halves_are_a_congruence_with_the_inverse() {
        let tree = tree();
        let n = tree.len();
        let symmetric = |from: f64| {
            let mut c = Matrix::zeros(n, n);
            for i in 0..n {
                for j in 0..=i {
                    c[(i, j)] = (from + i as f64 * 1.3 + j as f64 * 0.7).sin();
                    c[(j, i)] = c[(i, j)];
                }
            }
            c
        };
        let mut m = symmetric(0.4);
        (0..n).for_each(|i| m[(i, i)] += 4.0);
        // Joints of different branches do not meet in M.
        for (i, j) in [(1, 3), (1, 4), (2, 3), (2, 4)] {
            m[(i, j)] = 0.0;
            m[(j, i)] = 0.0;
        }
        let mut factor = Factor::new(&tree);
        factor.factor(&m, |k| m[(k, k)]).unwrap();
        let mut c = symmetric(1.1);
        let dense = |m: &Matrix<f64>| DMatrix::from_row_slice(n, n, m.as_slice());
        let inverse = dense(&m).try_inverse().unwrap();
        let expected = &inverse * dense(&c) * &inverse;
        factor.reduce_symmetric(&mut c);
        assert_eq!(dense(&c), dense(&c).transpose());
        factor.expand_symmetric(&mut c);
        assert_eq!(dense(&c), dense(&c).transpose());
        assert!((dense(&c) - expected).amax() < 1e-14);
    }
}
