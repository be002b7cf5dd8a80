//! Jacobians by central differences, for comparison with exact ones.

use crate::extremal::hamiltonian::equations::Outputs;
use crate::extremal::{BoundaryValueProblem, ControlLaw, HamiltonianTerms};
use crate::options::JacobianRoute;
use costate::EvalError;

/// An extremal whose Jacobian has several routes; it owns buffers for differences of its right-hand side.
pub(crate) trait Differenced: BoundaryValueProblem {
    fn differences(&mut self) -> &mut Differences;

    /// g(z) and its Jacobian, with the blocks y'F_xx if `hessian` is true.
    fn linearise_with(
        &mut self,
        hessian: bool,
        z: &[f64],
        law: ControlLaw<'_>,
        outputs: Outputs<'_, f64>,
    ) -> Result<HamiltonianTerms, EvalError>;

    /// g(z) and its Jacobian by this route.
    fn linearise_by(
        &mut self,
        route: JacobianRoute,
        z: &[f64],
        law: ControlLaw<'_>,
        Outputs { g, jacobian }: Outputs<'_, f64>,
    ) -> Result<HamiltonianTerms, EvalError> {
        if route == JacobianRoute::Differences {
            self.by_differences(z, law, jacobian)?;
            return self.evaluate(z, law, g);
        }
        self.linearise_with(route == JacobianRoute::Exact, z, law, Outputs { g, jacobian })
    }

    /// The Jacobian by central differences of the right-hand side.
    fn by_differences(
        &mut self,
        z: &[f64],
        law: ControlLaw<'_>,
        jacobian: &mut [f64],
    ) -> Result<(), EvalError> {
        let mut differences = std::mem::take(self.differences());
        let outcome = differences.jacobian(z, jacobian, |z, g| self.evaluate(z, law, g).map(|_| ()));
        *self.differences() = differences;
        outcome
    }
}

/// Buffers for a function from m to m numbers.
#[derive(Clone, Debug, Default)]
pub(crate) struct Differences {
    point: Vec<f64>,
    beside: [Vec<f64>; 2],
}

impl Differences {
    pub fn new(m: usize) -> Self {
        Self { point: vec![0.0; m], beside: [vec![0.0; m], vec![0.0; m]] }
    }

    /// `dg_i/dz_j = (g_i(z + h e_j) - g_i(z - h e_j)) / 2h` with `h = epsilon^(1/3) max(|z_j|, 1)`, m x m.
    ///
    /// # Errors
    /// The first error of `rate`.
    pub fn jacobian(
        &mut self,
        z: &[f64],
        jacobian: &mut [f64],
        mut rate: impl FnMut(&[f64], &mut [f64]) -> Result<(), EvalError>,
    ) -> Result<(), EvalError> {
        let m = z.len();
        self.point.copy_from_slice(z);
        for j in 0..m {
            let step = f64::EPSILON.cbrt() * z[j].abs().max(1.0);
            for (g, sign) in self.beside.iter_mut().zip([1.0, -1.0]) {
                self.point[j] = z[j] + sign * step;
                rate(&self.point, g)?;
            }
            self.point[j] = z[j];
            for i in 0..m {
                jacobian[i * m + j] = (self.beside[0][i] - self.beside[1][i]) / (2.0 * step);
            }
        }
        Ok(())
    }
}
