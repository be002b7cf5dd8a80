//! Multipliers of limits between the points.

use super::barrier::Barrier;
use super::side::Limited;
use crate::direct::motion::shape::POINTS;
use crate::direct::motion::spline::Spline;

/// The multipliers of a motion over its weights, at the points.
#[derive(Clone, Debug, Default)]
pub(crate) struct Multipliers {
    places: Vec<f64>,
    sides: usize,
    /// All sides of a point, one point after the other.
    densities: Vec<f64>,
    /// Gauss's points, and the sides of jerks and rates of torques there.
    gauss_places: Vec<f64>,
    rate_sides: usize,
    rate_densities: Vec<f64>,
    /// The weights that the multipliers of points are divided by.
    weights: Vec<f64>,
}

impl Multipliers {
    /// Those of a motion, with all of them at the points: for an integral over the points alone. Where the
    /// coefficients of torques are limited they are those of the torques, of either sign.
    ///
    /// Without those of the nodes at the ends of phases: a position or rate that is at its limit at an end
    /// alone, as a knee that is straight when its foot lands, leaves it at once. All of the multiplier is of
    /// that instant, where the limit is kept; spread over an interval it would be an error of the cost of
    /// the order of its width.
    pub fn at_points(spline: &Spline, barrier: &Barrier) -> Self {
        let mut found = Self::default();
        found.take(spline, barrier, false);
        let sides = found.sides;
        let is_torque = |i: &usize| barrier.is_hull(*i) && barrier.sides()[*i].limited == Limited::Torque;
        for i in (0..sides).filter(is_torque) {
            for (p, to) in found.densities.iter_mut().skip(i).step_by(sides).enumerate() {
                *to = barrier.net_density((p / POINTS, p % POINTS), i);
            }
        }
        found
    }

    /// Takes those of a motion for points and nodes of another mesh; allocates only for a longer one than
    /// ever before.
    pub fn fill(&mut self, spline: &Spline, barrier: &Barrier) {
        self.take(spline, barrier, true);
    }

    /// Multipliers over weights. A node shares its multipliers between the points beside it, and its weight
    /// too if the nodes shall have their part again.
    fn take(&mut self, spline: &Spline, barrier: &Barrier, with_nodes: bool) {
        let (sides, points) = (barrier.sides().len(), barrier.points());
        let Self { densities, places, weights, .. } = self;
        densities.clear();
        densities.extend_from_slice(&barrier.multiplier[..sides * points]);
        weights.clear();
        weights.extend_from_slice(&barrier.weight[..sides * points]);
        for k in 0..spline.mesh.nodes.len() {
            if !with_nodes && spline.mesh.is_end(k) {
                continue;
            }
            for (i, at) in barrier.at_node(k).enumerate() {
                for (p, share) in beside(spline, k).into_iter().flatten() {
                    densities[sides * p + i] += share * barrier.multiplier[at];
                    if with_nodes {
                        weights[sides * p + i] += share * barrier.weight[at];
                    }
                }
            }
        }
        densities.iter_mut().zip(weights).for_each(|(density, weight)| *density /= *weight);
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

    /// Looks densities up, one place after the other.
    pub fn lookup(&self) -> Lookup<'_> {
        Lookup { multipliers: self, place: f64::NAN, is_rate: false, right: 0, part: 0.0 }
    }
}

/// Densities between the points, linear there; remembers where the last one was.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lookup<'a> {
    multipliers: &'a Multipliers,
    place: f64,
    is_rate: bool,
    /// The point to the right of the place, and the part of the way to it from the one before.
    right: usize,
    part: f64,
}

impl Lookup<'_> {
    /// Of a side at a place; sides of jerks and rates of torques come after the others.
    pub fn density(&mut self, s: f64, side: usize) -> f64 {
        let Multipliers { sides, places, gauss_places, .. } = self.multipliers;
        let is_rate = side >= *sides;
        if s != self.place || is_rate != self.is_rate {
            let places = if is_rate { gauss_places } else { places };
            let right = places.partition_point(|&place| place < s).clamp(1, places.len() - 1);
            let (a, b) = (places[right - 1], places[right]);
            self.part = ((s - a) / (b - a)).clamp(0.0, 1.0);
            (self.place, self.is_rate, self.right) = (s, is_rate, right);
        }
        let of = |p: usize| match is_rate {
            true => self.multipliers.at_gauss_point(p, side - sides),
            false => self.multipliers.at_point(p, side),
        };
        (1.0 - self.part) * of(self.right - 1) + self.part * of(self.right)
    }
}

/// The points beside a node, with their parts of what is linear between them.
fn beside(spline: &Spline, k: usize) -> [Option<(usize, f64)>; 2] {
    let (mesh, last) = (&spline.mesh, spline.mesh.intervals());
    let [left, right] = [(k > 0).then(|| POINTS * k - 1), (k < last).then_some(POINTS * k)];
    let part = match (left, right) {
        (Some(left), Some(right)) => {
            let [a, b] = [left, right].map(|p| mesh.point(p).0);
            (mesh.nodes[k] - a) / (b - a)
        }
        (left, _) => f64::from(left.is_none()),
    };
    [left.map(|p| (p, 1.0 - part)), right.map(|p| (p, part))]
}

#[cfg(test)]
mod tests {
    use super::Multipliers;
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::motion::shape::Shape;

    /// The sum of the multipliers of a side is what the cost falls by when its limit moves, on any mesh.
    #[test]
    fn points_and_nodes_together_keep_the_sums() {
        let mut interior = started(Shape::Quartic);
        interior.move_to(vec![0.0, 0.2, 0.7, 0.8, 1.0]).unwrap();
        let barrier = &mut interior.barrier;
        let mut random = fastrand::Rng::with_seed(9);
        for at in (0..barrier.count()).filter(|&at| barrier.weight[at] > 0.0) {
            barrier.multiplier[at] = random.f64();
        }
        let (mut multipliers, sides) = (Multipliers::default(), barrier.sides().len());
        multipliers.fill(&interior.spline, barrier);
        let (mut before, mut after) = (vec![0.0; sides], vec![0.0; sides]);
        let mut lookup = multipliers.lookup();
        for at in 0..barrier.count() {
            if let Some(side) = barrier.side_index(at) {
                let density = lookup.density(barrier.place(at, &interior.spline), side);
                before[side] += barrier.multiplier[at];
                after[side] += barrier.weight[at] * density;
            }
        }
        for (i, (before, after)) in before.iter().zip(after).enumerate() {
            assert!((after / before - 1.0).abs() < 1e-12, "{i}: {before} {after}");
        }
    }
}
