//! Which entries of a barrier belong to a point, a node, a side or an end, and the other way round.

use super::barrier::Barrier;
use crate::direct::motion::spline::Spline;
use std::ops::Range;

impl Barrier {
    /// The entries of a point: all sides.
    pub fn at_point(&self, p: usize) -> Range<usize> {
        self.sides.len() * p..self.sides.len() * (p + 1)
    }

    /// The entries of a node: the sides of positions and rates.
    pub fn at_node(&self, k: usize) -> Range<usize> {
        let first = self.sides.len() * self.points + self.states * k;
        first..first + self.states
    }

    /// The entries of one of Gauss's points: the sides of jerks and rates of torques.
    pub fn at_gauss_point(&self, p: usize) -> Range<usize> {
        let first = self.first_of_rates() + self.rates.len() * p;
        first..first + self.rates.len()
    }

    /// The entries of the rows at the ends of phases, one side a row: equations, and limits of gaits.
    pub fn at_ends(&self) -> Range<usize> {
        self.first_at_ends()..self.weight.len()
    }

    /// The end of a phase at which a row is, by its entry.
    pub fn end_of(&self, at: usize) -> usize {
        let row = at - self.first_at_ends();
        self.first_at.partition_point(|&first| first <= row) - 1
    }

    pub(super) fn first_of_rates(&self) -> usize {
        self.sides.len() * self.points + self.states * self.nodes
    }

    pub(super) fn first_at_ends(&self) -> usize {
        self.first_of_rates() + self.rates.len() * self.gauss_points
    }

    /// The number of the side of an entry, those of jerks and rates of torques after the others; `None` for a
    /// row at an end.
    pub fn side_index(&self, at: usize) -> Option<usize> {
        let (nodes, rates) = (self.sides.len() * self.points, self.first_of_rates());
        if at < nodes {
            Some(at % self.sides.len())
        } else if at < rates {
            Some((at - nodes) % self.states)
        } else {
            (at < self.first_at_ends()).then(|| self.sides.len() + (at - rates) % self.rates.len())
        }
    }

    /// The entries of a side along the motion, by its number.
    pub fn entries_of(&self, index: usize) -> impl Iterator<Item = usize> {
        let (sides, states, rates) = (self.sides.len(), self.states, self.rates.len());
        let (first_node, first_rate) = (sides * self.points, self.first_of_rates());
        let some = |count: usize, has: bool| if has { 0..count } else { 0..0 };
        let points = some(self.points, index < sides).map(move |p| sides * p + index);
        let nodes = some(self.nodes, index < states).map(move |k| first_node + states * k + index);
        let of_rates = some(self.gauss_points, index >= sides);
        points.chain(nodes).chain(of_rates.map(move |p| first_rate + rates * p + index - sides))
    }

    /// The point of an entry; `None` at nodes and ends.
    pub fn point_of(&self, at: usize) -> Option<usize> {
        (at < self.sides.len() * self.points).then(|| at / self.sides.len())
    }

    /// The number of its point, or of its Gauss's point, of an entry that has one.
    pub fn place_in_interval(&self, at: usize) -> usize {
        match at.checked_sub(self.first_of_rates()) {
            Some(rate) => rate / self.rates.len(),
            None => at / self.sides.len(),
        }
    }

    /// s of an entry.
    pub fn place(&self, at: usize, spline: &Spline) -> f64 {
        let nodes = self.sides.len() * self.points;
        if at < nodes {
            spline.mesh.point(at / self.sides.len()).0
        } else if at < self.first_of_rates() {
            spline.mesh.nodes[(at - nodes) / self.states]
        } else if at < self.first_at_ends() {
            spline.mesh.gauss_point((at - self.first_of_rates()) / self.rates.len()).0
        } else {
            self.end_of(at) as f64
        }
    }
}
