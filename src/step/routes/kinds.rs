//! Steps of one scheme over every number, with and without floating and spherical joints.

use crate::dynamics::QuaternionDynamics;
use crate::error::EvalError;
use crate::hamiltonian::HamiltonianSecondOrder;
use crate::lagrangian::LagrangianSecondOrder;
use crate::robot::Robot;
use crate::scalar::Scalar;
use crate::step::{FreeStep, ModelFamily, RungeKutta, Scheme, Step, StepContraction, StepError, Tableau};
use std::marker::PhantomData;

/// Steps of a robot by one scheme, one for every scalar; x = (q, p) or (q, v) has nq + n entries, its
/// derivatives those in the tangent space, 2n.
pub(super) trait Kind {
    /// The step for one scalar.
    type Step<S: Scalar>;

    /// Builds the step for one scalar.
    fn step<S: Scalar>(robot: &Robot) -> Self::Step<S>;

    /// Phi(x, u, h).
    fn evaluate<'a, S: Scalar>(
        step: &'a mut Self::Step<S>,
        x: &[S],
        u: &[S],
        h: S,
    ) -> Result<&'a [S], StepError<EvalError>>;

    /// Phi at (x, u) with its derivatives, and those of y'Phi.
    fn contract<'a, S: Scalar>(
        step: &'a mut Self::Step<S>,
        x_u_y: [&[S]; 3],
        h: S,
    ) -> Result<StepContraction<'a, S>, StepError<EvalError>>;
}

/// A scheme of a robot whose joints all have one degree of freedom.
pub(super) struct Plain<F, M>(PhantomData<(F, M)>);

impl<F, M> Kind for Plain<F, M>
where
    F: ModelFamily<Error = EvalError> + for<'a> From<&'a Robot>,
    M: Scheme<F>,
{
    type Step<S: Scalar> = M::Step<S>;

    fn step<S: Scalar>(robot: &Robot) -> Self::Step<S> {
        M::step(F::from(robot).model())
    }

    fn evaluate<'a, S: Scalar>(
        step: &'a mut Self::Step<S>,
        x: &[S],
        u: &[S],
        h: S,
    ) -> Result<&'a [S], StepError<EvalError>> {
        step.evaluate(x, u, h)
    }

    fn contract<'a, S: Scalar>(
        step: &'a mut Self::Step<S>,
        [x, u, y]: [&[S]; 3],
        h: S,
    ) -> Result<StepContraction<'a, S>, StepError<EvalError>> {
        step.contract(x, u, h, y)
    }
}

/// Models of robots with floating and spherical joints that [`FreeStep`] steps.
macro_rules! free {
    ($(#[$meta:meta])* $kind:ident, $model:ident, $space:ident) => {
        $(#[$meta])*
        pub(super) struct $kind<T>(PhantomData<T>);

        impl<T: Tableau> Kind for $kind<T> {
            type Step<S: Scalar> = FreeStep<S, RungeKutta<S, QuaternionDynamics<S, $model<S>>, T>>;

            fn step<S: Scalar>(robot: &Robot) -> Self::Step<S> {
                FreeStep::$space(robot, RungeKutta::new)
            }

            fn evaluate<'a, S: Scalar>(
                step: &'a mut Self::Step<S>,
                x: &[S],
                u: &[S],
                h: S,
            ) -> Result<&'a [S], StepError<EvalError>> {
                step.evaluate(x, u, h)
            }

            fn contract<'a, S: Scalar>(
                step: &'a mut Self::Step<S>,
                [x, u, y]: [&[S]; 3],
                h: S,
            ) -> Result<StepContraction<'a, S>, StepError<EvalError>> {
                step.contract(x, u, h, y)
            }
        }
    };
}

free! {
    /// A scheme of a robot with floating and spherical joints in x = (q, p).
    FreeMomenta, HamiltonianSecondOrder, in_momenta
}

free! {
    /// The same in x = (q, v).
    FreeRates, LagrangianSecondOrder, in_rates
}
