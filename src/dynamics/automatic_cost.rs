//! Any function with one output as a cost, differentiated automatically.

use super::automatic::Parts;
use super::{Cost, CostGradient, CostHessian};
use crate::derivative::{CHUNK, DerivativeError, Function, InnerNumber, Jacobian};
use crate::scalar::Scalar;
use std::fmt;

/// The first output of a function of the states and controls, one after the other, as a cost.
///
/// The gradient by dual numbers, the Hessian by hyper-dual numbers. `T`: as for [`Jacobian`].
///
/// ```
/// use costate::derivative::{DerivativeError, Function};
/// use costate::dynamics::{AutomaticCost, Cost};
/// use costate::scalar::Scalar;
/// use std::convert::Infallible;
///
/// /// 1 - cos x + u^2 / 2
/// #[derive(Clone)]
/// struct Swing;
///
/// impl Function for Swing {
///     type Workspace<S: Scalar> = ();
///     type Error = Infallible;
///     fn inputs(&self) -> usize { 2 }
///     fn outputs(&self) -> usize { 1 }
///     fn workspace<S: Scalar>(&self) {}
///     fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], l: &mut [S]) -> Result<(), Infallible> {
///         let (_, cos) = z[0].sin_cos();
///         l[0] = (z[1] * z[1]).times(0.5) - cos.plus(-1.0);
///         Ok(())
///     }
/// }
///
/// let mut cost: AutomaticCost<_> = AutomaticCost::running(Swing, 1);
/// let second = cost.hessian(&[0.0], &[3.0])?;
/// assert_eq!((second.gradient.u[0], second.xx[(0, 0)], second.uu[(0, 0)]), (3.0, 1.0, 1.0));
/// # Ok::<(), DerivativeError<Infallible>>(())
/// ```
pub struct AutomaticCost<F: Function, T: InnerNumber = f64> {
    jacobian: Jacobian<F, CHUNK, T>,
    parts: Parts<F, T>,
    one: Vec<T>,
}

impl<F: Function, T: InnerNumber> fmt::Debug for AutomaticCost<F, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("AutomaticCost")
            .field("states", &self.parts.states())
            .field("controls", &self.parts.controls())
            .finish_non_exhaustive()
    }
}

impl<F: Function + Clone, T: InnerNumber> AutomaticCost<F, T> {
    /// A running cost with so many states; all further inputs are controls.
    ///
    /// # Panics
    /// If the function has fewer inputs than states, or no output.
    pub fn running(function: F, states: usize) -> Self {
        let (inputs, outputs) = (function.inputs(), function.outputs());
        assert!(inputs >= states, "{states} states are not among {inputs} inputs");
        assert!(outputs > 0, "a cost needs an output");
        let mut one: Vec<T> = vec![Scalar::zero(); outputs];
        one[0] = Scalar::one();
        Self { jacobian: Jacobian::over(function.clone()), parts: Parts::new(function, states), one }
    }

    /// A terminal cost: a function of the states alone.
    ///
    /// # Panics
    /// If the function has no output.
    pub fn terminal(function: F) -> Self {
        let states = function.inputs();
        Self::running(function, states)
    }
}

impl<F: Function, T: InnerNumber> Cost<T> for AutomaticCost<F, T>
where
    F::Error: 'static,
{
    type Error = DerivativeError<F::Error>;

    fn states(&self) -> usize {
        self.parts.states()
    }

    fn controls(&self) -> usize {
        self.parts.controls()
    }

    fn evaluate(&mut self, x: &[T], u: &[T]) -> Result<T, Self::Error> {
        self.parts.set(x, u)?;
        self.parts.evaluate()?;
        Ok(self.parts.value[0])
    }

    fn gradient(&mut self, x: &[T], u: &[T]) -> Result<CostGradient<'_, T>, Self::Error> {
        self.parts.set(x, u)?;
        let first = self.jacobian.linearise(&self.parts.z)?;
        let (x, u) = first.gradient().split_at(x.len());
        Ok(CostGradient { value: first.value[0], x, u })
    }

    fn hessian(&mut self, x: &[T], u: &[T]) -> Result<CostHessian<'_, T>, Self::Error> {
        self.parts.set(x, u)?;
        self.parts.contract(&self.one)?;
        let first = self.jacobian.linearise(&self.parts.z)?;
        let (x, u) = first.gradient().split_at(x.len());
        let Parts { xx, ux, uu, .. } = &self.parts;
        Ok(CostHessian {
            gradient: CostGradient { value: first.value[0], x, u },
            xx: xx.view(),
            ux: Some(ux.view()),
            uu: uu.view(),
        })
    }
}
