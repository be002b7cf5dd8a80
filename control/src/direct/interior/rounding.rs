//! Rounding of what is made of differences of positions: of accelerations and torques over the square of a
//! width, of jerks and rates of torques over its cube.

use super::iterate::Interior;
use crate::constants::direct as constants;
use crate::direct::limits::side::{Limited, Side};

/// The largest factor of a position in the jerk, times the cube of the width and of the time.
const IN_JERKS: f64 = 60.0;
/// The same in an acceleration at a point, times their squares.
const IN_ACCELERATIONS: f64 = 5.0;

impl<D> Interior<D> {
    /// Rounding of a value on an interval of width 1, in its unit: of a derivative of the positions of
    /// this order in time, with this factor of theirs. The points have been contracted before.
    fn rounding(&self, is_torque: bool, joint: usize, factor: f64, order: i32) -> f64 {
        let (spline, n) = (&self.spline, self.spline.dof);
        let fastest = spline.times.iter().copied().fold(f64::INFINITY, f64::min);
        let states = || spline.unknowns.chunks_exact(spline.node()).take(spline.mesh.nodes.len());
        let largest = |joint: usize| states().map(|state| state[joint].abs()).fold(0.0, f64::max);
        let value = if is_torque {
            let inertias = &self.points.tau_z(0)[3 * n * joint + 2 * n..][..n];
            inertias.iter().enumerate().map(|(l, inertia)| inertia.abs() * largest(l)).sum()
        } else {
            largest(joint)
        };
        factor * f64::EPSILON * value / fastest.powi(order)
    }

    /// The same in parts of the ranges of limits, the largest one: of jerks and rates of torques. Zero where
    /// none is limited.
    fn of_rates(&self) -> f64 {
        let of =
            |side: &Side| self.rounding(side.limited != Limited::Jerk, side.joint, IN_JERKS, 3) / side.range;
        self.barrier.rate_sides().iter().map(of).fold(0.0, f64::max)
    }

    /// The same of accelerations and torques.
    fn of_limits(&self) -> f64 {
        let sides = self.barrier.sides().iter();
        let of = |side: &Side| match side.limited {
            Limited::Acceleration | Limited::Torque => {
                let is_torque = side.limited == Limited::Torque;
                self.rounding(is_torque, side.joint, IN_ACCELERATIONS, 2) / side.range
            }
            _ => 0.0,
        };
        sides.map(of).fold(0.0, f64::max)
    }

    /// The same of all torques that cost something, in parts of what would cost as much as the motion.
    fn of_torques(&self) -> f64 {
        let cost = self.figures.size / self.spline.duration();
        let of = |(joint, effort): (usize, &f64)| {
            let part = self.rounding(true, joint, IN_ACCELERATIONS, 2) * (0.5 * effort / cost).sqrt();
            if part.is_finite() { part } else { 0.0 }
        };
        self.running.effort.iter().enumerate().map(of).fold(0.0, f64::max)
    }

    /// The narrowest interval to divide, and the least distance of new nodes.
    pub fn narrowest(&self) -> [f64; 2] {
        let second = self.of_limits().max(self.of_torques());
        let of_torques = (second / constants::ROUNDING_OF_TORQUES).sqrt();
        let of_rates = (self.of_rates() / constants::ROUNDING_OF_RATES).cbrt();
        let narrowest = constants::NARROWEST.max(of_rates);
        let closest = match self.spline.mesh.shape.is_smooth() {
            true => constants::CLOSEST_SMOOTH,
            false => constants::CLOSEST,
        };
        [narrowest.max(of_torques), (closest * narrowest).max(of_torques)]
    }

    /// Violations of limits that may be rounding, in parts of their ranges.
    pub(super) fn find_least_violation(&self) -> f64 {
        let mesh = &self.spline.mesh;
        let width = (0..mesh.intervals()).map(|k| mesh.width(k)).fold(1.0, f64::min);
        let rounding = (self.of_limits() / width.powi(2)).max(self.of_rates() / width.powi(3));
        constants::VIOLATION_AT_POINTS.max(rounding.min(constants::VIOLATION_ACCEPTED))
    }
}

#[cfg(test)]
mod tests {
    use super::constants;
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::limits::side::Limited;
    use crate::direct::motion::shape::Shape;

    /// What the last digit of a position changes in torques and accelerations on the narrowest interval.
    #[test]
    fn the_narrowest_interval_rounds_by_what_is_allowed() {
        let mut interior = started(Shape::Quartic);
        // A motion of a microsecond, whose intervals are short too.
        interior.slow_down(1e-6);
        interior.start(None).unwrap();
        interior.refresh().unwrap();
        let [narrowest, closest] = interior.narrowest();
        assert!(narrowest > constants::NARROWEST && closest == narrowest, "{narrowest} {closest}");
        let width = narrowest.min(0.3);
        interior.move_to(vec![0.0, 0.5, 0.5 + width, 1.0]).unwrap();
        let before = interior.barrier.distance.clone();
        let n = interior.spline.dof;
        let (mut most, allowed) = (0.0_f64, constants::ROUNDING_OF_TORQUES * (narrowest / width).powi(2));
        for at in [2 * n, 2 * n + 1] {
            let kept = interior.spline.unknowns[at];
            interior.spline.unknowns[at] *= 1.0 + f64::EPSILON;
            interior.evaluate().unwrap();
            interior.spline.unknowns[at] = kept;
            let of_points = interior.barrier.points() * interior.barrier.sides().len();
            for (entry, before) in before[..of_points].iter().enumerate() {
                let side = interior.barrier.side(entry);
                if matches!(side.limited, Limited::Torque | Limited::Acceleration) {
                    most = most.max((interior.barrier.distance[entry] - before).abs() / side.range);
                }
            }
        }
        assert!(most < 3.0 * allowed && most > 1e-3 * allowed, "{most} {allowed}");
    }
}
