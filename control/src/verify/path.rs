//! A motion as polynomials of time between nodes.

use crate::numerics::roots::roots;

/// Coefficients of a polynomial: degree five at most.
pub(crate) const POWERS: usize = 6;

/// A motion of n coordinates.
#[derive(Clone, Debug, Default)]
pub(crate) struct Path {
    /// n.
    pub dof: usize,
    /// The polynomials between neighbouring nodes, in the order of time.
    pub pieces: Vec<Piece>,
}

/// The polynomials between two nodes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Piece {
    /// The time of its start and its length (s).
    pub start: f64,
    pub length: f64,
    /// The phase to which it belongs, from 0.
    pub phase: usize,
    /// q(x) on [0, 1], lowest power first: six coefficients for each coordinate.
    powers: Vec<[f64; POWERS]>,
}

impl Piece {
    /// From what a motion is at both ends: q, v, a and the jerk at the start, q and v at the end (2n numbers
    /// at least). These six determine a polynomial of degree five.
    pub fn through(start: f64, length: f64, phase: usize, left: &[f64], right: &[f64]) -> Self {
        let n = left.len() / 4;
        let h = length;
        let powers = (0..n).map(|i| {
            let low =
                [left[i], h * left[n + i], 0.5 * h * h * left[2 * n + i], h * h * h / 6.0 * left[3 * n + i]];
            let [c0, c1, c2, c3] = low;
            let (value, slope) =
                (right[i] - (c0 + c1 + c2 + c3), h * right[n + i] - (c1 + 2.0 * c2 + 3.0 * c3));
            [c0, c1, c2, c3, 5.0 * value - slope, slope - 4.0 * value]
        });
        Self { start, length, phase, powers: powers.collect() }
    }

    /// The time at the part x of it (s).
    pub fn time(&self, x: f64) -> f64 {
        self.start + x * self.length
    }

    /// q, v, a and the jerk at the part x of it, n numbers each; as many of them as `z` has room for.
    pub fn at(&self, x: f64, z: &mut [f64]) {
        let n = self.powers.len();
        let rate = 1.0 / self.length;
        for (i, powers) in self.powers.iter().enumerate() {
            let (mut value, mut first, mut second, mut third) = (0.0, 0.0, 0.0, 0.0);
            for power in powers.iter().rev() {
                third = third * x + 3.0 * second;
                second = second * x + 2.0 * first;
                first = first * x + value;
                value = value * x + power;
            }
            let mut scale = 1.0;
            for (to, derivative) in z[i..].iter_mut().step_by(n).zip([value, first, second, third]) {
                *to = scale * derivative;
                scale *= rate;
            }
        }
    }

    /// The coefficients in x of the derivative by time of this order (0 to 3) of a coordinate.
    pub fn derivative(&self, coordinate: usize, order: usize) -> [f64; POWERS] {
        let mut powers = self.powers[coordinate];
        for _ in 0..order {
            for m in 0..POWERS {
                powers[m] = powers.get(m + 1).map_or(0.0, |next| (m + 1) as f64 * next / self.length);
            }
        }
        powers
    }

    /// The coefficients of all coordinates, [`POWERS`] each.
    pub fn coefficients(&self) -> Vec<f64> {
        self.powers.concat()
    }

    /// Adds the parts of it, without its ends, at which a derivative of a coordinate has this value.
    pub fn add_crossings(&self, coordinate: usize, order: usize, value: f64, to: &mut Vec<f64>) {
        roots(&self.derivative(coordinate, order)[..POWERS - order], value, to);
    }

    /// Adds the parts of it at which a derivative of a coordinate is largest or least: both ends and where
    /// the next derivative vanishes.
    pub fn add_extrema(&self, coordinate: usize, order: usize, to: &mut Vec<f64>) {
        to.extend([0.0, 1.0]);
        self.add_crossings(coordinate, order + 1, 0.0, to);
    }
}

impl Path {
    /// How long the motion takes (s).
    pub fn duration(&self) -> f64 {
        self.pieces.last().map_or(0.0, |last| last.start + last.length)
    }

    /// The largest magnitude of each component of (q, v) at nodes and in the middle between them; of one that
    /// hardly moves `part` of the largest of all coordinates, and `least` at least.
    pub fn sizes(&self, part: f64, least: f64, counted: usize) -> Vec<f64> {
        let n = self.dof;
        let mut sizes = vec![0.0_f64; 2 * n];
        let mut z = vec![0.0; 2 * n];
        for (piece, x) in self.pieces.iter().flat_map(|piece| [0.0, 0.5, 1.0].map(|x| (piece, x))) {
            piece.at(x, &mut z);
            sizes.iter_mut().zip(&z).for_each(|(size, z)| *size = size.max(z.abs()));
        }
        for group in sizes.chunks_exact_mut(n) {
            let floor = group[..counted].iter().fold(0.0, |most: f64, size| most.max(*size));
            group.iter_mut().for_each(|size| *size = size.max(part * floor).max(least));
        }
        sizes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.3 - t + 0.5 t^3 - 0.3 t^4 + 0.8 t^5 with its derivatives.
    fn quintic(t: f64) -> [f64; 4] {
        [
            0.3 - t + 0.5 * t.powi(3) - 0.3 * t.powi(4) + 0.8 * t.powi(5),
            -1.0 + 1.5 * t * t - 1.2 * t.powi(3) + 4.0 * t.powi(4),
            3.0 * t - 3.6 * t * t + 16.0 * t.powi(3),
            3.0 - 7.2 * t + 48.0 * t * t,
        ]
    }

    #[test]
    fn a_quintic_is_reproduced_with_its_crossings_and_extrema() {
        let piece = Piece::through(0.4, 0.8, 0, &quintic(0.4), &quintic(1.2)[..2]);
        for x in [0.0, 0.2, 0.7, 1.0] {
            let mut z = [0.0; 4];
            piece.at(x, &mut z);
            let expected = quintic(piece.time(x));
            assert!(z.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{x}: {z:?} {expected:?}");
        }
        let mut places = Vec::new();
        piece.add_crossings(0, 1, 0.0, &mut places);
        assert_eq!(places.len(), 1, "{places:?}");
        assert!(quintic(piece.time(places[0]))[1].abs() < 1e-12);
        piece.add_extrema(0, 0, &mut places);
        assert_eq!(places.len(), 4, "{places:?}");
    }
}
