//! Compares the derivatives of steps in time with hyper-dual numbers.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not
// by everyone who builds the library.

use super::error::check;
use super::{
    Classical, HamiltonianRobot, LagrangianRobot, Midpoint, ModelFamily, Scheme, SemiImplicit, Step,
    StepContraction, StepError, Verlet,
};
use crate::derivative::{CLOSE, Called, Figure, InnerNumber, Judged, Row, Verdict, rounded_once, scales};
use crate::error::EvalError;
use crate::hamiltonian::Hamiltonian;
use crate::matrix::Matrix;
use crate::robot::Robot;
use crate::scalar::{Count, Scalar};
use num_dual::HyperDual;
use std::fmt;

/// Compares the derivatives of one step of a robot, by every scheme, with hyper-dual numbers through the step
/// itself (through the iterations of implicit schemes, too).
///
/// Phi_z, z = (x, u, h), and the product of `y'Phi_zz`, z = (x, u), with a direction. The bound is that of
/// [`Routes`](crate::derivative::Routes).
pub struct StepRoutes {
    tolerance: f64,
    momenta: Hamiltonian<f64>,
    runge_kutta: Compared<HamiltonianRobot, Classical>,
    verlet: Compared<HamiltonianRobot, Verlet>,
    midpoint: Compared<HamiltonianRobot, Midpoint>,
    semi_implicit: Compared<LagrangianRobot, SemiImplicit>,
}

/// Tolerance that lets the error of the reference be propagated whatever the differences.
const ALWAYS: f64 = 0.0;

/// Exponents of the scales, see [`Row`].
#[derive(Clone, Copy)]
struct Scales {
    /// Of the state x.
    state: &'static [i8],
    /// Of what is dual to (x, u).
    dual: &'static [i8],
    /// Of what is dual to (x, u, h).
    dual_with_h: &'static [i8],
}

/// For x = (q, p).
const MOMENTA: Scales = Scales { state: &[1, -1], dual: &[-1, 1, 1], dual_with_h: &[-1, 1, 1, 0] };

/// For x = (q, v).
const VELOCITIES: Scales = Scales { state: &[1, 1], dual: &[-1, -1, 1], dual_with_h: &[-1, -1, 1, 0] };

impl fmt::Debug for StepRoutes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StepRoutes").field("dof", &self.momenta.dof()).finish_non_exhaustive()
    }
}

impl StepRoutes {
    /// Builds every workspace.
    #[inline]
    pub fn new(robot: &Robot) -> Self {
        let (hamiltonian, lagrangian) = (HamiltonianRobot::from(robot), LagrangianRobot::from(robot));
        Self {
            tolerance: 1.0,
            momenta: Hamiltonian::new(robot),
            runge_kutta: Compared::new("RK4 (q, p)", &hamiltonian, MOMENTA),
            verlet: Compared::new("Verlet (q, p)", &hamiltonian, MOMENTA),
            midpoint: Compared::new("midpoint (q, p)", &hamiltonian, MOMENTA),
            semi_implicit: Compared::new("semi-implicit (q, v)", &lagrangian, VELOCITIES),
        }
    }

    /// As [`Routes::with_tolerance`](crate::derivative::Routes::with_tolerance).
    #[must_use]
    pub fn with_tolerance(mut self, tolerance: f64) -> Self {
        self.tolerance = tolerance;
        self
    }

    /// Compares a step of duration h from x = (q, p) under u with the costate y. The direction of the Hessian
    /// product is (y, u). Appends all figures, or none on an error.
    ///
    /// # Errors
    /// A wrong length, a state that the model refuses, or an implicit equation that was not solved to
    /// rounding.
    #[inline]
    pub fn compare(
        &mut self,
        x: &[f64],
        u: &[f64],
        h: f64,
        y: &[f64],
        figures: &mut Vec<Figure>,
    ) -> Result<(), StepError<EvalError>> {
        let (rows, d) = self.rows([x, u, y], h, self.tolerance)?;
        figures.extend(rows.iter().map(|row| row.judge(&d)));
        Ok(())
    }

    /// As [`Routes::undetected`](crate::derivative::Routes::undetected).
    ///
    /// # Errors
    /// As for [`compare`](Self::compare).
    #[doc(hidden)]
    #[inline]
    pub fn undetected(
        &mut self,
        x: &[f64],
        u: &[f64],
        h: f64,
        y: &[f64],
        change: f64,
    ) -> Result<Vec<[&'static str; 2]>, StepError<EvalError>> {
        let (rows, d) = self.rows([x, u, y], h, ALWAYS)?;
        Ok(rows.iter().filter(|row| !row.detects(change, &d)).map(|row| row.row.name).collect())
    }

    /// All rows, and the scales of the coordinates.
    #[inline]
    fn rows(
        &mut self,
        [x, u, y]: [&[f64]; 3],
        h: f64,
        tolerance: f64,
    ) -> Result<(Vec<Judged>, Vec<f64>), StepError<EvalError>> {
        let n = self.momenta.dof();
        check([2 * n, n], [x, u], h, Some(y))?;
        let (q, p) = x.split_at(n);
        let in_velocities = [q, self.momenta.velocity(q, p)?].concat();
        let d = scales(&self.momenta.mass_matrix(q)?.view().to_nalgebra());
        let mut found = Vec::new();
        found.extend(self.runge_kutta.rows([x, u, y], h, &d, tolerance)?);
        found.extend(self.verlet.rows([x, u, y], h, &d, tolerance)?);
        found.extend(self.midpoint.rows([x, u, y], h, &d, tolerance)?);
        found.extend(self.semi_implicit.rows([&in_velocities, u, y], h, &d, tolerance)?);
        found.sort_by_key(|judged| judged.row.name[0]);
        Ok((found, d))
    }
}

/// One scheme and its reference, in `f64` and in numbers that carry their rounding error.
struct Compared<F: ModelFamily, M: Scheme<F>> {
    name: &'static str,
    scales: Scales,
    step: M::Step<f64>,
    reference: M::Step<Called<HyperDual<f64>>>,
    rounded_step: M::Step<Count>,
    rounded_reference: M::Step<Called<HyperDual<Count>>>,
}

impl<F: ModelFamily, M: Scheme<F>> Compared<F, M> {
    #[inline]
    fn new(name: &'static str, family: &F, scales: Scales) -> Self {
        Self {
            name,
            scales,
            step: M::step(family.model()),
            reference: M::step(family.model()),
            rounded_step: M::step(family.model()),
            rounded_reference: M::step(family.model()),
        }
    }

    /// The rows with their rounding errors; those of the reference are propagated where one rounding is not
    /// enough, see [`Routes`](crate::derivative::Routes).
    #[inline]
    fn rows(
        &mut self,
        [x, u, y]: [&[f64]; 3],
        h: f64,
        d: &[f64],
        tolerance: f64,
    ) -> Result<Vec<Judged>, StepError<F::Error>> {
        let (name, scales) = (self.name, self.scales);
        let reference = evaluate(&mut self.reference, [x, u, y], h)?;
        let rows = compare(name, scales, &mut self.step, &reference, [x, u, y], h)?;
        let exact = |values: &[f64]| values.iter().map(|&value| Count::variable(value)).collect::<Vec<_>>();
        let (x, u, y, h) = (&exact(x)[..], &exact(u)[..], &exact(y)[..], Count::variable(h));
        let mut judged = |reference| -> Result<Vec<_>, StepError<F::Error>> {
            let rounded = compare(name, scales, &mut self.rounded_step, &reference, [x, u, y], h)?;
            Ok(rows.iter().cloned().zip(rounded).map(|(row, rounded)| Judged { row, rounded }).collect())
        };
        let mut found = judged(reference.map(|part| rounded_once(&part)))?;
        if found.iter().any(|row| row.judge(d).verdict(CLOSE * tolerance) == Verdict::Differs) {
            found = judged(evaluate(&mut self.rounded_reference, [x, u, y], h)?)?;
        }
        // Hyper-dual numbers take two more iterations: their value is solved to rounding.
        let value = found.remove(0).judge(d);
        if value.verdict(tolerance.max(1.0)) == Verdict::Differs {
            return Err(StepError::Inaccurate { scheme: self.name, difference: value.difference });
        }
        Ok(found)
    }
}

/// Phi, Phi_z and `y'Phi_zz d` by hyper-dual numbers over one number type.
#[inline]
fn evaluate<S: InnerNumber, E: std::error::Error>(
    reference: &mut impl Step<Called<HyperDual<S>>, Error = E>,
    [x, u, y]: [&[S]; 3],
    h: S,
) -> Result<[Matrix<S>; 3], E> {
    let (states, inputs) = (x.len(), x.len() + u.len() + 1);
    let (zero, one): (S, S) = (Scalar::zero(), Scalar::one());
    let direction = [y, u, &[zero]].concat();
    let values = [x, u, &[h]].concat();
    let (mut phi_z, mut product) = (Matrix::zeros(states, inputs), Matrix::zeros(1, inputs - 1));
    let mut phi = Matrix::zeros(states, 1);
    for j in 0..inputs {
        let unit = |l| if l == j { one } else { zero };
        let number = |l| Called(HyperDual::new(values[l], direction[l], unit(l), zero));
        let z: Vec<_> = (0..inputs).map(number).collect();
        let next = reference.evaluate(&z[..states], &z[states..inputs - 1], z[inputs - 1])?;
        let mut sum = zero;
        for (k, next) in next.iter().enumerate() {
            phi[(k, 0)] = next.0.re;
            phi_z[(k, j)] = next.0.eps2;
            sum += next.0.eps1eps2 * y[k];
        }
        if j + 1 < inputs {
            product[(0, j)] = sum;
        }
    }
    Ok([phi, phi_z, product])
}

/// Phi, Phi_z and `y'Phi_zz d` by a step, compared with the reference.
#[inline]
fn compare<S: Scalar, E: std::error::Error>(
    name: &'static str,
    Scales { state, dual, dual_with_h }: Scales,
    step: &mut impl Step<S, Error = E>,
    [phi, phi_z, product]: &[Matrix<S>; 3],
    [x, u, y]: [&[S]; 3],
    h: S,
) -> Result<[Row<S>; 3], E> {
    let found = step.contract(x, u, h, y)?;
    let (value, first) = (Matrix::from_rows(1, found.first.next), jacobian(&found));
    let mut by_hand = Matrix::zeros(1, x.len() + u.len());
    let (in_x, in_u) = by_hand.row_mut(0).split_at_mut(x.len());
    found.times([y, u], [in_x, in_u]);
    Ok([
        Row::new(["Phi", name], value.view(), phi.view(), [state, &[0]]),
        Row::new(["Phi_z, z = (x, u, h)", name], first.view(), phi_z.view(), [state, dual_with_h]),
        Row::new(["y'Phi_zz d, z = (x, u)", name], by_hand.view(), product.view(), [&[0], dual]),
    ])
}

/// `[Phi_x, Phi_u, Phi_h]`.
#[inline]
fn jacobian<S: Scalar>(found: &StepContraction<'_, S>) -> Matrix<S> {
    let first = &found.first;
    let rows = first.phi_x.iter_rows().zip(first.phi_u.iter_rows()).zip(first.phi_h);
    let entries: Vec<S> = rows.flat_map(|((x, u), h)| [x, u, std::slice::from_ref(h)].concat()).collect();
    Matrix::from_rows(entries.len() / first.next.len().max(1), &entries)
}
