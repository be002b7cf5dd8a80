//! Where torques jump inside of intervals.

use super::basis::POINTS;
use super::points::Points;
use crate::constants::direct as constants;

/// Parts of the values at the points in the quadratic through them, at the left end; at the right end in the
/// opposite order.
const AT_LEFT_END: [f64; POINTS] = [1.478_830_557_701_236, -2.0 / 3.0, 0.187_836_108_965_430_67];

/// Weights of the points in the mean.
const MEAN: [f64; POINTS] = super::basis::WEIGHTS;

/// Torques at the ends of all intervals, from the points inside.
#[derive(Clone, Debug, Default)]
pub(super) struct Jumps {
    dof: usize,
    /// At the left end, at the right end, and the mean, of each interval and joint.
    values: Vec<[f64; 3]>,
    /// Largest less smallest torque of each joint.
    range: Vec<f64>,
}

/// Where an interval is to be cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// The part of the interval to the left.
    pub place: f64,
    /// The node that moves there.
    pub replaces: Option<usize>,
}

impl Jumps {
    /// Takes the torques at the points of a motion.
    pub fn measure(&mut self, points: &Points) {
        let n = points.dof;
        self.dof = n;
        self.values.clear();
        self.range.clear();
        self.range.resize(n, 0.0);
        for k in 0..points.count() / POINTS {
            for i in 0..n {
                let [a, b, c] = [0, 1, 2].map(|j| points.tau(POINTS * k + j)[i]);
                let sum = |f: [f64; POINTS]| f[0] * a + f[1] * b + f[2] * c;
                let [l, m, r] = AT_LEFT_END;
                self.values.push([sum([l, m, r]), sum([r, m, l]), sum(MEAN)]);
            }
        }
        for (i, range) in self.range.iter_mut().enumerate() {
            let values = || (0..points.count()).map(|p| points.tau(p)[i]);
            *range = values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min);
        }
    }

    /// The jump from the polynomial of interval k - 1 to that of k.
    fn at_node(&self, k: usize, i: usize) -> Option<f64> {
        let left = self.values.get((k.checked_sub(1)?) * self.dof + i)?;
        let right = self.values.get(k * self.dof + i)?;
        Some(right[0] - left[1])
    }

    /// The smaller one of the jumps at both ends of an interval.
    fn least(&self, k: usize, i: usize) -> f64 {
        let jumps = [self.at_node(k, i), self.at_node(k + 1, i)].into_iter().flatten().map(f64::abs);
        jumps.reduce(f64::min).unwrap_or(0.0)
    }

    /// The mean square of the jumps at both ends of an interval; without that of an end at which the exact motion
    /// jumps, as is likely if one is large and much larger than the other.
    pub fn mean_square(&self, k: usize, i: usize) -> f64 {
        let both = [self.at_node(k, i), self.at_node(k + 1, i)].map(|jump| jump.unwrap_or(0.0).powi(2));
        let (least, most) = (both[0].min(both[1]), both[0].max(both[1]));
        let exact = constants::EXACT_JUMP.powi(2);
        let is_exact = most > exact * self.range[i] * self.range[i] && least < exact * most;
        if is_exact { least } else { 0.5 * (least + most) }
    }

    /// The places of an interval in which torques jump, in their order.
    ///
    /// If a torque jumps from A to B at the part x of an interval, its mean is x A + (1 - x) B; A and B are those of
    /// the intervals beside it. The optimal motion on a mesh has this mean but for terms in the square of the width.
    pub fn cuts(&self, k: usize) -> Vec<Cut> {
        let mut cuts: Vec<Cut> = Vec::new();
        let last = self.values.len() / self.dof - 1;
        if k == 0 || k == last {
            return cuts;
        }
        for i in 0..self.dof {
            let value = |k: usize| self.values[k * self.dof + i];
            let (before, after) = (value(k - 1)[1], value(k + 1)[0]);
            let change = before - after;
            let place = (value(k)[2] - after) / change;
            if change.abs() > constants::LEAST_JUMP * self.range[i]
                && self.least(k, i) > constants::MISS * change.abs()
                && (1e-4..=1.0 - 1e-4).contains(&place)
            {
                let near = match place {
                    x if x < constants::NEAR_NODE => Some(k),
                    x if x > 1.0 - constants::NEAR_NODE => Some(k + 1),
                    _ => None,
                };
                let replaces = near.filter(|&node| node > 0 && node <= last && !self.is_needed(node, i));
                cuts.push(Cut { place, replaces });
            }
        }
        cuts.sort_by(|a, b| a.place.total_cmp(&b.place));
        cuts
    }

    /// Whether the torque of another joint than `i` jumps at a node.
    fn is_needed(&self, node: usize, i: usize) -> bool {
        let jumps = |l: usize| self.at_node(node, l).map_or(0.0, f64::abs);
        (0..self.dof).any(|l| l != i && jumps(l) > 0.2 * self.range[l])
    }
}

#[cfg(test)]
mod tests {
    use super::super::basis::PLACES;
    use super::*;

    /// Points of one joint with these torques.
    fn points(tau: &[f64]) -> Points {
        let mut points = Points::default();
        points.resize(1, tau.len());
        points.tau.copy_from_slice(tau);
        points
    }

    #[test]
    fn quadratics_are_continued_exactly_to_the_ends() {
        let value = |x: f64| 1.0 - 3.0 * x + 2.0 * x * x;
        let mut jumps = Jumps::default();
        jumps.measure(&points(&PLACES.map(value)));
        let [left, right, mean] = jumps.values[0];
        let errors = [left - value(0.0), right - value(1.0), mean - (1.0 - 1.5 + 2.0 / 3.0)];
        assert!(errors.iter().all(|error| error.abs() < 1e-14), "{errors:?}");
    }

    #[test]
    fn a_jump_is_found_from_the_mean() {
        // From 2 to -1 at 0.8 of the second interval.
        let inside = [2.0, 2.0, (0.8 * 2.0 - 0.2 - 2.0 * (MEAN[0] + MEAN[1])) / MEAN[2]];
        let mut jumps = Jumps::default();
        jumps.measure(&points(&[[2.0; 3], inside, [-1.0; 3]].concat()));
        let cuts = jumps.cuts(1);
        assert_eq!(cuts.len(), 1);
        assert!((cuts[0].place - 0.8).abs() < 1e-14 && cuts[0].replaces == Some(2), "{cuts:?}");
        // A jump at a node is none.
        jumps.measure(&points(&[[2.0; 3], [2.0; 3], [-1.0; 3], [-1.0; 3]].concat()));
        assert!((0..4).all(|k| jumps.cuts(k).is_empty()));
        assert!((0..4).all(|k| jumps.mean_square(k, 0) == 0.0));
    }
}
