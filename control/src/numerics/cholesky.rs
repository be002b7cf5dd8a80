//! `A = L L'` of small dense matrices that are symmetric and positive definite.

/// A pivot that is less than this part of its diagonal entry is rounding.
const ROUNDING: f64 = 1e-13;

/// Replaces the lower triangle of A (n x n, row by row) by L. False unless A is positive definite.
pub(crate) fn factorise(a: &mut [f64], n: usize) -> bool {
    factorise_above(a, n, |_, entry| ROUNDING * entry.abs())
}

/// The same where pivot i counts as positive above `least(i, a_ii)`.
pub(crate) fn factorise_above(a: &mut [f64], n: usize, least: impl Fn(usize, f64) -> f64) -> bool {
    for i in 0..n {
        for j in 0..=i {
            let entry = a[i * n + j];
            let known: f64 = (0..j).map(|k| a[i * n + k] * a[j * n + k]).sum();
            let sum = entry - known;
            if i == j {
                // Not true for NaN.
                let is_positive = sum > least(i, entry) && sum.is_finite();
                if !is_positive {
                    return false;
                }
                a[i * n + i] = sum.sqrt();
            } else {
                a[i * n + j] = sum / a[j * n + j];
            }
        }
    }
    true
}

/// Replaces b by A^-1 b with the L of [`factorise`].
pub(crate) fn solve(l: &[f64], n: usize, b: &mut [f64]) {
    for i in 0..n {
        let known: f64 = (0..i).map(|k| l[i * n + k] * b[k]).sum();
        b[i] = (b[i] - known) / l[i * n + i];
    }
    for i in (0..n).rev() {
        let known: f64 = (i + 1..n).map(|k| l[k * n + i] * b[k]).sum();
        b[i] = (b[i] - known) / l[i * n + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_and_tells_what_is_not_positive() {
        let a = [4.0, 2.0, 0.4, 2.0, 5.0, -1.0, 0.4, -1.0, 3.0];
        let (mut l, mut b) = (a, [1.0, -2.0, 3.0]);
        assert!(factorise(&mut l, 3));
        solve(&l, 3, &mut b);
        for (row, value) in a.chunks(3).zip([1.0, -2.0, 3.0]) {
            let product: f64 = row.iter().zip(b).map(|(a, b)| a * b).sum();
            assert!((product - value).abs() < 1e-14);
        }
        // An eigenvalue of -1; one of 0; a NaN.
        for mut bad in [[1.0, 2.0, 2.0, 1.0], [1.0, 1.0, 1.0, 1.0], [1.0, f64::NAN, f64::NAN, 1.0]] {
            assert!(!factorise(&mut bad, 2), "{bad:?}");
        }
    }
}
