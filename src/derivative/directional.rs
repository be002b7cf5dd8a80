//! Derivative along one direction, by one dual number.

use super::function::{DerivativeError, Function, check_length};
use num_dual::Dual64;

/// Computes `f(x)` and `f_x d`; no call allocates but what the function itself does.
pub struct Directional<F: Function> {
    function: F,
    workspace: F::Workspace<Dual64>,
    x: Vec<Dual64>,
    y: Vec<Dual64>,
    value: Vec<f64>,
    derivative: Vec<f64>,
}

/// Value and derivative along one direction; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct AlongDirection<'a> {
    /// `f(x)`, m.
    pub value: &'a [f64],
    /// `sum_j d_j df/dx_j`, m.
    pub derivative: &'a [f64],
}

impl<F: Function> Directional<F> {
    /// Builds the buffers.
    pub fn new(function: F) -> Self {
        let (n, m) = (function.inputs(), function.outputs());
        Self {
            workspace: function.workspace(),
            x: vec![Dual64::from_re(0.0); n],
            y: vec![Dual64::from_re(0.0); m],
            value: vec![0.0; m],
            derivative: vec![0.0; m],
            function,
        }
    }

    /// The function, to change its parameters (not its sizes).
    pub fn function_mut(&mut self) -> &mut F {
        &mut self.function
    }

    /// `f(x)` (m) and `sum_j d_j df/dx_j` (m) at x (n) along d (n).
    ///
    /// # Errors
    /// A wrong length, or the function's own error.
    pub fn evaluate(
        &mut self,
        x: &[f64],
        d: &[f64],
    ) -> Result<AlongDirection<'_>, DerivativeError<F::Error>> {
        check_length("x", x, self.x.len())?;
        check_length("d", d, self.x.len())?;
        for ((dual, &x), &d) in self.x.iter_mut().zip(x).zip(d) {
            *dual = Dual64::new(x, d);
        }
        self.function.evaluate(&mut self.workspace, &self.x, &mut self.y)?;
        for (k, y) in self.y.iter().enumerate() {
            self.value[k] = y.re;
            self.derivative[k] = y.eps;
        }
        Ok(AlongDirection { value: &self.value, derivative: &self.derivative })
    }
}
