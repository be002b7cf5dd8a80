//! Where torques and accelerations jump inside of intervals.

use crate::constants::direct as constants;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::side::Limited;
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::shape::{PLACES, POINTS, WEIGHTS};
use crate::direct::points::values::Points;
use crate::numerics::lagrange::{slopes, values};
use std::ops::Range;

/// A value on an interval: the quadratic through the points.
#[derive(Clone, Copy, Debug, Default)]
struct Piece {
    /// At the left end, and its derivative by the part of the interval.
    left: [f64; 2],
    /// The same at the right end.
    right: [f64; 2],
    mean: f64,
}

impl Piece {
    fn through(value: [f64; POINTS]) -> Self {
        const ENDS: [[[f64; POINTS]; 2]; 2] =
            [[values(&PLACES, 0.0), slopes(&PLACES, 0.0)], [values(&PLACES, 1.0), slopes(&PLACES, 1.0)]];
        let sum = |factors: [f64; POINTS]| value.iter().zip(factors).map(|(value, f)| value * f).sum();
        let [left, right] = ENDS.map(|end| end.map(sum));
        Self { left, right, mean: sum(WEIGHTS) }
    }
}

/// Torques, then accelerations, of all intervals as quadratics; where these are continuous their rates: rates
/// of torques, then jerks.
#[derive(Clone, Debug, Default)]
pub(super) struct Jumps {
    /// Values of an interval: torques and accelerations of all joints.
    count: usize,
    pieces: Vec<Piece>,
    /// Widths and phases of the intervals.
    widths: Vec<f64>,
    phases: Vec<usize>,
    /// Largest less smallest value along the motion.
    range: Vec<f64>,
    /// Where accelerations are continuous: the values that limits make jump.
    limited: Option<Range<usize>>,
    /// Values whose coefficients are limited, so that they may go from limit to limit within an interval.
    steep: Vec<bool>,
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
    /// Takes the values at Gauss's points of a motion with these limits.
    pub fn measure(&mut self, points: &Points, mesh: &Mesh, barrier: &Barrier) {
        let (n, shape) = (points.dof, mesh.shape);
        let any = |limited| barrier.rate_sides().iter().any(|side| side.limited == limited);
        let of_value = if shape.is_smooth() {
            [Limited::TorqueRate, Limited::Jerk]
        } else {
            [Limited::Torque, Limited::Acceleration]
        };
        self.steep.clear();
        self.steep.resize(2 * n, false);
        let hulls = barrier.all_sides().enumerate().filter(|(i, _)| barrier.is_hull(*i));
        for (_, side) in hulls {
            if let Some(group) = of_value.iter().position(|limited| *limited == side.limited) {
                self.steep[n * group + side.joint] = true;
            }
        }
        self.limited = shape.is_smooth().then(|| {
            let first = if any(Limited::TorqueRate) { 0 } else { n };
            first..if any(Limited::Jerk) { 2 * n } else { n }
        });
        let value = |p: usize, i: usize| match (shape.is_smooth(), i < n) {
            (false, true) => points.tau(p)[i],
            (false, false) => points.z(p)[n + i],
            (true, true) => points.rates.torque[n * p + i],
            (true, false) => points.rates.jerk[n * p + i - n],
        };
        self.count = 2 * n;
        self.widths.clear();
        self.widths.extend((0..mesh.intervals()).map(|k| mesh.width(k)));
        self.phases.clear();
        self.phases.extend((0..mesh.intervals()).map(|k| mesh.phase(k)));
        self.pieces.clear();
        for k in 0..self.widths.len() {
            self.pieces
                .extend((0..2 * n).map(|i| Piece::through([0, 1, 2].map(|j| value(POINTS * k + j, i)))));
        }
        self.range.clear();
        self.range.extend((0..2 * n).map(|i| {
            let values = || (0..POINTS * self.widths.len()).map(|p| value(p, i));
            values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
        }));
    }

    fn piece(&self, k: usize, i: usize) -> &Piece {
        &self.pieces[self.count * k + i]
    }

    /// Whether a node is inside of a phase: at vias the exact motion may jump.
    pub fn is_inside(&self, node: usize) -> bool {
        node > 0 && node < self.phases.len() && self.phases[node - 1] == self.phases[node]
    }

    /// The jump from the polynomial of interval k - 1 to that of k; none at the ends of phases.
    fn at_node(&self, k: usize, i: usize) -> Option<f64> {
        self.is_inside(k).then(|| self.piece(k, i).left[0] - self.piece(k - 1, i).right[0])
    }

    /// The smaller one of the jumps at both ends of an interval.
    fn least(&self, k: usize, i: usize) -> f64 {
        let jumps = [self.at_node(k, i), self.at_node(k + 1, i)].into_iter().flatten().map(f64::abs);
        jumps.reduce(f64::min).unwrap_or(0.0)
    }

    /// The mean square of the jumps of value i at both ends of an interval; without that of an end at which
    /// the exact motion jumps, as is likely if one is large and much larger than the other. The first and the
    /// last interval have one jump, which counts.
    pub fn mean_square(&self, k: usize, i: usize) -> f64 {
        let [left, right] =
            [self.at_node(k, i), self.at_node(k + 1, i)].map(|jump| jump.map(|jump| jump * jump));
        let (Some(left), Some(right)) = (left, right) else {
            return left.or(right).unwrap_or(0.0);
        };
        let (least, most) = (left.min(right), left.max(right));
        let exact = constants::EXACT_JUMP.powi(2);
        let is_exact = most > exact * self.range[i] * self.range[i] && least < exact * most;
        if is_exact { least } else { 0.5 * (least + most) }
    }

    /// The places of an interval in which torques or accelerations jump, in their order.
    pub fn cuts(&self, k: usize) -> Vec<Cut> {
        let mut cuts: Vec<Cut> = Vec::new();
        if !self.is_inside(k) || !self.is_inside(k + 1) {
            return cuts;
        }
        for i in self.limited.clone().unwrap_or(0..self.count) {
            let Some(place) = self.jump(k, i) else { continue };
            // Accelerations of all joints jump with a torque.
            if cuts.iter().any(|cut| (cut.place - place).abs() < constants::SAME_JUMP) {
                continue;
            }
            let near = match place {
                x if x < constants::NEAR_NODE => Some(k),
                x if x > 1.0 - constants::NEAR_NODE => Some(k + 1),
                _ => None,
            };
            let replaces = near.filter(|&node| self.is_inside(node) && !self.is_needed(node, i));
            cuts.push(Cut { place, replaces });
        }
        cuts.sort_by(|a, b| a.place.total_cmp(&b.place));
        cuts
    }

    /// The place in interval k where value i jumps, if it does.
    ///
    /// If it jumps from A to B at the part x of the interval, its mean is `x A + (1 - x) B`, where A and
    /// B are means of the values beside the interval, continued into it. The optimal motion on a mesh
    /// has this mean but for terms in the square of the width.
    fn jump(&self, k: usize, i: usize) -> Option<f64> {
        let (before, after) = (self.piece(k - 1, i), self.piece(k + 1, i));
        let change = before.right[0] - after.left[0];
        // Slopes by the part of this interval.
        let of_before = before.right[1] * self.widths[k] / self.widths[k - 1];
        let of_after = after.left[1] * self.widths[k] / self.widths[k + 1];
        // What neither of the values beside the interval leads to.
        let beside = (change + of_before).abs().min((change + of_after).abs());
        let jumps = change.abs() > constants::LEAST_JUMP * self.range[i]
            && (self.least(k, i) > constants::MISS * change.abs()
                || self.steep[i] && beside > constants::STEEP * change.abs());
        if !jumps {
            return None;
        }
        let mut place = 0.5;
        for _ in 0..constants::STEPS_OF_JUMP {
            let a = before.right[0] + 0.5 * place * of_before;
            let b = after.left[0] - 0.5 * (1.0 - place) * of_after;
            place = ((self.piece(k, i).mean - b) / (a - b)).clamp(0.0, 1.0);
        }
        (constants::NEAREST_JUMP..=1.0 - constants::NEAREST_JUMP).contains(&place).then_some(place)
    }

    /// Whether any value jumps at a node.
    pub fn jumps_at(&self, node: usize) -> bool {
        let jumps = |l: usize| self.at_node(node, l).map_or(0.0, f64::abs);
        (0..self.count).any(|l| jumps(l) > constants::NEEDED * self.range[l])
    }

    /// Whether the torque of another joint than that of value `i` jumps at a node; where accelerations are
    /// continuous, the rate of its torque or its jerk, whatever the value is.
    fn is_needed(&self, node: usize, i: usize) -> bool {
        let n = self.count / 2;
        let first = if self.limited.is_some() { i / n * n } else { 0 };
        let jumps = |l: usize| self.at_node(node, l).map_or(0.0, f64::abs);
        (first..first + n).any(|l| l % n != i % n && jumps(l) > constants::NEEDED * self.range[l])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::motion::shape::Shape;

    /// Jumps of points of one joint with these torques and no accelerations.
    fn jumps(tau: &[f64]) -> Jumps {
        let mut points = Points::default();
        points.resize_values(1, [0; 2], std::iter::once(tau.len()));
        points.tau.copy_from_slice(tau);
        let mut jumps = Jumps::default();
        let mesh = Mesh::new(Mesh::even(1, tau.len() / POINTS), Shape::Quartic);
        jumps.measure(&points, &mesh, &Barrier::default());
        jumps
    }

    #[test]
    fn quadratics_are_continued_exactly_to_the_ends() {
        let piece = Piece::through(PLACES.map(|x| 1.0 - 3.0 * x + 2.0 * x * x));
        let found = [piece.left[0], piece.left[1], piece.right[0], piece.right[1], piece.mean];
        let expected = [1.0, -3.0, 0.0, 1.0, 1.0 - 1.5 + 2.0 / 3.0];
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-13), "{found:?}");
    }

    #[test]
    fn a_jump_is_found_from_the_mean() {
        // On straight lines from 2 and to -1, which jumps at 0.8 of the second of three intervals.
        let (before, after) = (|x: f64| 2.0 + 0.1 * x, |x: f64| -1.0 + 0.2 * (x - 2.0));
        let of = |line: &dyn Fn(f64) -> f64, k: f64| PLACES.map(|x| line(k + x));
        let mean = 0.8 * before(1.4) + 0.2 * after(1.9);
        let mut inside = of(&before, 1.0);
        inside[2] = (mean - WEIGHTS[0] * inside[0] - WEIGHTS[1] * inside[1]) / WEIGHTS[2];
        let cuts = jumps(&[of(&before, 0.0), inside, of(&after, 2.0)].concat()).cuts(1);
        assert_eq!(cuts.len(), 1);
        assert!((cuts[0].place - 0.8).abs() < 1e-9 && cuts[0].replaces == Some(2), "{cuts:?}");
        // A jump at a node is none.
        let jumps = jumps(&[[2.0; 3], [2.0; 3], [-1.0; 3], [-1.0; 3]].concat());
        assert!((0..4).all(|k| jumps.cuts(k).is_empty()));
        assert!((0..4).all(|k| jumps.mean_square(k, 0) < 1e-24));
    }

    #[test]
    fn the_only_jump_of_an_end_counts() {
        let jumps = jumps(&[[2.0; 3], [-1.0; 3]].concat());
        assert!((0..2).all(|k| (jumps.mean_square(k, 0) - 9.0).abs() < 1e-12));
    }
}
