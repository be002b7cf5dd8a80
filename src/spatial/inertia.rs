//! Inertia of a rigid body about the origin of a frame.

use super::motion::{Force, Motion};
use super::turn::{FixedTurn, Turn};
use super::vector::Vec3;
use crate::scalar::{Scalar, inlined};
use std::ops::AddAssign;

/// A symmetric 3 x 3 matrix.
#[derive(Clone, Copy, Debug)]
pub struct Symmetric3<S> {
    /// First diagonal entry.
    pub xx: S,
    /// Second diagonal entry.
    pub yy: S,
    /// Third diagonal entry.
    pub zz: S,
    /// Entry (x, y).
    pub xy: S,
    /// Entry (x, z).
    pub xz: S,
    /// Entry (y, z).
    pub yz: S,
}

impl<S: Scalar> Symmetric3<S> {
    /// The zero matrix.
    #[inline(always)]
    pub fn zero() -> Self {
        let zero = S::zero();
        Self { xx: zero, yy: zero, zz: zero, xy: zero, xz: zero, yz: zero }
    }

    /// Matrix times vector.
    #[inline(always)]
    pub fn apply(&self, a: Vec3<S>) -> Vec3<S> {
        inlined!(
            S,
            Vec3::new(
                self.xx.mul_add(a.x, self.xy.mul_add(a.y, self.xz * a.z)),
                self.xy.mul_add(a.x, self.yy.mul_add(a.y, self.yz * a.z)),
                self.xz.mul_add(a.x, self.yz.mul_add(a.y, self.zz * a.z)),
            )
        )
    }

    /// `Rz J Rz'` for a rotation about z.
    #[inline(always)]
    pub fn rotated_about_z(&self, turn: &Turn<S>) -> Self {
        inlined!(S, {
            let [xx, yy, xy] = turn.congruence([self.xx, self.yy, self.xy]);
            let [xz, yz] = turn.apply([self.xz, self.yz]);
            Self { xx, yy, zz: self.zz, xy, xz, yz }
        })
    }

    /// As [`rotated_about_z`](Self::rotated_about_z), by a constant angle.
    #[inline(always)]
    pub fn rotated_about_z_constant(&self, turn: &FixedTurn) -> Self {
        inlined!(S, {
            let [xx, yy, xy] = turn.congruence([self.xx, self.yy, self.xy]);
            let [xz, yz] = turn.apply([self.xz, self.yz]);
            Self { xx, yy, zz: self.zz, xy, xz, yz }
        })
    }

    /// `Rx J Rx'` for a rotation about x by a constant angle.
    #[inline(always)]
    pub fn rotated_about_x_constant(&self, turn: &FixedTurn) -> Self {
        inlined!(S, {
            let [yy, zz, yz] = turn.congruence([self.yy, self.zz, self.yz]);
            let [xy, xz] = turn.apply([self.xy, self.xz]);
            Self { xx: self.xx, yy, zz, xy, xz, yz }
        })
    }
}

impl<S: Scalar> AddAssign for Symmetric3<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        self.xx += other.xx;
        self.yy += other.yy;
        self.zz += other.zz;
        self.xy += other.xy;
        self.xz += other.xz;
        self.yz += other.yz;
    }
}

/// Inertia of a body whose mass is a constant of the model: `(m, h, J)` with first moment `h = m c` (kg m)
/// and inertia matrix `J` about the origin of the frame (kg m^2).
#[derive(Clone, Copy, Debug)]
pub struct Inertia<S> {
    /// Mass (kg).
    pub mass: f64,
    /// First moment (kg m).
    pub first_moment: Vec3<S>,
    /// Inertia matrix about the origin (kg m^2).
    pub matrix: Symmetric3<S>,
}

impl<S: Scalar> Inertia<S> {
    /// Momentum of the body in the motion: `(J w + h x v; m v - h x w)`.
    #[inline(always)]
    pub fn apply(&self, motion: Motion<S>) -> Force<S> {
        inlined!(S, {
            let (w, v, h) = (motion.angular, motion.linear, self.first_moment);
            Force { moment: self.matrix.apply(w) + h.cross(v), force: v.times(self.mass) - h.cross(w) }
        })
    }

    /// The sum with another body in the same frame, except that the mass is left as it is.
    #[inline(always)]
    pub fn with_moments(mut self, other: Self) -> Self {
        inlined!(S, {
            self.first_moment = self.first_moment + other.first_moment;
            self.matrix += other.matrix;
            self
        })
    }
}

/// Inertia of a link: the constants of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConstantInertia {
    /// Mass (kg).
    pub mass: f64,
    /// First moment (kg m).
    pub first_moment: [f64; 3],
    /// xx, yy, zz, xy, xz, yz of the inertia matrix about the origin (kg m^2).
    pub matrix: [f64; 6],
}

impl ConstantInertia {
    /// The same as scalars.
    #[inline(always)]
    pub fn lift<S: Scalar>(&self) -> Inertia<S> {
        inlined!(S, {
            let [xx, yy, zz, xy, xz, yz] = self.matrix.map(S::from_f64);
            Inertia {
                mass: self.mass,
                first_moment: Vec3::constant(self.first_moment),
                matrix: Symmetric3 { xx, yy, zz, xy, xz, yz },
            }
        })
    }

    /// Momentum of the link, as [`Inertia::apply`].
    #[inline(always)]
    pub fn apply<S: Scalar>(&self, motion: Motion<S>) -> Force<S> {
        inlined!(S, {
            let [xx, yy, zz, xy, xz, yz] = self.matrix;
            let (w, v, h) = (motion.angular, motion.linear, self.first_moment);
            let turned = Vec3::new(
                w.dot_constant([xx, xy, xz]),
                w.dot_constant([xy, yy, yz]),
                w.dot_constant([xz, yz, zz]),
            );
            let [x, y, z] = h;
            Force { moment: turned.plus_cross(v, [-x, -y, -z]), force: v.times(self.mass).plus_cross(w, h) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    fn body() -> ConstantInertia {
        ConstantInertia {
            mass: 2.5,
            first_moment: [0.3, -0.2, 0.9],
            matrix: [1.0, 1.3, 0.8, -0.1, 0.05, 0.2],
        }
    }

    fn dense(j: &Symmetric3<f64>) -> Matrix3<f64> {
        Matrix3::new(j.xx, j.xy, j.xz, j.xy, j.yy, j.yz, j.xz, j.yz, j.zz)
    }

    #[test]
    fn turning_is_the_congruence_with_the_rotation() {
        let (s, c) = 0.7_f64.sin_cos();
        let j = body().lift::<f64>().matrix;
        let rz = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let rx = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
        let z = rz * dense(&j) * rz.transpose();
        assert!((dense(&j.rotated_about_z(&Turn::by(0.7))) - z).amax() < 1e-15);
        assert!((dense(&j.rotated_about_z_constant(&FixedTurn::new([s, c]))) - z).amax() < 1e-15);
        let x = rx * dense(&j) * rx.transpose();
        assert!((dense(&j.rotated_about_x_constant(&FixedTurn::new([s, c]))) - x).amax() < 1e-15);
    }

    #[test]
    fn constant_and_lifted_inertia_give_the_same_momentum() {
        let motion =
            Motion { angular: Vec3::constant([0.2, 1.1, -0.7]), linear: Vec3::constant([3.0, -0.4, 0.6]) };
        let (a, b) = (body().apply::<f64>(motion), body().lift().apply(motion));
        assert!((a.moment - b.moment).dot(a.moment - b.moment) < 1e-30);
        assert!((a.force - b.force).dot(a.force - b.force) < 1e-30);
    }
}
