//! Rounding of jerks and rates of torques, which are differences of positions over the cube of a width.

use super::iterate::Interior;
use crate::constants::direct as constants;
use crate::direct::limits::side::{Limited, Side};

/// The largest factor of a position in the jerk, times the cube of the width and of the time.
const LARGEST: f64 = 60.0;

impl<D> Interior<D> {
    /// Rounding of the limited values, in parts of their ranges, on an interval of width 1. The points have
    /// been contracted before. Zero where no jerk and no rate of a torque is limited.
    fn rounding(&self) -> f64 {
        let (spline, n) = (&self.spline, self.spline.dof);
        let fastest = spline.times.iter().copied().fold(f64::INFINITY, f64::min);
        let states = || spline.unknowns.chunks_exact(spline.node()).take(spline.mesh.nodes.len());
        let of = |side: &Side| {
            let largest = states().map(|state| state[side.joint].abs()).fold(0.0, f64::max);
            let inertia = match side.limited {
                Limited::Jerk => 1.0,
                _ => self.points.tau_z(0)[3 * n * side.joint + 2 * n + side.joint],
            };
            LARGEST * f64::EPSILON * inertia * largest / (side.range * fastest.powi(3))
        };
        self.barrier.rate_sides().iter().map(of).fold(0.0, f64::max)
    }

    /// The narrowest interval to divide.
    pub fn narrowest(&self) -> f64 {
        constants::NARROWEST.max((self.rounding() / constants::ROUNDING_OF_RATES).cbrt())
    }

    /// Violations of limits that may be rounding, in parts of their ranges.
    pub(super) fn find_least_violation(&self) -> f64 {
        let mesh = &self.spline.mesh;
        let width = (0..mesh.intervals()).map(|k| mesh.width(k)).fold(1.0, f64::min);
        let rounding = self.rounding() / width.powi(3);
        constants::VIOLATION_AT_POINTS.max(rounding.min(constants::VIOLATION_ACCEPTED))
    }
}
