//! Sums of rows, the building block of matrix products; rows of packs as numbers.

use super::Panel;
use crate::scalar::{Pack, Scalar};

/// `sum_k a_k b_k`, truncated to the shorter slice.
#[inline]
pub fn dot<S: Scalar>(a: &[S], b: &[S]) -> S {
    a.iter().zip(b).fold(S::zero(), |sum, (&a, &b)| a.mul_add(b, sum))
}

/// The same in packs, the terms in another order.
#[inline]
pub(crate) fn dot_packs<S: Scalar>(a: &[S], b: &[S]) -> S {
    let lanes = Panel::<S>::LANES;
    if Panel::<S>::ONE_LANE {
        return dot(a, b);
    }
    let length = a.len().min(b.len());
    let (pairs_a, pairs_b) = (a[..length].chunks_exact(2 * lanes), b[..length].chunks_exact(2 * lanes));
    let rest = pairs_a.remainder().chunks(lanes).zip(pairs_b.remainder().chunks(lanes));
    let mut sums = [S::Pack::zero(); 2];
    for (a, b) in pairs_a.zip(pairs_b) {
        for (k, sum) in sums.iter_mut().enumerate() {
            let part = k * lanes..(k + 1) * lanes;
            *sum = S::Pack::read(&a[part.clone()]).mul_add(S::Pack::read(&b[part]), *sum);
        }
    }
    let [even, odd] = sums;
    let sum = rest.fold(even + odd, |sum, (a, b)| S::Pack::read(a).mul_add(S::Pack::read(b), sum));
    (1..lanes).fold(sum.lane(0), |total, lane| total + sum.lane(lane))
}

/// `target += factor source`, truncated to the shorter slice.
#[inline]
pub fn add_scaled<S: Scalar>(target: &mut [S], factor: S, source: &[S]) {
    target.iter_mut().zip(source).for_each(|(target, &source)| *target = factor.mul_add(source, *target));
}

/// `target += sum of a row_k` over the terms (k, a), rows of `source` being `stride` apart.
///
/// W: length of the target and stride where they are known, else 0, and some columns at a time. The sums stay
/// in registers during the loop over the terms.
#[inline(always)]
pub(crate) fn sum_rows<const W: usize, S: Scalar>(
    target: &mut [S],
    source: &[S],
    stride: usize,
    terms: impl Iterator<Item = (usize, S)> + Clone,
) {
    if W == 0 {
        add_rows(target, source, stride, terms);
    } else if let Some(target) = target.first_chunk_mut::<W>() {
        let (mut sum, (rows, _)) = (*target, source.as_chunks::<W>());
        for (k, a) in terms {
            for (sum, &entry) in sum.iter_mut().zip(&rows[k]) {
                *sum = a.mul_add(entry, *sum);
            }
        }
        *target = sum;
    } else {
        // Not the known length after all: correct, but not fast.
        for left in 0..target.len() {
            add_block::<1, S>(&mut target[left..], source, stride, left, terms.clone());
        }
    }
}

/// [`sum_rows`] for a target of any length.
#[inline(always)]
pub(crate) fn add_rows<S: Scalar>(
    target: &mut [S],
    source: &[S],
    stride: usize,
    terms: impl Iterator<Item = (usize, S)> + Clone,
) {
    let mut left = 0;
    // The number of sums that fit into registers.
    while const { size_of::<S>() <= 32 } && target.len() - left >= 12 {
        add_block::<12, S>(&mut target[left..], source, stride, left, terms.clone());
        left += 12;
    }
    while target.len() - left >= 6 {
        add_block::<6, S>(&mut target[left..], source, stride, left, terms.clone());
        left += 6;
    }
    if target.len() - left >= 4 {
        add_block::<4, S>(&mut target[left..], source, stride, left, terms.clone());
        left += 4;
    }
    if target.len() - left >= 2 {
        add_block::<2, S>(&mut target[left..], source, stride, left, terms.clone());
        left += 2;
    }
    if target.len() > left {
        add_block::<1, S>(&mut target[left..], source, stride, left, terms);
    }
}

#[inline(always)]
fn add_block<const B: usize, S: Scalar>(
    target: &mut [S],
    source: &[S],
    stride: usize,
    left: usize,
    terms: impl Iterator<Item = (usize, S)>,
) {
    let Some(target) = target.first_chunk_mut::<B>() else { return };
    let mut sum = *target;
    for (k, a) in terms {
        let row = &source[k * stride + left..][..B];
        for (sum, &entry) in sum.iter_mut().zip(row) {
            *sum = a.mul_add(entry, *sum);
        }
    }
    *target = sum;
}

/// A function of the packs, as many lanes as there are numbers.
#[inline(always)]
pub(crate) fn write_packs<S: Scalar>(from: &[S::Pack], to: &mut [S], function: impl Fn(S::Pack) -> S::Pack) {
    // Whole packs apart: each is one store.
    let (whole, rest) = to.split_at_mut(to.len() - to.len() % Panel::<S>::LANES);
    let packs = whole.len() / Panel::<S>::LANES;
    whole.chunks_exact_mut(Panel::<S>::LANES).zip(from).for_each(|(to, &pack)| function(pack).write(to));
    if !rest.is_empty() {
        function(from[packs]).write(rest);
    }
}

#[cfg(test)]
mod tests {
    use super::{add_rows, dot, dot_packs, sum_rows};

    #[test]
    fn a_product_in_packs_is_that_of_the_numbers() {
        for n in 0..=27 {
            let numbers = |from: f64| (0..n).map(|i| (from + 1.3 * i as f64).sin()).collect::<Vec<f64>>();
            let (a, b) = (numbers(0.2), numbers(1.7));
            assert!((dot_packs(&a, &b) - dot(&a, &b)).abs() < 1e-14, "n = {n}");
            // As far as the shorter one.
            assert_eq!(dot_packs(&a, &[b.as_slice(), &[7.0; 9]].concat()), dot_packs(&a, &b));
        }
    }

    #[test]
    fn rows_are_added_in_blocks_of_any_length() {
        let source: Vec<f64> = (0..40).map(|i| (i * i % 17) as f64).collect();
        for columns in 1..=10 {
            let terms = [(0, 2.0), (3, -1.0), (1, 0.5)];
            let mut target: Vec<f64> = (0..columns).map(|j| j as f64).collect();
            add_rows(&mut target, &source, 10, terms.into_iter());
            for (j, found) in target.iter().enumerate() {
                let expected = terms.iter().map(|(k, a)| a * source[10 * k + j]).sum::<f64>() + j as f64;
                assert_eq!(*found, expected);
            }
        }
    }

    #[test]
    fn a_length_that_is_known_changes_nothing() {
        let source: Vec<f64> = (0..40).map(|i| (i * i % 17) as f64).collect();
        let terms = [(0, 2.0), (3, -1.0), (1, 0.5)];
        let (mut known, mut unknown) = ([1.0, 2.0, 3.0, 4.0, 5.0], [1.0, 2.0, 3.0, 4.0, 5.0]);
        sum_rows::<5, _>(&mut known, &source, 5, terms.into_iter());
        add_rows(&mut unknown, &source, 5, terms.into_iter());
        assert_eq!(known, unknown);
    }
}
