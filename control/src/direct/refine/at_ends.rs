//! Limits at both ends of each interval, from inside: values that jump at nodes are largest there.

use super::between::evaluate_places;
use super::rates_between::RatesBetween;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::distances::measure;
use crate::direct::points::values::{PointDynamics, Points};
use costate::EvalError;

/// The ends of an interval.
const ENDS: [f64; 2] = [0.0, 1.0];

/// Distances to all limits at the ends of all intervals.
#[derive(Clone, Debug, Default)]
pub(crate) struct AtEnds {
    /// The motion at the left end of each interval, then at its right end.
    pub points: Points,
    /// All sides of one end after the other.
    pub distance: Vec<f64>,
    /// Jerks and rates of torques.
    rates: RatesBetween,
}

impl AtEnds {
    /// Those of a motion.
    pub fn of<D: PointDynamics>(interior: &mut Interior<D>) -> Result<Self, EvalError> {
        let mut found = Self::default();
        evaluate_places(interior, &ENDS, &mut found.points)?;
        found.rates.evaluate(interior, &ENDS, &mut found.points)?;
        let sides = interior.barrier.sides();
        if !sides.is_empty() {
            found.distance.resize(sides.len() * found.points.count(), 0.0);
            measure(sides, &found.points, &mut found.distance);
        }
        Ok(found)
    }

    /// Distances of jerks and rates of torques to their limits.
    pub fn rate_distance(&self) -> &[f64] {
        &self.rates.distance
    }
}
