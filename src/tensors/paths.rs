//! The path from the root to every joint, and the storage position of a coefficient with given indices.

use crate::robot::{JointKind, Tree};
use std::ops::Range;

/// The ancestors of every joint, in order. A position on a path is the depth of the joint there.
///
/// A coefficient belongs to the deepest joint d among its indices. The coefficients of one d form a block, in
/// which indices are positions on the path to d; h is the position of d itself.
#[derive(Clone, Debug)]
pub(super) struct Paths {
    starts: Vec<usize>,
    joints: Vec<usize>,
    kinds: Vec<JointKind>,
    first: Vec<usize>,
    second: Vec<usize>,
}

impl Paths {
    pub fn new(tree: &Tree) -> Self {
        let mut paths =
            Self { starts: vec![0], joints: Vec::new(), kinds: Vec::new(), first: vec![0], second: vec![0] };
        for (d, joint) in tree.joints().iter().enumerate() {
            if let Some(parent) = joint.parent {
                paths.joints.extend_from_within(paths.starts[parent]..paths.starts[parent + 1]);
            }
            paths.joints.push(d);
            paths.starts.push(paths.joints.len());
            let h = paths.depth(d);
            paths.first.push(paths.first[d] + h * (h + 1));
            paths.second.push(paths.second[d] + beyond(h));
        }
        paths.kinds = paths.joints.iter().map(|&i| tree.joints()[i].kind).collect();
        paths
    }

    /// Number of joints.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Number of ancestors of joint d.
    #[inline]
    pub fn depth(&self, d: usize) -> usize {
        self.starts[d + 1] - self.starts[d] - 1
    }

    /// The joints from the root to d.
    #[inline]
    pub fn of(&self, d: usize) -> &[usize] {
        &self.joints[self.pairs(d)]
    }

    /// Their kinds.
    #[inline]
    pub fn kinds(&self, d: usize) -> &[JointKind] {
        &self.kinds[self.pairs(d)]
    }

    /// Positions of the pairs (i, d), i <= d, in storage.
    #[inline]
    pub fn pairs(&self, d: usize) -> Range<usize> {
        self.starts[d]..self.starts[d + 1]
    }

    /// Number of pairs i <= d.
    pub fn all_pairs(&self) -> usize {
        self.joints.len()
    }

    /// Storage positions of the `Gamma^k_ij`, and of the `M_ij,k`, that belong to d.
    #[inline]
    pub fn first_block(&self, d: usize) -> Range<usize> {
        self.first[d]..self.first[d + 1]
    }

    /// Total number.
    pub fn first_len(&self) -> usize {
        self.first[self.len()]
    }

    /// Storage positions of the `Gamma^k_ij,l`, and of the `M_ij,kl`, that belong to d.
    #[inline]
    pub fn second_block(&self, d: usize) -> Range<usize> {
        self.second[d]..self.second[d + 1]
    }

    /// Total number.
    pub fn second_len(&self) -> usize {
        self.second[self.len()]
    }

    /// The deepest of the joints and the positions of all on its path; `None` unless they lie on one branch.
    pub fn on_one_branch<const N: usize>(&self, joints: [usize; N]) -> Option<(usize, [usize; N])> {
        let positions = joints.map(|joint| self.depth(joint));
        let mut deepest = 0;
        for a in 1..N {
            if positions[a] > positions[deepest] {
                deepest = a;
            }
        }
        let d = joints[deepest];
        let path = self.of(d);
        joints.iter().zip(positions).all(|(&joint, at)| path[at] == joint).then_some((d, positions))
    }
}

/// `r (r + 1)^2 / 2`.
#[inline]
fn beyond(r: usize) -> usize {
    r * (r + 1) * (r + 1) / 2
}

/// Index of the pair i <= j. For pairs i < j without the diagonal, use (i, j - 1).
#[inline]
pub(super) fn triangle(i: usize, j: usize) -> usize {
    j * (j + 1) / 2 + i
}

/// Index of `Gamma^k_id`, i < d, k <= d, in its block.
#[inline]
pub(super) fn gamma(h: usize, k: usize, i: usize) -> usize {
    i * (h + 1) + k
}

/// Index of `M_ij,k`, i <= j, i < k, in its block: rows by i, then the index among j and k that is not d (or
/// d), counted from i.
#[inline]
pub(super) fn mass_first(h: usize, [i, j, k]: [usize; 3]) -> usize {
    let row = i * (2 * h - i + 1);
    if j < h { row + j - i } else { row + (h - i) + (k - i - 1) }
}

/// Index of `Gamma^k_ij,d`, i < j <= d, k <= j, in its block: cases (a) and (b) of (45).
#[inline]
pub(super) fn gamma_by_last(k: usize, i: usize, j: usize) -> usize {
    (j * j * j - j) / 3 + i * (j + 1) + k
}

/// Index of `Gamma^k_id,l`, i < k <= l < d, in its block: case (c) of (45).
#[inline]
pub(super) fn gamma_of_last(h: usize, k: usize, i: usize, l: usize) -> usize {
    h * (h + 1) * (h + 2) / 3 + (l * l * l - l) / 6 + k * (k - 1) / 2 + i
}

/// Index of `M_ij,kl`, i <= j, i < k <= l, in its block.
#[inline]
pub(super) fn mass_second(h: usize, [i, j, k, l]: [usize; 4]) -> usize {
    let r = h - i;
    let start = beyond(h) - beyond(r);
    if l == h {
        return start + (j - i) * r + (k - i - 1);
    }
    let (a, b) = (k - i - 1, l - i - 1);
    start + (r + 1) * r + a * (2 * (r - 1) + 1 - a) / 2 + (b - a)
}
