//! Any function generic over the scalar as a model, differentiated automatically.

use super::{Contraction, Dynamics, Linearisation, Structure};
use crate::derivative::{CHUNK, DerivativeError, Function, Hessian, InnerNumber, Jacobian, check_length};
use crate::matrix::Matrix;
use crate::scalar::Scalar;
use std::fmt;

/// `dx/dt = f(x, u)` of a function of the states and controls, one after the other, with as many outputs as
/// states.
///
/// f_x and f_u by dual numbers, y'f_xx, y'f_ux and y'f_uu by hyper-dual numbers. `T`: as for [`Jacobian`].
///
/// ```
/// use costate::derivative::Function;
/// use costate::dynamics::{Automatic, Dynamics};
/// use costate::scalar::Scalar;
/// use std::convert::Infallible;
///
/// /// A pendulum of unit length with a brushed motor: x = (angle, rate), u = (voltage).
/// #[derive(Clone)]
/// struct Pendulum;
///
/// impl Function for Pendulum {
///     type Workspace<S: Scalar> = ();
///     type Error = Infallible;
///     fn inputs(&self) -> usize { 3 }
///     fn outputs(&self) -> usize { 2 }
///     fn workspace<S: Scalar>(&self) {}
///     fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], f: &mut [S]) -> Result<(), Infallible> {
///         let (sin, _) = z[0].sin_cos();
///         f[0] = z[1];
///         f[1] = z[2] - z[1].times(0.2) - sin.times(9.81);
///         Ok(())
///     }
/// }
///
/// let mut model: Automatic<_> = Automatic::new(Pendulum);
/// let second = model.contract(&[0.3, 1.0], &[0.5], &[0.0, 2.0])?;
/// assert!((second.xx[(0, 0)] - 2.0 * 9.81 * 0.3_f64.sin()).abs() < 1e-14);
/// # Ok::<(), costate::derivative::DerivativeError<Infallible>>(())
/// ```
pub struct Automatic<F: Function, T: InnerNumber = f64> {
    jacobian: Jacobian<F, CHUNK, T>,
    parts: Parts<F, T>,
    f_x: Matrix<T>,
    f_u: Matrix<T>,
}

impl<F: Function, T: InnerNumber> fmt::Debug for Automatic<F, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Automatic")
            .field("states", &self.parts.states())
            .field("controls", &self.parts.controls())
            .finish_non_exhaustive()
    }
}

/// The common part of automatic models and costs: values and Hessians of a function of (x, u).
pub(super) struct Parts<F: Function, T: InnerNumber> {
    function: F,
    workspace: F::Workspace<T>,
    hessian: Hessian<F, T>,
    pub z: Vec<T>,
    pub value: Vec<T>,
    pub xx: Matrix<T>,
    pub ux: Matrix<T>,
    pub uu: Matrix<T>,
}

impl<F: Function + Clone, T: InnerNumber> Parts<F, T> {
    pub fn new(function: F, states: usize) -> Self {
        let controls = function.inputs() - states;
        Self {
            workspace: function.workspace(),
            hessian: Hessian::over(function.clone()),
            z: vec![Scalar::zero(); function.inputs()],
            value: vec![Scalar::zero(); function.outputs()],
            xx: Matrix::zeros(states, states),
            ux: Matrix::zeros(controls, states),
            uu: Matrix::zeros(controls, controls),
            function,
        }
    }
}

impl<F: Function, T: InnerNumber> Parts<F, T> {
    pub fn states(&self) -> usize {
        self.xx.rows()
    }

    pub fn controls(&self) -> usize {
        self.uu.rows()
    }

    /// z = (x, u).
    pub fn set(&mut self, x: &[T], u: &[T]) -> Result<(), DerivativeError<F::Error>> {
        let states = self.states();
        check_length("x", x, states)?;
        check_length("u", u, self.controls())?;
        check_finite("x", x)?;
        check_finite("u", u)?;
        self.z[..states].copy_from_slice(x);
        self.z[states..].copy_from_slice(u);
        Ok(())
    }

    /// `y` must be as long as the outputs.
    pub fn check_costate(&self, y: &[T]) -> Result<(), DerivativeError<F::Error>> {
        check_length("y", y, self.value.len())?;
        check_finite("y", y)
    }

    pub fn evaluate(&mut self) -> Result<(), DerivativeError<F::Error>> {
        Ok(self.function.evaluate(&mut self.workspace, &self.z, &mut self.value)?)
    }

    /// The blocks of the Hessian contracted with y.
    pub fn contract(&mut self, y: &[T]) -> Result<(), DerivativeError<F::Error>> {
        let states = self.states();
        let whole = self.hessian.contract(&self.z, y)?;
        for i in 0..states {
            self.xx.row_mut(i).copy_from_slice(&whole.row(i)[..states]);
        }
        for i in 0..self.uu.rows() {
            let (left, right) = whole.row(states + i).split_at(states);
            self.ux.row_mut(i).copy_from_slice(left);
            self.uu.row_mut(i).copy_from_slice(right);
        }
        Ok(())
    }
}

/// Every entry is finite.
fn check_finite<T: InnerNumber, E: std::error::Error>(
    what: &'static str,
    values: &[T],
) -> Result<(), DerivativeError<E>> {
    match values.iter().position(|value| T::CHECKED && !Scalar::is_finite(*value)) {
        Some(index) => Err(DerivativeError::NonFinite { what, index }),
        None => Ok(()),
    }
}

impl<F: Function + Clone, T: InnerNumber> Automatic<F, T> {
    /// The model of a function: as many states as outputs; all further inputs are controls.
    ///
    /// # Panics
    /// If the function has fewer inputs than outputs.
    pub fn new(function: F) -> Self {
        let (inputs, states) = (function.inputs(), function.outputs());
        assert!(inputs >= states, "{states} rates of change need as many states among {inputs} inputs");
        Self {
            jacobian: Jacobian::over(function.clone()),
            f_x: Matrix::zeros(states, states),
            f_u: Matrix::zeros(states, inputs - states),
            parts: Parts::new(function, states),
        }
    }
}

impl<F: Function, T: InnerNumber> Automatic<F, T> {
    fn differentiate(&mut self) -> Result<(), DerivativeError<F::Error>> {
        let states = self.parts.states();
        let first = self.jacobian.linearise(&self.parts.z)?;
        self.parts.value.copy_from_slice(first.value);
        for i in 0..states {
            let (left, right) = first.jacobian.row(i).split_at(states);
            self.f_x.row_mut(i).copy_from_slice(left);
            self.f_u.row_mut(i).copy_from_slice(right);
        }
        Ok(())
    }

    fn first(&self) -> Linearisation<'_, T> {
        Linearisation { f: &self.parts.value, f_x: self.f_x.view(), f_u: self.f_u.view() }
    }
}

impl<F: Function, T: InnerNumber> Dynamics<T> for Automatic<F, T>
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

    fn structure(&self) -> Structure {
        Structure::general(self.parts.states())
    }

    fn evaluate(&mut self, x: &[T], u: &[T]) -> Result<&[T], Self::Error> {
        self.parts.set(x, u)?;
        self.parts.evaluate()?;
        Ok(&self.parts.value)
    }

    fn linearise(&mut self, x: &[T], u: &[T]) -> Result<Linearisation<'_, T>, Self::Error> {
        self.parts.set(x, u)?;
        self.differentiate()?;
        Ok(self.first())
    }

    fn adjoint(
        &mut self,
        x: &[T],
        u: &[T],
        y: &[T],
        y_f_x: &mut [T],
        y_f_u: &mut [T],
    ) -> Result<(), Self::Error> {
        self.parts.check_costate(y)?;
        check_length("y_f_x", y_f_x, x.len())?;
        check_length("y_f_u", y_f_u, u.len())?;
        self.linearise(x, u)?.adjoint(y, [y_f_x, y_f_u]);
        Ok(())
    }

    fn hessian_product(
        &mut self,
        x: &[T],
        u: &[T],
        y: &[T],
        [d_x, d_u]: [&[T]; 2],
        [x_product, u_product]: [&mut [T]; 2],
    ) -> Result<(), Self::Error> {
        check_length("d_x", d_x, x.len())?;
        check_length("d_u", d_u, u.len())?;
        check_length("x_product", x_product, x.len())?;
        check_length("u_product", u_product, u.len())?;
        check_finite("d_x", d_x)?;
        check_finite("d_u", d_u)?;
        self.contract(x, u, y)?.times([d_x, d_u], [x_product, u_product]);
        Ok(())
    }

    fn contract(&mut self, x: &[T], u: &[T], y: &[T]) -> Result<Contraction<'_, T>, Self::Error> {
        self.parts.set(x, u)?;
        self.parts.check_costate(y)?;
        self.differentiate()?;
        self.parts.contract(y)?;
        let Parts { xx, ux, uu, .. } = &self.parts;
        Ok(Contraction { first: self.first(), xx: xx.view(), ux: Some(ux.view()), uu: Some(uu.view()) })
    }
}
