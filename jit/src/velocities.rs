//! Models in (q, v) for steps that need this form.

use crate::error::JitError;
use crate::fours::Quantities;
use crate::model::{JitLanesModel, JitModel};
use costate::EvalError;
use costate::codegen::{CodegenError, Coordinates};
use costate::dynamics::{Contraction, Dynamics, Linearisation, Structure};
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate::step::VelocityForm;

/// A [`JitModel`] in (q, v), with f = (v, a), for [steps](costate::step) that need this form.
///
/// ```
/// use costate::robot::Robot;
/// use costate::step::{SemiImplicitEuler, Step};
/// use costate_jit::JitVelocityModel;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut step = SemiImplicitEuler::new(JitVelocityModel::new(&robot)?);
/// let next = step.evaluate(&[0.3, -0.8, 1.0, 0.5], &[0.2, 0.0], 0.01)?;
/// assert_eq!(next[0], 0.3 + 0.01 * next[2]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// A model in (q, p) does not have it:
///
/// ```compile_fail,E0277
/// # use costate::{codegen::Coordinates, robot::Robot, step::SemiImplicitEuler};
/// # let robot = Robot::from_file("robots/two_link.toml").unwrap();
/// let model = costate_jit::JitModel::new(&robot, Coordinates::Hamiltonian).unwrap();
/// SemiImplicitEuler::new(model);
/// ```
#[derive(Clone, Debug)]
pub struct JitVelocityModel<M = JitModel>(M);

impl JitVelocityModel {
    /// Records and compiles f, f_x and y'f_xx in (q, v).
    ///
    /// # Errors
    /// As [`JitModel::new`].
    pub fn new(robot: &Robot) -> Result<Self, CodegenError> {
        JitModel::new(robot, Coordinates::Lagrangian).map(Self)
    }
}

impl JitVelocityModel<JitLanesModel> {
    /// The same for four states at once.
    ///
    /// # Errors
    /// As [`JitModel::over_lanes`].
    pub fn over_lanes(robot: &Robot) -> Result<Result<Self, JitError>, CodegenError> {
        Ok(JitModel::over_lanes(robot, Coordinates::Lagrangian)?.map(Self))
    }
}

impl<S: Scalar, Q: Quantities<S>> VelocityForm<S> for JitVelocityModel<JitModel<S, Q>> {}

impl<S: Scalar, Q: Quantities<S>> Dynamics<S> for JitVelocityModel<JitModel<S, Q>> {
    type Error = EvalError;

    fn states(&self) -> usize {
        self.0.states()
    }

    fn controls(&self) -> usize {
        self.0.controls()
    }

    fn structure(&self) -> Structure {
        self.0.structure()
    }

    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<&[S], EvalError> {
        self.0.evaluate(x, u)
    }

    fn linearise(&mut self, x: &[S], u: &[S]) -> Result<Linearisation<'_, S>, EvalError> {
        self.0.linearise(x, u)
    }

    fn contract(&mut self, x: &[S], u: &[S], y: &[S]) -> Result<Contraction<'_, S>, EvalError> {
        self.0.contract(x, u, y)
    }
}
