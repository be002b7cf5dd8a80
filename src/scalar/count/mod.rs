//! A scalar that counts operations.

mod dual_num;
mod number;
mod operators;

pub use number::Count;

use std::cell::Cell;
use std::ops::{Add, AddAssign};

/// Arithmetic operations, by kind. Changes of sign, choices by [`select`](super::Scalar::select) and copies
/// are free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Multiplications.
    pub mul: u64,
    /// Additions and subtractions.
    pub add: u64,
    /// Divisions and reciprocals.
    pub div: u64,
    /// Square roots.
    pub sqrt: u64,
    /// Pairs of sine and cosine.
    pub sincos: u64,
    /// Exponential functions.
    pub exp: u64,
    /// Comparisons.
    pub less: u64,
    /// Any other function; the pipeline has none.
    pub other: u64,
}

impl Add for Operations {
    type Output = Self;
    fn add(self, more: Self) -> Self {
        Self {
            mul: self.mul + more.mul,
            add: self.add + more.add,
            div: self.div + more.div,
            sqrt: self.sqrt + more.sqrt,
            sincos: self.sincos + more.sincos,
            exp: self.exp + more.exp,
            less: self.less + more.less,
            other: self.other + more.other,
        }
    }
}

impl AddAssign for Operations {
    fn add_assign(&mut self, more: Self) {
        *self = *self + more;
    }
}

/// How operations with constant results are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Constants {
    /// They are free, as in code generated for one robot: products with exactly 0, 1 or -1, sums with exactly
    /// 0, anything between two constants. A division by a constant is a multiplication.
    #[default]
    Folded,
    /// They count like all others: every operation, as scalars without a fused multiply-add execute
    /// them, one lane at a time.
    Kept,
}

/// The kinds of [`Operations`].
#[derive(Clone, Copy, Debug)]
enum Kind {
    Mul,
    Add,
    Div,
    Sqrt,
    SinCos,
    Exp,
    Less,
    Other,
}

/// The running count of a thread by [`Kind`], and its mode.
struct Tally {
    counts: [Cell<u64>; 8],
    constants: Cell<Constants>,
}

impl Tally {
    const fn new() -> Self {
        Self { counts: [const { Cell::new(0) }; 8], constants: Cell::new(Constants::Folded) }
    }

    fn operations(&self) -> Operations {
        let of = |kind: Kind| self.counts[kind as usize].get();
        Operations {
            mul: of(Kind::Mul),
            add: of(Kind::Add),
            div: of(Kind::Div),
            sqrt: of(Kind::Sqrt),
            sincos: of(Kind::SinCos),
            exp: of(Kind::Exp),
            less: of(Kind::Less),
            other: of(Kind::Other),
        }
    }

    /// Exchanges counts and mode with those of this thread.
    fn swap(&self) {
        TALLY.with(|tally| {
            self.counts.iter().zip(&tally.counts).for_each(|(ours, theirs)| ours.swap(theirs));
            self.constants.swap(&tally.constants);
        });
    }
}

thread_local! {
    static TALLY: Tally = const { Tally::new() };
}

/// Restores the outer tally, also after a panic.
struct Surroundings(Tally);

impl Drop for Surroundings {
    fn drop(&mut self) {
        self.0.swap();
    }
}

/// Counts the operations of `work` with [`Count`] numbers on this thread, [`Constants::Folded`].
///
/// Nested counts are separate: the outer count does not include the inner one.
///
/// ```
/// use costate::scalar::{Count, Scalar, count};
/// let x = Count::variable(3.0);
/// let (_, operations) = count(|| x * x + Count::one() * x + Count::zero());
/// assert_eq!((operations.mul, operations.add), (1, 1)); // 1 x and + 0 are folded
/// ```
pub fn count<R>(work: impl FnOnce() -> R) -> (R, Operations) {
    count_with(Constants::Folded, work)
}

/// As [`count`], with constants folded or kept.
///
/// ```
/// use costate::scalar::{Constants, Count, Scalar, count_with};
/// let x = Count::variable(3.0);
/// let (_, operations) = count_with(Constants::Kept, || x * x + Count::one() * x + Count::zero());
/// assert_eq!((operations.mul, operations.add), (2, 2));
/// ```
pub fn count_with<R>(constants: Constants, work: impl FnOnce() -> R) -> (R, Operations) {
    let surroundings = Surroundings(Tally::new());
    surroundings.0.constants.set(constants);
    surroundings.0.swap();
    let result = work();
    let counted = TALLY.with(Tally::operations);
    drop(surroundings);
    (result, counted)
}

/// Counts an operation; if its result is `known` beforehand, only with constants kept.
#[inline]
fn tally(known: bool, kind: Kind) {
    TALLY.with(|tally| {
        if !known || tally.constants.get() == Constants::Kept {
            let count = &tally.counts[kind as usize];
            count.set(count.get() + 1);
        }
    });
}

/// Whether constants are currently folded.
fn folds() -> bool {
    TALLY.with(|tally| tally.constants.get() == Constants::Folded)
}

#[cfg(test)]
mod tests {
    use super::{Constants, Count, Operations, count, count_with};
    use crate::scalar::Scalar;

    /// Every operation and function, with constants in between.
    fn everything(x: Count, y: Count) -> Count {
        let s = x * y + x.times(3.0) - x.times(0.0) + y.plus(0.0);
        let (sin, cos) = s.sin_cos();
        sin / cos + x.recip() + x.sqrt() + Scalar::tanh(x)
    }

    #[test]
    fn every_kind_is_counted_and_constants_are_folded() {
        let (x, y) = (Count::variable(2.0), Count::variable(0.0));
        let (value, o) = count(|| everything(x, y).value());
        assert!((value - (6.0_f64.tan() + 0.5 + 2.0_f64.sqrt() + 2.0_f64.tanh())).abs() < 1e-14);
        assert_eq!((o.mul, o.div, o.sqrt, o.sincos, o.exp, o.less), (2 + 4, 2 + 2, 1, 1, 2, 2));
        assert_eq!(o.add, 2 + 3 + 2);
    }

    #[test]
    fn constants_that_are_kept_count_and_change_no_value() {
        let (x, y) = (Count::variable(2.0), Count::variable(0.0));
        let (folded, few) = count(|| everything(x, y).value());
        let (kept, all) = count_with(Constants::Kept, || everything(x, y).value());
        assert_eq!(folded, kept);
        assert_eq!(all, Operations { mul: few.mul + 1, add: few.add + 2, ..few });
        let two = Count::from_f64(2.0);
        let known = || (two / two + two.sqrt().exp()) * x / two;
        assert_eq!(count(known).1, Operations { mul: 2, ..Operations::default() });
        let (_, all) = count_with(Constants::Kept, known);
        assert_eq!(all, Operations { mul: 1, div: 2, add: 1, sqrt: 1, exp: 1, ..Operations::default() });
    }

    #[test]
    fn a_zero_of_rounded_constants_passes_its_error_on() {
        let (x, c) = (Count::variable(2.0), Count::from_f64(0.3).times(3.0));
        let zero = c - c;
        assert!(zero.value() == 0.0 && zero.rounding() > 0.0);
        for (product, factor) in [(zero * x, 2.0), (x * zero, 2.0), (zero / x, 0.5), (zero * c, c.value())] {
            assert!(product.value() == 0.0 && (product.rounding() / zero.rounding() - factor).abs() < 1e-15);
        }
        assert_eq!((Count::zero() * c).rounding(), 0.0);
    }

    #[test]
    fn counts_nest() {
        let x = Count::variable(2.0);
        let (inner, outer) = count_with(Constants::Kept, || {
            let before = x * x;
            let (_, inner) = count(|| before + x + Count::zero());
            (inner, before + Count::zero())
        });
        assert_eq!((inner.0.add, inner.0.mul, outer.add, outer.mul), (1, 0, 1, 1));
    }

    #[test]
    fn a_count_that_unwinds_leaves_its_surroundings_as_they_were() {
        let x = Count::variable(2.0);
        let (_, outer) = count(|| {
            let before = x * x;
            let inner = || count_with(Constants::Kept, || std::panic::resume_unwind(Box::new(before + x)));
            assert!(std::panic::catch_unwind(inner).is_err());
            before + Count::zero()
        });
        assert_eq!(outer, Operations { mul: 1, ..Operations::default() });
    }
}
