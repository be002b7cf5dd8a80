//! Errors of the cost that limits make between the points.

use super::between::{BETWEEN, weight};
use super::peaks::Peak;
use super::resolution::Resolution;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::multipliers::Multipliers;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::{PLACES, POINTS, WEIGHTS};
use crate::numerics::lagrange::values;

/// Integrals of multipliers over an interval.
#[derive(Clone, Copy, Debug, Default)]
struct Products {
    /// Times distances, and times their magnitudes.
    signed: f64,
    unsigned: f64,
    multipliers: f64,
}

impl Resolution {
    /// Adds to the error of each interval what limits between the points make of the cost.
    pub(super) fn add_errors_of_limits<D>(&mut self, interior: &Interior<D>) {
        let multipliers = Multipliers::at_points(&interior.spline, &interior.barrier);
        let (sides, shape) = (interior.barrier.sides(), interior.spline.mesh.shape);
        self.peaks.clear();
        self.peaks.resize(self.errors.len(), Peak::default());
        // Where accelerations are continuous, limits of torques and accelerations bend motions as well.
        let (passes, is_smooth) = (self.passes_through(sides), shape.is_smooth());
        for k in 0..self.errors.len() {
            for (i, side) in sides.iter().enumerate() {
                if side.limited.jumps(shape) || side.is_equation {
                    self.errors[k] += self.error_of_values(interior, &multipliers, k, i);
                } else if is_smooth || passes && side.limited.is_task() {
                    self.errors[k] += self.products(interior, &multipliers, k, i).unsigned;
                } else {
                    self.add_error_of_peaks(interior, k, i);
                }
            }
            self.add_errors_of_rates(interior, &multipliers, k);
        }
    }

    /// Whether rows of tasks are far beyond their limits between the points: bodies pass through each other.
    /// Such a motion says nothing about one that keeps them: what distances make of the cost in the mean is
    /// what its mesh does not resolve.
    fn passes_through(&self, sides: &[Side]) -> bool {
        let is_row = |side: &Side| side.limited == Limited::Task && !side.is_equation;
        let tasks = || (0..sides.len()).filter(|&i| is_row(&sides[i]));
        let most = |k: usize| tasks().map(|i| self.excess.of(k, i)).fold(self.swept[k].part, f64::max);
        (0..self.errors.len()).any(|k| most(k) > constants::MOST_MOVED)
    }

    /// Of what is smooth along a motion only peaks lie beyond a limit that is kept at points and nodes: where
    /// it is touched or left. To keep the limit there would cost what it is exceeded by, times the
    /// multipliers of the points around, to first order. Where the limit was moved inside instead, the motion
    /// costs more by the way times the multipliers.
    fn add_error_of_peaks<D>(&mut self, interior: &Interior<D>, k: usize, i: usize) {
        let (barrier, mesh) = (&interior.barrier, &interior.spline.mesh);
        self.errors[k] += barrier.price_of_moves(mesh, k, i);
        let (mut most, mut interval) = (0.0, k);
        for other in k.saturating_sub(1)..(k + 2).min(self.errors.len()) {
            let over = self.excess.of(other, i);
            if over > most {
                (most, interval) = (over, other);
            }
        }
        let side = &barrier.sides()[i];
        // What is exceeded by more is not to be kept by a little more.
        let error = barrier.price(mesh, k, i) * most.min(constants::MOST_MOVED) * side.range;
        // It is less where the peak is resolved.
        self.errors[interval] += error;
        // Rates are at their limits for a while, and beyond them where that begins and ends.
        let touches = side.limited == Limited::Position || side.limited.is_task();
        let peak = self.excess.place(interval, i).filter(|_| touches);
        if let Some(peak) = peak {
            // The exact motion touches the limit where the multipliers are, in the mean.
            let (left, width) = (mesh.nodes[interval], mesh.width(interval));
            let around = interval.saturating_sub(1)..(interval + 2).min(self.errors.len());
            let centre = barrier.centre(&interior.spline, around, i).map(|s| (s - left) / width);
            let place = centre.filter(|place| (0.0..=1.0).contains(place)).unwrap_or(peak);
            self.peaks[interval].take(Peak { error, place, is_at_node: !side.limited.is_task() });
        }
    }

    /// Multiplier times distance in the mean between points, of equations and of what may jump at nodes. On
    /// smooth arcs at a limit the distance of a torque or acceleration changes its sign at each point, and
    /// next to nothing is left. What it would cost to move these limits inside, so that they are kept between
    /// points too, is told apart from that.
    fn error_of_values<D>(
        &mut self,
        interior: &Interior<D>,
        multipliers: &Multipliers,
        k: usize,
        i: usize,
    ) -> f64 {
        let (side, products) = (&interior.barrier.sides()[i], self.products(interior, multipliers, k, i));
        if !side.is_equation {
            self.overshoots.add_loss(k, side, self.excess.of(k, i), products.multipliers * side.range);
        }
        products.signed.abs()
    }

    /// Integrals over an interval, with densities of multipliers between the points.
    fn products<D>(&self, interior: &Interior<D>, multipliers: &Multipliers, k: usize, i: usize) -> Products {
        let (sides, mesh): (&[Side], _) = (interior.barrier.sides(), &interior.spline.mesh);
        let (side, shape, first) = (&sides[i], mesh.shape, mesh.first_point(k));
        let distances = &self.distance[sides.len() * BETWEEN.len() * k..];
        let mut found = Products::default();
        let mut add = |x: f64, weight: f64, distance: f64| {
            let parts = shape.parts(x);
            let parts = parts[..shape.places().len()].iter().enumerate();
            let density: f64 = parts.map(|(j, part)| part * multipliers.at_point(first + j, i)).sum();
            let density = if side.is_equation { density } else { density.max(0.0) };
            let part = mesh.width(k) * weight * density;
            let product = part * distance;
            found.signed += product;
            found.unsigned += product.abs();
            found.multipliers += part;
        };
        if self.crossings.of(k).is_empty() {
            let each = BETWEEN.iter().enumerate();
            each.for_each(|(at, &x)| add(x, weight(at), distances[sides.len() * at + i]));
        } else {
            self.crossings.each_distance(k, [i, sides.len()], add);
        }
        found
    }

    /// The same of jerks and rates of torques.
    fn add_errors_of_rates<D>(&mut self, interior: &Interior<D>, multipliers: &Multipliers, k: usize) {
        let width = interior.spline.mesh.width(k);
        for (i, side) in interior.barrier.rate_sides().iter().enumerate() {
            let densities = [0, 1, 2].map(|j| multipliers.at_gauss_point(POINTS * k + j, i));
            let mean: f64 = WEIGHTS.iter().zip(densities).map(|(weight, d)| weight * d).sum();
            self.overshoots.add_loss(k, side, self.rates.of(k, i), width * mean * side.range);
            let signed = BETWEEN.iter().enumerate().map(|(at, &x)| {
                let density: f64 = values(&PLACES, x).iter().zip(densities).map(|(part, d)| part * d).sum();
                weight(at) * density.max(0.0) * self.rates.distance(BETWEEN.len() * k + at)[i]
            });
            self.errors[k] += width * signed.sum::<f64>().abs();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Limited, Resolution, constants};
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::motion::shape::Shape;

    /// What a multiplier adds to the error, by the peak around its point and by the way that its limit moved.
    #[test]
    fn peaks_and_moves_cost_their_price() {
        let mut interior = started(Shape::Quartic);
        let mut resolution = Resolution::default();
        let mut error = |interior: &mut super::Interior<_>| {
            resolution.measure(interior).unwrap();
            let sides = interior.barrier.sides();
            let over = |i: &usize| sides[*i].limited == Limited::Rate && resolution.excess.of(1, *i) > 0.0;
            let side = (0..sides.len()).find(over).unwrap();
            let most = (0..3).map(|k| resolution.excess.of(k, side)).fold(0.0, f64::max);
            (resolution.error(), side, most.min(constants::MOST_MOVED) * sides[side].range)
        };
        let (before, side, most) = error(&mut interior);
        assert!(most > 0.0);
        let at = interior.barrier.at_point(4).start + side;
        interior.barrier.multiplier[at] += 10.0;
        let (peak, ..) = error(&mut interior);
        assert!(((peak - before) / (10.0 * most) - 1.0).abs() < 1e-9, "{before} {peak} {most}");
        interior.barrier.move_inside(1, side, 0.25, f64::INFINITY);
        let (moved, ..) = error(&mut interior);
        let others = interior.barrier.price(&interior.spline.mesh, 0, side)
            + interior.barrier.price(&interior.spline.mesh, 1, side)
            + interior.barrier.price(&interior.spline.mesh, 2, side);
        assert!(moved - peak >= 10.0 * 0.25 - 1e-9 && moved - peak <= 0.25 * others + 1e-9, "{peak} {moved}");
    }
}
