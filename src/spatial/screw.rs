//! The constant part of a transform between joint frames: rotation about z, translation, rotation about x,
//! translation along z.

use super::turn::FixedTurn;
use super::vector::Vec3;
use crate::scalar::Scalar;

/// The constant part `Rz(gamma) (r + Rx(alpha) (rise e_z + .))` of a transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedScrew {
    /// Rotation by gamma about z of the parent's frame; `None` where gamma = 0.
    pub gamma: Option<FixedTurn>,
    /// Rotation by alpha about x.
    pub alpha: FixedTurn,
    /// Translation r (m), in the axes rotated by gamma.
    pub translation: [f64; 3],
    /// Translation along the joint axis (m), of a revolute joint.
    pub rise: f64,
}

impl FixedScrew {
    /// `Rz(gamma) (r + Rx(alpha) rise e_z)`: the origin of the joint frame at zero (m).
    pub fn origin(&self) -> [f64; 3] {
        let [x, y, z] = self.translation;
        let [up, along] = self.alpha.apply([0.0, self.rise]);
        let [x, y] = self.gamma.map_or([x, y + up], |gamma| gamma.apply([x, y + up]));
        [x, y, z + along]
    }

    /// Whether r is along x, as in the modified Denavit-Hartenberg convention.
    #[inline(always)]
    pub(super) fn is_along_x(&self) -> bool {
        let [_, y, z] = self.translation;
        y == 0.0 && z == 0.0
    }

    /// `v + w x r`.
    #[inline(always)]
    pub(super) fn add_arm<S: Scalar>(&self, mut v: Vec3<S>, w: Vec3<S>) -> Vec3<S> {
        if self.is_along_x() {
            let [x, ..] = self.translation;
            v.y = v.y.plus_times(w.z, x);
            v.z = v.z.plus_times(w.y, -x);
            return v;
        }
        v.plus_cross(w, self.translation)
    }

    /// `n - f x r`.
    #[inline(always)]
    pub(super) fn subtract_arm<S: Scalar>(&self, mut n: Vec3<S>, f: Vec3<S>) -> Vec3<S> {
        let [x, y, z] = self.translation;
        if self.is_along_x() {
            n.y = n.y.plus_times(f.z, -x);
            n.z = n.z.plus_times(f.y, x);
            return n;
        }
        n.plus_cross(f, [-x, -y, -z])
    }
}
