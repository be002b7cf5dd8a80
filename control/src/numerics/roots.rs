//! Real roots of polynomials on the unit interval.

/// Most coefficients of a polynomial.
pub(crate) const MOST_COEFFICIENTS: usize = 8;
/// Halvings of a bracket: the width of the last one is below the spacing of numbers near 1.
const HALVINGS: usize = 54;
/// An extremum whose value is this small, relative to the sum of the magnitudes of the coefficients, touches
/// zero: rounding of Horner's rule is below `2 n eps` times that sum, n the number of coefficients.
const TOUCHES: f64 = 16.0 * f64::EPSILON;

/// Finds all `x` in (0, 1) with `c_0 + c_1 x + .. + c_m x^m = level`, rising, and adds them to `found`.
///
/// The extrema, which are the roots of the derivative, split the interval into monotone pieces; each piece
/// with a change of sign is bisected. So no root is missed, however close to another one, unless rounding
/// hides it. A double root is found as an extremum whose value is rounding. A constant has no roots. At most
/// [`MOST_COEFFICIENTS`] coefficients count.
pub(crate) fn roots(coefficients: &[f64], level: f64, found: &mut Vec<f64>) {
    let count = coefficients.len().min(MOST_COEFFICIENTS);
    let mut c = [0.0; MOST_COEFFICIENTS];
    c[..count].copy_from_slice(&coefficients[..count]);
    c[0] -= level;
    if count < 2 || c.iter().any(|c| !c.is_finite()) {
        return;
    }
    // Roots of the derivatives, the highest one first.
    let mut derivatives = [[0.0; MOST_COEFFICIENTS]; MOST_COEFFICIENTS];
    derivatives[0] = c;
    for order in 1..count {
        for k in 0..count - order {
            derivatives[order][k] = (k + 1) as f64 * derivatives[order - 1][k + 1];
        }
    }
    let (mut extrema, mut extrema_count) = ([0.0; MOST_COEFFICIENTS], 0);
    for (order, c) in derivatives[..count - 1].iter().enumerate().rev() {
        let (mut next, mut next_count) = ([0.0; MOST_COEFFICIENTS], 0);
        let size: f64 = c.iter().map(|c| c.abs()).sum();
        let mut left = (0.0, value(c, 0.0));
        let ends = extrema[..extrema_count].iter().map(|x| (*x, true)).chain([(1.0, false)]);
        for (x, is_extremum) in ends {
            let mut right = (x, value(c, x));
            if right.1.abs() <= TOUCHES * size && is_extremum {
                right.1 = 0.0;
            }
            let root = if left.1 * right.1 < 0.0 {
                Some(bisect(c, left, right.0))
            } else {
                (right.1 == 0.0 && right.0 < 1.0).then_some(right.0)
            };
            if let Some(root) = root.filter(|_| size > 0.0 && next_count < MOST_COEFFICIENTS) {
                (next[next_count], next_count) = (root, next_count + 1);
            }
            left = right;
        }
        (extrema, extrema_count) = (next, next_count);
        if order == 0 {
            found.extend(extrema[..extrema_count].iter().filter(|x| **x > 0.0 && **x < 1.0));
        }
    }
}

fn value(c: &[f64], x: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * x + c)
}

/// The root between two places whose values have different signs.
fn bisect(c: &[f64], (mut low, at_low): (f64, f64), mut high: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if (value(c, middle) > 0.0) == (at_low > 0.0) { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficients of the product of `x - root`.
    fn product(roots: &[f64]) -> Vec<f64> {
        roots.iter().fold(vec![1.0], |c, root| {
            let mut next = vec![0.0; c.len() + 1];
            for (k, c) in c.iter().enumerate() {
                next[k + 1] += c;
                next[k] -= root * c;
            }
            next
        })
    }

    fn found(coefficients: &[f64], level: f64) -> Vec<f64> {
        let mut found = Vec::new();
        roots(coefficients, level, &mut found);
        found
    }

    /// A root of multiplicity one is off by about the rounding of the value over the slope there.
    #[test]
    fn all_roots_inside_are_found_in_their_order() {
        let expected = [0.1, 0.101, 0.5, 0.93];
        let all = found(&product(&[-0.4, 0.93, 0.1, 0.5, 0.101, 1.7]), 0.0);
        assert_eq!(all.len(), 4, "{all:?}");
        assert!(all.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-10), "{all:?}");
        // A level, not zero.
        let all = found(&[0.0, 0.0, 4.0], 1.0);
        assert!(all.len() == 1 && (all[0] - 0.5).abs() < 1e-15, "{all:?}");
    }

    #[test]
    fn a_touch_is_one_root_and_ends_and_constants_are_none() {
        let touch = found(&product(&[0.3, 0.3]), 0.0);
        assert!(touch.len() == 1 && (touch[0] - 0.3).abs() < 1e-7, "{touch:?}");
        assert!(found(&product(&[0.0, 1.0]), 0.0).is_empty());
        assert!(found(&[0.0; 4], 0.0).is_empty() && found(&[2.0], 2.0).is_empty());
        assert!(found(&[f64::NAN, 1.0], 0.0).is_empty());
    }

    #[test]
    fn roots_of_random_polynomials_are_sign_changes() {
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..300 {
            let c: Vec<f64> = (0..6).map(|_| 2.0 * random.f64() - 1.0).collect();
            let all = found(&c, 0.0);
            let signs = (0..=10_000).map(|k| value(&c, f64::from(k) / 10_000.0) > 0.0);
            let changes = signs.clone().zip(signs.skip(1)).filter(|(a, b)| a != b).count();
            assert!(all.len() >= changes && all.windows(2).all(|pair| pair[0] < pair[1]), "{c:?} {all:?}");
            assert!(all.iter().all(|x| value(&c, *x).abs() < 1e-14), "{c:?} {all:?}");
        }
    }
}
