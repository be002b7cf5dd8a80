//! How far routes to the same numbers differ.

use crate::matrix::Block;
use nalgebra::DMatrix;

/// One comparison at one state, see [`StateReport`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// What is compared.
    pub quantity: &'static str,
    /// By which route it was computed.
    pub route: &'static str,
    /// Relative difference from what judges it.
    pub value: f64,
    /// How much more than usual the condition of M may spoil it, see [`StateReport::excess`].
    pub sensitivity: f64,
}

/// What the routes say of each other at one state; made by [`Routes`](super::Routes).
#[derive(Clone, Debug, PartialEq)]
pub struct StateReport {
    /// Condition number of M in the 2-norm.
    pub condition: f64,
    /// Every comparison; the same in every report on one robot, but that the last may be missing.
    pub figures: Vec<Figure>,
}

impl StateReport {
    /// The figure of one quantity by one route, `None` if there is no such comparison.
    pub fn get(&self, quantity: &str, route: &str) -> Option<f64> {
        let same = |figure: &&Figure| figure.quantity == quantity && figure.route == route;
        self.figures.iter().find(same).map(|figure| figure.value)
    }

    /// The largest of all figures.
    pub fn worst(&self) -> f64 {
        self.figures.iter().map(|figure| figure.value).fold(0.0, worse)
    }

    /// The largest figure in units of what double precision allows: `tolerance max(1, sensitivity condition / 1000)`.
    pub fn excess(&self, tolerance: f64) -> f64 {
        let allowed = |figure: &Figure| tolerance * (figure.sensitivity * self.condition / 1000.0).max(1.0);
        self.figures.iter().map(|figure| figure.value / allowed(figure)).fold(0.0, worse)
    }

    /// The larger of each figure of two reports on one robot; figures at the end that one of them lacks are the other's.
    pub fn with_worse_of(mut self, other: &Self) -> Self {
        self.condition = worse(self.condition, other.condition);
        for (ours, theirs) in self.figures.iter_mut().zip(&other.figures) {
            ours.value = worse(ours.value, theirs.value);
        }
        self.figures.extend(other.figures.iter().skip(self.figures.len()));
        self
    }
}

/// `max |a - b| / max(max |b|, natural)` over all entries.
///
/// `natural` is the size of the terms that a quantity is the sum of: it can vanish though its terms do not (a balanced
/// wheel, friction at rest, a pendulum at a right angle), and is then rounding, of which no digit can agree.
///
/// # Panics
/// If the blocks differ in shape.
pub fn relative_difference(a: Block<'_, f64>, b: Block<'_, f64>, natural: f64) -> f64 {
    let (a, b) = (a.as_nalgebra(), b.as_nalgebra());
    in_relation(largest(&(a - b)), largest(b), natural)
}

/// The same for vectors.
pub(super) fn vector_difference(a: &[f64], b: &[f64], natural: f64) -> f64 {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    in_relation(largest(&differences), largest(b), natural)
}

/// The largest absolute value; not-a-number if one is (which nalgebra's `amax` and `f64::max` would pass over).
pub fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |largest, value| worse(largest, value.abs()))
}

/// `max |a - a'| / max |a|`, see [`relative_difference`].
pub(super) fn asymmetry(a: &DMatrix<f64>, natural: f64) -> f64 {
    in_relation(largest(&(a - a.transpose())), largest(a), natural)
}

/// A difference relative to the size of what is compared.
pub(super) fn in_relation(difference: f64, size: f64, natural: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / worse(size, natural) }
}

/// The larger of two figures; not-a-number is the worst.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::{Figure, StateReport, relative_difference};
    use crate::matrix::Matrix;

    /// A figure that is not a number must never look like agreement.
    #[test]
    fn not_a_number_is_not_agreement() {
        let good = Matrix::from_rows(2, &[1.0, 2.0, 3.0, 4.0]);
        for at in 0..4 {
            let mut entries = [1.0, 2.0, 3.0, 4.0];
            entries[at] = f64::NAN;
            let bad = Matrix::from_rows(2, &entries);
            assert!(relative_difference(good.view(), bad.view(), 0.0).is_nan(), "entry {at}");
            assert!(relative_difference(bad.view(), good.view(), 1.0).is_nan(), "entry {at}");
        }
        assert_eq!(relative_difference(good.view(), good.view(), 0.0), 0.0);
    }

    #[test]
    fn figures_are_judged_by_their_own_sensitivity() {
        let figure = |value, sensitivity| Figure { quantity: "F", route: "a", value, sensitivity };
        let report = |figures: &[Figure]| StateReport { condition: 2000.0, figures: figures.to_vec() };
        assert_eq!(report(&[figure(4e-12, 1.0), figure(4e-12, 10.0)]).excess(1e-12), 2.0);
        assert_eq!(report(&[figure(4e-12, 0.0)]).excess(1e-12), 4.0);
        let both = report(&[figure(1.0, 1.0)]).with_worse_of(&report(&[figure(f64::NAN, 1.0)]));
        assert!(both.worst().is_nan() && both.excess(1.0).is_nan() && both.get("F", "a").unwrap().is_nan());
        assert_eq!(both.get("F", "b"), None);
    }
}
