//! The cost of a control on a path, bounds included: a convex function of u.

use crate::constants::path::EDGE;
use crate::extremal::ControlRange;
use crate::extremal::actuation::SmoothRange;
use crate::extremal::penalty::Term;

/// `1/2 r u^2` and beyond a bound `1/2 stiffness (excess)^2`.
///
/// A control without effort between two bounds has `r w^2 ( s artanh s + 1/2 log(1 - s^2) )`, s = (u -
/// middle)/w with w half the distance between the bounds, up to |s| = 0.98; beyond, its parabola there and
/// the stiffness. Where u maximises the Hamiltonian, the derivative of either is `b y_p`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ControlCost {
    pub effort: f64,
    pub bounds: ControlRange,
    pub smooth: Option<SmoothRange>,
    pub stiffness: f64,
}

impl ControlCost {
    /// Value and first two derivatives at u.
    pub fn at(&self, u: f64) -> Term {
        let inside = match self.smooth {
            None => {
                let first = self.effort * u;
                Term { value: 0.5 * first * u, first, second: self.effort }
            }
            Some(SmoothRange { middle, width }) => self.smoothed((u - middle) / width, width),
        };
        let ControlRange { low, high } = self.bounds;
        let excess = if u < low {
            u - low
        } else if u > high {
            u - high
        } else {
            return inside;
        };
        let pull = self.stiffness * excess;
        Term {
            value: inside.value + 0.5 * pull * excess,
            first: inside.first + pull,
            second: inside.second + self.stiffness,
        }
    }

    fn smoothed(&self, s: f64, half: f64) -> Term {
        let (r, at) = (self.effort, s.clamp(-EDGE, EDGE));
        let (slope, curvature) = (at.atanh(), 1.0 / (1.0 - at * at));
        let beyond = s - at;
        let value = at * slope + 0.5 * (1.0 - at * at).ln() + beyond * (slope + 0.5 * curvature * beyond);
        Term {
            value: r * half * half * value,
            first: r * half * (slope + curvature * beyond),
            second: r * curvature,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_are_those_of_the_value() {
        let (free, bounds) = (ControlRange::UNBOUNDED, ControlRange::new(-1.0, 2.0));
        let smooth = Some(SmoothRange { middle: 0.5, width: 1.5 });
        for cost in [
            ControlCost { effort: 0.7, bounds: free, smooth: None, stiffness: 0.0 },
            ControlCost { effort: 0.7, bounds, smooth: None, stiffness: 30.0 },
            ControlCost { effort: 0.3, bounds, smooth, stiffness: 9.0 },
        ] {
            for u in [-3.0, -1.2, -0.99, -0.4, 0.0, 0.8, 1.95, 1.99, 2.4] {
                let (at, h) = (cost.at(u), 1e-6);
                let (before, after) = (cost.at(u - h), cost.at(u + h));
                assert!(((after.value - before.value) / (2.0 * h) - at.first).abs() < 1e-7, "{cost:?} {u}");
                assert!(((after.first - before.first) / (2.0 * h) - at.second).abs() < 1e-4, "{cost:?} {u}");
                assert!(at.second > 0.0);
            }
        }
    }
}
