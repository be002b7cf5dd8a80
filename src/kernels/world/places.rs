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

    /// Entries (i, j) from row i of the upper matrix and (j, i) from row i of the lower one, j in the subtree
    /// of i, to the rows and columns of the joints. Other entries are left as they are or set to zero.
    #[inline(always)]
    pub fn store<S: Scalar>(&self, upper: &Panel<S>, lower: &Panel<S>, to: &mut Matrix<S>) {
        let lanes = Panel::<S>::LANES;
        if Panel::<S>::ONE_LANE || !self.in_order {
            for (k, place) in self.iter().enumerate() {
                for (l, beyond) in self[..place.end].iter().enumerate().skip(k) {
                    to[(beyond.joint, place.joint)] = lower.get(k, l);
                    to[(place.joint, beyond.joint)] = upper.get(k, l);
                }
            }
            return;
        }
        for (top, some) in self.chunks(lanes).enumerate() {
            let end = some.iter().fold(0, |end, place| end.max(place.end));
            for left in top..end.div_ceil(lanes) {
                store_block(upper, lower, [top, left], to);
            }
        }
    }
}

/// The square block of packs at rows `LANES top`, place `left >= top`, and its mirror image.
#[inline(always)]
fn store_block<S: Scalar>(upper: &Panel<S>, lower: &Panel<S>, [top, left]: [usize; 2], to: &mut Matrix<S>) {
    let (lanes, n) = (Panel::<S>::LANES, to.rows());
    let (first, side) = (top * lanes, left * lanes);
    let mut above = [S::Pack::zero(); MOST_LANES];
    let mut below = above;
    for r in 0..lanes.min(n - first) {
        above[r] = upper.row(first + r)[left];
        below[r] = lower.row(first + r)[left];
    }
    S::Pack::transpose(&mut below[..lanes]);
    if top == left {
        for (r, (above, below)) in above.iter_mut().zip(&below).enumerate().take(lanes) {
            for lane in 0..r {
                *above = above.with_lane(lane, below.lane(lane));
            }
        }
    } else {
        for (r, pack) in below.iter().enumerate().take(lanes.min(n - side)) {
            pack.write(&mut to.row_mut(side + r)[first..]);
        }
    }
    for (r, pack) in above.iter().enumerate().take(lanes.min(n - first)) {
        pack.write(&mut to.row_mut(first + r)[side..]);
    }
}
