//! The positions of all joints from the coordinates.

use super::joint::{Joint, Mimic};
use crate::scalar::Scalar;
use std::collections::BTreeMap;
use std::ops::Range;

/// `q_full = G q + b`: the N joints of a tree in which some mimic others, from its n coordinates.
///
/// Row k of G has one entry, the ratio of joint k, in the column of its independent joint. Then `L(q, v) =
/// L_full(G q + b, G v)`: gradients of L become `G' L_full,q`, second derivatives `G' L_full,qq G`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct JointMap {
    rows: Vec<Row>,
    /// The joints of each coordinate, rising; prefix sums of their numbers.
    joints: Vec<usize>,
    starts: Vec<usize>,
    entries: Vec<Entry>,
    terms: Vec<Term>,
}

/// `q_k = ratio q_coordinate + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Row {
    pub coordinate: usize,
    pub ratio: f64,
    pub offset: f64,
}

impl Row {
    /// That of a joint that mimics no other.
    pub fn independent(coordinate: usize) -> Self {
        Self { coordinate, ratio: 1.0, offset: 0.0 }
    }

    /// Position of the joint.
    #[inline(always)]
    pub fn position<S: Scalar>(&self, q: &[S]) -> S {
        self.position_from(q[self.coordinate])
    }

    /// The same from the position of the independent joint.
    #[inline(always)]
    pub fn position_from<S: Scalar>(&self, independent: S) -> S {
        let turned = scaled(self.ratio, independent);
        if self.offset == 0.0 { turned } else { turned.plus(self.offset) }
    }

    /// Velocity of the joint, or its change.
    #[inline(always)]
    pub fn rate<S: Scalar>(&self, v: &[S]) -> S {
        scaled(self.ratio, v[self.coordinate])
    }
}

/// Entries (r, s) and (s, r), r >= s, of `G' A G`: those of `A` that they are sums of.
#[derive(Clone, Debug, PartialEq)]
struct Entry {
    at: [usize; 2],
    terms: Range<usize>,
}

/// Entries (i, j) and (j, i) of A, i a joint of coordinate r, j one of s, and the product of their ratios.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Term {
    pub at: [usize; 2],
    pub factor: f64,
}

impl Term {
    /// The factor of this term in entry `at` of the sums of a symmetric matrix: on their diagonal, entries
    /// (i, j) and (j, i) are one term.
    #[inline(always)]
    pub fn symmetric_factor(&self, at: [usize; 2]) -> f64 {
        if at[0] == at[1] && self.at[0] != self.at[1] { 2.0 * self.factor } else { self.factor }
    }
}

/// `ratio x`; exact, and no operation, for ratios of 1 and -1.
#[inline(always)]
pub(crate) fn scaled<S: Scalar>(ratio: f64, x: S) -> S {
    if ratio == 1.0 {
        x
    } else if ratio == -1.0 {
        -x
    } else {
        x.times(ratio)
    }
}

impl JointMap {
    /// The map of these joints; `None` if all are independent. `pairs` are those of joints whose entries of M
    /// can be other than zero, each once.
    pub fn new(joints: &[Joint], pairs: impl Iterator<Item = (usize, usize)>) -> Option<Self> {
        let rows = rows(joints)?;
        let mut members = vec![Vec::new(); joints.iter().filter(|joint| joint.mimic.is_none()).count()];
        rows.iter().enumerate().for_each(|(i, row)| members[row.coordinate].push(i));
        let ends = members.iter().scan(0, |end, of| {
            *end += of.len();
            Some(*end)
        });
        let starts = std::iter::once(0).chain(ends).collect();
        let mut sums: BTreeMap<[usize; 2], BTreeMap<[usize; 2], f64>> = BTreeMap::new();
        for (i, j) in pairs {
            let (i, j) = if rows[i].coordinate >= rows[j].coordinate { (i, j) } else { (j, i) };
            let entry = sums.entry([rows[i].coordinate, rows[j].coordinate]).or_default();
            entry.insert([i, j], rows[i].ratio * rows[j].ratio);
        }
        let (mut entries, mut terms) = (Vec::new(), Vec::new());
        for (at, of) in sums {
            let start = terms.len();
            terms.extend(of.into_iter().map(|(at, factor)| Term { at, factor }));
            entries.push(Entry { at, terms: start..terms.len() });
        }
        Some(Self { rows, starts, joints: members.into_iter().flatten().collect(), entries, terms })
    }

    /// The row of each joint.
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The joints that move with coordinate `r`, rising.
    pub fn joints_of(&self, r: usize) -> &[usize] {
        &self.joints[self.starts[r]..self.starts[r + 1]]
    }

    /// The places `[r, s]`, r >= s, of the entries of `G' A G` that can be other than zero, with their terms.
    pub fn entries(&self) -> impl Iterator<Item = ([usize; 2], &[Term])> {
        self.entries.iter().map(|entry| (entry.at, &self.terms[entry.terms.clone()]))
    }

    /// `G q + b`.
    pub fn positions<S: Scalar>(&self, q: &[S], all: &mut [S]) {
        for (all, row) in all.iter_mut().zip(&self.rows) {
            *all = row.position(q);
        }
    }

    /// `G v`: velocities, accelerations and directions.
    pub fn rates<S: Scalar>(&self, v: &[S], all: &mut [S]) {
        for (all, row) in all.iter_mut().zip(&self.rows) {
            *all = row.rate(v);
        }
    }

    /// `G' f`: momenta and forces.
    pub fn sum<S: Scalar>(&self, all: &[S], sums: &mut [S]) {
        for (r, sum) in sums.iter_mut().enumerate() {
            let mut terms = self.joints_of(r).iter().map(|&k| scaled(self.rows[k].ratio, all[k]));
            let first = terms.next().unwrap_or(S::zero());
            *sum = terms.fold(first, |sum, term| sum + term);
        }
    }

    /// Numbers that [`positions`](Self::positions), [`rates`](Self::rates) and sums multiply with or add.
    pub fn constants(&self) -> impl Iterator<Item = f64> {
        let ratios = || self.rows.iter().map(|row| row.ratio);
        let of_rows = self.rows.iter().flat_map(|row| [row.ratio, row.offset]);
        let products = ratios().flat_map(move |a| ratios().map(move |b| a * b));
        let cubes = self.rows.iter().map(|row| row.ratio * row.ratio * row.ratio);
        let factors = self.terms.iter().flat_map(|term| [term.factor, 2.0 * term.factor]);
        of_rows.chain(products).chain(cubes).chain(factors)
    }
}

/// The coordinate of each joint; `None` if all are independent.
pub(super) fn rows(joints: &[Joint]) -> Option<Vec<Row>> {
    if joints.iter().all(|joint| joint.mimic.is_none()) {
        return None;
    }
    let mut coordinate = vec![0; joints.len()];
    let independent = (0..joints.len()).filter(|&i| joints[i].mimic.is_none());
    independent.enumerate().for_each(|(k, i)| coordinate[i] = k);
    let row = |(i, joint): (usize, &Joint)| match joint.mimic {
        None => Row::independent(coordinate[i]),
        Some(Mimic { joint, ratio, offset }) => Row { coordinate: coordinate[joint], ratio, offset },
    };
    Some(joints.iter().enumerate().map(row).collect())
}
