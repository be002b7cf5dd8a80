//! The cost of a model with its derivatives, in parts of the reference cost.

use super::problem::DirectDynamics;
use crate::extremal::dynamics::response::eval_error;
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};

impl<D, C> DirectDynamics<D, C> {
    /// $c_t$.
    pub(super) fn time_weight(&self) -> f64 {
        self.problem.cost.time / self.reference
    }
}

impl<D: Dynamics<f64>, C: Cost<f64>> DirectDynamics<D, C> {
    /// $\tfrac12 u^\top R u + l$.
    pub(super) fn running(&mut self, x: &[f64], u: &[f64]) -> Result<f64, EvalError> {
        let effort: f64 = self.problem.cost.effort.iter().zip(u).map(|(r, u)| 0.5 * r * u * u).sum();
        let l = match &mut self.cost {
            Some(cost) => {
                let of = cost.controls();
                cost.evaluate(x, &u[..of]).map_err(eval_error)?
            }
            None => 0.0,
        };
        Ok((effort + l) / self.reference)
    }

    /// The same with its gradient and Hessian in (x, u).
    pub(super) fn running_derivatives(
        &mut self,
        x: &[f64],
        u: &[f64],
        first: &mut [f64],
        second: &mut [f64],
    ) -> Result<f64, EvalError> {
        let (n, size) = (x.len(), first.len());
        first.fill(0.0);
        second.fill(0.0);
        let mut value = 0.0;
        for (i, (r, u)) in self.problem.cost.effort.iter().zip(u).enumerate() {
            value += 0.5 * r * u * u;
            first[n + i] = r * u;
            second[(n + i) * size + n + i] = *r;
        }
        if let Some(cost) = &mut self.cost {
            let of = cost.controls();
            let all = cost.hessian(x, &u[..of]).map_err(eval_error)?;
            value += all.gradient.value;
            let gradient = all.gradient.x.iter().chain(all.gradient.u);
            first.iter_mut().zip(gradient).for_each(|(sum, part)| *sum += part);
            for (i, row) in all.xx.iter_rows().enumerate() {
                row.iter().enumerate().for_each(|(j, part)| second[i * size + j] += part);
            }
            if of > 0 {
                for (i, row) in all.uu.iter_rows().enumerate() {
                    row.iter().enumerate().for_each(|(j, part)| second[(n + i) * size + n + j] += part);
                }
            }
            for (i, row) in all.ux.iter().flat_map(|ux| ux.iter_rows()).enumerate() {
                for (j, part) in row.iter().enumerate() {
                    second[(n + i) * size + j] += part;
                    second[j * size + n + i] += part;
                }
            }
        }
        first.iter_mut().chain(&mut *second).for_each(|entry| *entry /= self.reference);
        Ok(value / self.reference)
    }
}
