//! Polynomials of one interval.

use super::shape::{MOST_COEFFICIENTS, Shape};
use costate_numerics::widest_fused;

/// q, q', q'', q''' at a point as sums over the coefficients: of a quartic the height of the bubble, then q
/// and q' at the left end and at the right end; of a quintic q, q' and q'' at both ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Basis {
    /// Factors of the coefficients in q and its derivatives; zero for those that are not there.
    pub rows: [[f64; MOST_COEFFICIENTS]; 4],
}

/// A polynomial on [0, 1], lowest power first.
pub(super) type Powers = [f64; 6];

/// 16 x^2 (1 - x)^2, which is 1 in the middle; then position and first derivative 1 at the left end, then at
/// the right end, everything else 0 at both ends.
const QUARTIC: [Powers; 5] = [
    [0.0, 0.0, 16.0, -32.0, 16.0, 0.0],
    [1.0, 0.0, -3.0, 2.0, 0.0, 0.0],
    [0.0, 1.0, -2.0, 1.0, 0.0, 0.0],
    [0.0, 0.0, 3.0, -2.0, 0.0, 0.0],
    [0.0, 0.0, -1.0, 1.0, 0.0, 0.0],
];

/// Position, first and second derivative 1 at the left end, then at the right end, everything else 0.
const QUINTIC: [Powers; 6] = [
    [1.0, 0.0, 0.0, -10.0, 15.0, -6.0],
    [0.0, 1.0, 0.0, -6.0, 8.0, -3.0],
    [0.0, 0.0, 0.5, -1.5, 1.5, -0.5],
    [0.0, 0.0, 0.0, 10.0, -15.0, 6.0],
    [0.0, 0.0, 0.0, -4.0, 7.0, -3.0],
    [0.0, 0.0, 0.0, 0.5, -1.0, 0.5],
];

impl Basis {
    /// At the part `x` of an interval of width `h`.
    pub fn at(shape: Shape, x: f64, h: f64) -> Self {
        let (polynomials, degrees): (&[Powers], [usize; MOST_COEFFICIENTS]) = match shape {
            Shape::Quartic => (&QUARTIC, [0, 0, 1, 0, 1, 0]),
            Shape::Quintic => (&QUINTIC, [0, 1, 2, 0, 1, 2]),
        };
        let inverse = 1.0 / h;
        // From h^-3 to h^2.
        let scales = [inverse * inverse * inverse, inverse * inverse, inverse, 1.0, h, h * h];
        let mut rows = [[0.0; MOST_COEFFICIENTS]; 4];
        for (i, powers) in polynomials.iter().enumerate() {
            let [mut value, mut first, mut second, mut third] = [0.0; 4];
            for &power in powers.iter().rev() {
                third = third * x + 3.0 * second;
                second = second * x + 2.0 * first;
                first = first * x + value;
                value = value * x + power;
            }
            for (order, (row, derivative)) in rows.iter_mut().zip([value, first, second, third]).enumerate() {
                row[i] = derivative * scales[degrees[i] + 3 - order];
            }
        }
        Self { rows }
    }

    /// Takes the coefficients of the right end of these orders as differences: from what the left end gives
    /// with its highest derivative constant ([`flow`]). With all orders the factors of the left end are
    /// powers of the time since then, and those of higher derivatives exactly zero.
    pub fn take_differences(&mut self, shape: Shape, h: f64, orders: [bool; 3]) {
        let (order, inner, flow) = (shape.node(), shape.inner(), flow(h));
        let all = orders[..order].iter().all(|is_difference| *is_difference);
        for m in 0..order {
            for (derivative, row) in self.rows.iter_mut().enumerate() {
                let given = (0..=m).filter(|j| orders[*j]);
                let sum: f64 = given.map(|j| row[inner + order + j] * flow[m - j]).sum();
                row[inner + m] = match derivative {
                    _ if all && derivative == m => 1.0,
                    _ if all && derivative > m => 0.0,
                    _ => row[inner + m] + sum,
                };
            }
        }
    }

    /// Polynomials of the part x of an interval of width `h` that the coefficients are factors of, lowest
    /// power first.
    pub fn powers(shape: Shape, h: f64) -> [Powers; MOST_COEFFICIENTS] {
        let mut all = [[0.0; 6]; MOST_COEFFICIENTS];
        let (polynomials, degrees): (&[Powers], [i32; MOST_COEFFICIENTS]) = match shape {
            Shape::Quartic => (&QUARTIC, [0, 0, 1, 0, 1, 0]),
            Shape::Quintic => (&QUINTIC, [0, 1, 2, 0, 1, 2]),
        };
        for ((to, powers), degree) in all.iter_mut().zip(polynomials).zip(degrees) {
            *to = powers.map(|power| power * h.powi(degree));
        }
        all
    }

    /// Factors of q, v, a in the coefficients: those of derivatives in s, times 1, 1/T, 1/T^2.
    #[inline(always)]
    pub fn in_time(&self, inverse: f64) -> [[f64; MOST_COEFFICIENTS]; 3] {
        let scales = [1.0, inverse, inverse * inverse];
        [0, 1, 2].map(|s| self.rows[s].map(|factor| factor * scales[s]))
    }

    /// q, q', q'', and q''' if `z` has room for it, from the coefficients: inner ones, then those of both
    /// ends.
    #[inline(never)]
    pub fn combine(&self, n: usize, inner: &[f64], ends: &[f64], z: &mut [f64]) {
        widest_fused(
            #[inline(always)]
            |_| match (inner.len() + ends.len()) / n {
                5 => self.sum::<5>(n, inner, ends, z),
                _ => self.sum::<6>(n, inner, ends, z),
            },
        );
    }

    /// q''' alone, n numbers.
    pub fn jerk(&self, n: usize, inner: &[f64], ends: &[f64], jerk: &mut [f64]) {
        jerk.fill(0.0);
        for (parts, factor) in inner.chunks_exact(n).chain(ends.chunks_exact(n)).zip(self.rows[3]) {
            jerk.iter_mut().zip(parts).for_each(|(jerk, part)| *jerk += factor * part);
        }
    }

    #[inline(always)]
    fn sum<const C: usize>(&self, n: usize, inner: &[f64], ends: &[f64], z: &mut [f64]) {
        let mut parts = [&inner[..0]; C];
        for (c, part) in parts.iter_mut().enumerate() {
            let at = c * n;
            *part = if at < inner.len() { &inner[at..at + n] } else { &ends[at - inner.len()..][..n] };
        }
        for (row, z) in self.rows.iter().zip(z.chunks_exact_mut(n)) {
            for (i, z) in z.iter_mut().enumerate() {
                let [mut even, mut odd] = [0.0; 2];
                for c in (0..C).step_by(2) {
                    even += row[c] * parts[c][i];
                    if c + 1 < C {
                        odd += row[c + 1] * parts[c + 1][i];
                    }
                }
                *z = even + odd;
            }
        }
    }
}

/// What a constant derivative adds to those of orders 0, 1 and 2 below its own in the time `h`: 1, h, h^2 /
/// 2.
pub(super) fn flow(h: f64) -> [f64; 3] {
    [1.0, h, 0.5 * h * h]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A polynomial and its derivatives.
    fn value(t: f64, highest: f64) -> [f64; 4] {
        [
            1.0 - t + 0.5 * t.powi(3) - 0.3 * t.powi(4) + highest * t.powi(5),
            -1.0 + 1.5 * t * t - 1.2 * t.powi(3) + 5.0 * highest * t.powi(4),
            3.0 * t - 3.6 * t * t + 20.0 * highest * t.powi(3),
            3.0 - 7.2 * t + 60.0 * highest * t * t,
        ]
    }

    #[test]
    fn polynomials_are_reproduced_with_their_derivatives() {
        let (left, h) = (0.3, 0.7);
        for (shape, highest) in [(Shape::Quartic, 0.0), (Shape::Quintic, 0.8)] {
            let ends = [left, left + h].map(|t| value(t, highest)[..shape.node()].to_vec()).concat();
            let mut inner = vec![0.0; shape.inner()];
            let mut middle = [0.0; 3];
            Basis::at(shape, 0.5, h).combine(1, &inner, &ends, &mut middle);
            inner.iter_mut().for_each(|bubble| *bubble = value(left + 0.5 * h, highest)[0] - middle[0]);
            for x in [0.0, 0.1, 0.5, 0.9, 1.0] {
                let mut z = [0.0; 4];
                Basis::at(shape, x, h).combine(1, &inner, &ends, &mut z);
                let expected = value(left + x * h, highest);
                let close = z.iter().zip(expected).all(|(z, expected)| (z - expected).abs() < 1e-12);
                assert!(close, "{shape:?} {x}: {z:?} {expected:?}");
            }
        }
    }
}
