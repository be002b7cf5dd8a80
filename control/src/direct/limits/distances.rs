//! How far a motion is from its limits.

use super::at_node::AtNode;
use super::barrier::Barrier;
use super::side::{Limited, Side};
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::Points;

impl Barrier {
    /// Gives sides along the motion other bounds.
    pub fn set_bounds(&mut self, which: impl Fn(&Side) -> bool, bound: impl Fn(&Side) -> f64) {
        for side in self.sides.iter_mut().filter(|side| which(side)) {
            side.bound = bound(side);
        }
    }

    /// d from the values at the points and nodes.
    pub fn measure(&self, spline: &Spline, points: &Points, distance: &mut [f64]) {
        let (others, at_ends) = distance.split_at_mut(self.first_at_ends());
        for ((distance, side), g) in at_ends.iter_mut().zip(&self.at_ends).zip(&points.ends.g) {
            *distance = side.sign * (g - side.bound);
        }
        let (others, of_rates) = others.split_at_mut(self.first_of_rates());
        let n = points.dof;
        let values = points.rates.jerk.chunks_exact(n).zip(points.rates.torque.chunks_exact(n));
        measure_rates(&self.rates, values, of_rates);
        if !self.sides.is_empty() {
            let (at_points, at_nodes) = others.split_at_mut(self.sides.len() * points.count());
            measure(&self.sides, points, at_points);
            for (k, distance) in at_nodes.chunks_exact_mut(self.states.max(1)).enumerate() {
                let node = AtNode::new(spline, k);
                for (distance, side) in distance.iter_mut().zip(&self.sides) {
                    *distance = side.sign * (node.of(side).value - side.bound);
                }
            }
        }
        self.take_coefficients(distance);
        distance.iter_mut().zip(&self.moved).for_each(|(distance, moved)| *distance += moved);
    }
}

/// d from jerks and rates of torques.
pub(crate) fn measure_rates<'a>(
    sides: &[Side],
    values: impl Iterator<Item = (&'a [f64], &'a [f64])>,
    distance: &mut [f64],
) {
    if sides.is_empty() {
        return;
    }
    for (distance, (jerk, torque)) in distance.chunks_exact_mut(sides.len()).zip(values) {
        for (distance, side) in distance.iter_mut().zip(sides) {
            let values = if side.limited == Limited::Jerk { jerk } else { torque };
            *distance = side.sign * (values[side.joint] - side.bound);
        }
    }
}

/// d from the values at points.
pub(crate) fn measure(sides: &[Side], points: &Points, distance: &mut [f64]) {
    let n = points.dof;
    for (p, distance) in distance.chunks_exact_mut(sides.len()).enumerate() {
        let (z, tau, g, h) = (points.z(p), points.tau(p), points.g(p), points.h(p));
        for (distance, side) in distance.iter_mut().zip(sides) {
            let value = match side.limited {
                Limited::Torque => tau[side.joint],
                Limited::Power | Limited::TorqueSpeed | Limited::ToolAcceleration => h[side.joint],
                Limited::Task => g[side.joint],
                _ => z[side.index(n)],
            };
            *distance = side.sign * (value - side.bound);
        }
    }
}
