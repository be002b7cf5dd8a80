//! Unit quaternions and the rotations that they stand for.

use super::inertia::Symmetric3;
use super::vector::Vec3;
use crate::scalar::{Pack, Scalar, inlined};

/// A quaternion `w + x i + y j + z k` of length 1.
#[derive(Clone, Copy, Debug)]
pub struct Quaternion<S> {
    /// (x, y, z).
    pub vector: Vec3<S>,
    /// w.
    pub scalar: S,
}

impl<S: Scalar> Quaternion<S> {
    /// The quaternion (x, y, z, w).
    #[inline(always)]
    pub fn new([x, y, z, w]: [S; 4]) -> Self {
        Self { vector: Vec3::new(x, y, z), scalar: w }
    }

    /// The quaternion (x, y, z, w) of constants.
    #[inline(always)]
    pub fn constant(entries: [f64; 4]) -> Self {
        Self::new(entries.map(S::from_f64))
    }

    /// (x, y, z, w).
    #[inline(always)]
    pub fn to_array(self) -> [S; 4] {
        let Vec3 { x, y, z } = self.vector;
        [x, y, z, self.scalar]
    }

    /// The same in every lane.
    #[inline(always)]
    pub fn splat<P: Pack<S>>(&self) -> Quaternion<P> {
        Quaternion { vector: self.vector.splat(), scalar: P::splat(self.scalar) }
    }

    /// `self o other`: first the rotation of `other`, then that of `self`.
    #[inline]
    pub fn then_after(self, other: Self) -> Self {
        let (a, b) = (self.vector, other.vector);
        Self {
            vector: a.scaled(other.scalar) + b.scaled(self.scalar) + a.cross(b),
            scalar: self.scalar * other.scalar - a.dot(b),
        }
    }

    /// The reverse rotation.
    #[inline]
    pub fn conjugate(self) -> Self {
        Self { vector: -self.vector, scalar: self.scalar }
    }

    /// The square of its length.
    #[inline]
    pub fn square(self) -> S {
        self.vector.dot(self.vector) + self.scalar * self.scalar
    }

    /// Its length; no square overflows or vanishes.
    pub fn length(self) -> S {
        let (scaled, largest) = self.scaled();
        scaled.square().sqrt() * largest
    }

    /// Itself divided by its length; not a number if this is zero.
    pub fn unit(self) -> Self {
        let (scaled, _) = self.scaled();
        let inverse = scaled.square().sqrt().recip();
        Self::new(scaled.to_array().map(|entry| entry * inverse))
    }

    /// Itself divided by its largest entry, and this, or 1 where all are zero.
    fn scaled(self) -> (Self, S) {
        let larger = |a: S, b: S| S::select(a.less(b), b, a);
        let entries = self.to_array();
        let largest = entries.map(S::abs).into_iter().fold(S::zero(), larger);
        let largest = S::select(S::zero().less(largest), largest, S::one());
        (Self::new(entries.map(|entry| entry / largest)), largest)
    }

    /// `(R a, R b)`.
    ///
    /// This and the next three are calls in transforms, which are inlined at many places: only free joints
    /// are oriented.
    #[inline(never)]
    pub(super) fn apply_both(&self, a: Vec3<S>, b: Vec3<S>) -> (Vec3<S>, Vec3<S>) {
        let rotation = self.rotation();
        (rotation.apply(a), rotation.apply(b))
    }

    /// `(R' a, R' b)`.
    #[inline(never)]
    pub(super) fn undo_both(&self, a: Vec3<S>, b: Vec3<S>) -> (Vec3<S>, Vec3<S>) {
        let rotation = self.rotation();
        (rotation.undo(a), rotation.undo(b))
    }

    /// `R' a`.
    #[inline(never)]
    pub(super) fn undo(&self, a: Vec3<S>) -> Vec3<S> {
        self.rotation().undo(a)
    }

    /// `(R a, R A R')` for a symmetric matrix A.
    #[inline(never)]
    pub(super) fn turn(&self, a: Vec3<S>, matrix: &Symmetric3<S>) -> (Vec3<S>, Symmetric3<S>) {
        let rotation = self.rotation();
        (rotation.apply(a), rotation.congruence(matrix))
    }

    /// The rotation matrix.
    #[inline(always)]
    pub fn rotation(&self) -> Rotation<S> {
        inlined!(S, {
            let ([x, y, z], w) = (self.vector.to_array(), self.scalar);
            let [x2, y2, z2] = [x + x, y + y, z + z];
            let [xx, yy, zz] = [x * x2, y * y2, z * z2];
            let [xy, xz, yz] = [x * y2, x * z2, y * z2];
            let [wx, wy, wz] = [w * x2, w * y2, w * z2];
            Rotation {
                rows: [
                    Vec3::new((-(yy + zz)).plus(1.0), xy - wz, xz + wy),
                    Vec3::new(xy + wz, (-(xx + zz)).plus(1.0), yz - wx),
                    Vec3::new(xz - wy, yz + wx, (-(xx + yy)).plus(1.0)),
                ],
            }
        })
    }
}

/// A rotation matrix R.
#[derive(Clone, Copy, Debug)]
pub struct Rotation<S> {
    /// Its rows.
    pub rows: [Vec3<S>; 3],
}

impl<S: Scalar> Rotation<S> {
    /// `R a`.
    #[inline(always)]
    pub fn apply(&self, a: Vec3<S>) -> Vec3<S> {
        let [x, y, z] = self.rows;
        inlined!(S, Vec3::new(x.dot(a), y.dot(a), z.dot(a)))
    }

    /// `R' a`.
    #[inline(always)]
    pub fn undo(&self, a: Vec3<S>) -> Vec3<S> {
        let [x, y, z] = self.rows;
        inlined!(S, x.scaled(a.x) + y.scaled(a.y) + z.scaled(a.z))
    }

    /// `R A R'` for a symmetric matrix A.
    #[inline(always)]
    pub fn congruence(&self, a: &Symmetric3<S>) -> Symmetric3<S> {
        inlined!(S, {
            let [x, y, z] = self.rows;
            let [ax, ay, az] = [a.apply(x), a.apply(y), a.apply(z)];
            Symmetric3 {
                xx: x.dot(ax),
                yy: y.dot(ay),
                zz: z.dot(az),
                xy: x.dot(ay),
                xz: x.dot(az),
                yz: y.dot(az),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, UnitQuaternion, Vector3};

    fn unit(x: f64) -> (Quaternion<f64>, UnitQuaternion<f64>) {
        let reference = UnitQuaternion::from_scaled_axis(Vector3::new(x, 1.0 - x, 0.3 * x - 0.8));
        (Quaternion::new(reference.coords.into()), reference)
    }

    #[test]
    fn quaternions_turn_as_those_of_nalgebra() {
        let ((a, of_a), (b, of_b)) = (unit(0.7), unit(-2.1));
        let close = |a: Vec3<f64>, b: Vector3<f64>| assert!((Vector3::from(a.to_array()) - b).amax() < 1e-14);
        let product = nalgebra::Vector4::from(a.then_after(b).to_array());
        assert!((product - (of_a * of_b).coords).amax() < 1e-15);
        assert!((a.square() - 1.0).abs() < 1e-15);
        let v = [0.3, -1.2, 0.8];
        close(a.rotation().apply(Vec3::from(v)), of_a * Vector3::from(v));
        close(a.rotation().undo(Vec3::from(v)), of_a.inverse() * Vector3::from(v));
        close(a.conjugate().rotation().apply(Vec3::from(v)), of_a.inverse() * Vector3::from(v));
        let j = Symmetric3 { xx: 2.0, yy: 1.5, zz: 0.7, xy: 0.3, xz: -0.4, yz: 0.1 };
        let dense = Matrix3::new(2.0, 0.3, -0.4, 0.3, 1.5, 0.1, -0.4, 0.1, 0.7);
        let r = of_a.to_rotation_matrix();
        let expected = r.matrix() * dense * r.matrix().transpose();
        let found = a.rotation().congruence(&j);
        let found =
            [found.xx, found.yy, found.zz, found.xy, found.xz, found.yz].map(|entry: f64| entry).to_vec();
        let places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        assert!(found.iter().zip(places).all(|(found, at)| (found - expected[at]).abs() < 1e-14));
    }
}
