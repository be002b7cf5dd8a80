//! Products with the inertias of unit bodies.

use crate::robot::{JointKind, Placement};
use crate::scalar::{Scalar, inlined};
use crate::spatial::{Motion, Vec3};

/// `m x (S rate)` for the axis S of a joint, in its frame.
#[inline(always)]
pub(super) fn across_joint<S: Scalar>(kind: JointKind, m: Motion<S>, rate: S) -> Motion<S> {
    let across = |a: Vec3<S>| Vec3::new(a.y * rate, -(a.x * rate), S::zero());
    match kind {
        JointKind::Revolute => Motion { angular: across(m.angular), linear: across(m.linear) },
        JointKind::Prismatic => Motion { angular: Vec3::zero(), linear: across(m.angular) },
    }
}

/// `m + S rate` for the axis S of a joint, in its frame.
#[inline(always)]
pub(super) fn plus_joint<S: Scalar>(kind: JointKind, mut m: Motion<S>, rate: S) -> Motion<S> {
    match kind {
        JointKind::Revolute => m.angular.z += rate,
        JointKind::Prismatic => m.linear.z += rate,
    }
    m
}

/// `R' a` for a constant rotation.
#[inline(always)]
pub(super) fn turned_back<S: Scalar>(frame: &Placement, a: Vec3<S>) -> Vec3<S> {
    let column = |k: usize| a.dot_constant(frame.rotation.column(k).into_owned().into());
    Vec3::new(column(0), column(1), column(2))
}

/// A motion seen from and referred to an inner frame with this placement.
#[inline(always)]
pub(super) fn seen_from<S: Scalar>(frame: &Placement, m: Motion<S>) -> Motion<S> {
    inlined!(S, {
        let moved = m.linear + m.angular.cross_constant(frame.translation.into());
        Motion { angular: turned_back(frame, m.angular), linear: turned_back(frame, moved) }
    })
}

/// `m . I_a n` for the inertias `I_a = dI/da` of the ten inertial parameters a, in their order; symmetric in
/// m and n.
///
/// With the angular parts w and linear parts v of m = (w, v) and n = (w', v'):
///
/// ```text
/// mass: v . v'      first moment: v x w' - w x v'      J_xx: w_x w'_x      J_xy: w_x w'_y + w_y w'_x
/// ```
#[inline(always)]
pub(super) fn unit_products<S: Scalar>(m: Motion<S>, n: Motion<S>) -> [S; 10] {
    inlined!(S, {
        let (a, b) = (m.angular, n.angular);
        let h = m.linear.cross(b) - a.cross(n.linear);
        let mixed = |p: S, q: S, r: S, s: S| p.mul_add(q, r * s);
        [
            m.linear.dot(n.linear),
            h.x,
            h.y,
            h.z,
            a.x * b.x,
            a.y * b.y,
            a.z * b.z,
            mixed(a.x, b.y, a.y, b.x),
            mixed(a.x, b.z, a.z, b.x),
            mixed(a.y, b.z, a.z, b.y),
        ]
    })
}

/// The sum of two lists of products.
#[inline(always)]
pub(super) fn added<S: Scalar>(mut a: [S; 10], b: [S; 10]) -> [S; 10] {
    a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
    a
}

/// The difference of two lists of products.
#[inline(always)]
pub(super) fn less<S: Scalar>(mut a: [S; 10], b: [S; 10]) -> [S; 10] {
    a.iter_mut().zip(b).for_each(|(a, b)| *a -= b);
    a
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spatial::ConstantInertia;

    #[test]
    fn products_add_up_to_the_power_of_a_momentum() {
        let parameters = [1.7, 0.3, -0.2, 0.9, 1.0, 1.3, 0.8, -0.1, 0.05, 0.2];
        let body = ConstantInertia {
            mass: parameters[0],
            first_moment: [1, 2, 3].map(|k| parameters[k]),
            matrix: [4, 5, 6, 7, 8, 9].map(|k| parameters[k]),
        };
        let m =
            Motion { angular: Vec3::constant([0.2, 1.1, -0.7]), linear: Vec3::constant([3.0, -0.4, 0.6]) };
        let n =
            Motion { angular: Vec3::constant([-1.3, 0.4, 0.9]), linear: Vec3::constant([0.1, 2.0, -0.8]) };
        let expected: f64 = body.apply(n).dot(m);
        let sum = |products: [f64; 10]| -> f64 { products.iter().zip(parameters).map(|(a, b)| a * b).sum() };
        assert!((sum(unit_products(m, n)) - expected).abs() < 1e-15);
        assert!((sum(unit_products(n, m)) - expected).abs() < 1e-15);
    }

    #[test]
    fn products_with_the_axis_are_those_of_motions() {
        let m =
            Motion { angular: Vec3::constant([0.2, 1.1, -0.7]), linear: Vec3::constant([3.0, -0.4, 0.6]) };
        for kind in [JointKind::Revolute, JointKind::Prismatic] {
            let axis = plus_joint(kind, Motion::zero(), 0.7);
            let (ours, whole) = (across_joint(kind, m, 0.7), m.cross(axis));
            let parts = |m: Motion<f64>| [m.angular, m.linear].map(|a| [a.x, a.y, a.z]);
            for (a, b) in parts(ours).iter().flatten().zip(parts(whole).iter().flatten()) {
                assert!((a - b).abs() < 1e-15);
            }
        }
    }
}
