//! Running costs of tools.

use super::functions::{PathFunction, TaskFunctions};
use super::orient::orient;
use crate::problem::task_error::TaskError;
use crate::problem::tools::ToolOrientation;
use costate::EvalError;

/// `l(q, v) = 1/2 sum_k weight_k (g_k - g_k0)^2` with its derivatives; no call allocates.
#[derive(Clone, Debug)]
pub(crate) struct ToolCosts {
    functions: TaskFunctions,
    weights: Vec<f64>,
    g: Vec<f64>,
    /// `weight_k (g_k - g_k0)`.
    slopes: Vec<f64>,
    jacobian: Vec<f64>,
    /// l, in cost per second.
    pub value: f64,
    /// l_x, x = (q, v): 2n.
    pub gradient: Vec<f64>,
    /// l_xx, 2n x 2n.
    pub hessian: Vec<f64>,
}

impl ToolCosts {
    /// The costs of these functions and weights, those of [`TaskRows`](super::build::TaskRows), of a robot
    /// with n coordinates.
    pub fn new(functions: TaskFunctions, weights: Vec<f64>, n: usize) -> Self {
        let count = functions.rows();
        Self {
            functions,
            weights,
            g: vec![0.0; count],
            slopes: vec![0.0; count],
            jacobian: vec![0.0; 2 * n * count],
            value: 0.0,
            gradient: vec![0.0; 2 * n],
            hessian: vec![0.0; 4 * n * n],
        }
    }

    /// Changes the value at which a row costs nothing.
    pub fn set_value(&mut self, row: usize, value: f64) {
        self.functions.set_value(row, value);
    }

    /// Changes the orientation at which a tool costs nothing, whose first row this is.
    ///
    /// # Errors
    /// As [`orient`].
    pub fn orient(&mut self, row: usize, to: &ToolOrientation) -> Result<(), TaskError> {
        orient(&mut self.functions, row, to)
    }

    /// Whether there are any.
    pub fn any(&self) -> bool {
        !self.functions.is_empty()
    }

    /// l, to [`value`](Self::value).
    ///
    /// # Errors
    /// As [`PathFunction::values`].
    pub fn evaluate(&mut self, q: &[f64], v: &[f64]) -> Result<f64, EvalError> {
        self.functions.values(q, v, &mut self.g)?;
        self.value = 0.0;
        for (k, row) in self.functions.bounds().iter().enumerate() {
            let off = self.g[k] - row.lower;
            self.slopes[k] = self.weights[k] * off;
            self.value += 0.5 * self.slopes[k] * off;
        }
        Ok(self.value)
    }

    /// l, l_x and l_xx, to the fields.
    ///
    /// # Errors
    /// As [`PathFunction::contract`].
    pub fn contract(&mut self, q: &[f64], v: &[f64]) -> Result<(), EvalError> {
        self.evaluate(q, v)?;
        let Self { functions, weights, g, slopes, jacobian, gradient, hessian, .. } = self;
        hessian.fill(0.0);
        gradient.fill(0.0);
        functions.contract(q, v, slopes, g, jacobian, hessian)?;
        let width = gradient.len();
        for (k, row) in jacobian.chunks_exact(width).enumerate() {
            for i in 0..width {
                gradient[i] += slopes[k] * row[i];
                let factor = weights[k] * row[i];
                if factor != 0.0 {
                    for (entry, other) in hessian[width * i..].iter_mut().zip(row) {
                        *entry += factor * other;
                    }
                }
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::tools::{Tool, ToolCost, ToolPose};
    use crate::problem::{Problem, Task};
    use crate::task::build::TaskRows;
    use costate::robot::Robot;
    use nalgebra::Rotation3;

    #[test]
    fn costs_have_the_derivatives_by_differences() {
        let arm = Robot::from_file("../robots/ur5.urdf").unwrap();
        let tool = Tool::new("tool0").with_offset([0.1, 0.0, 0.2]);
        let turn = Rotation3::from_euler_angles(0.3, -0.8, 1.0);
        let pose = ToolPose::of(tool.clone()).with_position([0.3, f64::INFINITY, 0.5]).with_rotation(turn);
        let axis = ToolPose::of(tool).with_axis([1.0, 0.0, 0.0], [0.0, 1.0, 1.0]);
        let task = Task::default()
            .with_tool_cost(ToolCost::new(pose, 3.0, 2.0))
            .with_tool_cost(ToolCost::new(axis, 0.0, 5.0));
        let problem = Problem::rest_to_rest(arm, &[0.0; 6], &[1.0; 6], 1.0).with_task(task);
        let rows = TaskRows::new(&problem).unwrap();
        let mut costs = ToolCosts::new(rows.costs, rows.weights, 6);
        assert!(costs.any());
        let (q, v) = ([0.3, -1.2, 0.8, 0.1, 0.5, 0.2], [0.0; 6]);
        costs.contract(&q, &v).unwrap();
        let (gradient, hessian) = (costs.gradient.clone(), costs.hessian.clone());
        const STEP: f64 = 1e-5;
        for j in 0..6 {
            let mut moved = |step: f64| {
                let mut q = q;
                q[j] += step;
                costs.contract(&q, &v).unwrap();
                (costs.value, costs.gradient.clone())
            };
            let ((up, above), (down, below)) = (moved(STEP), moved(-STEP));
            assert!((gradient[j] - (up - down) / (2.0 * STEP)).abs() < 1e-8);
            for i in 0..12 {
                let slope = (above[i] - below[i]) / (2.0 * STEP);
                assert!(
                    (hessian[12 * i + j] - slope).abs() < 1e-7,
                    "{i} {j}: {} {slope}",
                    hessian[12 * i + j]
                );
            }
        }
    }
}
