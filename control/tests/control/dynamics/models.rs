//! Models that are not robots, and a running cost.

use costate::derivative::Function;
use costate::dynamics::Automatic;
use costate::scalar::Scalar;
use std::convert::Infallible;

/// Declares a function of (x, u) as a model.
macro_rules! model {
    ($name:ident, $states:expr, $controls:expr, |$z:ident, $f:ident| $body:block) => {
        #[derive(Clone, Debug)]
        pub struct $name;

        impl Function for $name {
            type Workspace<S: Scalar> = ();
            type Error = Infallible;
            fn inputs(&self) -> usize {
                $states + $controls
            }
            fn outputs(&self) -> usize {
                $states
            }
            fn workspace<S: Scalar>(&self) {}
            fn evaluate<S: Scalar>(&self, _: &mut (), $z: &[S], $f: &mut [S]) -> Result<(), Infallible> {
                $body
                Ok(())
            }
        }

        impl $name {
            pub fn automatic() -> Automatic<Self> {
                Automatic::new(Self)
            }
        }
    };
}

// x = (position, rate), u = acceleration.
model!(Cart, 2, 1, |z, f| {
    (f[0], f[1]) = (z[1], z[2]);
});

// x = (x, y, heading), u = (speed, turning rate).
model!(Unicycle, 3, 2, |z, f| {
    let (sin, cos) = z[2].sin_cos();
    (f[0], f[1], f[2]) = (z[3] * cos, z[3] * sin, z[4]);
});

// x = (x, y, angle, rates), u = thrusts above those of hovering; mass 1 kg, inertia 0.1 kg m^2, arm 0.3 m.
model!(Quadrotor, 6, 2, |z, f| {
    let (sin, cos) = z[2].sin_cos();
    let thrust = (z[6] + z[7]).plus(9.81);
    (f[0], f[1], f[2]) = (z[3], z[4], z[5]);
    f[3] = S::zero() - thrust * sin;
    f[4] = (thrust * cos).plus(-9.81);
    f[5] = (z[7] - z[6]).times(3.0);
});

// Not affine in u.
model!(Square, 1, 1, |z, f| {
    f[0] = z[1] * z[1];
});

/// l(x) = 3 (1 - cos of the angle) + x y.
#[derive(Clone, Debug)]
pub struct Tilt;

impl Function for Tilt {
    type Workspace<S: Scalar> = ();
    type Error = Infallible;
    fn inputs(&self) -> usize {
        6
    }
    fn outputs(&self) -> usize {
        1
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, _: &mut (), x: &[S], l: &mut [S]) -> Result<(), Infallible> {
        let (_, cos) = x[2].sin_cos();
        l[0] = S::from_f64(3.0) - cos.times(3.0) + x[0] * x[1];
        Ok(())
    }
}
