//! Multipliers of limits between the points.

use super::basis::POINTS;
use super::limits::Barrier;
use super::spline::Spline;

/// The multipliers of a motion over its weights, at the points.
#[derive(Clone, Debug, Default)]
pub(super) struct Multipliers {
    places: Vec<f64>,
    sides: usize,
    /// All sides of a point, one point after the other.
    densities: Vec<f64>,
}

impl Multipliers {
    /// Those of a motion. A node shares its multipliers between the points beside it.
    pub fn of(spline: &Spline, barrier: &Barrier) -> Self {
        let mut found = Self::default();
        found.fill(spline, barrier);
        found
    }

    /// Takes those of a motion; allocates only for a longer one than ever before.
    pub fn fill(&mut self, spline: &Spline, barrier: &Barrier) {
        let (sides, points) = (barrier.sides().len(), barrier.points());
        let Self { densities, places, .. } = self;
        densities.clear();
        densities.extend_from_slice(&barrier.multiplier[..sides * points]);
        for k in 0..spline.mesh.nodes.len() {
            for (i, at) in barrier.at_node(k).enumerate() {
                let beside =
                    [(k > 0).then(|| POINTS * k - 1), (k < spline.mesh.intervals()).then_some(POINTS * k)];
                let count = beside.iter().flatten().count() as f64;
                for p in beside.into_iter().flatten() {
                    densities[sides * p + i] += barrier.multiplier[at] / count;
                }
            }
        }
        densities.iter_mut().zip(&barrier.weight).for_each(|(density, weight)| *density /= weight);
        // An equation that is off beside an end has the density of the next point.
        if points > 1 {
            for i in 0..sides {
                for (off, next) in [(i, sides + i), (sides * (points - 1) + i, sides * (points - 2) + i)] {
                    if barrier.weight[off] == 0.0 {
                        densities[off] = densities[next];
                    }
                }
            }
        }
        places.clear();
        places.extend((0..points).map(|p| spline.mesh.point(p).0));
        self.sides = sides;
    }

    /// At a point.
    pub fn at_point(&self, p: usize, side: usize) -> f64 {
        self.densities[self.sides * p + side]
    }

    /// Linear between the points.
    pub fn density(&self, s: f64, side: usize) -> f64 {
        let last = self.places.len() - 1;
        let right = self.places.partition_point(|&place| place < s).clamp(1, last);
        let (a, b) = (self.places[right - 1], self.places[right]);
        let part = ((s - a) / (b - a)).clamp(0.0, 1.0);
        let of = |p: usize| self.at_point(p, side);
        (1.0 - part) * of(right - 1) + part * of(right)
    }
}
