//! Robots whose loops leave them one coordinate, by their energies alone.

use costate::derivative::Function;
use costate::scalar::{Scalar, Tangent};
use costate_control::{DynamicsProblem, EndState, FinalTime};
use std::convert::Infallible;

/// What is known of a robot with one coordinate, an angle.
pub(crate) trait Energies: Copy {
    /// M (kg m^2) and V (J): the kinetic energy is `M w^2 / 2`, the potential one V.
    fn energies<S: Scalar>(&self, angle: S) -> [S; 2];
}

/// `M dw/dt = u - M' w^2 / 2 - V'` for x = (angle, w) and the torque u.
#[derive(Clone, Copy)]
pub(crate) struct Reduced<E>(pub E);

impl<E: Energies> Function for Reduced<E> {
    type Workspace<S: Scalar> = ();
    type Error = Infallible;
    fn inputs(&self) -> usize {
        3
    }
    fn outputs(&self) -> usize {
        2
    }
    fn workspace<S: Scalar>(&self) {}
    fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], f: &mut [S]) -> Result<(), Infallible> {
        let [mass, potential] = self.0.energies(Tangent::new(z[0], S::from_f64(1.0)));
        let forces = z[2] - (mass.eps * z[1] * z[1]).times(0.5) - potential.eps;
        (f[0], f[1]) = (z[1], forces / mass.re);
        Ok(())
    }
}

/// From rest to rest at these angles (rad) in a given time (s).
pub(crate) fn between([from, to]: [f64; 2], time: f64) -> DynamicsProblem {
    let [from, to] = [from, to].map(|angle| EndState::fixed(&[angle, 0.0]));
    DynamicsProblem::new(from, to, FinalTime::Fixed(time), 1)
}
