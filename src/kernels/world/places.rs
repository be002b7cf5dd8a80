//! The order of the joints: a subtree is a range of places, and so is a row of a matrix.

use crate::matrix::{Matrix, Panel};
use crate::robot::{JointKind, Tree};
use crate::scalar::{MOST_LANES, Pack, Scalar};

/// Where a joint stands in the order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub joint: usize,
    /// Place of the parent.
    pub parent: Option<usize>,
    /// One after the last place of the subtree.
    pub end: usize,
    pub kind: JointKind,
    /// Whether a joint before it on its branch is revolute.
    pub turns: bool,
}

/// The joints depth first.
#[derive(Clone, Debug)]
pub(super) struct Places {
    places: Vec<Place>,
    /// Whether this is the order of the joints.
    in_order: bool,
}

impl std::ops::Deref for Places {
    type Target = [Place];
    #[inline(always)]
    fn deref(&self) -> &[Place] {
        &self.places
    }
}

impl Places {
    pub fn new(tree: &Tree) -> Self {
        let n = tree.dof();
        let mut place_of = vec![0; n];
        let mut places: Vec<Place> = Vec::with_capacity(n);
        let roots = (0..n).filter(|&i| tree.joints()[i].parent.is_none());
        for i in roots.flat_map(|root| tree.subtree(root).iter().copied()) {
            let (k, joint) = (places.len(), &tree.joints()[i]);
            place_of[i] = k;
            let parent = joint.parent.map(|parent| place_of[parent]);
            let turns = parent.is_some_and(|p| places[p].turns || places[p].kind == JointKind::Revolute);
            places.push(Place { joint: i, parent, end: k + tree.subtree(i).len(), kind: joint.kind, turns });
        }
        let in_order = places.iter().enumerate().all(|(k, place)| place.joint == k);
        Self { places, in_order }
    }

    /// Whether this is the order of the joints.
    #[inline(always)]
    pub fn are_in_order(&self) -> bool {
        self.in_order
    }

    /// Completes a square matrix below its diagonal: entry (j, i), j in the subtree of i, from entry (i, j)
    /// of the lower matrix or, if it is symmetric, of the same.
    #[inline(always)]
    pub fn mirror<S: Scalar>(&self, entries: &mut Panel<S>, lower: Option<&Panel<S>>) {
        let (lanes, width) = (Panel::<S>::LANES, entries.width::<0>());
        for (top, side) in self.blocks(lanes) {
            let mut block = [S::Pack::zero(); MOST_LANES];
            let rows = lower.unwrap_or(entries).packs();
            for (r, pack) in block.iter_mut().enumerate().take(lanes) {
                *pack = rows[(top * lanes + r) * width + side];
            }
            S::Pack::transpose(&mut block[..lanes]);
            let rows = entries.packs_mut();
            for (r, pack) in block.iter().enumerate().take(lanes) {
                let to = &mut rows[(side * lanes + r) * width + top];
                *to = if side > top { *pack } else { pack.before(r, *to) };
            }
        }
    }

    /// Blocks (a, b), a <= b, of rows and packs that hold entries of joints on one branch.
    #[inline(always)]
    fn blocks(&self, lanes: usize) -> impl Iterator<Item = (usize, usize)> {
        self.chunks(lanes).enumerate().flat_map(move |(top, some)| {
            let end = some.iter().fold(0, |end, place| end.max(place.end)).div_ceil(lanes);
            (top..end).map(move |side| (top, side))
        })
    }

    /// Sets the entries of joints on one branch in a matrix by joints from one by places, n x n; others are
    /// left as they are.
    #[inline(never)]
    pub fn write<S: Scalar>(&self, from: &Panel<S>, to: &mut Matrix<S>) {
        if !self.in_order {
            return self.reorder(from, |i, j, entry| to[(i, j)] = entry);
        }
        let (lanes, n) = (Panel::<S>::LANES, self.len());
        for (a, b) in self.blocks(lanes) {
            for (top, side) in [(a, b), (b, a)] {
                let columns = side * lanes..((side + 1) * lanes).min(n);
                for i in top * lanes..((top + 1) * lanes).min(n) {
                    from.row(i)[side].write(&mut to.row_mut(i)[columns.clone()]);
                }
            }
        }
    }

    /// Sets entry (i, j) of the joints from a square matrix by places, for joints on one branch.
    pub fn reorder<S: Scalar>(&self, from: &Panel<S>, mut set: impl FnMut(usize, usize, S)) {
        for (k, row) in self.iter().enumerate() {
            for (l, column) in self.iter().enumerate().take(row.end).skip(k) {
                set(row.joint, column.joint, from.get(k, l));
                set(column.joint, row.joint, from.get(l, k));
            }
        }
    }
}
