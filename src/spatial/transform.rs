//! From the frame of a joint to that of its parent and back.
//!
//! `x_parent = Rz(gamma) ( r + Rx(alpha) J(q) x )`, where J turns about z by q (+ an offset) or slides along z by q.
//! Every placement of two frames has this form once each frame is turned about its own z axis: with gamma = 0 it is
//! the modified Denavit-Hartenberg convention (A1.2). Rotations are made of sine and cosine only.

use super::inertia::Inertia;
use super::vector::{Force, Motion, Vec3};
use crate::scalar::Scalar;

/// The constant part `Rz(gamma) (r + Rx(alpha) .)` of a transform.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedScrew {
    /// Sine and cosine of gamma; `None` where gamma = 0.
    pub gamma: Option<[f64; 2]>,
    /// Sine and cosine of alpha.
    pub alpha: [f64; 2],
    /// Translation r (m), in axes turned by gamma.
    pub translation: [f64; 3],
}

/// The part that depends on q.
#[derive(Clone, Copy, Debug)]
pub enum JointPosition<S> {
    /// Turned about z.
    Turned {
        /// Sine of the joint angle.
        sin: S,
        /// Cosine of the joint angle.
        cos: S,
    },
    /// Slid along z.
    Slid {
        /// By this distance (m).
        distance: S,
    },
}

/// One transform between neighbouring frames.
#[derive(Clone, Copy, Debug)]
pub struct Transform<S> {
    /// Its constant part.
    pub fixed: FixedScrew,
    /// Its moving part.
    pub joint: JointPosition<S>,
}

#[inline(always)]
fn turn_z<S: Scalar>(a: Vec3<S>, sin: S, cos: S) -> Vec3<S> {
    Vec3::new(cos * a.x - sin * a.y, sin * a.x + cos * a.y, a.z)
}

#[inline(always)]
fn turn_z_back<S: Scalar>(a: Vec3<S>, sin: S, cos: S) -> Vec3<S> {
    Vec3::new(cos * a.x + sin * a.y, cos * a.y - sin * a.x, a.z)
}

#[inline(always)]
fn turn_z_constant<S: Scalar>(a: Vec3<S>, [sin, cos]: [f64; 2]) -> Vec3<S> {
    Vec3::new(a.x.times(cos) - a.y.times(sin), a.x.times(sin) + a.y.times(cos), a.z)
}

#[inline(always)]
fn turn_x_constant<S: Scalar>(a: Vec3<S>, [sin, cos]: [f64; 2]) -> Vec3<S> {
    Vec3::new(a.x, a.y.times(cos) - a.z.times(sin), a.y.times(sin) + a.z.times(cos))
}

impl<S: Scalar> Transform<S> {
    /// A free vector of the parent's frame, seen from this frame.
    #[inline(always)]
    pub fn vector_down(&self, mut a: Vec3<S>) -> Vec3<S> {
        if let Some([sin, cos]) = self.fixed.gamma {
            a = turn_z_constant(a, [-sin, cos]);
        }
        let [sin, cos] = self.fixed.alpha;
        a = turn_x_constant(a, [-sin, cos]);
        match self.joint {
            JointPosition::Turned { sin, cos } => turn_z_back(a, sin, cos),
            JointPosition::Slid { .. } => a,
        }
    }

    /// A rigid motion seen from and referred to the parent's frame, now to this frame.
    #[inline(always)]
    pub fn motion_down(&self, parent: Motion<S>) -> Motion<S> {
        let (mut w, mut v) = (parent.angular, parent.linear);
        if let Some([sin, cos]) = self.fixed.gamma {
            w = turn_z_constant(w, [-sin, cos]);
            v = turn_z_constant(v, [-sin, cos]);
        }
        v = v + w.cross_constant(self.fixed.translation);
        let [sin, cos] = self.fixed.alpha;
        w = turn_x_constant(w, [-sin, cos]);
        v = turn_x_constant(v, [-sin, cos]);
        match self.joint {
            JointPosition::Turned { sin, cos } => {
                Motion { angular: turn_z_back(w, sin, cos), linear: turn_z_back(v, sin, cos) }
            }
            JointPosition::Slid { distance } => {
                Motion { angular: w, linear: Vec3::new(v.x + w.y * distance, v.y - w.x * distance, v.z) }
            }
        }
    }

    /// A force about the origin of this frame, now seen from the parent's frame, about its origin.
    #[inline(always)]
    pub fn force_up(&self, here: Force<S>) -> Force<S> {
        let (mut n, mut f) = (here.moment, here.force);
        match self.joint {
            JointPosition::Turned { sin, cos } => {
                n = turn_z(n, sin, cos);
                f = turn_z(f, sin, cos);
            }
            JointPosition::Slid { distance } => {
                n = Vec3::new(n.x - distance * f.y, n.y + distance * f.x, n.z)
            }
        }
        n = turn_x_constant(n, self.fixed.alpha);
        f = turn_x_constant(f, self.fixed.alpha);
        n = n - f.cross_constant(self.fixed.translation);
        if let Some(gamma) = self.fixed.gamma {
            n = turn_z_constant(n, gamma);
            f = turn_z_constant(f, gamma);
        }
        Force { moment: n, force: f }
    }

    /// An inertia about the origin of this frame, now about that of the parent's frame.
    ///
    /// Translation by r adds `2 (r.w) 1 - r w' - w r'` to J, w = h + m r / 2 (parallel-axis theorem).
    #[inline(always)]
    pub fn inertia_up(&self, body: &Inertia<S>) -> Inertia<S> {
        let mass = body.mass;
        let (mut h, mut j) = (body.first_moment, body.matrix);
        match self.joint {
            JointPosition::Turned { sin, cos } => {
                h = turn_z(h, sin, cos);
                j = j.turned_about_z(sin, cos);
            }
            JointPosition::Slid { distance } => {
                let moved = distance.times(mass);
                let spread = distance * (h.z + h.z + moved);
                j.xx += spread;
                j.yy += spread;
                j.xz -= distance * h.x;
                j.yz -= distance * h.y;
                h.z += moved;
            }
        }
        h = turn_x_constant(h, self.fixed.alpha);
        j = j.turned_about_x_constant(self.fixed.alpha);
        let r @ [rx, ry, rz] = self.fixed.translation;
        let w = h.plus(r.map(|r| 0.5 * mass * r));
        let (xx, yy, zz) = (w.x.times(rx), w.y.times(ry), w.z.times(rz));
        let double = |a: S| a + a;
        j.xx += double(yy + zz);
        j.yy += double(xx + zz);
        j.zz += double(xx + yy);
        j.xy -= w.x.times(ry) + w.y.times(rx);
        j.xz -= w.x.times(rz) + w.z.times(rx);
        j.yz -= w.y.times(rz) + w.z.times(ry);
        h = h.plus(r.map(|r| mass * r));
        if let Some(gamma) = self.fixed.gamma {
            h = turn_z_constant(h, gamma);
            j = j.turned_about_z_constant(gamma);
        }
        Inertia { mass, first_moment: h, matrix: j }
    }
}

#[cfg(test)]
mod tests {
    use super::super::inertia::{ConstantInertia, Symmetric3};
    use super::*;
    use nalgebra::{Matrix3, Vector3};

    fn cases() -> Vec<Transform<f64>> {
        let unit = |angle: f64| [angle.sin(), angle.cos()];
        let (sin, cos) = 0.4_f64.sin_cos();
        let turned = JointPosition::Turned { sin, cos };
        let slid = JointPosition::Slid { distance: -0.8 };
        let translation = [0.3, -0.5, 0.7];
        let mut cases = Vec::new();
        for joint in [turned, slid] {
            for gamma in [None, Some(unit(2.2))] {
                cases.push(Transform { fixed: FixedScrew { gamma, alpha: unit(-1.3), translation }, joint });
            }
        }
        cases
    }

    /// Rotation and translation as dense arrays, built independently of the staged formulas.
    fn dense(t: &Transform<f64>) -> (Matrix3<f64>, Vector3<f64>) {
        let rz = |[s, c]: [f64; 2]| Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
        let [s, c] = t.fixed.alpha;
        let rx = Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c);
        let outer = rz(t.fixed.gamma.unwrap_or([0.0, 1.0]));
        let (turn, slide) = match t.joint {
            JointPosition::Turned { sin, cos } => (rz([sin, cos]), 0.0),
            JointPosition::Slid { distance } => (Matrix3::identity(), distance),
        };
        let origin = outer * (Vector3::from(t.fixed.translation) + rx * Vector3::new(0.0, 0.0, slide));
        (outer * rx * turn, origin)
    }

    fn to_na(a: Vec3<f64>) -> Vector3<f64> {
        Vector3::new(a.x, a.y, a.z)
    }

    fn close(a: Vec3<f64>, b: Vector3<f64>) {
        assert!((to_na(a) - b).amax() < 1e-14, "{a:?} is not {b:?}");
    }

    #[test]
    fn staged_transforms_agree_with_dense_matrices() {
        let (a, b) = (Vec3::constant([0.9, -0.1, 0.35]), Vec3::constant([-0.6, 0.45, 1.2]));
        for t in cases() {
            let (r, o) = dense(&t);
            close(t.vector_down(a), r.transpose() * to_na(a));
            let m = t.motion_down(Motion { angular: a, linear: b });
            close(m.angular, r.transpose() * to_na(a));
            close(m.linear, r.transpose() * (to_na(b) + to_na(a).cross(&o)));
            let f = t.force_up(Force { moment: a, force: b });
            close(f.force, r * to_na(b));
            close(f.moment, r * to_na(a) + o.cross(&(r * to_na(b))));
        }
    }

    #[test]
    fn inertia_moves_by_the_parallel_axis_theorem() {
        let (m, com) = (2.0, Vector3::new(0.2, -0.3, 0.1));
        let i_com = Matrix3::new(0.4, 0.02, -0.03, 0.02, 0.5, 0.01, -0.03, 0.01, 0.6);
        let about = |i: Matrix3<f64>, c: Vector3<f64>| {
            i + (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * m
        };
        let j = about(i_com, com);
        let body = ConstantInertia {
            mass: m,
            first_moment: (com * m).into(),
            matrix: [j[(0, 0)], j[(1, 1)], j[(2, 2)], j[(0, 1)], j[(0, 2)], j[(1, 2)]],
        };
        for t in cases() {
            let (r, o) = dense(&t);
            let moved = t.inertia_up(&body.lift());
            let c = r * com + o;
            close(moved.first_moment, c * m);
            let Symmetric3 { xx, yy, zz, xy, xz, yz } = moved.matrix;
            let ours = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            assert!((ours - about(r * i_com * r.transpose(), c)).amax() < 1e-14);
        }
    }
}
