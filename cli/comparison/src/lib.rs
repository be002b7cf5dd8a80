//! What `costate check` and `costate count` compute.
//!
//! Both need the pipeline for a dozen number types. Here it is compiled once, for the command line and for
//! the tests, and release builds optimise it lightly (`[profile.release.package.costate-comparison]`): its
//! speed does not matter.

#![warn(missing_debug_implementations)]

use costate::derivative::{DerivativeError, OperationTable, OtherRoute, StateReport};
use costate::robot::Robot;
use costate::scalar::Constants;
use costate::step::StepError;
use costate::{EvalError, derivative, step};

/// [`derivative::Routes`], compiled here.
#[derive(Debug)]
pub struct Routes(derivative::Routes);

impl Routes {
    /// Builds every workspace.
    #[inline(never)]
    pub fn new(robot: &Robot) -> Self {
        Self(derivative::Routes::new(robot))
    }

    /// [`derivative::Routes::with_tolerance`].
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self(self.0.with_tolerance(tolerance))
    }

    /// [`derivative::Routes::with_route`].
    #[must_use]
    pub fn with_route(self, route: OtherRoute) -> Self {
        Self(self.0.with_route(route))
    }

    /// [`derivative::Routes::compare`].
    ///
    /// # Errors
    /// Those of [`derivative::Routes::compare`].
    #[inline(never)]
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        y: &[f64],
    ) -> Result<StateReport, DerivativeError<EvalError>> {
        self.0.compare(x, u, y)
    }
}

/// [`step::StepRoutes`], compiled here.
#[derive(Debug)]
pub struct StepRoutes(step::StepRoutes);

impl StepRoutes {
    /// Builds every workspace.
    #[inline(never)]
    pub fn new(robot: &Robot) -> Self {
        Self(step::StepRoutes::new(robot))
    }

    /// [`step::StepRoutes::with_tolerance`].
    #[must_use]
    pub fn with_tolerance(self, tolerance: f64) -> Self {
        Self(self.0.with_tolerance(tolerance))
    }

    /// [`step::StepRoutes::compare`].
    ///
    /// # Errors
    /// Those of [`step::StepRoutes::compare`].
    #[inline(never)]
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        h: f64,
        y: &[f64],
        figures: &mut Vec<derivative::Figure>,
    ) -> Result<(), StepError<EvalError>> {
        self.0.compare(x, u, h, y, figures)
    }
}

/// [`OperationTable::new`].
///
/// # Errors
/// Those of [`OperationTable::new`].
#[inline(never)]
pub fn operation_table(
    robot: &Robot,
    constants: Constants,
) -> Result<OperationTable, DerivativeError<EvalError>> {
    OperationTable::new(robot, constants)
}
