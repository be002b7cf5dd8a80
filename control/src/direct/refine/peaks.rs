//! New nodes at the peaks of what is beyond its limit between points.

use crate::constants::direct as constants;

/// The peak in an interval that makes the largest error of the cost there.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Peak {
    pub error: f64,
    /// The part of the interval to the left.
    pub place: f64,
    /// Whether the limit is kept at nodes, or else at the middle of intervals.
    pub is_at_node: bool,
}

impl Peak {
    /// Takes another one if it is larger. What the multipliers of neighbours make of one peak adds up.
    pub fn take(&mut self, other: Self) {
        if other.place == self.place {
            self.error += other.error;
        } else if other.error > self.error {
            *self = other;
        }
    }

    /// Where an interval with this error is divided, in parts of it: so that the limit is kept at the place
    /// of the peak. Then it moves by little, and what is left of it falls with the square of that. `None`
    /// where the peak does not make most of the error, or lies at a node and the limit is kept there.
    pub fn parts(&self, of_interval: f64) -> Option<Parts> {
        let room = self.place.min(1.0 - self.place);
        if self.error < constants::OF_PEAK * of_interval {
            return None;
        }
        let [node, point] = constants::BESIDE_NODE;
        match (self.is_at_node, room < if self.is_at_node { node } else { point }) {
            (true, false) => Some(Parts::At(vec![self.place])),
            (true, true) => None,
            (false, false) => Some(Parts::At([-0.5, 0.5].map(|part| self.place + part * room).to_vec())),
            (false, true) => Some(Parts::Instead(self.place)),
        }
    }
}

/// How an interval with a peak is divided.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Parts {
    /// At the peak, or with the peak in the middle between two places.
    At(Vec<f64>),
    /// On both sides of the peak, instead of the node beside it.
    Instead(f64),
}

#[cfg(test)]
mod tests {
    use super::{Parts, Peak};

    #[test]
    fn the_largest_peak_counts_with_all_that_it_costs() {
        let peak = |error: f64, place: f64| Peak { error, place, is_at_node: true };
        let mut found = Peak::default();
        for other in [peak(1.0, 0.4), peak(2.0, 0.6), peak(1.5, 0.4), peak(0.5, 0.6)] {
            found.take(other);
        }
        assert_eq!((found.error, found.place), (2.5, 0.6));
    }

    #[test]
    fn a_limit_is_kept_where_its_peak_was() {
        let peak = Peak { error: 0.9, place: 0.3, is_at_node: true };
        assert_eq!(peak.parts(1.0), Some(Parts::At(vec![0.3])));
        let around = Peak { is_at_node: false, ..peak };
        let Some(Parts::At(places)) = around.parts(1.0) else { panic!("{around:?}") };
        let [left, right] = places[..] else { panic!("{places:?}") };
        assert!((0.5 * (left + right) - 0.3).abs() < 1e-15 && (right - left - 0.3).abs() < 1e-15);
        assert_eq!(Peak { place: 0.02, ..around }.parts(1.0), Some(Parts::Instead(0.02)));
        // Other errors are larger; the node is there.
        assert_eq!(peak.parts(2.0), None);
        assert_eq!(Peak { place: 0.99, ..peak }.parts(1.0), None);
    }
}
