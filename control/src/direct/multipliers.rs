//! Multipliers of limits between the points.

use super::limits::Barrier;
use super::shape::POINTS;
use super::spline::Spline;

/// The multipliers of a motion over its weights, at the points.
#[derive(Clone, Debug, Default)]
pub(super) struct Multipliers {
    places: Vec<f64>,
    sides: usize,
    /// All sides of a point, one point after the other.
    densities: Vec<f64>,
    /// Gauss's points, and the sides of jerks and rates of torques there.
    gauss_places: Vec<f64>,
    rate_sides: usize,
    rate_densities: Vec<f64>,
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
        // What is off at a point has the mean density of the points beside it.
        for i in 0..sides {
            let is_on = |p: &usize| barrier.weight[sides * p + i] != 0.0;
            for p in (0..points).filter(|p| !is_on(p)) {
                let (before, after) = ((0..p).rev().find(is_on), (p + 1..points).find(is_on));
                let beside = || before.into_iter().chain(after);
                let sum: f64 = beside().map(|p| densities[sides * p + i]).sum();
                densities[sides * p + i] = sum / beside().count().max(1) as f64;
            }
        }
        let (mesh, gauss_points) = (&spline.mesh, spline.mesh.gauss_points());
        places.clear();
        places.extend((0..points).map(|p| mesh.point(p).0));
        self.sides = sides;
        self.gauss_places.clear();
        self.gauss_places.extend((0..gauss_points).map(|p| mesh.gauss_point(p).0));
        self.rate_sides = barrier.rate_sides().len();
        self.rate_densities.clear();
        let rates = (0..gauss_points).flat_map(|p| barrier.at_gauss_point(p));
        self.rate_densities.extend(rates.map(|at| barrier.multiplier[at] / barrier.weight[at]));
    }

    /// At a point.
    pub fn at_point(&self, p: usize, side: usize) -> f64 {
        self.densities[self.sides * p + side]
    }

    /// That of a jerk or the rate of a torque at one of Gauss's points.
    pub fn at_gauss_point(&self, p: usize, side: usize) -> f64 {
        self.rate_densities[self.rate_sides * p + side]
    }

    /// Linear between the points; sides of jerks and rates of torques come after the others.
    pub fn density(&self, s: f64, side: usize) -> f64 {
        let is_rate = side >= self.sides;
        let places = if is_rate { &self.gauss_places } else { &self.places };
        let right = places.partition_point(|&place| place < s).clamp(1, places.len() - 1);
        let (a, b) = (places[right - 1], places[right]);
        let part = ((s - a) / (b - a)).clamp(0.0, 1.0);
        let of = |p: usize| match is_rate {
            true => self.at_gauss_point(p, side - self.sides),
            false => self.at_point(p, side),
        };
        (1.0 - part) * of(right - 1) + part * of(right)
    }
}
