//! Hard limits at the points, nodes and ends of a motion, one side at a time.

use super::ends::Ends;
use super::side::{Limited, Side};
use crate::constants::direct::NODE_WEIGHT;
use crate::direct::motion::mesh::Mesh;

/// Slacks, multipliers and distances of all sides: first at the points, entry `sides p + i` for side i at
/// point p; then those of positions and rates at the nodes, unless these are points; then those of jerks and
/// rates of torques at Gauss's points; then the rows of tasks at the ends of phases.
///
/// The distance is `d = sign (value - bound)`; slack and multiplier are positive, and d = s at a
/// solution. A side that is off (that of an end that is given) has an infinite slack and neither
/// multiplier nor weight. An equation has no slack, s = 0, and a multiplier of either sign; `d^2
/// stiffness weight / (2 range^2)` is added to the cost, so that Newton's matrix stays positive definite
/// (the proximal method of multipliers: each step takes d to what the change of the multiplier over that
/// stiffness leaves).
#[derive(Clone, Debug, Default)]
pub(crate) struct Barrier {
    pub(super) sides: Vec<Side>,
    /// Sides of jerks and rates of torques.
    pub(super) rates: Vec<Side>,
    /// Number of sides of positions and rates, which come first, at a node; none where nodes are points.
    pub(super) states: usize,
    /// Rows of tasks at the ends of phases, one end after the other.
    pub(super) at_ends: Vec<Side>,
    /// The first of them at each end, and their number.
    pub(super) first_at: Vec<usize>,
    pub(super) points: usize,
    pub(super) gauss_points: usize,
    pub(super) nodes: usize,
    /// Sum of the weights of all limits without the equations.
    total_weight: f64,
    /// The entries of equations that count.
    pub(super) equations: Vec<usize>,
    /// What the square of an equation costs, of weight and range one.
    pub stiffness: f64,
    /// Weight of an entry in the barrier.
    pub weight: Vec<f64>,
    /// One over the range of an entry.
    pub unit: Vec<f64>,
    pub slack: Vec<f64>,
    pub multiplier: Vec<f64>,
    pub distance: Vec<f64>,
    /// How far the limit of an entry is moved out; inside where it is negative, so that it is kept between
    /// points too. Empty on most meshes.
    pub(super) moved: Vec<f64>,
    /// Whether entries are rows of a program, with multipliers of their own: nothing is eliminated, and
    /// gradients at mu = 0 are those of the cost.
    pub is_apart: bool,
    /// For each side whether its coefficients are limited ([`is_hull`](Self::is_hull)); empty for none.
    pub(super) hulls: Vec<bool>,
}

impl Barrier {
    /// Without entries; `at_ends` has the sides at each end of a phase.
    pub fn new(mut sides: Vec<Side>, at_ends: &[Vec<Side>]) -> Self {
        sides.sort_by_key(|side| side.limited);
        let rates = sides.split_off(sides.partition_point(|side| side.limited < Limited::Jerk));
        let first_at = (0..=at_ends.len()).map(|end| at_ends[..end].iter().map(Vec::len).sum()).collect();
        Self { sides, rates, first_at, at_ends: at_ends.concat(), ..Self::default() }
    }

    /// The same without entries, each equation of a task along the motion as two limits. Laws of physics stay
    /// equations: no motion is without them.
    pub fn with_halves(&self) -> Self {
        let sides = self.all_sides().flat_map(|side| side.halves()).collect();
        Self { at_ends: self.at_ends.clone(), first_at: self.first_at.clone(), ..Self::new(sides, &[]) }
    }

    /// Largest violation of each side, in parts of its range; 0 for none.
    pub fn violations(&self) -> Vec<f64> {
        let mut most = vec![0.0_f64; self.all_sides().count()];
        for at in (0..self.weight.len()).filter(|&at| self.weight[at] > 0.0) {
            if let Some(side) = self.side_index(at) {
                most[side] = most[side].max(self.side(at).violation(self.distance[at]));
            }
        }
        most
    }

    /// Ranges of all sides.
    pub fn ranges(&self) -> Vec<f64> {
        self.all_sides().map(|side| side.range).collect()
    }

    /// Measures sides in other ranges; for the entries of the next mesh.
    pub fn set_ranges(&mut self, ranges: &[f64]) {
        let sides = self.sides.iter_mut().chain(&mut self.rates);
        sides.zip(ranges).for_each(|(side, &range)| side.range = range);
    }

    /// Room for the entries of a mesh, with their weights.
    pub fn resize(&mut self, mesh: &Mesh, ends: &Ends) {
        self.points = mesh.points();
        self.gauss_points = mesh.gauss_points();
        self.nodes = mesh.nodes.len();
        self.states = match mesh.shape.is_smooth() {
            true => 0,
            false => self.sides.partition_point(|side| side.limited < Limited::Acceleration),
        };
        self.weight.clear();
        for p in 0..mesh.points() {
            let weight = mesh.point(p).1;
            let on = |side: &Side| !ends.is_settled(mesh, p, side);
            self.weight.extend(self.sides.iter().map(|side| if on(side) { weight } else { 0.0 }));
        }
        let last = mesh.intervals();
        for k in 0..=last {
            let left = if k > 0 { mesh.width(k - 1) } else { 0.0 };
            let right = if k < last { mesh.width(k) } else { 0.0 };
            let end = mesh.end_at(k);
            self.weight.extend(self.sides[..self.states].iter().map(|side| match end {
                Some(end) if ends.is_given(end, side) => 0.0,
                _ if k > 0 && ends.is_impulse(side) => 0.0,
                _ => NODE_WEIGHT * (left + right),
            }));
        }
        for p in 0..mesh.gauss_points() {
            let weight = mesh.gauss_point(p).1;
            self.weight.extend(self.rates.iter().map(|_| weight));
        }
        self.weight.extend(self.at_ends.iter().map(|_| 1.0));
        let limits = (0..self.weight.len()).filter(|&at| !self.side(at).is_equation);
        self.total_weight = limits.map(|at| self.weight[at]).sum();
        self.equations.clear();
        for at in (0..self.weight.len()).filter(|&at| self.weight[at] > 0.0) {
            if self.side(at).is_equation {
                self.equations.push(at);
            }
        }
        self.unit.clear();
        for at in 0..self.weight.len() {
            self.unit.push(1.0 / self.side(at).range);
        }
        self.moved.clear();
        for vector in [&mut self.slack, &mut self.multiplier, &mut self.distance] {
            vector.clear();
            vector.resize(self.weight.len(), 0.0);
        }
    }

    /// The sides at the points, those of positions and rates first.
    pub fn sides(&self) -> &[Side] {
        &self.sides
    }

    /// Those at the points, then those of jerks and of rates of torques: in the order of their numbers.
    pub fn all_sides(&self) -> impl Iterator<Item = &Side> {
        self.sides.iter().chain(&self.rates)
    }

    /// The sides of jerks, then those of rates of torques.
    pub fn rate_sides(&self) -> &[Side] {
        &self.rates
    }

    /// Number of entries.
    pub fn count(&self) -> usize {
        self.weight.len()
    }

    /// Gives a row at an end another bound.
    pub fn set_end_bound(&mut self, end: usize, row: usize, bound: f64) {
        self.at_ends[self.first_at[end] + row].bound = bound;
    }

    /// How far the limit of an entry is moved out.
    pub fn moved_by(&self, at: usize) -> f64 {
        self.moved.get(at).copied().unwrap_or(0.0)
    }

    /// Number of intervals.
    pub(super) fn intervals(&self) -> usize {
        self.nodes - 1
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.points
    }

    /// A side by its number.
    #[inline(always)]
    pub fn numbered(&self, index: usize) -> &Side {
        self.sides.get(index).unwrap_or_else(|| &self.rates[index - self.sides.len()])
    }

    /// The side of an entry.
    pub fn side(&self, at: usize) -> &Side {
        match self.side_index(at) {
            Some(index) => self.numbered(index),
            None => &self.at_ends[at - self.first_at_ends()],
        }
    }

    /// Whether an entry counts and is no equation.
    #[inline(always)]
    pub fn is_limit(&self, at: usize) -> bool {
        let slack = self.slack[at];
        slack > 0.0 && slack.is_finite()
    }

    /// The entries of equations that count.
    pub fn equations(&self) -> impl Iterator<Item = usize> {
        self.equations.iter().copied()
    }

    /// Whether an entry counts.
    #[inline(always)]
    pub fn is_on(&self, at: usize) -> bool {
        self.slack[at].is_finite()
    }

    /// Second derivative by the distance of an entry that counts, whose slack and multiplier are eliminated.
    #[inline(always)]
    pub fn curvature(&self, at: usize) -> f64 {
        if self.is_apart {
            return 0.0;
        }
        let slack = self.slack[at];
        if slack > 0.0 {
            return self.multiplier[at] / slack;
        }
        self.stiffness * self.weight[at] * self.unit[at] * self.unit[at]
    }

    /// Whether accelerations are continuous.
    pub fn is_smooth(&self) -> bool {
        self.gauss_points > 0
    }

    /// Sum of the weights of all limits without the equations.
    pub fn total_weight(&self) -> f64 {
        self.total_weight
    }
}
