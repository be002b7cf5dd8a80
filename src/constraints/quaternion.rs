//! The orientation rows: twice the vector part of the quaternion of a rotation.

use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// The quaternion (eps, eta) of a rotation R, eta > 0.
///
/// With w the axis of a joint nearer to the second frame than all others, or the only one,
///
/// ```text
/// eps_,s = 1/2 (eta w_s + w_s x eps)      eta_,s = -1/2 eps . w_s      psi = 2 eps
/// (nu . psi)_,st = nu . ( eta_,s w_t + eta w_s x w_t + (w_s x w_t) x eps + w_t x eps_,s )
/// ```
///
/// for s not beyond t: three independent rows for every angle below pi, and gradients, so that constraints
/// made of them are holonomic.
#[derive(Clone, Copy, Debug)]
pub(super) struct HalfTurn<S> {
    eps: Vec3<S>,
    eta: S,
}

impl<S: Scalar> HalfTurn<S> {
    /// From a rotation by rows: `eta = 1/2 sqrt(1 + tr R)`, `eps = vee(R - R') / (4 eta)`.
    pub fn of(rotation: &[Vec3<S>; 3]) -> Self {
        let [x, y, z] = rotation;
        let twice = (x.x + y.y + z.z).plus(1.0).sqrt();
        let vee = Vec3::new(z.y - y.z, x.z - z.x, y.x - x.y);
        Self { eps: vee.scaled(twice.recip().times(0.5)), eta: twice.times(0.5) }
    }

    /// `psi = 2 eps`.
    pub fn value(&self) -> Vec3<S> {
        self.eps.times(2.0)
    }

    /// `psi_,s = eta w + w x eps`.
    pub fn slope(&self, w: Vec3<S>) -> Vec3<S> {
        w.scaled(self.eta) + w.cross(self.eps)
    }

    /// `(nu . psi)_,st`, s the inner one.
    pub fn curvature(&self, nu: Vec3<S>, inner: Vec3<S>, outer: Vec3<S>) -> S {
        let turned = inner.cross(outer);
        let of_outer = outer.scaled(self.eps.dot(inner).times(-0.5)) + self.slope(turned);
        nu.dot(of_outer + outer.cross(self.slope(inner).times(0.5)))
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
    use num_dual::HyperDual64;

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
                let found = plain.curvature(Vec3::constant(nu), seen(s), seen(t));
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
}
