//! Rotations in a plane, by sine and cosine.
//!
//! `(a, b) -> (c a - s b, s a + c b)` takes three products: with `k = c (a + b)` it is `(k - (c + s) b, k +
//! (s - c) a)`. Where a product costs no more than a sum ([`Scalar::FUSED`]), the first formula is faster.

use crate::scalar::{Pack, Scalar, inlined};

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
        Self::from_sin_cos(sin, cos)
    }

    /// By the angle with this sine and cosine.
    #[inline(always)]
    pub fn from_sin_cos(sin: S, cos: S) -> Self {
        Self { sin, cos, sum: cos + sin, difference: sin - cos }
    }

    /// The same in every lane.
    #[inline(always)]
    pub fn splat<P: Pack<S>>(&self) -> Turn<P> {
        let [sin, cos, sum, difference] = [self.sin, self.cos, self.sum, self.difference].map(P::splat);
        Turn { sin, cos, sum, difference }
    }

    /// `(c a - s b, s a + c b)`.
    #[inline(always)]
    pub fn apply(&self, [a, b]: [S; 2]) -> [S; 2] {
        inlined!(S, {
            if S::FUSED {
                return [self.cos.mul_add(a, -(self.sin * b)), self.sin.mul_add(a, self.cos * b)];
            }
            let k = self.cos * (a + b);
            [k - self.sum * b, k + self.difference * a]
        })
    }

    /// `(c a + s b, c b - s a)`.
    #[inline(always)]
    pub fn undo(&self, [a, b]: [S; 2]) -> [S; 2] {
        inlined!(S, {
            if S::FUSED {
                return [self.cos.mul_add(a, self.sin * b), self.cos.mul_add(b, -(self.sin * a))];
            }
            let k = self.cos * (a + b);
            [k + self.difference * b, k - self.sum * a]
        })
    }

    /// `R A R'` for a symmetric 2 x 2 matrix A, given and returned as (xx, yy, xy).
    ///
    /// With `e = s (xx - yy) + 2 c xy`: `xx - s e`, `yy + s e`, `c e - xy`.
    #[inline(always)]
    pub fn congruence(&self, [xx, yy, xy]: [S; 3]) -> [S; 3] {
        inlined!(S, {
            let e = self.sin.mul_add(xx - yy, self.cos * (xy + xy));
            if S::FUSED {
                return [(-self.sin).mul_add(e, xx), self.sin.mul_add(e, yy), self.cos.mul_add(e, -xy)];
            }
            let moved = self.sin * e;
            [xx - moved, yy + moved, self.cos * e - xy]
        })
    }
}

/// A rotation by a constant angle; quarter turns are exact and cost nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedTurn {
    sin: f64,
    cos: f64,
    /// `cos + sin` and `sin - cos`.
    sum: f64,
    difference: f64,
    quarters: Option<Quarters>,
}

/// A multiple of a quarter turn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Quarters {
    None,
    One,
    Two,
    Three,
}

impl FixedTurn {
    /// By the angle with this sine and cosine.
    pub fn new([sin, cos]: [f64; 2]) -> Self {
        let quarters = match [sin, cos] {
            [0.0, 1.0] => Some(Quarters::None),
            [1.0, 0.0] => Some(Quarters::One),
            [0.0, -1.0] => Some(Quarters::Two),
            [-1.0, 0.0] => Some(Quarters::Three),
            _ => None,
        };
        Self { sin, cos, sum: cos + sin, difference: sin - cos, quarters }
    }

    /// Sine and cosine.
    pub fn sin_cos(&self) -> [f64; 2] {
        [self.sin, self.cos]
    }

    /// Whether it is a multiple of a quarter turn.
    #[inline]
    pub fn is_right(&self) -> bool {
        self.quarters.is_some()
    }

    /// `(c a - s b, s a + c b)`.
    #[inline(always)]
    pub fn apply<S: Scalar>(&self, [a, b]: [S; 2]) -> [S; 2] {
        inlined!(
            S,
            match self.quarters {
                Some(Quarters::None) => [a, b],
                Some(Quarters::One) => [-b, a],
                Some(Quarters::Two) => [-a, -b],
                Some(Quarters::Three) => [b, -a],
                None if S::FUSED => {
                    [a.times(self.cos).plus_times(b, -self.sin), a.times(self.sin).plus_times(b, self.cos)]
                }
                None => {
                    let k = (a + b).times(self.cos);
                    [k - b.times(self.sum), k + a.times(self.difference)]
                }
            }
        )
    }

    /// `(c a + s b, c b - s a)`.
    #[inline(always)]
    pub fn undo<S: Scalar>(&self, [a, b]: [S; 2]) -> [S; 2] {
        inlined!(
            S,
            match self.quarters {
                Some(Quarters::None) => [a, b],
                Some(Quarters::One) => [b, -a],
                Some(Quarters::Two) => [-a, -b],
                Some(Quarters::Three) => [-b, a],
                None if S::FUSED => {
                    [a.times(self.cos).plus_times(b, self.sin), b.times(self.cos).plus_times(a, -self.sin)]
                }
                None => {
                    let k = (a + b).times(self.cos);
                    [k + b.times(self.difference), k - a.times(self.sum)]
                }
            }
        )
    }

    /// As [`Turn::congruence`].
    #[inline(always)]
    pub fn congruence<S: Scalar>(&self, [xx, yy, xy]: [S; 3]) -> [S; 3] {
        inlined!(
            S,
            match self.quarters {
                Some(Quarters::None | Quarters::Two) => [xx, yy, xy],
                Some(Quarters::One | Quarters::Three) => [yy, xx, -xy],
                None => {
                    let e = (xx - yy).times(self.sin).plus_times(xy, 2.0 * self.cos);
                    if S::FUSED {
                        return [
                            xx.plus_times(e, -self.sin),
                            yy.plus_times(e, self.sin),
                            (-xy).plus_times(e, self.cos),
                        ];
                    }
                    let moved = e.times(self.sin);
                    [xx - moved, yy + moved, e.times(self.cos) - xy]
                }
            }
        )
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
