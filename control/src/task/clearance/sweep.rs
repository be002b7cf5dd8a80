//! Motions between two places, so that no two bodies pass through each other unseen.
//!
//! The distance of two cores changes no faster than their points move. A point of a core that revolute joint
//! j moves is within the sum of the lengths of the links between from its axis, so it moves at most by that
//! times the rate of the joint. A step that is shorter than the distance over the sum of these speeds cannot
//! make the cores meet.

use super::pair::{Bounds, Look, Other, Pair};
use super::{Body, Clearances, rows};
use crate::constants::task::SHORTEST_STEP;
use crate::task::placed::Placed;
use costate::EvalError;

impl Clearances {
    /// Sets the speeds for a piece of a motion: how fast the distances of all pairs can change.
    pub fn see_piece(&mut self, placed: &Placed, bounds: Bounds<'_>) {
        for k in 0..self.pairs.len() {
            let pair = &self.pairs[k];
            let own = speed(&self.bodies[pair.body], &pair.paths[0], placed, bounds);
            let other = match pair.other {
                Other::Body(b) => speed(&self.bodies[b], &pair.paths[1], placed, bounds),
                Other::Box(_) | Other::HalfSpace { .. } => 0.0,
            };
            self.speeds[k] = own + other;
        }
    }

    /// The largest violation at a place.
    ///
    /// # Errors
    /// As [`PathFunction::values`](crate::task::functions::PathFunction::values).
    pub fn look(&mut self, placed: &Placed) -> Result<Look, EvalError> {
        self.place(placed)?;
        let mut found = Look { violation: 0.0, row: 0, step: f64::INFINITY };
        let mut row = 0;
        for (pair, speed) in self.pairs.iter().zip(&self.speeds) {
            let own = row;
            row += self.rows_of(pair);
            if matches!(pair.other, Other::HalfSpace { .. }) {
                // Nothing is beyond it.
                continue;
            }
            let (clearance, distance) = self.distance(pair);
            let violation = -clearance / pair.radius;
            if violation > found.violation {
                (found.violation, found.row) = (violation, own);
            }
            found.step = found.step.min(distance / speed.max(f64::MIN_POSITIVE));
        }
        found.step = found.step.max(SHORTEST_STEP);
        Ok(found)
    }

    /// The clearance of a pair, and the distance of its cores.
    fn distance(&self, pair: &Pair) -> (f64, f64) {
        let core = &self.cores[pair.body];
        let closest = rows::closest(core, &pair.other, &self.cores, pair.radius);
        let clearance = rows::clearance(closest.half_square, pair.radius)[0] + rows::depth(core, &pair.other);
        (clearance, (2.0 * closest.half_square).sqrt())
    }
}

/// Largest speed of a point of a core by these joints of its path.
fn speed(body: &Body, joints: &[usize], placed: &Placed, bounds: Bounds<'_>) -> f64 {
    let Some(carried) = &body.carried else { return 0.0 };
    let mut lever = body.to.map_or(body.from.norm(), |to| to.norm().max(body.from.norm()));
    let mut sum = 0.0;
    for (&joint, length) in carried.path.iter().zip(&carried.lengths) {
        // From the origin of this joint to the point.
        lever += length;
        let (coordinate, ratio) = placed.coordinate(joint);
        let slides = placed.slides(joint);
        if joints.contains(&joint) {
            sum += ratio.abs() * bounds.rates[coordinate] * if slides { 1.0 } else { lever };
        }
        if slides {
            lever += ratio.abs() * bounds.positions[coordinate] + placed.offset(joint).abs();
        }
    }
    sum
}
