//! Limits that are moved: inside, so that they are kept between points too; out, where they give.

use super::barrier::Barrier;
use crate::direct::motion::shape::POINTS;

impl Barrier {
    /// Moves the limit of a side inside by `amount` at the points and nodes of an interval, and by `most` in
    /// all.
    pub fn move_inside(&mut self, interval: usize, side: usize, amount: f64, most: f64) {
        self.moved.resize(self.weight.len(), 0.0);
        let points = POINTS * interval..POINTS * (interval + 1);
        let nodes = if side < self.states { interval..interval + 2 } else { 0..0 };
        let entries = points.map(|p| self.at_point(p).start).chain(nodes.map(|k| self.at_node(k).start));
        for first in entries.collect::<Vec<_>>() {
            let moved = &mut self.moved[first + side];
            *moved = (*moved - amount).max(-most);
        }
    }

    /// Moves the limit of a jerk or of the rate of a torque, a side of [`rate_sides`](Self::rate_sides),
    /// inside by `amount` at Gauss's points of an interval, and by `most` in all.
    pub fn move_rate_inside(&mut self, interval: usize, side: usize, amount: f64, most: f64) {
        self.moved.resize(self.weight.len(), 0.0);
        let (first, sides) = (self.first_of_rates() + side, self.rates.len());
        for p in POINTS * interval..POINTS * (interval + 1) {
            let moved = &mut self.moved[first + sides * p];
            *moved = (*moved - amount).max(-most);
        }
    }

    /// Moves the limits of each side out by so much, wherever they are measured along the motion.
    pub fn move_out(&mut self, amount: impl Fn(usize) -> f64) {
        self.moved.clear();
        self.moved.resize(self.weight.len(), 0.0);
        for at in 0..self.first_at_ends() {
            self.moved[at] = self.side_index(at).map_or(0.0, &amount);
        }
    }

    /// How far an entry is inside of its own limit, not the one that was moved.
    pub fn true_distance(&self, at: usize) -> f64 {
        self.distance[at] - self.moved.get(at).copied().unwrap_or(0.0)
    }
}
