//! Comparison of analytic and automatic derivatives of forward dynamics.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not by
// everyone who builds the library.

use super::function::DerivativeError;
use super::report::{Figure, largest, relative_difference};
use super::{ForwardDynamics, Hessian, Jacobian, NestedHessian};
use crate::error::EvalError;
use crate::lagrangian::LagrangianSecondOrder;
use crate::robot::Robot;

/// a(q, v, u) by every route.
#[derive(Debug)]
pub(super) struct LagrangianRoutes {
    analytic: LagrangianSecondOrder<f64>,
    dual: Jacobian<ForwardDynamics>,
    nested: NestedHessian<ForwardDynamics>,
    hyperdual: Hessian<ForwardDynamics>,
}

impl LagrangianRoutes {
    /// Builds every workspace.
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        let function = || ForwardDynamics::new(robot);
        Self {
            analytic: LagrangianSecondOrder::new(robot),
            dual: Jacobian::new(function()),
            nested: NestedHessian::new(function()),
            hyperdual: Hessian::new(function()),
        }
    }

    /// Compares a_z and y'a_zz, z = (q, v, u), with hyper-dual numbers; appends the differences to `figures`.
    #[inline]
    pub fn compare(
        &mut self,
        [q, v, u, y]: [&[f64]; 4],
        figures: &mut Vec<Figure>,
    ) -> Result<(), DerivativeError<EvalError>> {
        let z = [q, v, u].concat();
        self.hyperdual.contract(&z, y)?;
        let (expected, contracted) = (self.hyperdual.last().jacobian(), self.hyperdual.last_contraction());
        let second = self.analytic.contract_forward_dynamics(q, v, u, y)?;
        let natural = 1e-3 * largest(y) * largest(expected.as_slice());
        let dual = self.dual.linearise(&z)?;
        let nested = self.nested.contract(&z, y)?;
        let off_first = |found| relative_difference(found, expected.view(), 0.0);
        let off_second = |found| relative_difference(found, contracted.view(), natural);
        // The analytic y'a_zz rounds M differently from (hyper-)dual numbers, and M^-1 enters three times.
        for (quantity, route, value, sensitivity) in [
            ("a_z, z = (q, v, u)", "analytic", off_first(second.forward_dynamics().matrix()), 1.0),
            ("a_z, z = (q, v, u)", "dual", off_first(dual.jacobian.view()), 1.0),
            ("y'a_zz", "analytic", off_second(second.to_matrix().view()), 10.0),
            ("y'a_zz", "dual", off_second(nested.view()), 1.0),
        ] {
            figures.push(Figure { quantity, route, value, sensitivity });
        }
        Ok(())
    }
}
