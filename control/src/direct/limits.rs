//! Hard limits at the points and nodes of a motion, one side at a time.

use super::basis::POINTS;
use super::points::Points;
use super::spline::{Mesh, Spline};
use std::ops::Range;

/// Weight of a node among the limits, as a part of the intervals beside it. At a node only positions and
/// rates are limited; without it rates could swing between the points.
const NODE_WEIGHT: f64 = 0.1;

/// What is limited. The order is that of the values of a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Limited {
    Position,
    Rate,
    Acceleration,
    Torque,
}

/// A limit on one side: `sign (value - bound) >= 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Side {
    pub limited: Limited,
    pub joint: usize,
    /// 1 for a lower bound, -1 for an upper one.
    pub sign: f64,
    pub bound: f64,
    /// Distance to the bound on the other side, or the size of values, if there is none: the unit of
    /// violations.
    pub range: f64,
}

impl Side {
    /// Both sides of a limit; an infinite bound is none.
    pub fn pair(limited: Limited, joint: usize, lower: f64, upper: f64) -> impl Iterator<Item = Self> {
        let range = if (upper - lower).is_finite() {
            upper - lower
        } else {
            [lower, upper]
                .into_iter()
                .filter(|bound| bound.is_finite())
                .fold(1.0, |range: f64, b| range.max(b.abs()))
        };
        [(1.0, lower), (-1.0, upper)]
            .into_iter()
            .filter(|(_, bound)| bound.is_finite())
            .map(move |(sign, bound)| Self { limited, joint, sign, bound, range })
    }

    /// Where its value stands among those of a point: q, v, a, tau.
    pub fn index(&self, n: usize) -> usize {
        self.limited as usize * n + self.joint
    }
}

/// Slacks, multipliers and distances of all sides: first at the points, entry `sides p + i` for side i at
/// point p; then those of positions and rates at the nodes.
///
/// The distance is `d = sign (value - bound)`; slack and multiplier are positive, and d = s at a solution. A
/// side that is off (that of an end that is given) has an infinite slack and neither multiplier nor weight.
#[derive(Clone, Debug, Default)]
pub(crate) struct Barrier {
    sides: Vec<Side>,
    /// Number of sides of positions and rates, which come first.
    states: usize,
    points: usize,
    /// Weight of an entry in the barrier.
    pub weight: Vec<f64>,
    /// One over the range of an entry.
    pub unit: Vec<f64>,
    pub slack: Vec<f64>,
    pub multiplier: Vec<f64>,
    pub distance: Vec<f64>,
}

impl Barrier {
    /// Without entries.
    pub fn new(mut sides: Vec<Side>) -> Self {
        sides.sort_by_key(|side| side.limited);
        let states = sides.partition_point(|side| side.limited < Limited::Acceleration);
        Self { sides, states, ..Self::default() }
    }

    /// Room for the entries of a mesh, with their weights; `is_off` says which sides of the first (0) or last
    /// (1) node are off.
    pub fn resize(&mut self, mesh: &Mesh, is_off: impl Fn(usize, &Side) -> bool) {
        self.points = mesh.points();
        self.weight.clear();
        for p in 0..mesh.points() {
            let weight = mesh.point(p).1;
            self.weight.extend(self.sides.iter().map(|_| weight));
        }
        let last = mesh.intervals();
        for k in 0..=last {
            let left = if k > 0 { mesh.width(k - 1) } else { 0.0 };
            let right = if k < last { mesh.width(k) } else { 0.0 };
            let end = [(0, 0), (last, 1)].into_iter().find(|(node, _)| *node == k).map(|(_, end)| end);
            self.weight.extend(self.sides[..self.states].iter().map(|side| match end {
                Some(end) if is_off(end, side) => 0.0,
                _ => NODE_WEIGHT * (left + right),
            }));
        }
        self.unit.clear();
        for at in 0..self.weight.len() {
            self.unit.push(1.0 / self.side(at).range);
        }
        for vector in [&mut self.slack, &mut self.multiplier, &mut self.distance] {
            vector.clear();
            vector.resize(self.weight.len(), 0.0);
        }
    }

    /// All sides, those of positions and rates first.
    pub fn sides(&self) -> &[Side] {
        &self.sides
    }

    /// Number of entries.
    pub fn count(&self) -> usize {
        self.weight.len()
    }

    /// The entries of a point: all sides.
    pub fn at_point(&self, p: usize) -> Range<usize> {
        self.sides.len() * p..self.sides.len() * (p + 1)
    }

    /// The entries of a node: the sides of positions and rates.
    pub fn at_node(&self, k: usize) -> Range<usize> {
        let first = self.sides.len() * self.points + self.states * k;
        first..first + self.states
    }

    /// The number of the side of an entry.
    pub fn side_index(&self, at: usize) -> usize {
        let nodes = self.sides.len() * self.points;
        if at < nodes { at % self.sides.len() } else { (at - nodes) % self.states }
    }

    /// The side of an entry.
    pub fn side(&self, at: usize) -> &Side {
        &self.sides[self.side_index(at)]
    }

    /// s of an entry.
    pub fn place(&self, at: usize, spline: &Spline) -> f64 {
        let nodes = self.sides.len() * self.points;
        if at < nodes {
            spline.mesh.point(at / self.sides.len()).0
        } else {
            spline.mesh.nodes[(at - nodes) / self.states]
        }
    }

    /// d from the values at the points and nodes.
    pub fn measure(&self, spline: &Spline, points: &Points, distance: &mut [f64]) {
        if self.sides.is_empty() {
            return;
        }
        let n = points.dof;
        let (at_points, at_nodes) = distance.split_at_mut(self.sides.len() * points.count());
        measure(&self.sides, points, at_points);
        if self.states == 0 {
            return;
        }
        let rate = 1.0 / spline.time;
        for (distance, state) in at_nodes.chunks_exact_mut(self.states).zip(spline.unknowns.chunks(2 * n)) {
            for (distance, side) in distance.iter_mut().zip(&self.sides) {
                let factor = if side.limited == Limited::Rate { rate } else { 1.0 };
                *distance = side.sign * (factor * state[side.index(n)] - side.bound);
            }
        }
    }

    /// Sum of multiplier times slack.
    pub fn complementarity(&self) -> f64 {
        let on = self.slack.iter().zip(&self.multiplier).filter(|(slack, _)| slack.is_finite());
        on.map(|(slack, multiplier)| slack * multiplier).sum()
    }

    /// Sum of all weights.
    pub fn total_weight(&self) -> f64 {
        self.weight.iter().sum()
    }
}

/// d from the values at points.
pub(super) fn measure(sides: &[Side], points: &Points, distance: &mut [f64]) {
    let n = points.dof;
    for (p, distance) in distance.chunks_exact_mut(sides.len()).enumerate() {
        let (z, tau) = (points.z(p), points.tau(p));
        for (distance, side) in distance.iter_mut().zip(sides) {
            let index = side.index(n);
            let value = if index < 3 * n { z[index] } else { tau[index - 3 * n] };
            *distance = side.sign * (value - side.bound);
        }
    }
}

/// The multipliers of a motion over its weights, at the points.
#[derive(Clone, Debug)]
pub(super) struct Multipliers {
    places: Vec<f64>,
    sides: usize,
    /// All sides of a point, one point after the other.
    densities: Vec<f64>,
}

impl Multipliers {
    /// Those of a motion. A node shares its multipliers between the points beside it.
    pub fn of(spline: &Spline, barrier: &Barrier) -> Self {
        let (sides, points) = (barrier.sides.len(), barrier.points);
        let mut densities = barrier.multiplier[..sides * points].to_vec();
        for k in 0..spline.mesh.nodes.len() {
            for (i, at) in barrier.at_node(k).enumerate() {
                let beside =
                    [(k > 0).then(|| POINTS * k - 1), (k < spline.mesh.intervals()).then_some(POINTS * k)];
                let count = beside.iter().flatten().count() as f64;
                for p in beside.into_iter().flatten() {
                    densities[sides * p + i] += barrier.multiplier[at] / count;
                }
            }
        }
        densities.iter_mut().zip(&barrier.weight).for_each(|(density, weight)| *density /= weight);
        Self { places: (0..points).map(|p| spline.mesh.point(p).0).collect(), sides, densities }
    }

    /// At a point.
    pub fn at_point(&self, p: usize, side: usize) -> f64 {
        self.densities[self.sides * p + side]
    }

    /// Linear between the points.
    pub fn density(&self, s: f64, side: usize) -> f64 {
        let last = self.places.len() - 1;
        let right = self.places.partition_point(|&place| place < s).clamp(1, last);
        let (a, b) = (self.places[right - 1], self.places[right]);
        let part = ((s - a) / (b - a)).clamp(0.0, 1.0);
        let of = |p: usize| self.at_point(p, side);
        (1.0 - part) * of(right - 1) + part * of(right)
    }
}
