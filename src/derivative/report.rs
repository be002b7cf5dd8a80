//! How far methods for the same numbers differ, and how far rounding lets them.

use crate::matrix::Block;
use std::cmp::Ordering;

/// One comparison at one state, see [`StateReport`].
///
/// Every block is judged by a bound of its own; this is the block that comes closest to it. Both numbers are
/// relative to the largest sum of reference and difference in that block, in scaled coordinates (see
/// [`Routes`](super::Routes)).
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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

/// What a [`Figure`] says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The difference is within the bound.
    Agrees,
    /// Rounding may change the block by more than a thousandth of it: M is nearly singular, or numbers
    /// overflow.
    NotComparable,
    /// The difference exceeds the bound, or is not finite.
    Differs,
}

/// Largest relative bound of a comparison that says anything.
const COMPARABLE: f64 = 1e-3;

impl Figure {
    /// Difference in units of the bound; not-a-number if one of them is.
    pub fn ratio(&self) -> f64 {
        if self.difference == 0.0 { 0.0 } else { self.difference / self.bound }
    }

    /// Judges the difference by `tolerance` times the bound.
    pub fn verdict(&self, tolerance: f64) -> Verdict {
        if !self.difference.is_finite() {
            Verdict::Differs
        } else if self.bound.is_nan() || self.bound > COMPARABLE {
            Verdict::NotComparable
        } else if self.ratio() <= tolerance {
            Verdict::Agrees
        } else {
            Verdict::Differs
        }
    }

    /// The worse of two: of what is comparable the larger ratio counts, and not-a-number is the worst; of
    /// equal ones, the larger bound is kept. What is not comparable is passed over, but not for zeros that no
    /// operation rounds: they would agree though nothing was compared.
    #[must_use]
    pub fn or_worse(self, other: &Self) -> Self {
        let rank = |figure: &Self| {
            let number = |x: f64| if x.is_nan() { f64::INFINITY } else { x };
            let is_exact = figure.difference == 0.0 && figure.bound == 0.0;
            let says_something = figure.verdict(1.0) != Verdict::NotComparable && !is_exact;
            (says_something, figure.difference.is_nan(), number(figure.ratio()), number(figure.bound))
        };
        if rank(other).partial_cmp(&rank(&self)).is_some_and(Ordering::is_gt) { *other } else { self }
    }
}

/// All comparisons at one state; made by [`Routes`](super::Routes).
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct StateReport {
    /// Condition number of M in the 2-norm.
    pub condition: f64,
    /// Bound of the rounding error of M^-1 relative to its largest entry, in scaled coordinates.
    pub inverse_error: f64,
    /// Every comparison, in the same order in all reports on one robot; those of steps, which come last, may
    /// be missing.
    pub figures: Vec<Figure>,
}

impl StateReport {
    /// The figure of one quantity by one method, `None` if there is no such comparison.
    pub fn get(&self, quantity: &str, route: &str) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.quantity == quantity && figure.route == route)
    }

    /// The comparisons whose difference exceeds `tolerance` times the bound, or is not a number.
    pub fn failures(&self, tolerance: f64) -> impl Iterator<Item = &Figure> {
        self.figures.iter().filter(move |figure| figure.verdict(tolerance) == Verdict::Differs)
    }

    /// Whether rounding leaves less than three digits of M^-1, or too few for some comparison (see
    /// [`Verdict::NotComparable`]).
    pub fn is_nearly_singular(&self) -> bool {
        self.inverse_error > COMPARABLE
            || self.figures.iter().any(|figure| figure.verdict(1.0) == Verdict::NotComparable)
    }

    /// The worse of each figure of two reports on one robot; figures at the end that one of them lacks are
    /// the other's.
    #[must_use]
    pub fn with_worse_of(mut self, other: &Self) -> Self {
        self.condition = worse(self.condition, other.condition);
        self.inverse_error = worse(self.inverse_error, other.inverse_error);
        for (ours, theirs) in self.figures.iter_mut().zip(&other.figures) {
            *ours = ours.or_worse(theirs);
        }
        self.figures.extend(other.figures.iter().skip(self.figures.len()));
        self
    }
}

/// `max |a - b| / max(max |b|, natural)` over all entries.
///
/// `natural` is the size of the terms that a quantity is the sum of: it can vanish though its terms do not (a
/// balanced wheel, friction at rest, a pendulum at a right angle), and then consists of rounding errors only.
///
/// # Panics
/// If the blocks differ in shape.
pub fn relative_difference(a: Block<'_, f64>, b: Block<'_, f64>, natural: f64) -> f64 {
    let (a, b) = (a.as_nalgebra(), b.as_nalgebra());
    in_relation(largest(&(a - b)), largest(b), natural)
}

/// The largest absolute value; not-a-number if one is (which nalgebra's `amax` and `f64::max` would pass
/// over).
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
    use super::{Figure, Verdict, relative_difference};
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

    fn figure(difference: f64, bound: f64) -> Figure {
        Figure { quantity: "F", route: "a", difference, bound }
    }

    #[test]
    fn the_figure_nearest_to_its_bound_is_kept() {
        let (near, far) = (figure(1e-14, 2e-14), figure(2e-14, 1e-13));
        assert_eq!((near.or_worse(&far), far.or_worse(&near)), (near, near));
        assert_eq!(
            (near.ratio(), near.verdict(1.0), near.verdict(0.4)),
            (0.5, Verdict::Agrees, Verdict::Differs)
        );
        assert_eq!((figure(0.0, 0.0).ratio(), figure(0.0, 0.0).verdict(1.0)), (0.0, Verdict::Agrees));
        assert_eq!(figure(1e-20, 0.0).verdict(1.0), Verdict::Differs);
    }

    #[test]
    fn not_a_number_fails_and_is_kept() {
        let (bad, good) = (figure(f64::NAN, 1e-14), figure(1.0, 1e-14));
        assert_eq!(bad.verdict(1e300), Verdict::Differs);
        assert!(good.or_worse(&bad).difference.is_nan() && bad.or_worse(&good).difference.is_nan());
    }

    #[test]
    fn what_has_no_digits_left_is_not_compared() {
        assert_eq!(figure(0.1, 0.01).verdict(1.0), Verdict::NotComparable);
        assert_eq!(figure(0.1, f64::NAN).verdict(1.0), Verdict::NotComparable);
        assert_eq!(figure(0.4, 0.5).verdict(1.0), Verdict::NotComparable);
        assert_eq!(figure(0.4, f64::INFINITY).verdict(1.0), Verdict::NotComparable);
        assert_eq!(figure(0.0, 0.5).verdict(1.0), Verdict::NotComparable, "equal by chance");
        let (silent, loud) = (figure(0.4, 0.01), figure(1e-13, 1e-14));
        assert_eq!((silent.or_worse(&loud), loud.or_worse(&silent)), (loud, loud));
        let zero = figure(0.0, 0.0);
        for silent in [silent, figure(0.0, 0.5), figure(0.4, f64::NAN)] {
            for kept in [silent.or_worse(&zero), zero.or_worse(&silent)] {
                assert_eq!(kept.verdict(1.0), Verdict::NotComparable, "zeros hide {silent:?}");
            }
        }
    }
}
