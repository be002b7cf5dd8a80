//! How smooth a motion is: its unknowns at nodes and in intervals, and the points of an interval.
//!
//! Where neither jerks nor rates of torques are limited or cost anything, accelerations may jump, and on an
//! interval of width h the position is a polynomial of degree four: the cubic with the positions and first
//! derivatives of both ends, and a bubble that vanishes at both ends with its first derivative. The
//! acceleration is a quadratic, which may jump at the nodes. It has as many values at Gauss's three points as
//! the polynomial has coefficients beside the state at its left end, so torques at limits determine the
//! motion, and multipliers of torques are costates.
//!
//! Otherwise accelerations are continuous, and the position is the quintic with the positions and the first
//! two derivatives of both ends. Now the jerk is the quadratic that may jump at the nodes, with as many
//! values at Gauss's points as the quintic has coefficients beside the state (q, q', q'') at its left end.
//! Jerks and rates of torques are limited there. The acceleration is a cubic without jumps: values at Gauss's
//! points would not see one that is Legendre's polynomial of degree three on each interval, with a sign that
//! changes from interval to interval. So everything else is evaluated at Lobatto's five points. Two intervals
//! share the node between them, which leaves four new points for each interval, as many as Gauss's rule of
//! the same order has. The torques at the five points have the rates of the polynomial of degree four through
//! them.

use crate::numerics::lagrange::values;
use crate::problem::Problem;

/// Gauss's points of an interval.
pub(crate) const POINTS: usize = 3;

/// Where these points lie on [0, 1]: 1/2 and 1/2 -+ sqrt(3/20).
pub(crate) const PLACES: [f64; POINTS] = [0.112_701_665_379_258_31, 0.5, 0.887_298_334_620_741_7];
/// Weights of the points.
pub(crate) const WEIGHTS: [f64; POINTS] = [5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0];

/// Lobatto's points on [0, 1]: both ends, 1/2 and 1/2 -+ sqrt(3/28).
pub(crate) const LOBATTO_PLACES: [f64; MOST_POINTS] =
    [0.0, 0.172_673_164_646_011_43, 0.5, 0.827_326_835_353_988_6, 1.0];
/// Their weights.
const LOBATTO_WEIGHTS: [f64; MOST_POINTS] = [0.05, 49.0 / 180.0, 16.0 / 45.0, 49.0 / 180.0, 0.05];

/// Most coefficients of an interval and joint.
pub(crate) const MOST_COEFFICIENTS: usize = 6;
/// Most points of an interval.
pub(crate) const MOST_POINTS: usize = 5;

/// The polynomials of a motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Degree four: q and q' are continuous.
    #[default]
    Quartic,
    /// Degree five: q'' is continuous too.
    Quintic,
}

impl Shape {
    /// That of the motions of a problem.
    pub fn of(problem: &Problem) -> Self {
        if problem.first_of_rates().is_some() { Self::Quintic } else { Self::Quartic }
    }

    /// Unknowns of a joint at a node: q and its derivatives in s.
    pub fn node(self) -> usize {
        match self {
            Self::Quartic => 2,
            Self::Quintic => 3,
        }
    }

    /// Unknowns of a joint in an interval: heights of bubbles.
    pub fn inner(self) -> usize {
        match self {
            Self::Quartic => 1,
            Self::Quintic => 0,
        }
    }

    /// Coefficients of an interval and joint: inner ones, then those of the left and of the right end.
    pub fn coefficients(self) -> usize {
        self.inner() + 2 * self.node()
    }

    /// The points of an interval on [0, 1].
    pub fn places(self) -> &'static [f64] {
        match self {
            Self::Quartic => &PLACES,
            Self::Quintic => &LOBATTO_PLACES,
        }
    }

    /// Their weights.
    pub fn weights(self) -> &'static [f64] {
        match self {
            Self::Quartic => &WEIGHTS,
            Self::Quintic => &LOBATTO_WEIGHTS,
        }
    }

    /// How many points an interval has that the next one does not share.
    pub fn stride(self) -> usize {
        match self {
            Self::Quartic => POINTS,
            Self::Quintic => MOST_POINTS - 1,
        }
    }

    /// Points of so many intervals, with both ends: what `solver.nodes` and `solver.max_nodes` count.
    pub fn points_of(self, intervals: usize) -> usize {
        self.stride() * intervals + 1
    }

    /// Whether the acceleration is continuous.
    pub fn is_smooth(self) -> bool {
        self == Self::Quintic
    }

    /// Parts at `x` of values at the points of an interval: in the quadratic through Gauss's points, linear
    /// between Lobatto's, where multipliers may be much larger at one point than beside it.
    pub fn parts(self, x: f64) -> [f64; MOST_POINTS] {
        let mut parts = [0.0; MOST_POINTS];
        match self {
            Self::Quartic => parts[..POINTS].copy_from_slice(&values(&PLACES, x)),
            Self::Quintic => {
                let right = LOBATTO_PLACES.partition_point(|&place| place < x).clamp(1, MOST_POINTS - 1);
                let [a, b] = [LOBATTO_PLACES[right - 1], LOBATTO_PLACES[right]];
                (parts[right - 1], parts[right]) = ((b - x) / (b - a), (x - a) / (b - a));
            }
        }
        parts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_points_integrate_powers() {
        for (shape, last) in [(Shape::Quartic, 5), (Shape::Quintic, 7)] {
            for power in 0..=last {
                let pairs = shape.places().iter().zip(shape.weights());
                let sum: f64 = pairs.map(|(x, w)| w * x.powi(power)).sum();
                assert!((sum - 1.0 / (f64::from(power) + 1.0)).abs() < 1e-15, "{shape:?} {power}");
            }
        }
    }

    #[test]
    fn parts_reproduce_what_they_interpolate() {
        for x in [0.0, 0.1, 0.5, 0.6, 0.93, 1.0] {
            for (shape, power) in [(Shape::Quartic, 2), (Shape::Quintic, 1)] {
                let pairs = shape.parts(x).into_iter().zip(shape.places());
                let sum: f64 = pairs.map(|(part, place)| part * place.powi(power)).sum();
                assert!((sum - x.powi(power)).abs() < 1e-14, "{shape:?} {x}");
            }
        }
    }
}
