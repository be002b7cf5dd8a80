//! Diagonal blocks of the factors of the mass matrix.

use crate::matrix::Panel;
use crate::scalar::{MOST_LANES, Pack, Scalar};

/// As many rows of a matrix as a pack has lanes, in one pack each.
pub(super) type Rows<S> = [<S as Scalar>::Pack; MOST_LANES];

/// A diagonal block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner<S: Scalar> {
    /// Rows of L: only entries below its diagonal have a meaning.
    pub l: Rows<S>,
    /// `D^-1/2`.
    pub roots: S::Pack,
}

impl<S: Scalar> Corner<S> {
    /// That of the unit matrix.
    pub fn unit() -> Self {
        Self { l: [S::Pack::zero(); MOST_LANES], roots: S::Pack::one() }
    }

    /// L and D of a symmetric block, whose entries above the diagonal do not matter; D apart as well.
    #[inline(always)]
    pub fn of(mut rows: Rows<S>) -> (Self, S::Pack) {
        let (mut corner, mut pivots, mut inverses) = (Self::unit(), S::Pack::one(), S::Pack::one());
        for i in (0..Panel::<S>::LANES).rev() {
            let (own, pivot) = (rows[i], rows[i].lane(i));
            let inverse = pivot.recip();
            pivots = pivots.with_lane(i, pivot);
            inverses = inverses.with_lane(i, inverse);
            let inverse = S::Pack::splat(inverse);
            corner.l[i] = own * inverse;
            for (r, row) in rows.iter_mut().enumerate().take(i) {
                // The inverse comes last: products do not wait for it.
                *row = inverse.mul_add(-(S::Pack::splat(own.lane(r)) * own), *row);
            }
        }
        corner.roots = inverses.sqrt();
        (corner, pivots)
    }

    /// `L'^-1 X`, each row times its lane of `scale`.
    #[inline(always)]
    pub fn solve(&self, mut x: Rows<S>, scale: S::Pack) -> Rows<S> {
        for i in (1..Panel::<S>::LANES).rev() {
            for r in 0..i {
                x[r] = S::Pack::splat(-self.l[i].lane(r)).mul_add(x[i], x[r]);
            }
        }
        for (r, x) in x.iter_mut().enumerate().take(Panel::<S>::LANES) {
            *x *= S::Pack::splat(scale.lane(r));
        }
        x
    }
}
