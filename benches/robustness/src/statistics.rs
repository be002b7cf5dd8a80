//! Paired tests.

/// `P(X <= k or X >= n - k)`, at most 1, for X the number of heads in n throws of a fair coin and k the
/// smaller of both counts: whether two counts that should be alike by chance are.
///
/// Of pairs of searches of which one alone succeeds, this is McNemar's exact test; of pairs of which one is
/// cheaper, the sign test.
pub fn two_sided(one: usize, other: usize) -> f64 {
    let (n, k) = (one + other, one.min(other));
    // log of the binomial coefficient times 2^-n, from one to the next.
    let mut log = -(n as f64) * std::f64::consts::LN_2;
    let mut sum = log.exp();
    for i in 0..k {
        log += ((n - i) as f64 / (i + 1) as f64).ln();
        sum += log.exp();
    }
    (2.0 * sum).min(1.0)
}

/// The middle one, or the mean of both in the middle; not a number where there are none. Sorts.
pub fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    match values.len() {
        0 => f64::NAN,
        n if n % 2 == 1 => values[n / 2],
        n => 0.5 * (values[n / 2 - 1] + values[n / 2]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn probabilities_are_those_of_the_binomial_distribution() {
        // 2 (1 + 10 + 45) / 1024, 2 / 2^5, and all of it.
        assert!((two_sided(2, 8) - 112.0 / 1024.0).abs() < 1e-15);
        assert!((two_sided(8, 2) - 112.0 / 1024.0).abs() < 1e-15);
        assert!((two_sided(0, 5) - 0.0625).abs() < 1e-16);
        assert_eq!((two_sided(4, 4), two_sided(0, 0)), (1.0, 1.0));
        // 2 sum of C(21, 0..=6) / 2^21, summed by hand: 1 + 21 + 210 + 1330 + 5985 + 20349 + 54264.
        assert!((two_sided(6, 15) - 2.0 * 82160.0 / 2_097_152.0).abs() < 1e-14);
    }

    #[test]
    fn large_counts_do_not_overflow() {
        let p = two_sided(0, 900);
        assert!((p.log2() + 899.0).abs() < 1e-9, "{p}");
        assert!(two_sided(495, 505) > 0.7);
        assert_eq!(two_sided(0, 5000), 0.0);
    }

    #[test]
    fn medians_of_even_and_odd_numbers() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 9.0]), 3.0);
        assert!(median(&mut []).is_nan());
    }
}
