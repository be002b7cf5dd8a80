//! The orientation rows: twice the vector part of the quaternion of a rotation.

use crate::kinematics::quaternion;
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// The quaternion (eps, eta) of a rotation R, eta >= 0.
///
/// With w the axis of a joint nearer to the second frame than all others, or the only one,
///
/// ```text
/// eps_,s = 1/2 (eta w_s + w_s x eps)      eta_,s = -1/2 eps . w_s      psi = 2 eps
/// (nu . psi)_,st = nu . ( eta_,s w_t + eta w_s x w_t + (w_s x w_t) x eps + w_t x eps_,s ) = h_s . w_t
/// h_s = eta_,s nu + m x w_s + eps_,s x nu      m = eta nu + eps x nu
/// ```
///
/// for s not beyond t: three independent rows for every angle below pi, and gradients, so that constraints
/// made of them are holonomic. At a half turn psi jumps to -psi, and `psi_,s = w_s x eps` is zero for turns
/// about the axis: a singular pose, where its values and derivatives are those of one side.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfTurn<S> {
    eps: Vec3<S>,
    eta: S,
}

impl<S: Scalar> HalfTurn<S> {
    /// From a rotation by rows.
    pub fn of(rotation: &[Vec3<S>; 3]) -> Self {
        let (eta, eps) = quaternion(*rotation);
        Self { eps, eta }
    }

    /// `psi = 2 eps`.
    pub fn value(&self) -> Vec3<S> {
        self.eps.times(2.0)
    }

    /// `psi_,s = eta w + w x eps`.
    pub fn slope(&self, w: Vec3<S>) -> Vec3<S> {
        w.scaled(self.eta) + w.cross(self.eps)
    }

    /// h_s of `(nu . psi)_,st = h_s . w_t`, s the inner one.
    pub fn curvature(&self, nu: Vec3<S>, inner: Vec3<S>) -> Vec3<S> {
        let along = nu.scaled(self.eps.dot(inner).times(-0.5));
        along + self.moment(nu).cross(inner) + self.slope(inner).cross(nu).times(0.5)
    }

    /// The moment of multipliers nu of psi: `nu . psi' = moment . w` with `moment = eta nu + eps x nu`.
    pub fn moment(&self, nu: Vec3<S>) -> Vec3<S> {
        nu.scaled(self.eta) + self.eps.cross(nu)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scalar::Tangent;
    use num_dual::{Dual64, HyperDual64};
    use std::f64::consts::PI;

    /// Products of turns about the axes; the first is the innermost.
    fn rotation<S: Scalar>(angles: &[S], axes: &[[f64; 3]]) -> [Vec3<S>; 3] {
        let mut rows = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(Vec3::constant);
        for (&angle, &axis) in angles.iter().zip(axes) {
            let (sin, cos) = angle.sin_cos();
            let z = Vec3::<S>::constant(axis);
            // The rows are turned by the transposed rotation.
            rows = rows.map(|row| {
                row.scaled(cos) + row.cross(z).scaled(sin) + z.scaled(z.dot(row) * (S::one() - cos))
            });
        }
        rows
    }

    const AXES: [[f64; 3]; 3] = [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [0.48, -0.6, 0.64]];

    #[test]
    fn derivatives_are_those_of_hyper_dual_numbers() {
        let (angles, nu) = ([0.7, -0.9, 1.1], [0.3, -1.2, 0.8]);
        let plain = HalfTurn::of(&rotation(&angles, &AXES));
        let square = plain.eps.dot(plain.eps) + plain.eta * plain.eta;
        assert!((square - 1.0).abs() < 1e-15);
        let seen = |k: usize| {
            let rows = rotation(&angles[..k], &AXES[..k]);
            let axis = Vec3::constant(AXES[k]);
            Vec3::new(rows[0].dot(axis), rows[1].dot(axis), rows[2].dot(axis))
        };
        for t in 0..3 {
            for s in 0..=t {
                let seeds: Vec<HyperDual64> = (0..3)
                    .map(|k| {
                        let one = |on| f64::from(u8::from(on));
                        HyperDual64::new(angles[k], one(k == s), one(k == t), 0.0)
                    })
                    .collect();
                let expected = HalfTurn::of(&rotation(&seeds, &AXES)).value();
                let first = plain.slope(seen(s)).to_array();
                for (found, expected) in first.iter().zip(expected.to_array()) {
                    assert!((found - expected.eps1).abs() < 1e-14, "{s}");
                }
                let found = plain.curvature(Vec3::constant(nu), seen(s)).dot(seen(t));
                let expected: f64 =
                    nu.iter().zip(expected.to_array()).map(|(nu, psi)| nu * psi.eps1eps2).sum();
                assert!((found - expected).abs() < 1e-14, "{s} {t}: {found} {expected}");
            }
        }
        let w = Vec3::constant([0.2, -0.7, 0.4]);
        let power = Vec3::constant(nu).dot(plain.slope(w));
        assert!((plain.moment(Vec3::constant(nu)).dot(w) - power).abs() < 1e-15);
        // The value is differentiated by tangents, too.
        let along = [0.4, 1.0, -0.3];
        let moving: Vec<_> = angles.iter().zip(along).map(|(&q, v)| Tangent::new(q, v)).collect();
        let rate = HalfTurn::of(&rotation(&moving, &AXES)).value().to_array().map(|psi| psi.eps);
        let sum = (0..3).fold(Vec3::zero(), |sum, k| sum + plain.slope(seen(k)).scaled(along[k])).to_array();
        assert!(rate.iter().zip(sum).all(|(a, b): (&f64, f64)| (a - b).abs() < 1e-14));
    }

    /// The same turns as a product of quaternions: nothing is divided, and no digit is lost at any angle.
    fn product<S: Scalar>(angles: &[S], axes: &[[f64; 3]]) -> HalfTurn<S> {
        let mut all = HalfTurn { eps: Vec3::zero(), eta: S::one() };
        for (angle, &axis) in angles.iter().zip(axes) {
            let (sin, eta) = angle.times(0.5).sin_cos();
            let (HalfTurn { eps: a, eta: b }, eps) = (all, Vec3::<S>::constant(axis).scaled(sin));
            all = HalfTurn { eps: eps.scaled(b) + a.scaled(eta) + a.cross(eps), eta: b * eta - a.dot(eps) };
        }
        let is_negative = all.eta.less(S::zero());
        let turned = |entry: S| S::select(is_negative, -entry, entry);
        HalfTurn { eps: Vec3::from(all.eps.to_array().map(turned)), eta: turned(all.eta) }
    }

    fn random_axis(random: &mut fastrand::Rng) -> [f64; 3] {
        loop {
            let axis = [0; 3].map(|_| 2.0 * random.f64() - 1.0);
            let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
            if (0.1..1.0).contains(&length) {
                return axis.map(|x| x / length);
            }
        }
    }

    /// All entries of (eps, eta), each with what `parts` makes of it.
    fn entries<S: Scalar, const N: usize>(turn: &HalfTurn<S>, parts: impl Fn(S) -> [f64; N]) -> Vec<f64> {
        turn.eps.to_array().into_iter().chain([turn.eta]).flat_map(parts).collect()
    }

    /// Just before half a turn about any axis, with numbers that carry derivatives by three turns.
    #[test]
    fn no_digit_is_lost_just_before_half_a_turn() {
        let mut random = fastrand::Rng::with_seed(5);
        for missing in (3..=9).map(|k| 10.0_f64.powi(-k)) {
            for _ in 0..200 {
                let axes = [(); 3].map(|()| random_axis(&mut random));
                let angles = [PI - missing, 0.0, 0.0];
                let mut rates = || [(); 3].map(|()| 2.0 * random.f64() - 1.0);
                let (first, second) = (rates(), rates());
                let close = |found: &[f64], expected: &[f64]| {
                    for (found, expected) in found.iter().zip(expected) {
                        assert!((found - expected).abs() < 4e-15, "{missing:e}: {found} {expected} {axes:?}");
                    }
                };
                let [found, expected] = [HalfTurn::of(&rotation(&angles, &axes)), product(&angles, &axes)]
                    .map(|turn| entries(&turn, |x| [x]));
                close(&found, &expected);
                let duals = [0, 1, 2].map(|k| Dual64::new(angles[k], first[k]));
                let [found, expected] = [HalfTurn::of(&rotation(&duals, &axes)), product(&duals, &axes)]
                    .map(|turn| entries(&turn, |x| [x.re, x.eps]));
                close(&found, &expected);
                let tangents = [0, 1, 2].map(|k| Tangent::new(angles[k], first[k]));
                let found = entries(&HalfTurn::of(&rotation(&tangents, &axes)), |x| [x.re, x.eps]);
                close(&found, &expected);
                let hyper = [0, 1, 2].map(|k| HyperDual64::new(angles[k], first[k], second[k], 0.0));
                let [found, expected] = [HalfTurn::of(&rotation(&hyper, &axes)), product(&hyper, &axes)]
                    .map(|turn| entries(&turn, |x| [x.re, x.eps1, x.eps2, x.eps1eps2]));
                close(&found, &expected);
            }
        }
    }

    /// Beyond half a turn psi is that of the shorter way; at it, one of the two with finite derivatives.
    #[test]
    fn half_a_turn_is_a_singular_pose_without_infinite_numbers() {
        let axes = [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0]];
        let psi = |angle: f64| HalfTurn::of(&rotation(&[angle], &axes)).value();
        let (before, after) = (psi(PI - 1e-6), psi(PI + 1e-6));
        assert!((before + after).to_array().iter().all(|sum| sum.abs() < 1e-14), "{before:?} {after:?}");
        let duals = [Dual64::new(PI, 0.3), Dual64::new(0.0, 0.7)];
        let turn = HalfTurn::of(&rotation(&duals, &axes));
        let [psi, along] = [turn.value(), turn.slope(Vec3::constant(axes[0]))].map(Vec3::to_array);
        assert!((psi.map(|x| x.re * x.re).iter().sum::<f64>() - 4.0).abs() < 1e-14);
        assert!(along.iter().all(|x| x.re.abs() < 1e-15), "no turn about the axis changes psi: {along:?}");
        assert!(psi.iter().chain(&along).all(|x| x.eps.is_finite()));
    }
}
