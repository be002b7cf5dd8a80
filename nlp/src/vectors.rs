//! Loops over long vectors, for the widest vectors of the processor.

use crate::tiles::{LANES, fused};
use costate_numerics::in_widest;

/// The larger one; not-a-number is the largest.
#[inline(always)]
pub(crate) fn worse(a: f64, b: f64) -> f64 {
    if a >= b || a.is_nan() { a } else { b }
}

/// Folds values of entries of some vectors side by side, then together.
#[inline(always)]
fn fold<const K: usize>(
    from: [&[f64]; K],
    value: impl Fn([f64; K]) -> f64,
    with: impl Fn(f64, f64) -> f64,
) -> f64 {
    const SUMS: usize = 2 * LANES;
    let n = from.iter().map(|from| from.len()).min().unwrap_or(0);
    let from = from.map(|from| &from[..n]);
    let chunks = from.map(|from| &from.as_chunks::<SUMS>().0[..n / SUMS]);
    let mut sums = [0.0; SUMS];
    for i in 0..n / SUMS {
        for lane in 0..SUMS {
            sums[lane] = with(sums[lane], value(chunks.map(|chunk| chunk[i][lane])));
        }
    }
    let sum = sums.into_iter().fold(0.0, &with);
    (n / SUMS * SUMS..n).fold(sum, |sum, i| with(sum, value(from.map(|from| from[i]))))
}

/// The sum of these values of entries.
#[inline(always)]
pub(crate) fn sum_of<const K: usize>(from: [&[f64]; K], value: impl Fn([f64; K]) -> f64) -> f64 {
    fold(from, value, |a, b| a + b)
}

/// The largest of these values, which are not negative; not-a-number if one is.
#[inline(always)]
pub(crate) fn largest_of<const K: usize>(from: [&[f64]; K], value: impl Fn([f64; K]) -> f64) -> f64 {
    fold(from, value, worse)
}

/// The largest absolute value; not-a-number if one is.
pub(crate) fn largest(values: &[f64]) -> f64 {
    in_widest!(largest_entry(values))
}

#[inline(always)]
fn largest_entry<const FUSED: bool>(values: &[f64]) -> f64 {
    largest_of([values], |[value]| value.abs())
}

/// The sum of absolute values.
pub(crate) fn sum_of_sizes(values: &[f64]) -> f64 {
    in_widest!(sum_of_entries(values))
}

#[inline(always)]
fn sum_of_entries<const FUSED: bool>(values: &[f64]) -> f64 {
    sum_of([values], |[value]| value.abs())
}

/// The sum of the products of entries.
pub(crate) fn product(a: &[f64], b: &[f64]) -> f64 {
    in_widest!(product_of(a, b))
}

#[inline(always)]
fn product_of<const FUSED: bool>(a: &[f64], b: &[f64]) -> f64 {
    sum_of([a, b], |[a, b]| a * b)
}

/// The sum of `|a - b|`.
pub(crate) fn sum_of_differences(a: &[f64], b: &[f64]) -> f64 {
    in_widest!(sum_of_gaps(a, b))
}

#[inline(always)]
fn sum_of_gaps<const FUSED: bool>(a: &[f64], b: &[f64]) -> f64 {
    sum_of([a, b], |[a, b]| (a - b).abs())
}

/// `to = from + length step`.
pub(crate) fn move_along(to: &mut [f64], from: &[f64], step: &[f64], length: f64) {
    in_widest!(move_entries(to, from, step, length));
}

#[inline(always)]
fn move_entries<const FUSED: bool>(to: &mut [f64], from: &[f64], step: &[f64], length: f64) {
    for ((to, from), d) in to.iter_mut().zip(from).zip(step) {
        *to = fused::<FUSED>(length, *d, *from);
    }
}

/// The sum of logarithms, without entries that are infinite.
pub(crate) fn sum_of_logarithms(values: &[f64]) -> f64 {
    values.chunks(MANTISSAS).map(|values| in_widest!(logarithms(values))).sum()
}

/// The product of at most this many mantissas of four lanes each is a number.
const MANTISSAS: usize = 2048;

#[inline(always)]
fn logarithms<const FUSED: bool>(values: &[f64]) -> f64 {
    let (chunks, rest) = values.as_chunks::<LANES>();
    // Logarithms of products: of mantissas, and sums of exponents.
    let (mut mantissas, mut exponents, mut usual) = ([1.0; LANES], [0_u64; LANES], [true; LANES]);
    for chunk in chunks {
        for lane in 0..LANES {
            usual[lane] &= chunk[lane] >= f64::MIN_POSITIVE;
            let value = if chunk[lane] < f64::INFINITY { chunk[lane] } else { 1.0 };
            mantissas[lane] *= f64::from_bits(value.to_bits() & MANTISSA | 1.0_f64.to_bits());
            exponents[lane] += value.to_bits() >> 52;
        }
    }
    let logarithm = |value: &f64| if *value == f64::INFINITY { 0.0 } else { value.ln() };
    if usual != [true; LANES] {
        return values.iter().map(logarithm).sum();
    }
    let exponent = exponents.iter().sum::<u64>() as f64 - (1023 * LANES * chunks.len()) as f64;
    let rest: f64 = rest.iter().map(logarithm).sum();
    let [p, q, r, s] = mantissas.map(f64::ln);
    exponent * std::f64::consts::LN_2 + ((p + q) + (r + s)) + rest
}

/// The bits of a mantissa.
const MANTISSA: u64 = (1 << 52) - 1;

#[cfg(test)]
mod tests {
    use super::{largest, sum_of_logarithms};

    #[test]
    fn sums_of_logarithms_are_those_of_the_library() {
        let value = |k: usize| 10.0_f64.powf(40.0 * (k as f64 * 0.7).sin());
        for (count, odd) in [(3, None), (10, None), (5000, None), (9, Some(0.0)), (9, Some(1e-310))] {
            let mut a: Vec<f64> = (0..count).map(value).collect();
            a[1] = f64::INFINITY;
            if let Some(odd) = odd {
                a[2] = odd;
            }
            let expected: f64 = a.iter().filter(|gap| gap.is_finite()).map(|gap| gap.ln()).sum();
            let found = sum_of_logarithms(&a);
            let size: f64 = a.iter().filter(|gap| gap.is_finite()).map(|gap| gap.ln().abs()).sum();
            assert!(found == expected || (found - expected).abs() < 1e-14 * size, "{found} {expected}");
        }
        assert!(sum_of_logarithms(&[-1.0; 5]).is_nan());
    }

    #[test]
    fn a_value_that_is_no_number_is_the_largest() {
        for at in 0..9 {
            let mut values: Vec<f64> = (0..9).map(|k| k as f64 - 7.0).collect();
            assert_eq!(largest(&values), 7.0);
            values[at] = f64::NAN;
            assert!(largest(&values).is_nan());
        }
    }
}
