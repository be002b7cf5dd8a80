//! From quantities of all joints to those of the coordinates, for robots with mimic joints.
//!
//! With `q_full = G q + b`, G constant, `L(q, v) = L_full(G q + b, G v)`: gradients of L are `G' L_full,q`,
//! and second derivatives, their changes among them, `G' A G`. The kernels run with all N joints; here rows
//! and columns are summed into n. A robot without mimic joints has no sums, and pays nothing.

use crate::matrix::{Matrix, filled};
use crate::robot::{Tree, scaled};
use crate::scalar::Scalar;

/// A quantity of all joints and, where some of them mimic others, that of the coordinates.
#[derive(Clone, Debug)]
pub(crate) struct Coupled<T> {
    /// Of all N joints.
    pub all: T,
    /// Of the n coordinates; `None` where these are the joints.
    sums: Option<T>,
}

impl<T> Coupled<T> {
    /// A quantity of size N, or n.
    fn new(tree: &Tree, zero: impl Fn(usize) -> T) -> Self {
        let sums = tree.joint_map().map(|_| zero(tree.dof()));
        Self { all: zero(tree.joints().len()), sums }
    }

    /// The quantity of the coordinates.
    #[inline(always)]
    pub fn get(&self) -> &T {
        self.sums.as_ref().unwrap_or(&self.all)
    }
}

impl<S: Scalar> Coupled<Vec<S>> {
    /// A vector of zeros.
    pub fn row(tree: &Tree) -> Self {
        Self::new(tree, |n| filled(S::zero(), n))
    }

    /// `G' f`.
    #[inline(always)]
    pub fn sum(&mut self, tree: &Tree) {
        if let (Some(map), Some(sums)) = (tree.joint_map(), &mut self.sums) {
            map.sum(&self.all, sums);
        }
    }
}

impl<S: Scalar> Coupled<Matrix<S>> {
    /// A matrix of zeros.
    pub fn square(tree: &Tree) -> Self {
        Self::new(tree, |n| Matrix::zeros(n, n))
    }

    /// A matrix of zeros with a column for each joint, and this many rows.
    pub fn columns(tree: &Tree, rows: usize) -> Self {
        Self::new(tree, |n| Matrix::zeros(rows, n))
    }

    /// A matrix of zeros with four square blocks.
    pub fn blocks(tree: &Tree) -> Self {
        Self::new(tree, |n| Matrix::zeros(2 * n, 2 * n))
    }

    /// `J G`.
    #[inline(always)]
    pub fn sum_columns(&mut self, tree: &Tree) {
        if let Some(sums) = &mut self.sums {
            sum_columns(tree, &self.all, sums);
        }
    }

    /// `G' A G` for each of the four blocks A, which may be full.
    #[inline(always)]
    pub fn sum_blocks(&mut self, tree: &Tree) {
        if let Some(sums) = &mut self.sums {
            sum_blocks(tree, &self.all, sums);
        }
    }

    /// `G' A G` for a matrix whose entries are zero where those of M are by the tree.
    #[inline(always)]
    pub fn sum(&mut self, tree: &Tree) {
        if let Some(sums) = &mut self.sums {
            sum_square(tree, &self.all, sums);
        }
    }

    /// The same for a symmetric matrix.
    #[inline(always)]
    pub fn sum_symmetric(&mut self, tree: &Tree) {
        if let Some(sums) = &mut self.sums {
            sum_symmetric(tree, &self.all, sums);
        }
    }
}

#[inline(never)]
fn sum_square<S: Scalar>(tree: &Tree, all: &Matrix<S>, sums: &mut Matrix<S>) {
    for ([r, s], terms) in tree.joint_map().into_iter().flat_map(|map| map.entries()) {
        let mut entries: [Option<S>; 2] = [None; 2];
        for term in terms {
            let [i, j] = term.at;
            add(&mut entries[0], scaled(term.factor, all[(i, j)]));
            if i != j {
                // On the diagonal of the sums both belong to one entry.
                add(&mut entries[usize::from(r != s)], scaled(term.factor, all[(j, i)]));
            }
        }
        sums[(s, r)] = entries[1].unwrap_or(S::zero());
        sums[(r, s)] = entries[0].unwrap_or(S::zero());
    }
}

#[inline(never)]
fn sum_symmetric<S: Scalar>(tree: &Tree, all: &Matrix<S>, sums: &mut Matrix<S>) {
    for ([r, s], terms) in tree.joint_map().into_iter().flat_map(|map| map.entries()) {
        let mut entry = None;
        for term in terms {
            let [i, j] = term.at;
            add(&mut entry, scaled(term.symmetric_factor([r, s]), all[(i, j)]));
        }
        let entry = entry.unwrap_or(S::zero());
        sums[(r, s)] = entry;
        sums[(s, r)] = entry;
    }
}

#[inline(never)]
fn sum_columns<S: Scalar>(tree: &Tree, all: &Matrix<S>, sums: &mut Matrix<S>) {
    for i in 0..sums.rows() {
        tree.joint_map().into_iter().for_each(|map| map.sum(all.row(i), sums.row_mut(i)));
    }
}

#[inline(never)]
fn sum_blocks<S: Scalar>(tree: &Tree, all: &Matrix<S>, sums: &mut Matrix<S>) {
    let Some(map) = tree.joint_map() else { return };
    let (all_half, half) = (all.rows() / 2, sums.rows() / 2);
    sums.fill_zero();
    for [top, left] in [[0, 0], [0, 1], [1, 0], [1, 1]] {
        for (i, row) in map.rows().iter().enumerate() {
            for (j, column) in map.rows().iter().enumerate() {
                let entry = all[(top * all_half + i, left * all_half + j)];
                let at = (top * half + row.coordinate, left * half + column.coordinate);
                sums[at] += scaled(row.ratio * column.ratio, entry);
            }
        }
    }
}

/// Adds a term; the first one costs no addition.
#[inline(always)]
fn add<S: Scalar>(sum: &mut Option<S>, term: S) {
    *sum = Some(sum.map_or(term, |sum| sum + term));
}

/// A vector of all joints, made from one of the coordinates; without mimic joints it is the same.
#[derive(Clone, Debug)]
pub(crate) struct Spread<S>(Vec<S>);

impl<S: Scalar> Spread<S> {
    /// A buffer for a tree; empty without mimic joints.
    pub fn new(tree: &Tree) -> Self {
        Self(tree.joint_map().map_or(Vec::new(), |map| filled(S::zero(), map.rows().len())))
    }

    /// `G q + b`.
    #[inline(always)]
    pub fn positions<'a>(&'a mut self, tree: &Tree, q: &'a [S]) -> &'a [S] {
        let Some(map) = tree.joint_map() else { return q };
        map.positions(q, &mut self.0);
        &self.0
    }

    /// `G v`.
    #[inline(always)]
    pub fn rates<'a>(&'a mut self, tree: &Tree, v: &'a [S]) -> &'a [S] {
        let Some(map) = tree.joint_map() else { return v };
        map.rates(v, &mut self.0);
        &self.0
    }
}

/// `G q + b`: the positions of all joints, from the n coordinates.
#[inline(always)]
pub(crate) fn positions<S: Scalar>(tree: &Tree, q: &[S], all: &mut [S]) {
    match tree.joint_map() {
        None => all.copy_from_slice(q),
        Some(map) => map.positions(q, all),
    }
}

/// `G v`: the velocities of all joints, from those of the n coordinates.
#[inline(always)]
pub(crate) fn rates<S: Scalar>(tree: &Tree, v: &[S], all: &mut [S]) {
    match tree.joint_map() {
        None => all.copy_from_slice(v),
        Some(map) => map.rates(v, all),
    }
}

/// The scale of the rounding error of entry (k, k) of `G' M G` from those of M: of a sum of m terms, at most
/// `m sum_i g_i^2 size_i`.
#[inline(always)]
pub(crate) fn size_of_sum<S: Scalar>(tree: &Tree, k: usize, size_of: impl Fn(usize) -> S) -> S {
    let Some(map) = tree.joint_map() else { return size_of(k) };
    let joints = map.joints_of(k);
    let size = |&i: &usize| scaled(map.rows()[i].ratio * map.rows()[i].ratio, size_of(i));
    let sum = joints.iter().map(size).fold(S::zero(), |sum, size| sum + size);
    sum.times(joints.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::{JointSpec, LinkInertia, Robot};
    use nalgebra::DMatrix;

    /// Joint 2 mimics joint 0 and carries joint 3, which mimics joint 2; joint 4 mimics joint 1.
    fn tree() -> Tree {
        let link = LinkInertia::about_com(1.0, [0.1, 0.0, 0.2], nalgebra::Matrix3::identity());
        let joint = |name: &str| JointSpec::revolute(name).carrying(link);
        let robot = Robot::builder("mimics")
            .joint(joint("a"))
            .joint(joint("b").on("a"))
            .joint(joint("c").on("b").mimicking("a", -2.0, 0.1))
            .joint(joint("d").on("c").mimicking("c", 0.5, 0.3))
            .joint(joint("e").on("a").mimicking("b", -1.0, 0.0));
        Tree::from(&robot.build().unwrap())
    }

    #[test]
    fn sums_are_products_with_the_dense_map() {
        let tree = tree();
        let (all, n) = (tree.joints().len(), tree.dof());
        assert_eq!((all, n), (5, 2));
        let g = DMatrix::from_row_slice(5, 2, &[1.0, 0.0, 0.0, 1.0, -2.0, 0.0, -1.0, 0.0, 0.0, -1.0]);
        let on_one_branch = |i: usize, j: usize| tree.subtree(i).contains(&j) || tree.subtree(j).contains(&i);
        let entry = |i: usize, j: usize| {
            if on_one_branch(i, j) { (1.0 + 1.3 * i as f64 + 0.7 * j as f64).sin() } else { 0.0 }
        };
        let dense = DMatrix::from_fn(all, all, entry);
        let symmetric = &dense + dense.transpose();
        let read = |from: &DMatrix<f64>, to: &mut Matrix<f64>| {
            (0..all).for_each(|i| (0..all).for_each(|j| to[(i, j)] = from[(i, j)]));
        };
        let mut square = Coupled::<Matrix<f64>>::square(&tree);
        for (matrix, is_symmetric) in [(&dense, false), (&symmetric, false), (&symmetric, true)] {
            read(matrix, &mut square.all);
            if is_symmetric {
                square.sum_symmetric(&tree)
            } else {
                square.sum(&tree)
            }
            let sums = DMatrix::from_row_slice(n, n, square.get().as_slice());
            assert!((sums - g.transpose() * matrix * &g).amax() < 1e-14);
        }

        let mut row = Coupled::<Vec<f64>>::row(&tree);
        row.all.copy_from_slice(&[0.3, -0.2, 0.7, 1.1, -0.4]);
        let expected = g.transpose() * DMatrix::from_column_slice(all, 1, &row.all);
        row.sum(&tree);
        assert!((DMatrix::from_column_slice(n, 1, row.get()) - expected).amax() < 1e-15);

        let mut spread = Spread::new(&tree);
        let turned = &g * DMatrix::from_column_slice(n, 1, &[0.4, -0.9]);
        let rates = spread.rates(&tree, &[0.4, -0.9]).to_vec();
        assert_eq!(rates, turned.as_slice());
        let offsets = [0.0, 0.0, 0.1, 0.35, 0.0];
        let moved = spread.positions(&tree, &[0.4, -0.9]).iter().zip(&offsets).map(|(q, b)| q - b);
        assert!(moved.zip(&rates).all(|(a, b)| (a - b).abs() < 1e-15));
    }
}
