//! A quadratic cost of the distance from a target.

use super::{Cost, CostGradient, CostHessian};
use crate::error::{EvalError, check_length};
use crate::matrix::{Matrix, filled};
use crate::scalar::Scalar;

/// `1/2 sum_i Q_i (x_i - x*_i)^2 + 1/2 sum_j R_j (u_j - u*_j)^2`, with a weight and a target for each
/// component.
///
/// ```
/// use costate::dynamics::{Cost, QuadraticCost};
/// let mut cost = QuadraticCost::running(&[2.0, 0.1], &[0.5]).about(&[1.0, 0.0], &[0.0]);
/// let second = cost.hessian(&[0.0, 0.0], &[4.0])?;
/// assert_eq!((second.gradient.value, second.gradient.x, second.uu[(0, 0)]), (5.0, &[-2.0, 0.0][..], 0.5));
/// # Ok::<(), costate::EvalError>(())
/// ```
#[derive(Clone, Debug)]
pub struct QuadraticCost<S = f64> {
    weights: [Vec<f64>; 2],
    targets: [Vec<f64>; 2],
    gradient: [Vec<S>; 2],
    hessian: [Matrix<S>; 2],
}

impl<S: Scalar> QuadraticCost<S> {
    /// Weights Q of the states and R of the controls; all targets 0.
    pub fn running(states: &[f64], controls: &[f64]) -> Self {
        let weights = [states, controls];
        let diagonal = |weights: &[f64]| {
            let mut matrix = Matrix::zeros(weights.len(), weights.len());
            weights.iter().enumerate().for_each(|(i, &weight)| matrix[(i, i)] = S::from_f64(weight));
            matrix
        };
        Self {
            weights: weights.map(<[f64]>::to_vec),
            targets: weights.map(|weights| vec![0.0; weights.len()]),
            gradient: weights.map(|weights| filled(S::zero(), weights.len())),
            hessian: weights.map(diagonal),
        }
    }

    /// Weights of the states alone.
    pub fn terminal(states: &[f64]) -> Self {
        Self::running(states, &[])
    }

    /// The same cost about these targets, as long as the weights: `&[]` for the controls of a terminal cost.
    ///
    /// # Panics
    /// If a target is not as long as its weights.
    #[must_use]
    pub fn about(mut self, states: &[f64], controls: &[f64]) -> Self {
        for (target, new) in self.targets.iter_mut().zip([states, controls]) {
            target.copy_from_slice(new);
        }
        self
    }

    /// Returns the value and stores the gradient.
    fn update(&mut self, x: &[S], u: &[S]) -> Result<S, EvalError> {
        check_length("x", x, self.weights[0].len())?;
        check_length("u", u, self.weights[1].len())?;
        let mut twice = S::zero();
        for (k, z) in [x, u].into_iter().enumerate() {
            for (i, &z) in z.iter().enumerate() {
                let off = z.plus(-self.targets[k][i]);
                self.gradient[k][i] = off.times(self.weights[k][i]);
                twice += off * self.gradient[k][i];
            }
        }
        Ok(twice.times(0.5))
    }

    fn gradient_of(&self, value: S) -> CostGradient<'_, S> {
        CostGradient { value, x: &self.gradient[0], u: &self.gradient[1] }
    }
}

impl<S: Scalar> Cost<S> for QuadraticCost<S> {
    type Error = EvalError;

    fn states(&self) -> usize {
        self.weights[0].len()
    }

    fn controls(&self) -> usize {
        self.weights[1].len()
    }

    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<S, EvalError> {
        self.update(x, u)
    }

    fn gradient(&mut self, x: &[S], u: &[S]) -> Result<CostGradient<'_, S>, EvalError> {
        let value = self.update(x, u)?;
        Ok(self.gradient_of(value))
    }

    fn hessian(&mut self, x: &[S], u: &[S]) -> Result<CostHessian<'_, S>, EvalError> {
        let value = self.update(x, u)?;
        let [xx, uu] = self.hessian.each_ref().map(Matrix::view);
        Ok(CostHessian { gradient: self.gradient_of(value), xx, ux: None, uu })
    }
}
