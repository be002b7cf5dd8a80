//! Congruence transformations of symmetric matrices by the factors of the mass matrix.

use super::Factor;
use crate::matrix::Panel;
use crate::scalar::Scalar;

impl<S: Scalar> Factor<S> {
    /// `C <- L'^-1 C L^-1` for a symmetric matrix, n x n, in packs of one lane.
    ///
    /// Row by row from the last; symmetry halves the number of products to n^3/2.
    pub(crate) fn reduce_symmetric(&self, c: &mut Panel<S>) {
        let width = c.width::<0>();
        for i in (0..c.rows()).rev() {
            let (_, target, after) = c.split_at_row::<0>(i);
            self.l.minus_columns::<0, 0>(i, target, after, width);
            complete(c, i, self.l.column_terms(i));
        }
    }

    /// `C <- U D^-1 C D^-1 U'`, `U = L^-1`, for a symmetric matrix, n x n, in packs of one lane: after
    /// [`reduce_symmetric`](Self::reduce_symmetric) the product M^-1 C M^-1.
    pub(crate) fn expand_symmetric(&self, c: &mut Panel<S>) {
        let (width, pivots) = (c.width::<0>(), self.inverse_pivots());
        for (i, &pivot) in pivots.iter().enumerate() {
            for (j, &other) in pivots[..=i].iter().enumerate() {
                let entry = c.get(i, j) * pivot * other;
                c.set(i, j, entry);
            }
        }
        c.mirror_lower::<0>();
        for k in 0..c.rows() {
            let (before, target, _) = c.split_at_row::<0>(k);
            self.l.minus_rows(k, target, before, width);
            complete(c, k, self.l.row_terms(k));
        }
    }
}

/// `C <- E C E'`, E the identity but for row i with `terms` (k, E_ik), after row i has been updated:
/// completes the diagonal entry, which needs the terms twice, and copies row i to column i, which later rows
/// read.
#[inline(always)]
fn complete<S: Scalar>(c: &mut Panel<S>, i: usize, terms: impl Iterator<Item = (usize, S)>) {
    let diagonal = terms.fold(c.get(i, i), |sum, (k, factor)| factor.mul_add(c.get(i, k), sum));
    c.set(i, i, diagonal);
    for k in 0..c.rows() {
        c.set(k, i, c.get(i, k));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matrix::Matrix;
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
        let n = tree.dof();
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
        // M has no entries between different branches.
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
        let mut panel = Panel::zeros(n, n);
        panel.read::<0>(&c);
        let mut written = |panel: &Panel<f64>| {
            panel.write(&mut c);
            assert_eq!(dense(&c), dense(&c).transpose());
            dense(&c)
        };
        factor.reduce_symmetric(&mut panel);
        written(&panel);
        factor.expand_symmetric(&mut panel);
        assert!((written(&panel) - expected).amax() < 1e-14);
    }
}
