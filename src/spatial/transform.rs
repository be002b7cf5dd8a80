//! From the frame of a joint to that of its parent and back.
//!
//! `x_parent = Rz(gamma) (r + Rx(alpha) (rise e_z + J(q) x))`, where J rotates about z by q (+ an offset) or
//! translates along z by q (+ an offset). Every placement of two frames has this form once each frame is
//! rotated about its own z axis: with gamma = 0 and r along x it is the modified Denavit-Hartenberg
//! convention (A1.2). Rotations use sine and cosine only.

use super::inertia::Inertia;
use super::motion::{Force, Motion};
use super::quaternion::Quaternion;
use super::screw::FixedScrew;
use super::turn::Turn;
use super::vector::Vec3;
use crate::scalar::{Pack, Scalar, inlined};

/// The part that depends on q.
#[derive(Clone, Copy, Debug)]
pub enum JointPosition<S> {
    /// Rotated about z by the joint angle.
    Rotated(Turn<S>),
    /// Translated along z by this distance (m).
    Translated(S),
    /// Turned by any rotation, then about z by an angle that stays zero: the first of the three axes of a
    /// joint that turns freely. `FixedScrew::rise` is zero.
    Oriented(Quaternion<S>),
}

impl<S: Scalar> JointPosition<S> {
    /// The same in every lane.
    #[inline(always)]
    pub fn splat<P: Pack<S>>(&self) -> JointPosition<P> {
        match self {
            Self::Rotated(turn) => JointPosition::Rotated(turn.splat()),
            Self::Translated(distance) => JointPosition::Translated(P::splat(*distance)),
            Self::Oriented(orientation) => JointPosition::Oriented(orientation.splat()),
        }
    }
}

/// One transform between neighbouring frames.
#[derive(Clone, Copy, Debug)]
pub struct Transform<'a, S> {
    /// Its constant part.
    pub fixed: &'a FixedScrew,
    /// Its moving part.
    pub joint: JointPosition<S>,
}

impl<S: Scalar> Transform<'_, S> {
    /// A free vector of the parent's frame, seen from this frame.
    #[inline(always)]
    pub fn vector_down(&self, mut a: Vec3<S>) -> Vec3<S> {
        inlined!(S, {
            if let Some(gamma) = &self.fixed.gamma {
                [a.x, a.y] = gamma.undo([a.x, a.y]);
            }
            [a.y, a.z] = self.fixed.alpha.undo([a.y, a.z]);
            match &self.joint {
                JointPosition::Rotated(turn) => [a.x, a.y] = turn.undo([a.x, a.y]),
                JointPosition::Translated(_) => {}
                JointPosition::Oriented(orientation) => a = orientation.undo(a),
            }
            a
        })
    }

    /// A free vector of the parent's frame, seen from this frame, and its product with the position of the
    /// origin of this frame in the parent's.
    #[inline(always)]
    pub fn vector_down_with_arm(&self, mut a: Vec3<S>) -> (Vec3<S>, S) {
        inlined!(S, {
            let fixed = self.fixed;
            if let Some(gamma) = &fixed.gamma {
                [a.x, a.y] = gamma.undo([a.x, a.y]);
            }
            let mut arm = if fixed.is_along_x() {
                a.x.times(fixed.translation[0])
            } else {
                a.dot_constant(fixed.translation)
            };
            [a.y, a.z] = fixed.alpha.undo([a.y, a.z]);
            match &self.joint {
                JointPosition::Rotated(turn) => {
                    if fixed.rise != 0.0 {
                        arm = arm.plus_times(a.z, fixed.rise);
                    }
                    [a.x, a.y] = turn.undo([a.x, a.y]);
                }
                &JointPosition::Translated(distance) => arm = a.z.mul_add(distance, arm),
                JointPosition::Oriented(orientation) => a = orientation.undo(a),
            }
            (a, arm)
        })
    }

    /// A rigid motion seen from and referred to the parent's frame, now to this frame.
    #[inline(always)]
    pub fn motion_down(&self, parent: Motion<S>) -> Motion<S> {
        inlined!(S, {
            let (mut w, mut v) = (parent.angular, parent.linear);
            let fixed = self.fixed;
            if let Some(gamma) = &fixed.gamma {
                [w.x, w.y] = gamma.undo([w.x, w.y]);
                [v.x, v.y] = gamma.undo([v.x, v.y]);
            }
            v = fixed.add_arm(v, w);
            [w.y, w.z] = fixed.alpha.undo([w.y, w.z]);
            [v.y, v.z] = fixed.alpha.undo([v.y, v.z]);
            match &self.joint {
                JointPosition::Rotated(turn) => {
                    if fixed.rise != 0.0 {
                        v.x = v.x.plus_times(w.y, fixed.rise);
                        v.y = v.y.plus_times(w.x, -fixed.rise);
                    }
                    [w.x, w.y] = turn.undo([w.x, w.y]);
                    [v.x, v.y] = turn.undo([v.x, v.y]);
                }
                &JointPosition::Translated(distance) => {
                    v.x = w.y.mul_add(distance, v.x);
                    v.y = w.x.mul_add(-distance, v.y);
                }
                JointPosition::Oriented(orientation) => (w, v) = orientation.undo_both(w, v),
            }
            Motion { angular: w, linear: v }
        })
    }

    /// A force about the origin of this frame, now seen from the parent's frame, about its origin.
    #[inline(always)]
    pub fn force_up(&self, here: Force<S>) -> Force<S> {
        inlined!(S, {
            let (mut n, mut f) = (here.moment, here.force);
            let fixed = self.fixed;
            match &self.joint {
                JointPosition::Rotated(turn) => {
                    [n.x, n.y] = turn.apply([n.x, n.y]);
                    [f.x, f.y] = turn.apply([f.x, f.y]);
                    if fixed.rise != 0.0 {
                        n.x = n.x.plus_times(f.y, -fixed.rise);
                        n.y = n.y.plus_times(f.x, fixed.rise);
                    }
                }
                &JointPosition::Translated(distance) => {
                    n.x = f.y.mul_add(-distance, n.x);
                    n.y = f.x.mul_add(distance, n.y);
                }
                JointPosition::Oriented(orientation) => (n, f) = orientation.apply_both(n, f),
            }
            [n.y, n.z] = fixed.alpha.apply([n.y, n.z]);
            [f.y, f.z] = fixed.alpha.apply([f.y, f.z]);
            n = fixed.subtract_arm(n, f);
            if let Some(gamma) = &fixed.gamma {
                [n.x, n.y] = gamma.apply([n.x, n.y]);
                [f.x, f.y] = gamma.apply([f.x, f.y]);
            }
            Force { moment: n, force: f }
        })
    }

    /// An inertia about the origin of this frame, now about that of the parent's frame.
    ///
    /// Translation by r adds `2 (r.w) 1 - r w' - w r'` to J, w = h + m r / 2 (parallel-axis theorem).
    #[inline(always)]
    pub fn inertia_up(&self, body: &Inertia<S>) -> Inertia<S> {
        inlined!(S, {
            let mass = body.mass;
            let fixed = self.fixed;
            let (mut h, mut j) = (body.first_moment, body.matrix);
            match &self.joint {
                JointPosition::Rotated(turn) => {
                    [h.x, h.y] = turn.apply([h.x, h.y]);
                    j = j.rotated_about_z(turn);
                    if fixed.rise != 0.0 {
                        let spread = (h.z + h.z).plus(mass * fixed.rise).times(fixed.rise);
                        j.xx += spread;
                        j.yy += spread;
                        j.xz = j.xz.plus_times(h.x, -fixed.rise);
                        j.yz = j.yz.plus_times(h.y, -fixed.rise);
                        h.z = h.z.plus(mass * fixed.rise);
                    }
                }
                &JointPosition::Translated(distance) => {
                    let moved = distance.times(mass);
                    let spread = distance * (h.z + h.z + moved);
                    j.xx += spread;
                    j.yy += spread;
                    j.xz = h.x.mul_add(-distance, j.xz);
                    j.yz = h.y.mul_add(-distance, j.yz);
                    h.z += moved;
                }
                JointPosition::Oriented(orientation) => (h, j) = orientation.turn(h, &j),
            }
            [h.y, h.z] = fixed.alpha.apply([h.y, h.z]);
            j = j.rotated_about_x_constant(&fixed.alpha);
            let r @ [rx, ry, rz] = fixed.translation;
            if fixed.is_along_x() {
                let spread = h.x.plus(0.5 * mass * rx).times(2.0 * rx);
                j.yy += spread;
                j.zz += spread;
                j.xy = j.xy.plus_times(h.y, -rx);
                j.xz = j.xz.plus_times(h.z, -rx);
                h.x = h.x.plus(mass * rx);
            } else {
                let w = h.plus(r.map(|r| 0.5 * mass * r));
                let (xx, yy, zz) = (w.x.times(rx), w.y.times(ry), w.z.times(rz));
                let double = |a: S| a + a;
                j.xx += double(yy + zz);
                j.yy += double(xx + zz);
                j.zz += double(xx + yy);
                j.xy = j.xy.plus_times(w.x, -ry).plus_times(w.y, -rx);
                j.xz = j.xz.plus_times(w.x, -rz).plus_times(w.z, -rx);
                j.yz = j.yz.plus_times(w.y, -rz).plus_times(w.z, -ry);
                h = h.plus(r.map(|r| mass * r));
            }
            if let Some(gamma) = &fixed.gamma {
                [h.x, h.y] = gamma.apply([h.x, h.y]);
                j = j.rotated_about_z_constant(gamma);
            }
            Inertia { mass, first_moment: h, matrix: j }
        })
    }
}
