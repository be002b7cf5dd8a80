//! Three-vectors over any scalar.

use crate::scalar::{Pack, Scalar, inlined};
use std::ops::{Add, Neg, Sub};

/// A vector of three scalars.
#[derive(Clone, Copy, Debug)]
pub struct Vec3<S> {
    /// Along the first axis.
    pub x: S,
    /// Along the second axis.
    pub y: S,
    /// Along the third axis.
    pub z: S,
}

impl<S: Scalar> Vec3<S> {
    /// From its components.
    #[inline(always)]
    pub fn new(x: S, y: S, z: S) -> Self {
        Self { x, y, z }
    }

    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(S::zero(), S::zero(), S::zero())
    }

    /// A constant vector.
    #[inline(always)]
    pub fn constant([x, y, z]: [f64; 3]) -> Self {
        Self::new(S::from_f64(x), S::from_f64(y), S::from_f64(z))
    }

    /// `self . other`.
    #[inline(always)]
    pub fn dot(self, other: Self) -> S {
        inlined!(S, self.x.mul_add(other.x, self.y.mul_add(other.y, self.z * other.z)))
    }

    /// `self . other + term`.
    #[inline(always)]
    pub(crate) fn dot_plus(self, other: Self, term: S) -> S {
        inlined!(S, self.x.mul_add(other.x, self.y.mul_add(other.y, self.z.mul_add(other.z, term))))
    }

    /// `self + factor a`.
    #[inline(always)]
    pub(crate) fn plus_scaled(self, a: Self, factor: S) -> Self {
        inlined!(
            S,
            Self::new(a.x.mul_add(factor, self.x), a.y.mul_add(factor, self.y), a.z.mul_add(factor, self.z))
        )
    }

    /// `self + a x b`.
    #[inline(always)]
    pub(crate) fn plus_product(self, a: Self, b: Self) -> Self {
        inlined!(
            S,
            Self::new(
                a.y.mul_add(b.z, (-a.z).mul_add(b.y, self.x)),
                a.z.mul_add(b.x, (-a.x).mul_add(b.z, self.y)),
                a.x.mul_add(b.y, (-a.y).mul_add(b.x, self.z)),
            )
        )
    }

    /// The vector in lane `k`.
    #[inline(always)]
    pub(crate) fn lane<T: Scalar>(&self, k: usize) -> Vec3<T>
    where
        S: Pack<T>,
    {
        Vec3::new(self.x.lane(k), self.y.lane(k), self.z.lane(k))
    }

    /// Sets lane `k` in memory, see [`Pack::set_lane`].
    #[inline(always)]
    pub(crate) fn set_lane<T: Scalar>(&mut self, k: usize, value: Vec3<T>)
    where
        S: Pack<T>,
    {
        self.x.set_lane(k, value.x);
        self.y.set_lane(k, value.y);
        self.z.set_lane(k, value.z);
    }

    /// `self . constant`.
    #[inline(always)]
    pub fn dot_constant(self, [x, y, z]: [f64; 3]) -> S {
        inlined!(S, self.x.times(x).plus_times(self.y, y).plus_times(self.z, z))
    }

    /// `self x other`.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        inlined!(
            S,
            Self::new(
                self.y.mul_add(other.z, -(self.z * other.y)),
                self.z.mul_add(other.x, -(self.x * other.z)),
                self.x.mul_add(other.y, -(self.y * other.x)),
            )
        )
    }

    /// `self x constant`.
    #[inline(always)]
    pub fn cross_constant(self, [x, y, z]: [f64; 3]) -> Self {
        inlined!(
            S,
            Self::new(
                self.y.times(z).plus_times(self.z, -y),
                self.z.times(x).plus_times(self.x, -z),
                self.x.times(y).plus_times(self.y, -x),
            )
        )
    }

    /// `self + a x constant`.
    #[inline(always)]
    pub fn plus_cross(self, a: Self, [x, y, z]: [f64; 3]) -> Self {
        inlined!(
            S,
            Self::new(
                self.x.plus_times(a.y, z).plus_times(a.z, -y),
                self.y.plus_times(a.z, x).plus_times(a.x, -z),
                self.z.plus_times(a.x, y).plus_times(a.y, -x),
            )
        )
    }

    /// The same in every lane.
    #[inline(always)]
    pub fn splat<P: Pack<S>>(self) -> Vec3<P> {
        Vec3::new(P::splat(self.x), P::splat(self.y), P::splat(self.z))
    }

    /// `factor self` for a constant.
    #[inline(always)]
    pub fn times(self, factor: f64) -> Self {
        Self::new(self.x.times(factor), self.y.times(factor), self.z.times(factor))
    }

    /// `factor self`.
    #[inline(always)]
    pub fn scaled(self, factor: S) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }

    /// Its components.
    #[inline(always)]
    pub fn to_array(self) -> [S; 3] {
        [self.x, self.y, self.z]
    }

    /// `self + constant`.
    #[inline(always)]
    pub fn plus(self, [x, y, z]: [f64; 3]) -> Self {
        Self::new(self.x.plus(x), self.y.plus(y), self.z.plus(z))
    }
}

impl<S: Scalar> From<[S; 3]> for Vec3<S> {
    #[inline(always)]
    fn from([x, y, z]: [S; 3]) -> Self {
        Self::new(x, y, z)
    }
}

impl<S: Scalar> Add for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<S: Scalar> Sub for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<S: Scalar> Neg for Vec3<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

#[cfg(test)]
mod tests {
    use super::Vec3;

    #[test]
    fn products_agree_with_nalgebra() {
        let (a, b) = ([1.0, -2.0, 0.5], [0.25, 3.0, -1.5]);
        let (na, nb) = (nalgebra::Vector3::from(a), nalgebra::Vector3::from(b));
        let (ours_a, ours_b) = (Vec3::<f64>::constant(a), Vec3::constant(b));
        let same = |ours: Vec3<f64>, theirs: nalgebra::Vector3<f64>| {
            assert_eq!([ours.x, ours.y, ours.z], [theirs.x, theirs.y, theirs.z]);
        };
        same(ours_a.cross(ours_b), na.cross(&nb));
        same(ours_a.cross_constant(b), na.cross(&nb));
        same((ours_a - -ours_b + ours_b).times(2.0), (na + nb * 2.0) * 2.0);
        assert_eq!(ours_a.dot(ours_b), na.dot(&nb));
        assert_eq!(ours_a.dot_constant(b), na.dot(&nb));
    }
}
