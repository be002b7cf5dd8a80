//! One step of a model as a function for automatic differentiation.

use super::semi_implicit_euler::SemiImplicitEuler;
use super::{RungeKutta, Step, StepError, Tableau};
use crate::derivative::Function;
use crate::dynamics::Dynamics;
use crate::error::{EvalError, LengthError};
use crate::hamiltonian::HamiltonianSecondOrder;
use crate::lagrangian::LagrangianSecondOrder;
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use std::marker::PhantomData;

/// A family of models, one for every scalar.
pub trait ModelFamily {
    /// The error of an evaluation.
    type Error: std::error::Error + 'static;
    /// The model for one scalar.
    type Model<S: Scalar>: Dynamics<S, Error = Self::Error>;

    /// Builds the model for one scalar.
    fn model<S: Scalar>(&self) -> Self::Model<S>;
}

/// A robot in x = (q, p).
#[derive(Clone, Debug)]
pub struct HamiltonianRobot(pub Tree);

/// A robot in x = (q, v).
#[derive(Clone, Debug)]
pub struct LagrangianRobot(pub Tree);

impl From<&Robot> for HamiltonianRobot {
    fn from(robot: &Robot) -> Self {
        Self(Tree::from(robot))
    }
}

impl From<&Robot> for LagrangianRobot {
    fn from(robot: &Robot) -> Self {
        Self(Tree::from(robot))
    }
}

impl ModelFamily for HamiltonianRobot {
    type Error = EvalError;
    type Model<S: Scalar> = HamiltonianSecondOrder<S>;

    fn model<S: Scalar>(&self) -> Self::Model<S> {
        HamiltonianSecondOrder::from_tree(self.0.clone())
    }
}

impl ModelFamily for LagrangianRobot {
    type Error = EvalError;
    type Model<S: Scalar> = LagrangianSecondOrder<S>;

    fn model<S: Scalar>(&self) -> Self::Model<S> {
        LagrangianSecondOrder::from_tree(self.0.clone())
    }
}

/// A family of schemes, one for every scalar: builds a step of the models of a family.
///
/// Every [`Tableau`] is a scheme for every family; [`SemiImplicit`] is one for robots in (q, v).
pub trait Scheme<F: ModelFamily> {
    /// The step for one scalar.
    type Step<S: Scalar>: Step<S, Error = StepError<F::Error>>;

    /// Builds the step for one scalar.
    fn step<S: Scalar>(model: F::Model<S>) -> Self::Step<S>;
}

impl<F: ModelFamily, T: Tableau> Scheme<F> for T {
    type Step<S: Scalar> = RungeKutta<S, F::Model<S>, T>;

    fn step<S: Scalar>(model: F::Model<S>) -> Self::Step<S> {
        RungeKutta::new(model)
    }
}

/// The scheme of [`SemiImplicitEuler`].
#[derive(Clone, Copy, Debug)]
pub struct SemiImplicit;

impl Scheme<LagrangianRobot> for SemiImplicit {
    type Step<S: Scalar> = SemiImplicitEuler<S, LagrangianSecondOrder<S>>;

    fn step<S: Scalar>(model: LagrangianSecondOrder<S>) -> Self::Step<S> {
        SemiImplicitEuler::new(model)
    }
}

/// `(x, u, h) -> Phi(x, u, h)` of a model by a scheme, for automatic differentiation: the reference for every
/// [`Step`].
///
/// ```
/// use costate::derivative::Jacobian;
/// use costate::robot::Robot;
/// use costate::step::{HamiltonianRobot, OneStep, Step, StoermerVerlet, Verlet};
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let function = OneStep::<_, Verlet>::new(HamiltonianRobot::from(&robot));
/// let z = [0.3, -0.8, 1.0, 0.5, 0.2, 0.0, 0.01];
/// let mut automatic: Jacobian<_> = Jacobian::new(function);
/// let through_the_iteration = automatic.linearise(&z)?.jacobian[(0, 2)];
/// let mut step = StoermerVerlet::new(costate::hamiltonian::HamiltonianSecondOrder::<f64>::new(&robot));
/// let phi_x = step.linearise(&z[..4], &z[4..6], 0.01)?.phi_x;
/// assert!((phi_x[(0, 2)] - through_the_iteration).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct OneStep<F, M> {
    family: F,
    states: usize,
    controls: usize,
    scheme: PhantomData<M>,
}

impl<F: ModelFamily, M: Scheme<F>> OneStep<F, M> {
    /// The step of the models of this family.
    pub fn new(family: F) -> Self {
        let model = family.model::<f64>();
        Self { states: model.states(), controls: model.controls(), family, scheme: PhantomData }
    }
}

impl<F: ModelFamily, M: Scheme<F>> Function for OneStep<F, M> {
    type Workspace<S: Scalar> = M::Step<S>;
    type Error = StepError<F::Error>;

    fn inputs(&self) -> usize {
        self.states + self.controls + 1
    }

    fn outputs(&self) -> usize {
        self.states
    }

    fn workspace<S: Scalar>(&self) -> M::Step<S> {
        M::step(self.family.model())
    }

    fn evaluate<S: Scalar>(
        &self,
        step: &mut M::Step<S>,
        z: &[S],
        next: &mut [S],
    ) -> Result<(), StepError<F::Error>> {
        for (what, found, expected) in [("z", z.len(), self.inputs()), ("next", next.len(), self.states)] {
            LengthError::check(what, expected, found).map_err(StepError::WrongLength)?;
        }
        let (x, rest) = z.split_at(self.states);
        let (u, h) = rest.split_at(self.controls);
        next.copy_from_slice(step.evaluate(x, u, h[0])?);
        Ok(())
    }
}
