//! How the controls of a model respond to state and costate.

use costate::EvalError;
use costate::dynamics::Contraction;
use costate::matrix::add_scaled;
use std::error::Error;

/// How one w_i depends on x and y.
#[derive(Clone, Debug)]
pub(super) struct Response {
    pub in_x: Vec<f64>,
    pub in_y: Vec<f64>,
}

impl Response {
    pub fn new(states: usize) -> Self {
        Self { in_x: vec![0.0; states], in_y: vec![0.0; states] }
    }

    pub fn set(&mut self, all: &Contraction<'_, f64>, control: usize) {
        self.in_x.fill(0.0);
        if let Some(ux) = all.ux {
            self.in_x.iter_mut().zip(ux.row(control)).for_each(|(to, &from)| *to = from);
        }
        for (to, row) in self.in_y.iter_mut().zip(all.first.f_u.iter_rows()) {
            *to = row[control];
        }
    }

    /// Adds `slope (in_y, -in_x)' (in_x, in_y)`, row-major.
    pub fn add(&self, slope: f64, jacobian: &mut [f64]) {
        let states = self.in_x.len();
        let factors = self.in_y.iter().copied().chain(self.in_x.iter().map(|&in_x| -in_x));
        for (row, factor) in jacobian.chunks_exact_mut(2 * states).zip(factors) {
            let (in_x, in_y) = row.split_at_mut(states);
            add_scaled(in_x, slope * factor, &self.in_x);
            add_scaled(in_y, slope * factor, &self.in_y);
        }
    }
}

/// Second derivatives in u, relative to those in x and u, that are rounding errors.
const ROUNDING: f64 = 1e-12;

pub(super) fn is_affine(all: &Contraction<'_, f64>) -> bool {
    let Some(uu) = all.uu else { return true };
    let largest =
        |rows: &mut dyn Iterator<Item = &f64>| rows.fold(0.0_f64, |most, entry| most.max(entry.abs()));
    let scale = largest(&mut all.first.f_u.iter_rows().flatten()).max(1.0);
    largest(&mut uu.iter_rows().flatten()) <= ROUNDING * scale
}

/// The error of a model, as it is where it is one of a robot.
pub(crate) fn eval_error<E: Error + 'static>(error: E) -> EvalError {
    let any: &(dyn Error + 'static) = &error;
    any.downcast_ref::<EvalError>().cloned().unwrap_or_else(|| EvalError::Model { reason: error.to_string() })
}
