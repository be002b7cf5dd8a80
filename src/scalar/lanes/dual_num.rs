//! [`Lanes`] as a number of num-dual's.
//!
//! num-dual reads one real part from a number and compares numbers as a whole. Here the real part is the
//! common value of all lanes, or NaN if they differ, and a comparison holds if it holds in every lane. The
//! functions that the pipeline uses depend on neither. `abs`, `abs_sub` and the spherical Bessel functions of
//! a dual number choose a formula by the real part, and are correct only if all lanes agree: use
//! [`Scalar::abs`] and [`Scalar::select`].

use super::{Lanes, Vector};
use crate::scalar::dual_num::dual_num;
use crate::scalar::number::Scalar;

impl<V: Vector> Lanes<V> {
    fn real_part(&self) -> f64 {
        let first = self.lane(0);
        if self.as_slice().iter().all(|&lane| lane == first) { first } else { f64::NAN }
    }
}

dual_num!(Lanes<V>, V: Vector);
