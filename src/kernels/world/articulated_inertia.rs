//! Inertias of articulated bodies.

use crate::robot::JointKind;
use crate::scalar::{Scalar, inlined};
use crate::spatial::{Force, Symmetric3, Vec3};

/// Inertia of an articulated body: `(n; f) = (A w + B v; B' w + C v)`, B by rows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Articulated<S> {
    a: Symmetric3<S>,
    b: [Vec3<S>; 3],
    c: Symmetric3<S>,
}

impl<S: Scalar> Articulated<S> {
    pub fn zero() -> Self {
        Self { a: Symmetric3::zero(), b: [Vec3::zero(); 3], c: Symmetric3::zero() }
    }

    /// Of a rigid body with J, h and m.
    #[inline(always)]
    pub fn rigid(matrix: Symmetric3<S>, h: Vec3<S>, mass: S) -> Self {
        let zero = S::zero();
        Self {
            a: matrix,
            b: [Vec3::new(zero, -h.z, h.y), Vec3::new(h.z, zero, -h.x), Vec3::new(-h.y, h.x, zero)],
            c: Symmetric3 { xx: mass, yy: mass, zz: mass, xy: zero, xz: zero, yz: zero },
        }
    }

    /// `IA S` for the axis of a joint.
    #[inline(always)]
    pub fn along(&self, kind: JointKind, axis: Vec3<S>) -> Force<S> {
        inlined!(S, {
            let [x, y, z] = self.b;
            match kind {
                JointKind::Revolute => Force {
                    moment: self.a.apply(axis),
                    force: x.scaled(axis.x).plus_scaled(y, axis.y).plus_scaled(z, axis.z),
                },
                JointKind::Prismatic => Force {
                    moment: Vec3::new(x.dot(axis), y.dot(axis), z.dot(axis)),
                    force: self.c.apply(axis),
                },
            }
        })
    }

    /// `IA - U g'`, `g = U / D`.
    #[inline(always)]
    pub fn less(&self, u: &Force<S>, g: &Force<S>) -> Self {
        inlined!(S, {
            let (n, f) = (g.moment, -u.force);
            Self {
                a: plus_square(&self.a, -u.moment, n),
                b: [(self.b[0], n.x), (self.b[1], n.y), (self.b[2], n.z)]
                    .map(|(row, n)| row.plus_scaled(f, n)),
                c: plus_square(&self.c, f, g.force),
            }
        })
    }

    /// The same body about the origin where the arm r begins: `B + r x C`, and in A
    /// `r x B' - (B + r x C) r x`.
    #[inline(always)]
    pub fn shifted(&self, r: Vec3<S>) -> Self {
        inlined!(S, {
            let Symmetric3 { xx, yy, zz, xy, xz, yz } = self.c;
            let [bx, by, bz] = self.b;
            // Row a of r x C.
            let b = [
                bx.plus_scaled(Vec3::new(xz, yz, zz), r.y).plus_scaled(Vec3::new(xy, yy, yz), -r.z),
                by.plus_scaled(Vec3::new(xx, xy, xz), r.z).plus_scaled(Vec3::new(xz, yz, zz), -r.x),
                bz.plus_scaled(Vec3::new(xy, yy, yz), r.x).plus_scaled(Vec3::new(xx, xy, xz), -r.y),
            ];
            let cross = [
                |r: Vec3<S>, b: Vec3<S>, term: S| r.y.mul_add(b.z, (-r.z).mul_add(b.y, term)),
                |r: Vec3<S>, b: Vec3<S>, term: S| r.z.mul_add(b.x, (-r.x).mul_add(b.z, term)),
                |r: Vec3<S>, b: Vec3<S>, term: S| r.x.mul_add(b.y, (-r.y).mul_add(b.x, term)),
            ];
            let entry = |i: usize, j: usize, term: S| cross[i](r, self.b[j], cross[j](r, b[i], term));
            let a = &self.a;
            let a = Symmetric3 {
                xx: entry(0, 0, a.xx),
                yy: entry(1, 1, a.yy),
                zz: entry(2, 2, a.zz),
                xy: entry(0, 1, a.xy),
                xz: entry(0, 2, a.xz),
                yz: entry(1, 2, a.yz),
            };
            Self { a, b, c: self.c }
        })
    }

    /// Sum of the moments of inertia about the axes.
    #[inline(always)]
    pub fn turning_scale(&self) -> S {
        self.a.xx.abs() + self.a.yy.abs() + self.a.zz.abs()
    }

    /// Sum of the masses along the axes.
    #[inline(always)]
    pub fn pulling_scale(&self) -> S {
        self.c.xx.abs() + self.c.yy.abs() + self.c.zz.abs()
    }

    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        self.a += other.a;
        self.c += other.c;
        self.b.iter_mut().zip(other.b).for_each(|(row, other)| *row = *row + other);
    }
}

/// `A + u v'`, which is symmetric.
#[inline(always)]
fn plus_square<S: Scalar>(a: &Symmetric3<S>, u: Vec3<S>, v: Vec3<S>) -> Symmetric3<S> {
    Symmetric3 {
        xx: u.x.mul_add(v.x, a.xx),
        yy: u.y.mul_add(v.y, a.yy),
        zz: u.z.mul_add(v.z, a.zz),
        xy: u.x.mul_add(v.y, a.xy),
        xz: u.x.mul_add(v.z, a.xz),
        yz: u.y.mul_add(v.z, a.yz),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Matrix6, Vector3, Vector6};

    fn dense(inertia: &Articulated<f64>) -> Matrix6<f64> {
        let square = |j: &Symmetric3<f64>| Matrix3::new(j.xx, j.xy, j.xz, j.xy, j.yy, j.yz, j.xz, j.yz, j.zz);
        let b = Matrix3::from_fn(|i, j| [inertia.b[i].x, inertia.b[i].y, inertia.b[i].z][j]);
        let mut all = Matrix6::zeros();
        all.fixed_view_mut::<3, 3>(0, 0).copy_from(&square(&inertia.a));
        all.fixed_view_mut::<3, 3>(0, 3).copy_from(&b);
        all.fixed_view_mut::<3, 3>(3, 0).copy_from(&b.transpose());
        all.fixed_view_mut::<3, 3>(3, 3).copy_from(&square(&inertia.c));
        all
    }

    fn column(force: &Force<f64>) -> Vector6<f64> {
        let (n, f) = (force.moment, force.force);
        Vector6::new(n.x, n.y, n.z, f.x, f.y, f.z)
    }

    #[test]
    fn steps_of_articulated_bodies_are_those_of_dense_matrices() {
        let matrix = Symmetric3 { xx: 1.3, yy: 0.9, zz: 1.7, xy: 0.2, xz: -0.1, yz: 0.3 };
        let axis = Vec3::new(0.6, 0.0, 0.8);
        let mut body = Articulated::rigid(matrix, Vec3::new(0.3, -0.5, 0.2), 2.5);
        for (kind, start) in [(JointKind::Revolute, 0), (JointKind::Prismatic, 3)] {
            let mut s = Vector6::zeros();
            s.fixed_rows_mut::<3>(start).copy_from(&Vector3::new(axis.x, axis.y, axis.z));
            let before = dense(&body);
            let u = body.along(kind, axis);
            assert!((column(&u) - before * s).amax() < 1e-15);
            let inverse = 1.0 / s.dot(&column(&u));
            let gain = Force { moment: u.moment.scaled(inverse), force: u.force.scaled(inverse) };
            let less = body.less(&u, &gain);
            let expected = before - column(&u) * column(&u).transpose() * inverse;
            assert!((dense(&less) - expected).amax() < 1e-14);

            // Motions of the two origins: v' = v + w x r.
            let r = Vector3::new(0.4, -0.7, 1.1);
            let mut motion = Matrix6::identity();
            motion.fixed_view_mut::<3, 3>(3, 0).copy_from(&-r.cross_matrix());
            let shifted = less.shifted(Vec3::new(r.x, r.y, r.z));
            assert!((dense(&shifted) - motion.transpose() * expected * motion).amax() < 1e-14);
            body = shifted;
            body.add(&less);
            assert!((dense(&body) - dense(&shifted) - dense(&less)).amax() < 1e-14);
        }
    }
}
