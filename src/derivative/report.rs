//! How far methods for the same numbers differ, and how far rounding lets them.

use super::bounds::Bound;
use super::rounded::UNIT;
use crate::matrix::Block;

/// One comparison at one state, see [`StateReport`].
///
/// Every entry is judged by a bound of its own; this is the entry that comes closest to it. Both numbers are relative to
/// the size of the terms that the entry is the sum of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Figure {
    /// What is compared.
    pub quantity: &'static str,
    /// By which method it was computed.
    pub route: &'static str,
    /// Relative difference from the reference.
    pub difference: f64,
    /// Relative difference that rounding may cause.
    pub bound: f64,
}

impl Figure {
    /// Difference in units of the bound: agreement where it is at most 1. Not-a-number is no agreement.
    pub fn ratio(&self) -> f64 {
        if self.difference == 0.0 { 0.0 } else { self.difference / self.bound }
    }

    /// Compares entry by entry, `|a_ij - b_ij|` with [`SAFETY`] u times the error of the bound.
    pub(crate) fn judge(
        quantity: &'static str,
        route: &'static str,
        difference: impl Fn(usize, usize) -> f64,
        bound: &Bound,
    ) -> Self {
        let mut worst = Self { quantity, route, difference: 0.0, bound: 0.0 };
        for j in 0..bound.size.ncols() {
            for i in 0..bound.size.nrows() {
                let (difference, size) = (difference(i, j).abs(), bound.size[(i, j)]);
                let size = if difference == 0.0 { 1.0 } else { size };
                let bound = SAFETY * UNIT * bound.error[(i, j)] / size;
                worst = worst.or_worse(&Self { quantity, route, difference: difference / size, bound });
            }
        }
        worst
    }

    /// The one with the larger ratio; of two that agree exactly the one with the larger bound.
    fn or_worse(self, other: &Self) -> Self {
        let rank = |figure: &Self| if figure.ratio().is_nan() { f64::INFINITY } else { figure.ratio() };
        let (ours, theirs) = (rank(&self), rank(other));
        if theirs > ours || (theirs == ours && other.bound > self.bound) { *other } else { self }
    }
}

/// By how much a difference may exceed the standard deviation that bounds start from.
pub const SAFETY: f64 = 1.0;

/// What the methods say of each other at one state; made by [`Routes`](super::Routes).
#[derive(Clone, Debug, PartialEq)]
pub struct StateReport {
    /// Condition number of M in the 2-norm.
    pub condition: f64,
    /// Every comparison; the same in every report on one robot, but that the last may be missing.
    pub figures: Vec<Figure>,
}

impl StateReport {
    /// The figure of one quantity by one method, `None` if there is no such comparison.
    pub fn get(&self, quantity: &str, route: &str) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.quantity == quantity && figure.route == route)
    }

    /// The largest ratio of a difference to its bound.
    pub fn worst(&self) -> f64 {
        self.figures.iter().map(Figure::ratio).fold(0.0, worse)
    }

    /// The worse of each figure of two reports on one robot; figures at the end that one of them lacks are the other's.
    #[must_use]
    pub fn with_worse_of(mut self, other: &Self) -> Self {
        self.condition = worse(self.condition, other.condition);
        for (ours, theirs) in self.figures.iter_mut().zip(&other.figures) {
            *ours = ours.or_worse(theirs);
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

/// The largest absolute value; not-a-number if one is (which nalgebra's `amax` and `f64::max` would pass over).
pub fn largest<'a>(values: impl IntoIterator<Item = &'a f64>) -> f64 {
    values.into_iter().fold(0.0, |largest, value| worse(largest, value.abs()))
}

/// A difference relative to the size of what is compared.
fn in_relation(difference: f64, size: f64, natural: f64) -> f64 {
    if difference == 0.0 { 0.0 } else { difference / worse(size, natural) }
}

/// The larger of two figures; not-a-number is the worst.
pub fn worse(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

#[cfg(test)]
mod tests {
    use super::relative_difference;
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
}
