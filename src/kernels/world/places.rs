//! The order of the joints: a subtree is a range of places, and so is a row of a matrix.

use crate::matrix::{Matrix, Panel, write_packs};
use crate::robot::{JointKind, Row, Tree, scaled};
use crate::scalar::{Pack, Scalar};
use std::ops::Range;

/// Where a joint stands in the order.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub joint: usize,
    /// Place of the parent.
    pub parent: Option<usize>,
    /// The joint turns and slides at this many times the rate of this coordinate.
    pub coordinate: usize,
    pub ratio: f64,
    /// First and last place of the free joint that the joint is part of: of its own, if there is none.
    pub first: usize,
    pub last: usize,
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
    /// Whether this is the order of the coordinates.
    in_order: bool,
    /// Whether some joints mimic others.
    sums: bool,
    /// Blocks of rows with packs that hold entries of joints on one branch.
    spans: Vec<(usize, Range<usize>)>,
}

impl Place {
    /// The groups of so many joints that hold its pairs: with the joints beyond, and with those of its own
    /// joint.
    #[inline(always)]
    pub fn groups(&self, lanes: usize) -> Range<usize> {
        self.first / lanes..self.end.div_ceil(lanes)
    }

    /// Velocity of the joint, or its change, from those of the coordinates.
    #[inline(always)]
    pub fn rate<S: Scalar>(&self, v: &[S]) -> S {
        scaled(self.ratio, v[self.coordinate])
    }
}

impl std::ops::Deref for Places {
    type Target = [Place];
    #[inline(always)]
    fn deref(&self) -> &[Place] {
        &self.places
    }
}

/// Blocks of rows with packs, each as long as possible, that hold entries of joints on one branch.
fn spans(places: &[Place], lanes: usize) -> Vec<(usize, Range<usize>)> {
    let blocks = places.len().div_ceil(lanes);
    let mut held = vec![vec![false; blocks]; blocks];
    for (k, place) in places.iter().enumerate() {
        for l in k..place.end {
            (held[k / lanes][l / lanes], held[l / lanes][k / lanes]) = (true, true);
        }
    }
    let mut spans: Vec<(usize, Range<usize>)> = Vec::new();
    for (block, held) in held.iter().enumerate() {
        for pack in (0..blocks).filter(|&pack| held[pack]) {
            match spans.last_mut() {
                Some((last, packs)) if *last == block && packs.end == pack => packs.end += 1,
                _ => spans.push((block, pack..pack + 1)),
            }
        }
    }
    spans
}

impl Places {
    /// For packs of so many lanes.
    pub fn new(tree: &Tree, lanes: usize) -> Self {
        let n = tree.joints().len();
        let mut place_of = vec![0; n];
        let mut places: Vec<Place> = Vec::with_capacity(n);
        // How many joints of the same free joint are before a joint, and beyond it.
        let others = |joint: usize| {
            let parts = tree.free().iter().map(|free| {
                let first = free.joint.turned - free.joint.kind.slides();
                first..first + free.joint.kind.dof()
            });
            let own = parts.into_iter().find(|part| part.contains(&joint)).unwrap_or(joint..joint + 1);
            (joint - own.start, own.end - 1 - joint)
        };
        let roots = (0..n).filter(|&i| tree.joints()[i].parent.is_none());
        for i in roots.flat_map(|root| tree.subtree(root).iter().copied()) {
            let (k, joint) = (places.len(), &tree.joints()[i]);
            place_of[i] = k;
            let parent = joint.parent.map(|parent| place_of[parent]);
            let turns = parent.is_some_and(|p| places[p].turns || places[p].kind == JointKind::Revolute);
            let Row { coordinate, ratio, .. } = tree.row_of(i);
            let (end, kind, (before, beyond)) = (k + tree.subtree(i).len(), joint.kind, others(i));
            let (first, last) = (k - before, k + beyond);
            places.push(Place { joint: i, parent, coordinate, ratio, first, last, end, kind, turns });
        }
        let sums = tree.joint_map().is_some();
        let in_order = !sums && places.iter().enumerate().all(|(k, place)| place.joint == k);
        let spans = spans(&places, lanes);
        Self { places, in_order, sums, spans }
    }

    /// Prepares a vector of the coordinates for [`add`](Self::add).
    #[inline(always)]
    pub fn clear_sums<S: Scalar>(&self, sums: &mut [S]) {
        if self.sums {
            sums.fill(S::zero());
        }
    }

    /// Takes a generalised force of a joint to its coordinate: `G' f`.
    #[inline(always)]
    pub fn add<S: Scalar>(&self, sums: &mut [S], place: &Place, force: S) {
        let sum = &mut sums[place.coordinate];
        *sum = if self.sums { *sum + scaled(place.ratio, force) } else { force };
    }

    /// Whether this is the order of the coordinates.
    #[inline(always)]
    pub fn are_in_order(&self) -> bool {
        self.in_order
    }

    /// Completes a square matrix below its diagonal: entry (j, i), j in the subtree of i, from entry (i, j)
    /// of the lower matrix or, if it is symmetric, of the same.
    #[inline(always)]
    pub fn mirror<S: Scalar>(&self, entries: &mut Panel<S>, lower: Option<&Panel<S>>) {
        let lanes = Panel::<S>::LANES;
        for (top, side) in self.blocks(lanes) {
            let mut block = lower.unwrap_or(entries).block::<0>(top, side);
            S::Pack::transpose(&mut block[..lanes]);
            if side == top {
                let above = entries.block::<0>(top, top);
                for (r, pack) in block.iter_mut().enumerate().take(lanes) {
                    *pack = pack.before(r, above[r]);
                }
            }
            entries.set_block::<0>(side, top, &block);
        }
    }

    /// The same for entries (j, i) and (i, j) of pairs of one free joint, which are those of the rows of a
    /// lower matrix that hold its pairs on both sides of the diagonal.
    #[inline(always)]
    pub fn complete<S: Scalar>(&self, entries: &mut Panel<S>, lower: &Panel<S>) {
        self.for_own_pairs(|i, j| entries.set(i, j, lower.get(j, i)));
        self.mirror(entries, Some(lower));
    }

    /// The same for a symmetric matrix: pairs of one free joint have the mean of both entries.
    #[inline(always)]
    pub fn symmetrise<S: Scalar>(&self, entries: &mut Panel<S>) {
        self.for_own_pairs(|i, j| entries.set(i, j, (entries.get(i, j) + entries.get(j, i)).times(0.5)));
        self.mirror(entries, None);
    }

    /// Calls for each pair i <= j of a free joint.
    #[inline(always)]
    fn for_own_pairs(&self, mut of: impl FnMut(usize, usize)) {
        for (j, place) in self.iter().enumerate().filter(|(_, place)| place.first < place.last) {
            (place.first..=j).for_each(|i| of(i, j));
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
        for (block, packs) in &self.spans {
            let columns = packs.start * lanes..(packs.end * lanes).min(n);
            for i in block * lanes..((block + 1) * lanes).min(n) {
                write_packs(&from.row(i)[packs.clone()], &mut to.row_mut(i)[columns.clone()], |pack| pack);
            }
        }
    }

    /// Takes a square matrix by places to the coordinates: `G' A G` where joints mimic others. Entries of
    /// joints on different branches are left as they are, unless joints mimic others.
    pub fn take_to_coordinates<S: Scalar>(&self, from: &Panel<S>, to: &mut Panel<S>) {
        if !self.sums {
            return self.reorder(from, |i, j, entry| to.set(i, j, entry));
        }
        to.packs_mut().fill(S::Pack::zero());
        let mut add = |row: &Place, column: &Place, entry: S| {
            let (i, j) = (row.coordinate, column.coordinate);
            to.set(i, j, to.get(i, j) + scaled(row.ratio * column.ratio, entry));
        };
        for (k, row) in self.iter().enumerate() {
            add(row, row, from.get(k, k));
            for (l, column) in self.iter().enumerate().take(row.end).skip(k + 1) {
                add(row, column, from.get(k, l));
                add(column, row, from.get(l, k));
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
