//! Polynomials of degree four, such as rates on an interval times its length.

/// A bound of a polynomial of degree four on [0, 1], from its values at 0, 1/4, 1/2, 3/4 and 1: the largest
/// of its Bernstein coefficients, in whose range it is.
pub(super) fn bound_of_quartic(&[a, b, c, d, e]: &[f64; 5]) -> f64 {
    let sum = (16.0 * (b + d) - 18.0 * c - 4.0 * (a + e)) / 3.0;
    let difference = (16.0 * (b - d) - 5.0 * (a - e)) / 6.0;
    let middle = (16.0 * c - a - e - 4.0 * sum) / 6.0;
    let coefficients = [a, 0.5 * (sum + difference), middle, 0.5 * (sum - difference), e];
    coefficients.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

#[cfg(test)]
mod tests {
    use super::bound_of_quartic;

    /// The bound, and the largest value at many places.
    fn compare(f: impl Fn(f64) -> f64) -> (f64, f64) {
        let bound = bound_of_quartic(&std::array::from_fn(|j| f(j as f64 / 4.0)));
        let largest = (0..=1000).map(|j| f(f64::from(j) / 1000.0).abs()).fold(0.0, f64::max);
        (bound, largest)
    }

    #[test]
    fn quartics_stay_within_their_bounds() {
        // Zero at the four places that tell a cubic.
        let (bound, largest) = compare(|x| x * (x - 1.0 / 3.0) * (x - 2.0 / 3.0) * (x - 1.0));
        assert!(largest > 0.01 && bound >= largest && bound < 10.0 * largest, "{bound} {largest}");
        let mut random = fastrand::Rng::with_seed(2);
        for _ in 0..300 {
            let c: [f64; 5] = std::array::from_fn(|_| 2.0 * random.f64() - 1.0);
            let (bound, largest) = compare(|x| c.iter().fold(0.0, |sum, c| sum * x + c));
            assert!(bound >= largest * (1.0 - 1e-12) && bound < 12.0 * largest, "{c:?} {bound} {largest}");
        }
        // Bernstein's polynomials themselves.
        for (i, factor) in [1.0, 4.0, 6.0, 4.0, 1.0].into_iter().enumerate() {
            let power = i as i32;
            let (bound, _) = compare(|x| factor * x.powi(power) * (1.0 - x).powi(4 - power));
            assert!((bound - 1.0).abs() < 1e-13, "{i} {bound}");
        }
    }
}
