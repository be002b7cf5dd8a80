//! The reference: automatic derivatives, in `f64` by num-dual's numbers, with rounding errors by tangents.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not by
// everyone who builds the library.

use super::called::{ByCalls, Called};
use super::function::{DerivativeError, Function};
use super::methods::State;
use super::rounded::Rounded;
use super::{ForwardDynamics, Hessian, Jacobian, NestedHessian, PhaseVelocity};
use crate::error::EvalError;
use crate::hamiltonian::Hamiltonian;
use crate::matrix::Matrix;
use crate::robot::Robot;
use crate::scalar::{Scalar, Tangent};

/// Derivatives of F, of the acceleration a and of H by automatic differentiation.
#[derive(Clone, Debug)]
pub(super) struct Reference<S> {
    pub f_x: Matrix<S>,
    pub y_f_xx: Matrix<S>,
    pub a_z: Matrix<S>,
    pub y_a_zz: Matrix<S>,
    /// By dual numbers, and by dual numbers in dual numbers.
    pub dual_f_x: Matrix<S>,
    pub nested_y_f_xx: Matrix<S>,
    pub dual_a_z: Matrix<S>,
    pub nested_y_a_zz: Matrix<S>,
    /// H_x without friction, 2n.
    pub energy_gradient: Vec<S>,
}

/// H(q, p) as a function of 2n inputs.
struct TotalEnergy(Robot);

impl Function for TotalEnergy {
    type Workspace<S: Scalar> = Hamiltonian<S>;
    type Error = EvalError;

    fn inputs(&self) -> usize {
        2 * self.0.dof()
    }

    fn outputs(&self) -> usize {
        1
    }

    fn workspace<S: Scalar>(&self) -> Hamiltonian<S> {
        Hamiltonian::new(&self.0)
    }

    fn evaluate<S: Scalar>(
        &self,
        energy: &mut Hamiltonian<S>,
        x: &[S],
        h: &mut [S],
    ) -> Result<(), EvalError> {
        let (q, p) = x.split_at(self.0.dof());
        h[0] = energy.hamiltonian(q, p)?;
        Ok(())
    }
}

/// By num-dual's numbers.
pub(super) struct NumDual {
    dual: Jacobian<ByCalls<PhaseVelocity>>,
    nested: NestedHessian<ByCalls<PhaseVelocity>>,
    hyperdual: Hessian<ByCalls<PhaseVelocity>>,
    dual_a: Jacobian<ByCalls<ForwardDynamics>>,
    nested_a: NestedHessian<ByCalls<ForwardDynamics>>,
    hyperdual_a: Hessian<ByCalls<ForwardDynamics>>,
    energy: Jacobian<ByCalls<TotalEnergy>>,
}

impl NumDual {
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        let (f, a) = (|| ByCalls(PhaseVelocity::new(robot)), || ByCalls(ForwardDynamics::new(robot)));
        Self {
            dual: Jacobian::new(f()),
            nested: NestedHessian::new(f()),
            hyperdual: Hessian::new(f()),
            dual_a: Jacobian::new(a()),
            nested_a: NestedHessian::new(a()),
            hyperdual_a: Hessian::new(a()),
            energy: Jacobian::new(ByCalls(TotalEnergy(robot.without_friction()))),
        }
    }

    #[inline]
    pub fn evaluate(&mut self, state: &State<f64>) -> Result<Reference<f64>, DerivativeError<EvalError>> {
        let State { x, u, y, .. } = state;
        let (z, y_p) = (&state.z()[..], &y[u.len()..]);
        for function in [self.dual.function_mut(), self.nested.function_mut(), self.hyperdual.function_mut()]
        {
            function.0.u.copy_from_slice(u);
        }
        Ok(Reference {
            y_f_xx: self.hyperdual.contract(x, y)?.clone(),
            f_x: self.hyperdual.last().jacobian().clone(),
            y_a_zz: self.hyperdual_a.contract(z, y_p)?.clone(),
            a_z: self.hyperdual_a.last().jacobian().clone(),
            dual_f_x: self.dual.linearise(x)?.jacobian.clone(),
            nested_y_f_xx: self.nested.contract(x, y)?.clone(),
            dual_a_z: self.dual_a.linearise(z)?.jacobian.clone(),
            nested_y_a_zz: self.nested_a.contract(z, y_p)?.clone(),
            energy_gradient: self.energy.linearise(x)?.gradient().to_vec(),
        })
    }
}

/// A hyper-dual number of numbers that carry their rounding error.
pub(crate) type RoundedPair = Tangent<Tangent<Rounded>>;

/// By tangents of tangents.
pub(super) struct Tangents {
    f: Pairs<ByCalls<PhaseVelocity>>,
    a: Pairs<ByCalls<ForwardDynamics>>,
    energy: Hamiltonian<Called<Tangent<Rounded>>>,
}

impl Tangents {
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        Self {
            f: Pairs::new(ByCalls(PhaseVelocity::new(robot))),
            a: Pairs::new(ByCalls(ForwardDynamics::new(robot))),
            energy: Hamiltonian::new(&robot.without_friction()),
        }
    }

    /// Dual numbers round as hyper-dual numbers do: their entries are those of the reference.
    #[inline]
    pub fn evaluate(&mut self, state: &State<f64>) -> Result<Reference<Rounded>, EvalError> {
        let State { x, u, y, .. } = state;
        let n = u.len();
        self.f.function.0.u.copy_from_slice(u);
        let (f_x, y_f_xx) = self.f.evaluate(x, y)?;
        let (a_z, y_a_zz) = self.a.evaluate(&state.z(), &y[n..])?;
        let mut z: Vec<_> = x.iter().map(|&x| Called::<Tangent<Rounded>>::from_f64(x)).collect();
        let mut energy_gradient = Vec::with_capacity(2 * n);
        for j in 0..2 * n {
            z[j].0.eps = Rounded::one();
            energy_gradient.push(self.energy.hamiltonian(&z[..n], &z[n..])?.0.eps);
            z[j].0.eps = Rounded::zero();
        }
        Ok(Reference {
            dual_f_x: f_x.clone(),
            nested_y_f_xx: y_f_xx.clone(),
            dual_a_z: a_z.clone(),
            nested_y_a_zz: y_a_zz.clone(),
            f_x,
            y_f_xx,
            a_z,
            y_a_zz,
            energy_gradient,
        })
    }
}

/// One function, evaluated for each pair of inputs.
struct Pairs<F: Function> {
    function: F,
    workspace: F::Workspace<RoundedPair>,
}

impl<F: Function> Pairs<F> {
    #[inline]
    fn new(function: F) -> Self {
        Self { workspace: function.workspace(), function }
    }

    /// The Jacobian, and the second derivatives weighted with y.
    #[inline]
    fn evaluate(&mut self, x: &[f64], y: &[f64]) -> Result<(Matrix<Rounded>, Matrix<Rounded>), F::Error> {
        let (n, m) = (x.len(), y.len());
        let (mut first, mut second) = (Matrix::zeros(m, n), Matrix::zeros(n, n));
        let mut z: Vec<_> = x.iter().map(|&x| RoundedPair::from_f64(x)).collect();
        let mut f = vec![RoundedPair::zero(); m];
        for j in 0..n {
            z[j].eps.re = Rounded::one();
            for i in 0..=j {
                z[i].re.eps = Rounded::one();
                self.function.evaluate(&mut self.workspace, &z, &mut f)?;
                z[i].re.eps = Rounded::zero();
                let sum = f
                    .iter()
                    .zip(y)
                    .fold(Rounded::zero(), |sum, (f, &y)| sum + f.eps.eps * Rounded::from_f64(y));
                second[(i, j)] = sum;
                second[(j, i)] = sum;
            }
            f.iter().enumerate().for_each(|(k, f)| first[(k, j)] = f.eps.re);
            z[j].eps.re = Rounded::zero();
        }
        Ok((first, second))
    }
}
