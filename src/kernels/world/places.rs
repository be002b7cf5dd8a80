//! The order of the joints: a subtree is a range of places, and so is a row of a matrix.

use crate::matrix::Panel;
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
    /// Whether several joints stand on its link.
    pub branches: bool,
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
            let (end, branches) = (k + tree.subtree(i).len(), tree.children(i).len() > 1);
            places.push(Place { joint: i, parent, end, kind: joint.kind, turns, branches });
        }
        let in_order = places.iter().enumerate().all(|(k, place)| place.joint == k);
        Self { places, in_order }
    }

    /// Puts square blocks of a matrix where they belong, pack by pack: entries (i, j), j in the subtree of i,
    /// from row i of the upper matrix and (j, i) from row i of the lower one. All others are zero.
    ///
    /// `put` takes a row and the number of a pack in it, by places.
    #[inline(always)]
    pub fn spread<S: Scalar>(
        &self,
        upper: &Panel<S>,
        lower: &Panel<S>,
        mut put: impl FnMut(usize, usize, S::Pack),
    ) {
        let (lanes, width, n) = (Panel::<S>::LANES, upper.width::<0>(), self.len());
        let block = |panel: &Panel<S>, top: usize, side: usize| {
            let mut block = [S::Pack::zero(); MOST_LANES];
            for (r, pack) in block.iter_mut().enumerate().take(lanes) {
                *pack = panel.packs()[(top * lanes + r) * width + side];
            }
            block
        };
        for (top, some) in self.chunks(lanes).enumerate() {
            let end = some.iter().fold(0, |end, place| end.max(place.end)).div_ceil(lanes);
            for side in top..end {
                let (above, mut below) = (block(upper, top, side), block(lower, top, side));
                S::Pack::transpose(&mut below[..lanes]);
                for (r, (above, below)) in above.into_iter().zip(below).enumerate().take(lanes) {
                    if side == top {
                        if top * lanes + r < n {
                            put(top * lanes + r, top, below.before(r, above));
                        }
                        continue;
                    }
                    put(top * lanes + r, side, above);
                    if side * lanes + r < n {
                        put(side * lanes + r, top, below);
                    }
                }
            }
        }
    }

    /// Sets the entries of a matrix by joints, from [`spread`](Self::spread).
    #[inline(always)]
    pub fn reorder<S: Scalar>(
        &self,
        mut set: impl FnMut(usize, usize, S),
    ) -> impl FnMut(usize, usize, S::Pack) {
        move |row, pack, entries| {
            let first = pack * Panel::<S>::LANES;
            for (lane, place) in self[first..].iter().enumerate().take(Panel::<S>::LANES) {
                set(self[row].joint, place.joint, entries.lane(lane));
            }
        }
    }

    /// Whether this is the order of the joints.
    #[inline(always)]
    pub fn are_in_order(&self) -> bool {
        self.in_order
    }
}
