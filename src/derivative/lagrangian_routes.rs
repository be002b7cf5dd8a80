//! Derivatives of forward dynamics by hand beside automatic ones.

use super::bounds::DerivativeBounds;
use super::function::DerivativeError;
use super::report::Figure;
use super::{ForwardDynamics, Hessian, Jacobian, NestedHessian};
use crate::error::EvalError;
use crate::lagrangian::SecondOrder;
use crate::robot::Robot;

/// a(q, v, u) by every route.
pub(super) struct LagrangianRoutes {
    analytic: SecondOrder<f64>,
    dual: Jacobian<ForwardDynamics>,
    nested: NestedHessian<ForwardDynamics>,
    hyperdual: Hessian<ForwardDynamics>,
}

impl LagrangianRoutes {
    /// Builds every workspace.
    pub fn new(robot: &Robot) -> Self {
        let function = || ForwardDynamics::new(robot);
        Self {
            analytic: SecondOrder::new(robot),
            dual: Jacobian::new(function()),
            nested: NestedHessian::new(function()),
            hyperdual: Hessian::new(function()),
        }
    }

    /// The reference: hyper-dual numbers through a.
    pub fn evaluate(&mut self, [q, v, u, y]: [&[f64]; 4]) -> Result<(), DerivativeError<EvalError>> {
        self.hyperdual.contracted(&[q, v, u].concat(), y)?;
        Ok(())
    }

    /// Compares a_z and y'a_zz, z = (q, v, u), with the reference evaluated last; appends to `figures`.
    pub fn compare(
        &mut self,
        [q, v, u, y]: [&[f64]; 4],
        bounds: &DerivativeBounds,
        figures: &mut Vec<Figure>,
    ) -> Result<(), DerivativeError<EvalError>> {
        let z = [q, v, u].concat();
        let (expected, contracted) = (self.hyperdual.last().jacobian(), self.hyperdual.last_contracted());
        let second = self.analytic.contracted_hessian(q, v, u, y)?;
        let dual = self.dual.evaluate(&z)?;
        let nested = self.nested.contracted(&z, y)?;
        let (by_hand, hessian) = (second.linearisation().matrix(), second.to_matrix());
        let first = "a_z, z = (q, v, u)";
        let off = |i: usize, j: usize| by_hand.row(i)[j] - expected[(i, j)];
        figures.push(Figure::judge(first, "analytic", off, &bounds.a_z));
        let off = |i, j| dual.jacobian[(i, j)] - expected[(i, j)];
        figures.push(Figure::judge(first, "dual", off, &bounds.a_z));
        let off = |i, j| hessian[(i, j)] - contracted[(i, j)];
        figures.push(Figure::judge("y'a_zz", "analytic", off, &bounds.y_a_zz));
        let off = |i, j| nested[(i, j)] - contracted[(i, j)];
        figures.push(Figure::judge("y'a_zz", "dual", off, &bounds.y_a_zz));
        Ok(())
    }
}
