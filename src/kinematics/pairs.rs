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
        self.members.extend(0..tree.dof());
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
