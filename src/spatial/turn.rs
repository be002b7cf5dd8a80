//! Rotations in a plane, by sine and cosine.
//!
//! `(a, b) -> (c a - s b, s a + c b)` takes three products: with `k = c (a + b)` it is `(k - (c + s) b, k + (s - c) a)`.

use crate::scalar::Scalar;

/// A rotation by a joint angle.
#[derive(Clone, Copy, Debug)]
pub struct Turn<S> {
    /// Sine of the angle.
    pub sin: S,
    /// Cosine of the angle.
    pub cos: S,
    sum: S,
    difference: S,
}

impl<S: Scalar> Turn<S> {
    /// By the angle (rad).
    #[inline(always)]
    pub fn by(angle: S) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self { sin, cos, sum: cos + sin, difference: sin - cos }
    }

    /// `(c a - s b, s a + c b)`.
    #[inline(always)]
    pub fn apply(&self, [a, b]: [S; 2]) -> [S; 2] {
        let k = self.cos * (a + b);
        [k - self.sum * b, k + self.difference * a]
    }

    /// `(c a + s b, c b - s a)`.
    #[inline(always)]
    pub fn undo(&self, [a, b]: [S; 2]) -> [S; 2] {
        let k = self.cos * (a + b);
        [k + self.difference * b, k - self.sum * a]
    }

    /// The two off-diagonal entries and the diagonal of a symmetric 2 x 2 matrix turned on both sides.
    ///
    /// With `e = s (xx - yy) + 2 c xy`: `xx - s e`, `yy + s e`, `c e - xy`.
    #[inline(always)]
    pub fn congruence(&self, [xx, yy, xy]: [S; 3]) -> [S; 3] {
        let e = self.sin * (xx - yy) + self.cos * (xy + xy);
        let moved = self.sin * e;
        [xx - moved, yy + moved, self.cos * e - xy]
    }
}

/// A rotation by a constant angle; quarter turns are exact, and free where constants are folded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedTurn {
    sin: f64,
    cos: f64,
    right: bool,
}

impl FixedTurn {
    /// By the angle with this sine and cosine.
    pub fn new([sin, cos]: [f64; 2]) -> Self {
        Self { sin, cos, right: sin == 0.0 || cos == 0.0 }
    }

    /// Sine and cosine.
    pub fn sin_cos(&self) -> [f64; 2] {
        [self.sin, self.cos]
    }

    /// Whether it is a multiple of a quarter turn.
    #[inline]
    pub fn is_right(&self) -> bool {
        self.right
    }

    /// `(c a - s b, s a + c b)`.
    #[inline]
    pub fn apply<S: Scalar>(&self, [a, b]: [S; 2]) -> [S; 2] {
        let Self { sin, cos, right } = *self;
        if right {
            return [a.times(cos) - b.times(sin), a.times(sin) + b.times(cos)];
        }
        let k = (a + b).times(cos);
        [k - b.times(cos + sin), k + a.times(sin - cos)]
    }

    /// `(c a + s b, c b - s a)`.
    #[inline]
    pub fn undo<S: Scalar>(&self, [a, b]: [S; 2]) -> [S; 2] {
        let Self { sin, cos, right } = *self;
        if right {
            return [a.times(cos) + b.times(sin), b.times(cos) - a.times(sin)];
        }
        let k = (a + b).times(cos);
        [k + b.times(sin - cos), k - a.times(cos + sin)]
    }

    /// As [`Turn::congruence`].
    #[inline]
    pub fn congruence<S: Scalar>(&self, [xx, yy, xy]: [S; 3]) -> [S; 3] {
        let Self { sin, cos, right } = *self;
        if right {
            let (s, c) = (sin * sin, cos * cos);
            return [xx.times(c) + yy.times(s), xx.times(s) + yy.times(c), xy.times(c - s)];
        }
        let e = (xx - yy).times(sin) + xy.times(2.0 * cos);
        let moved = e.times(sin);
        [xx - moved, yy + moved, e.times(cos) - xy]
    }
}

#[cfg(test)]
mod tests {
    use super::{FixedTurn, Turn};
    use nalgebra::{Matrix2, Vector2};

    #[test]
    fn turns_are_rotations() {
        let close = |ours: &[f64], dense: &[f64]| {
            ours.iter().zip(dense).for_each(|(a, b)| assert!((a - b).abs() < 1e-14, "{ours:?} {dense:?}"));
        };
        for quarters in [0.0, 1.0, 2.0, 3.0, 0.3, -0.7, 1.9] {
            let angle = quarters * std::f64::consts::FRAC_PI_2;
            let (sin, cos) = angle.sin_cos();
            let round = |x: f64| {
                if x.abs() < 1e-15 {
                    0.0
                } else if x.abs() > 1.0 - 1e-15 {
                    x.signum()
                } else {
                    x
                }
            };
            let (turn, fixed) = (Turn::by(angle), FixedTurn::new([round(sin), round(cos)]));
            assert_eq!(fixed.is_right(), quarters.fract() == 0.0);
            let r = Matrix2::new(cos, -sin, sin, cos);
            let (a, m) = ([0.7, -1.9], Matrix2::new(0.4, -0.8, -0.8, 1.7));
            let (there, back) = (r * Vector2::from(a), r.transpose() * Vector2::from(a));
            close(&turn.apply(a), there.as_slice());
            close(&fixed.apply(a), there.as_slice());
            close(&turn.undo(a), back.as_slice());
            close(&fixed.undo(a), back.as_slice());
            let dense = r * m * r.transpose();
            let dense = [dense[(0, 0)], dense[(1, 1)], dense[(0, 1)]];
            close(&turn.congruence([0.4, 1.7, -0.8]), &dense);
            close(&fixed.congruence([0.4, 1.7, -0.8]), &dense);
        }
    }
}
