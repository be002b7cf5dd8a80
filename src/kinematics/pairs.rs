//! Symmetric matrices with one product for each pair of joints, one of which moves the other.

use crate::matrix::Matrix;
use crate::robot::Tree;
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// The symmetric matrix with the entries `H_ij = a_i . b_j` where joint i is j or nearer to the base on its
/// path, zero for all other pairs.
#[derive(Clone, Debug)]
pub(super) struct OrderedPairs<S> {
    /// a.
    pub inner: Vec<Vec3<S>>,
    /// b.
    pub outer: Vec<Vec3<S>>,
    /// The joints that count, parents before children.
    members: Vec<usize>,
    below: Vec<Vec3<S>>,
    beyond: Vec<Vec3<S>>,
}

impl<S: Scalar> OrderedPairs<S> {
    pub fn new(n: usize) -> Self {
        let zero = vec![Vec3::zero(); n];
        Self {
            inner: zero.clone(),
            outer: zero.clone(),
            members: Vec::with_capacity(n),
            below: zero.clone(),
            beyond: zero,
        }
    }

    /// Takes the joints that move joint `k`.
    pub fn take_path(&mut self, tree: &Tree, k: Option<usize>) {
        self.members.clear();
        self.members.extend(tree.path(k));
        self.members.reverse();
    }

    /// Takes all joints.
    pub fn take_all(&mut self, tree: &Tree) {
        self.members.clear();
        self.members.extend(0..tree.joints().len());
    }

    /// The matrix, both triangles, n x n.
    #[inline(never)]
    pub fn fill(&self, tree: &Tree, matrix: &mut Matrix<S>) {
        matrix.fill_zero();
        for &j in &self.members {
            let b = self.outer[j];
            for i in tree.path(Some(j)) {
                let entry = self.inner[i].dot(b);
                matrix[(i, j)] = entry;
                matrix[(j, i)] = entry;
            }
        }
    }

    /// The product of the matrix with d (n), to `product` (n); O(n), without the matrix:
    /// `(H d)_j = b_j . sum of a_i d_i (i up to j) + a_j . sum of b_l d_l (l beyond j)`.
    #[inline(never)]
    pub fn multiply(&mut self, tree: &Tree, d: &[S], product: &mut [S]) {
        product.fill(S::zero());
        for &j in &self.members {
            let before = tree.joints()[j].parent.map_or(Vec3::zero(), |parent| self.below[parent]);
            self.below[j] = before + self.inner[j].scaled(d[j]);
            self.beyond[j] = Vec3::zero();
        }
        for &j in self.members.iter().rev() {
            let beyond = self.beyond[j];
            product[j] = self.outer[j].dot(self.below[j]) + self.inner[j].dot(beyond);
            if let Some(parent) = tree.joints()[j].parent {
                self.beyond[parent] = self.beyond[parent] + beyond + self.outer[j].scaled(d[j]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{JointSpec, LinkInertia, Robot};

    #[test]
    fn the_product_is_that_with_the_matrix_on_paths_and_on_the_whole_tree() {
        let joint = |name: &str| JointSpec::revolute(name).carrying(LinkInertia::point(1.0, [1.0, 0.0, 0.0]));
        let robot =
            Robot::builder("tree").joint(joint("a")).joint(joint("b").on("a")).joint(joint("c").on("a"));
        let robot = robot.joint(joint("d").on("c")).joint(joint("e")).build().unwrap();
        let (tree, n) = (Tree::from(&robot), 5);
        let mut pairs = OrderedPairs::<f64>::new(n);
        for j in 0..n {
            let vector = |k: f64| Vec3::constant([k.sin(), (2.0 * k).cos(), k - 2.0]);
            (pairs.inner[j], pairs.outer[j]) = (vector(j as f64), vector(7.0 - j as f64));
        }
        let d = [0.3, -1.0, 2.0, 0.7, -0.4];
        let (mut matrix, mut product) = (Matrix::zeros(n, n), vec![0.0; n]);
        for k in [None, Some(1), Some(3), Some(4)] {
            if k.is_none() {
                pairs.take_all(&tree)
            } else {
                pairs.take_path(&tree, k)
            }
            pairs.fill(&tree, &mut matrix);
            pairs.multiply(&tree, &d, &mut product);
            for (i, product) in product.iter().enumerate() {
                let expected: f64 = (0..n).map(|j| matrix[(i, j)] * d[j]).sum();
                assert!((product - expected).abs() < 1e-14, "{k:?} {i}");
            }
            assert_eq!(matrix[(1, 3)], 0.0, "branches do not move each other");
            assert_eq!(matrix[(0, 3)] == 0.0, k == Some(1) || k == Some(4));
        }
    }
}
