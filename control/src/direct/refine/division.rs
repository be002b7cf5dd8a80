//! The nodes of a finer mesh.

use super::peaks::Parts;
use super::resolution::{Move, Resolution};
use crate::constants::direct as constants;
use crate::direct::motion::spline::Spline;

impl Resolution {
    /// Nodes of a finer mesh. Intervals that exceed a limit between points are divided, and those with
    /// the largest errors, until what is left is a small part of the whole, or `enough`; all of them may
    /// have `tolerance`. Where a torque jumps inside of an interval a node moves there, or is added;
    /// other intervals are divided evenly.
    pub fn nodes(&mut self, spline: &Spline, tolerance: f64, enough: f64) -> Vec<f64> {
        let beyond = |k: usize| {
            self.violations[k] > constants::VIOLATION_BETWEEN
                || self.rates.violations.get(k).is_some_and(|&most| most > constants::VIOLATION_OF_RATES)
        };
        let mut chosen: Vec<bool> = (0..self.errors.len()).map(beyond).collect();
        choose(&mut chosen, &self.errors, enough);
        self.divided(spline, &chosen, tolerance)
    }

    /// Nodes of a finer mesh on which limits of what may jump are exceeded by less between points: all
    /// intervals are divided in which one is. Their coefficients are limited already, so the values are no
    /// quadratics there. Torques, which are cut, do not count.
    pub fn nodes_for_limits(&mut self, spline: &Spline, allowed: f64) -> Vec<f64> {
        let beyond = |&most: &f64| most > constants::VIOLATION_BETWEEN;
        let chosen: Vec<bool> = self.overshoots.others.most.iter().map(beyond).collect();
        self.divided(spline, &chosen, allowed)
    }

    /// Nodes of a finer mesh on which limits cut off less of the torques.
    pub fn nodes_for_torques(&mut self, spline: &Spline, tolerance: f64) -> Vec<f64> {
        let mut chosen = vec![false; self.cut.len()];
        choose(&mut chosen, &self.cut, 0.0);
        self.divided(spline, &chosen, tolerance)
    }

    fn divided(&mut self, spline: &Spline, chosen: &[bool], tolerance: f64) -> Vec<f64> {
        let (narrowest, smooth) = (self.narrowest, spline.mesh.shape.is_smooth());
        let share = tolerance / self.errors.len() as f64;
        let mut moves = Vec::new();
        let (mut added, mut moved) = (Vec::new(), vec![false; spline.mesh.nodes.len()]);
        let mut narrow = Vec::new();
        for k in (0..chosen.len()).filter(|&k| chosen[k]) {
            let (left, width) = (spline.mesh.nodes[k], spline.mesh.width(k));
            let least = if self.crossings.touches(k) { constants::NARROWER * narrowest } else { narrowest };
            let (cuts, is_narrow) = (self.jumps.cuts(k), width < least);
            let crossed = self.crossings.graded(k);
            if cuts.is_empty() && !crossed.is_empty() {
                narrow.extend(crossed.into_iter().map(|x| left + width * x));
                continue;
            }
            for cut in cuts.iter().filter(|_| smooth || !is_narrow) {
                let place = left + width * cut.place;
                // Where accelerations are continuous, nodes move where there is no room for another one.
                let (near, part) = if cut.place < 0.5 { (k, cut.place) } else { (k + 1, 1.0 - cut.place) };
                let no_room = width * part < narrowest && !spline.mesh.is_end(near);
                let replaces = if smooth { no_room.then_some(near) } else { cut.replaces };
                if smooth && is_narrow && replaces.is_none() {
                    continue;
                }
                added.push(place);
                if let Some(node) = replaces {
                    let from = spline.mesh.nodes[node];
                    moved[node] = self.approaches(from, place);
                    moves.push(Move { place, distance: (place - from).abs() });
                }
            }
            // What is far beyond a limit is divided evenly, until that limit is nearly kept.
            let is_near = self.violations[k] <= constants::VIOLATION_BETWEEN;
            let peak = self.peaks.get(k).filter(|_| cuts.is_empty() && !is_narrow && is_near);
            let peak = peak.and_then(|peak| peak.parts(self.errors[k]));
            if let Some(parts) = peak.and_then(|parts| self.places_of_peak(spline, k, parts, &mut moved)) {
                added.extend(parts);
            } else if cuts.is_empty() && !is_narrow {
                // The error of a motion that is smooth in an interval falls with the seventh power of
                // its width.
                let by_error = (self.errors[k] / share).powf(1.0 / 7.0);
                // What exceeds a limit between points falls with its square where an arc at the limit begins.
                let by_violation = (self.violations[k] / constants::VIOLATION_BETWEEN).max(0.0).sqrt();
                let parts = by_error.max(by_violation).ceil().clamp(2.0, constants::MOST_PARTS);
                added.extend((1..parts as usize).map(|part| left + width * part as f64 / parts));
            }
        }
        let kept = spline.mesh.nodes.iter().zip(&moved).filter(|(_, moved)| !**moved).map(|(node, _)| *node);
        self.moves = moves;
        // What is narrow needs nodes that are closer; rounding in so few intervals moves the cost by next to
        // nothing.
        with_added(
            with_added(kept.collect(), added, self.closest),
            narrow,
            constants::NARROWER * self.closest,
        )
    }

    /// Where an interval is divided at a peak, if it can be: nodes at which torques jump stay.
    fn places_of_peak(
        &self,
        spline: &Spline,
        k: usize,
        parts: Parts,
        moved: &mut [bool],
    ) -> Option<Vec<f64>> {
        let mesh = &spline.mesh;
        let (left, width) = (mesh.nodes[k], mesh.width(k));
        match parts {
            Parts::At(places) => {
                let ends = std::iter::once(0.0).chain(places.iter().copied()).chain([1.0]);
                let ends: Vec<f64> = ends.collect();
                // The peak may lie in a part that is nearly all of the interval.
                let halves = ends.windows(2).filter(|ends| ends[1] - ends[0] > constants::NEARLY_WHOLE);
                let middles = halves.map(|ends| 0.5 * (ends[0] + ends[1]));
                Some(places.iter().copied().chain(middles).map(|place| left + width * place).collect())
            }
            Parts::Instead(place) => {
                let node = if place < 0.5 { k } else { k + 1 };
                if mesh.is_end(node) || self.jumps.jumps_at(node) {
                    return None;
                }
                moved[node] = true;
                let half = 0.5 * mesh.width(node - 1).min(mesh.width(node));
                Some([-half, half].map(|part| left + width * place + part).to_vec())
            }
        }
    }

    /// Whether a node may move: if it moved before, that was farther. One that moves to and fro is not
    /// at a jump, and stays.
    fn approaches(&self, from: f64, to: f64) -> bool {
        let before = self.moves.iter().find(|before| before.place == from);
        before.is_none_or(|before| (to - from).abs() < constants::APPROACH * before.distance)
    }
}

/// Nodes in their order with those that are added, one after the other, unless they are closer than this to
/// another one.
pub(super) fn with_added(mut nodes: Vec<f64>, mut added: Vec<f64>, closest: f64) -> Vec<f64> {
    added.sort_by(f64::total_cmp);
    for place in added {
        let right = nodes.partition_point(|&node| node < place);
        let beside = nodes[right.saturating_sub(1)..].iter().take(2);
        if beside.into_iter().all(|node| (node - place).abs() >= closest) {
            nodes.insert(right, place);
        }
    }
    nodes
}

/// Chooses the largest errors, until what is left is a small part of all, or `enough`.
fn choose(chosen: &mut [bool], errors: &[f64], enough: f64) {
    let mut order: Vec<usize> = (0..errors.len()).collect();
    order.sort_by(|&a, &b| errors[b].total_cmp(&errors[a]));
    let mut rest: f64 = errors.iter().sum();
    let enough = (constants::LEFT * rest).max(enough);
    for k in order {
        if rest <= enough {
            break;
        }
        chosen[k] = true;
        rest -= errors[k];
    }
}

#[cfg(test)]
mod tests {
    use super::super::peaks::Peak;
    use super::{Resolution, with_added};
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::motion::shape::Shape;

    /// Nodes of thirds with this peak in the middle one, which makes all of the error.
    fn divided(peak: Peak) -> Vec<f64> {
        let (interior, mut resolution) = (started(Shape::Quartic), Resolution::default());
        resolution.errors = vec![0.0, peak.error, 0.0];
        resolution.violations = vec![0.0; 3];
        resolution.peaks = vec![Peak::default(), peak, Peak::default()];
        resolution.divided(&interior.spline, &[false, true, false], 1e-6)
    }

    /// Positions and rates are limited at nodes, tasks at points in the middle of intervals too.
    #[test]
    fn intervals_are_divided_at_peaks() {
        let peak = Peak { error: 1.0, place: 0.4, is_at_node: true };
        let close = |found: Vec<f64>, expected: &[f64]| {
            assert_eq!(found.len(), expected.len(), "{found:?}");
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
        };
        let third = 1.0 / 3.0;
        close(divided(peak), &[0.0, third, 1.4 * third, 2.0 * third, 1.0]);
        let around = Peak { is_at_node: false, ..peak };
        close(divided(around), &[0.0, third, 1.2 * third, 1.6 * third, 2.0 * third, 1.0]);
        let beside = Peak { place: 0.1, ..peak };
        close(divided(beside), &[0.0, third, 1.1 * third, 1.55 * third, 2.0 * third, 1.0]);
    }

    #[test]
    fn nodes_that_are_kept_stay() {
        // Two that are close to each other; an added one close to each of them, to the ends, to another one.
        let nodes = vec![0.0, 0.4, 0.405, 1.0];
        let added = vec![0.996, 0.7, 0.395, 0.41, 0.004, 0.2, 0.705];
        assert_eq!(with_added(nodes, added, 0.01), [0.0, 0.2, 0.4, 0.405, 0.7, 1.0]);
    }
}
