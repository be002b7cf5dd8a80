//! Hard limits at the points of a motion, one side at a time.

use super::points::Points;

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

/// Slacks, multipliers and distances of all sides at all points: entry `sides p + i` for side i at point p.
///
/// The distance is `d = sign (value - bound)`; slack and multiplier are positive, and d = s at a solution. A
/// side that is off at a point (the position of an end that is given) has an infinite slack and no
/// multiplier.
#[derive(Clone, Debug, Default)]
pub(crate) struct Barrier {
    pub sides: Vec<Side>,
    pub slack: Vec<f64>,
    pub multiplier: Vec<f64>,
    pub distance: Vec<f64>,
}

impl Barrier {
    /// d from the values at the points.
    pub fn measure(&mut self, points: &Points) {
        measure(&self.sides, points, &mut self.distance);
    }

    /// Sum of multiplier times slack.
    pub fn complementarity(&self) -> f64 {
        let active = self.slack.iter().zip(&self.multiplier).filter(|(slack, _)| slack.is_finite());
        active.map(|(slack, multiplier)| slack * multiplier).sum()
    }
}

/// d from the values at the points.
pub(super) fn measure(sides: &[Side], points: &Points, distance: &mut [f64]) {
    let n = points.dof;
    if sides.is_empty() {
        return;
    }
    for (p, distance) in distance.chunks_exact_mut(sides.len()).enumerate() {
        let (z, tau) = (points.z(p), points.tau(p));
        for (distance, side) in distance.iter_mut().zip(sides) {
            let index = side.index(n);
            let value = if index < 3 * n { z[index] } else { tau[index - 3 * n] };
            *distance = side.sign * (value - side.bound);
        }
    }
}
