//! The exponential of SO(3) and SE(3), its Jacobian and the inverse of this.
//!
//! With theta the rotation vector, `[.]` its cross-product matrix and rho the displacement,
//!
//! $$ \exp(\rho, \theta) = (V \rho, \exp \theta), \qquad V = 1 + b [\theta] + c [\theta]^2, \qquad
//! J\_r = 1 - b [\theta] + c [\theta]^2, \qquad b = \frac{1 - \cos\theta}{\theta^2}, \qquad
//! c = \frac{\theta - \sin\theta}{\theta^3} $$
//!
//! (T. D. Barfoot, State Estimation for Robotics, Cambridge University Press, 2017, section 7.1). All
//! functions are smooth in the squared angle; below one radian they are power series, so that dual numbers
//! are right at zero too.

use crate::kinematics::{curvature, rotation_vector};
use crate::scalar::Scalar;
use crate::spatial::{Quaternion, Vec3};

/// A 3 x 3 matrix by rows.
pub(super) type Square<S> = [[S; 3]; 3];

/// Terms of a power series in the square of an angle of up to one radian.
const TERMS: i32 = 10;

/// `sum_k (-1)^k weight(k) square^k` where the square is below one, else the closed form.
fn smooth<S: Scalar>(square: S, weight: impl Fn(i32) -> f64, closed: S) -> S {
    let term = |k: i32| if k % 2 == 0 { weight(k) } else { -weight(k) };
    let series = (0..TERMS).rev().fold(S::zero(), |sum, k| (sum * square).plus(term(k)));
    S::select(square.less(S::one()), series, closed)
}

/// `n!`.
fn factorial(n: i32) -> f64 {
    (1..=n).map(f64::from).product()
}

/// Functions of the angle.
struct Angle<S> {
    square: S,
    angle: S,
    sin_half: S,
    cos_half: S,
}

impl<S: Scalar> Angle<S> {
    fn of(theta: Vec3<S>) -> Self {
        let square = theta.dot(theta);
        // Closed forms are not used below one, and must be finite there.
        let angle = S::select(square.less(S::one()), S::one(), square).sqrt();
        let (sin_half, cos_half) = angle.times(0.5).sin_cos();
        Self { square, angle, sin_half, cos_half }
    }

    fn sin(&self) -> S {
        (self.sin_half * self.cos_half).times(2.0)
    }

    /// `1 - cos`.
    fn rise(&self) -> S {
        (self.sin_half * self.sin_half).times(2.0)
    }

    /// `b`.
    fn b(&self) -> S {
        let closed = self.rise() / (self.angle * self.angle);
        smooth(self.square, |k| 1.0 / factorial(2 * k + 2), closed)
    }

    /// `c`.
    fn c(&self) -> S {
        let cube = self.angle * self.angle * self.angle;
        smooth(self.square, |k| 1.0 / factorial(2 * k + 3), (self.angle - self.sin()) / cube)
    }

    /// `(theta^2 / 2 + cos theta - 1) / theta^4`.
    fn d(&self) -> S {
        let square = self.angle * self.angle;
        let closed = (square.times(0.5) - self.rise()) / (square * square);
        smooth(self.square, |k| 1.0 / factorial(2 * k + 4), closed)
    }

    /// `(2 theta - 3 sin theta + theta cos theta) / (2 theta^5)`.
    fn e(&self) -> S {
        let square = self.angle * self.angle;
        let top = self.angle.times(3.0) - self.sin().times(3.0) - self.angle * self.rise();
        let closed = top / (square * square * self.angle).times(2.0);
        smooth(self.square, |k| f64::from(k + 1) / factorial(2 * k + 5), closed)
    }
}

/// The quaternion of a rotation vector.
pub(super) fn quaternion<S: Scalar>(theta: Vec3<S>) -> Quaternion<S> {
    let of = Angle::of(theta);
    let ratio = smooth(of.square.times(0.25), |k| 0.5 / factorial(2 * k + 1), of.sin_half / of.angle);
    let cos = smooth(of.square.times(0.25), |k| 1.0 / factorial(2 * k), of.cos_half);
    // The series are used below two radians; below one the closed forms are those of another angle.
    Quaternion { vector: theta.scaled(ratio), scalar: cos }
}

/// `V rho`.
pub(super) fn displacement<S: Scalar>(theta: Vec3<S>, rho: Vec3<S>) -> Vec3<S> {
    let of = Angle::of(theta);
    let turned = theta.cross(rho);
    rho + turned.scaled(of.b()) + theta.cross(turned).scaled(of.c())
}

/// `V^-1 r`.
pub(super) fn displacement_back<S: Scalar>(theta: Vec3<S>, r: Vec3<S>) -> Vec3<S> {
    let turned = theta.cross(r);
    r - turned.times(0.5) + theta.cross(turned).scaled(curvature(theta.dot(theta)).0)
}

/// The rotation vector of a quaternion, at most a half turn.
pub(super) fn logarithm<S: Scalar>(q: Quaternion<S>) -> Vec3<S> {
    let negative = q.scalar.less(S::zero());
    let side = |entry: S| S::select(negative, -entry, entry);
    rotation_vector(side(q.scalar), Vec3::from(q.vector.to_array().map(side)))
}

/// `[a]`.
pub(super) fn cross_matrix<S: Scalar>(a: Vec3<S>) -> Square<S> {
    let zero = S::zero();
    [[zero, -a.z, a.y], [a.z, zero, -a.x], [-a.y, a.x, zero]]
}

pub(super) fn product<S: Scalar>(a: &Square<S>, b: &Square<S>) -> Square<S> {
    let entry = |i: usize, j: usize| a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| entry(i, j)))
}

pub(super) fn sum<S: Scalar>(terms: &[(S, Square<S>)]) -> Square<S> {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| terms.iter().fold(S::zero(), |all, (f, of)| all + *f * of[i][j])))
}

pub(super) fn identity<S: Scalar>() -> Square<S> {
    let (one, zero) = (S::one(), S::zero());
    [[one, zero, zero], [zero, one, zero], [zero, zero, one]]
}

/// The diagonal block `J_r(theta)` of the right Jacobian, and the block of (linear, angular) for SE(3).
pub(super) fn right_jacobian<S: Scalar>(rho: Vec3<S>, theta: Vec3<S>) -> [Square<S>; 2] {
    let of = Angle::of(theta);
    let (t, p) = (cross_matrix(-theta), cross_matrix(-rho));
    let tt = product(&t, &t);
    let diagonal = sum(&[(S::one(), identity()), (of.b(), t), (of.c(), tt)]);
    let [tp, pt] = [product(&t, &p), product(&p, &t)];
    let tpt = product(&tp, &t);
    let (c, d, e) = (of.c(), of.d(), of.e());
    let corner = sum(&[
        (S::from_f64(0.5), p),
        (c, tp),
        (c, pt),
        (c, tpt),
        (d, product(&tt, &p)),
        (d, product(&p, &tt)),
        (d.times(-3.0), tpt),
        (e, product(&tpt, &t)),
        (e, product(&t, &tpt)),
    ]);
    [diagonal, corner]
}

/// The same blocks of its inverse.
pub(super) fn inverse_right_jacobian<S: Scalar>(rho: Vec3<S>, theta: Vec3<S>) -> [Square<S>; 2] {
    let t = cross_matrix(theta);
    let (curve, _) = curvature(theta.dot(theta));
    let inverse = sum(&[(S::one(), identity()), (S::from_f64(0.5), t), (curve, product(&t, &t))]);
    let [_, corner] = right_jacobian(rho, theta);
    let back = product(&product(&inverse, &corner), &inverse);
    [inverse, sum(&[(S::from_f64(-1.0), back)])]
}
