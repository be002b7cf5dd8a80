//! Limits that are exceeded between points by little.

use super::overshoots::most_moved;
use super::resolution::Resolution;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::points::values::PointDynamics;

/// Which limits move inside.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Inside {
    /// Whether those of torques move, which are cut to their limits anyway.
    pub torques: bool,
}

impl Resolution {
    /// Limits the coefficients of what may jump where it is exceeded anywhere between points, of `torques` or
    /// of all else: then it is not, but for what is no quadratic in an interval. Whether any values were
    /// limited before.
    pub fn take_hulls<D: PointDynamics>(&self, interior: &mut Interior<D>, torques: bool) -> bool {
        let (barrier, shape) = (&mut interior.barrier, interior.spline.mesh.shape);
        let sides: Vec<Side> = barrier.all_sides().copied().collect();
        let at_points = barrier.sides().len();
        let least = constants::MOVED_FROM * constants::VIOLATION_BETWEEN;
        let over = |i: usize, k: usize| match i.checked_sub(at_points) {
            Some(rate) => self.rates.of(k, rate),
            // Jumps that are not resolved stay.
            None if self.overshoots.of(&sides[i]).most[k] > 0.0 => self.excess.of(k, i),
            None => 0.0,
        };
        let counts = |side: &Side| {
            side.limited.jumps(shape) && (side.limited == Limited::Torque) == torques && !side.is_equation
        };
        let exceeds = |i: usize| counts(&sides[i]) && (0..self.violations.len()).any(|k| over(i, k) > least);
        let of = |i: usize| (sides[i].limited, sides[i].joint);
        // Both sides of a limit have the same rows.
        let limits: Vec<_> = (0..sides.len()).filter(|&i| exceeds(i)).map(of).collect();
        let mut any = false;
        for i in (0..sides.len()).filter(|&i| limits.contains(&of(i))) {
            any |= barrier.take_hull(i);
        }
        any
    }

    /// Moves limits inside by what they are exceeded between points, in the intervals where that is too much,
    /// if this may be enough: equations and bodies that pass through each other need narrower intervals.
    /// Whether any were moved.
    pub fn move_limits_inside<D: PointDynamics>(&self, interior: &mut Interior<D>, inside: Inside) -> bool {
        let sides = interior.barrier.sides();
        let (count, shape) = (sides.len(), interior.spline.mesh.shape);
        if shape.is_smooth() {
            return self.move_rates_inside(interior);
        }
        let moves = |i: &usize| !sides[*i].is_equation;
        let most = |k: usize| (0..count).filter(moves).map(|i| self.excess.of(k, i)).fold(0.0, f64::max);
        let enough = |(k, all): (usize, &f64)| *all <= most(k).max(constants::VIOLATION_BETWEEN);
        if !self.violations.iter().enumerate().all(enough) {
            return false;
        }
        let least = constants::MOVED_FROM * constants::VIOLATION_BETWEEN;
        let all = (0..self.violations.len()).flat_map(|k| (0..count).map(move |i| (k, i)));
        // Jumps that are not resolved stay.
        let is_seen = |k: usize, i: usize| {
            !sides[i].limited.jumps(shape) || self.overshoots.of(&sides[i]).most[k] > 0.0
        };
        let counts = |i: usize| inside.torques || sides[i].limited != Limited::Torque;
        let all = all.filter(|&(k, i)| moves(&i) && counts(i) && is_seen(k, i));
        let far: Vec<_> = all
            .map(|(k, i)| (k, i, self.excess.of(k, i)))
            .filter(|&(_, _, over)| over > least)
            .map(|(k, i, over)| {
                let Side { range, limited, .. } = sides[i];
                let most = if limited.jumps(shape) { most_moved(limited) } else { f64::INFINITY };
                (k, i, constants::MOVED * over * range, most * range)
            })
            .collect();
        for (k, i, amount, most) in far {
            interior.barrier.move_inside(k, i, amount, most);
        }
        true
    }

    /// The same of jerks and rates of torques.
    fn move_rates_inside<D: PointDynamics>(&self, interior: &mut Interior<D>) -> bool {
        let ranges: Vec<f64> = interior.barrier.rate_sides().iter().map(|side| side.range).collect();
        let least = constants::MOVED_FROM * constants::VIOLATION_BETWEEN;
        for k in 0..self.violations.len() {
            for (i, range) in ranges.iter().enumerate() {
                let over = self.rates.of(k, i);
                if over > least {
                    let (amount, most) = (constants::MOVED * over * range, constants::MOST_OF_JUMPS * range);
                    interior.barrier.move_rate_inside(k, i, amount, most);
                }
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::between::BETWEEN;
    use super::{Inside, Resolution, constants};
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::limits::side::Limited;
    use crate::direct::motion::shape::Shape;

    const ALL: Inside = Inside { torques: true };

    #[test]
    fn limits_move_only_if_that_may_be_enough() {
        let mut interior = started(Shape::Quartic);
        let sides = interior.barrier.sides();
        let of = |kind: Limited| sides.iter().position(|side| side.limited == kind).unwrap();
        let (count, side, row) = (sides.len(), of(Limited::Rate), of(Limited::Task));
        let (range, of_row) = (sides[side].range, sides[row].range);
        assert!(sides[row].is_equation);
        let part = 5.0 * constants::VIOLATION_BETWEEN;
        let mut resolution = Resolution::default();
        resolution.violations = vec![0.0; 3];
        resolution.overshoots.clear(3);
        let mut distance = vec![1e3; 3 * BETWEEN.len() * count];
        let at = |k: usize, i: usize| count * (BETWEEN.len() * k + 4) + i;
        for i in (0..count).filter(|&i| sides[i].is_equation) {
            (0..3 * BETWEEN.len()).for_each(|p| distance[count * p + i] = 0.0);
        }
        distance[at(1, side)] = -part * range;
        // Peaks of the motion between the places are far below.
        interior.spline.unknowns.fill(0.0);
        resolution.violations[1] = part;
        let shifts = |interior: &super::Interior<_>| -> Vec<f64> {
            let barrier: &crate::direct::limits::barrier::Barrier = &interior.barrier;
            (0..barrier.count()).map(|at| barrier.true_distance(at) - barrier.distance[at]).collect()
        };
        // An equation in the next interval is off as well.
        distance[at(2, row)] = 2.0 * part * of_row;
        resolution.violations[2] = 2.0 * part;
        resolution.excess.measure(&interior.spline, interior.barrier.sides(), &distance);
        assert!(!resolution.move_limits_inside(&mut interior, ALL));
        assert!(shifts(&interior).iter().all(|shift| *shift == 0.0));
        (distance[at(2, row)], resolution.violations[2]) = (0.0, 0.0);
        resolution.excess.measure(&interior.spline, interior.barrier.sides(), &distance);
        assert!(resolution.move_limits_inside(&mut interior, ALL));
        let moved: Vec<f64> = shifts(&interior).into_iter().filter(|shift| *shift != 0.0).collect();
        assert_eq!(moved.len(), 3 + 2);
        let expected = constants::MOVED * part * range;
        assert!(moved.iter().all(|shift| (shift / expected - 1.0).abs() < 1e-6), "{moved:?}");
    }
}
