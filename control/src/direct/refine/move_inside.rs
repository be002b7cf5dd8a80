//! Limits that are exceeded between points by little.

use super::overshoots::most_moved;
use super::resolution::Resolution;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::points::values::PointDynamics;

/// Which limits move inside, and how far.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Inside {
    /// Whether those of torques move, which are cut to their limits anyway.
    pub torques: bool,
    /// Whether those of what may jump move as far as is of use at once, where they are exceeded.
    pub whole: bool,
}

impl Inside {
    /// How far a limit of what may jump moves that is exceeded by so much, in parts of its range.
    fn amount(self, over: f64) -> f64 {
        if self.whole { constants::MOST_OF_JUMPS } else { constants::MOVED * over }
    }
}

impl Resolution {
    /// Moves limits inside by what they are exceeded between points, in the intervals where that is too much,
    /// if this may be enough: equations and bodies that pass through each other need narrower intervals.
    /// Whether any were moved.
    pub fn move_limits_inside<D: PointDynamics>(&self, interior: &mut Interior<D>, inside: Inside) -> bool {
        let sides = interior.barrier.sides();
        let (count, shape) = (sides.len(), interior.spline.mesh.shape);
        if shape.is_smooth() {
            return self.move_rates_inside(interior, inside);
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
                match limited.jumps(shape) {
                    true => (k, i, inside.amount(over) * range, most_moved(limited) * range),
                    false => (k, i, constants::MOVED * over * range, f64::INFINITY),
                }
            })
            .collect();
        for (k, i, amount, most) in far {
            interior.barrier.move_inside(k, i, amount, most);
        }
        true
    }

    /// The same of jerks and rates of torques, which are about quadratic in an interval. Around a jump from
    /// limit to limit a quadratic whose values at the points are within them is beyond them by up to 4/3 of
    /// them at its ends. Limits that are moved by 2/7 of their range, to 3/7 of what they are, are kept
    /// everywhere.
    fn move_rates_inside<D: PointDynamics>(&self, interior: &mut Interior<D>, inside: Inside) -> bool {
        let ranges: Vec<f64> = interior.barrier.rate_sides().iter().map(|side| side.range).collect();
        let least = constants::MOVED_FROM * constants::VIOLATION_BETWEEN;
        for k in 0..self.violations.len() {
            for (i, range) in ranges.iter().enumerate() {
                let over = self.rates.of(k, i);
                if over > least {
                    let (amount, most) = (inside.amount(over) * range, constants::MOST_OF_JUMPS * range);
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

    const ALL: Inside = Inside { torques: true, whole: false };

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
