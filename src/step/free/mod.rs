//! Steps of robots with floating and spherical joints, with derivatives in the tangent space.

mod charts;
#[cfg(test)]
mod kept_tests;
#[cfg(test)]
mod tests;

use super::error::check;
use super::{Step, StepContraction, StepError, StepLinearisation};
use crate::configuration::ConfigurationSpace;
use crate::dynamics::{QuaternionDynamics, SecondHalf};
use crate::error::{EvalError, LengthError};
use crate::hamiltonian::HamiltonianSecondOrder;
use crate::lagrangian::LagrangianSecondOrder;
use crate::matrix::{Matrix, add_scaled, filled};
use crate::robot::Robot;
use crate::scalar::Scalar;
use charts::Charts;

/// One step of a robot with floating and spherical joints, its first two derivatives in the tangent space.
///
/// x = (q, p) or (q, v) has nq + n entries, and so has the next state. The scheme `P` steps
/// [`QuaternionDynamics`], whose quaternions are plain numbers: in (q, p) in its
/// [canonical](QuaternionDynamics::canonical) coordinates (q, P), which (q, p) is mapped to and from, so that
/// symplectic schemes are symplectic. Quaternions of the result are divided by their lengths. Derivatives are
/// those of
///
/// $$ \varphi(d, e, u, h) = \big(\Phi\_q(q \oplus d, w + e, u, h) \ominus \Phi\_q(q, w, u, h),
/// \enspace \Phi\_w(q \oplus d, w + e, u, h)\big) $$
///
/// by (d, e), u and h at d = 0, e = 0 with ⊕ and ⊖ of
/// [`ConfigurationSpace`](crate::configuration::ConfigurationSpace): Phi_x is 2n x 2n, Phi_u 2n x n, the
/// costate y has 2n entries, and the Hessian of y'phi is symmetric. Between the plain numbers and the tangent
/// space go the charts at both ends, which are needed to second order alone. Without such joints all of it is
/// what `P` gives.
///
/// The order is that of the scheme, and so is what it keeps. Of a robot that is free in space
/// [`ImplicitMidpoint`](super::ImplicitMidpoint) and [`StoermerVerlet`](super::StoermerVerlet) in (q, p) keep
/// linear and angular momentum in the world to rounding, under gravity those that it leaves constant, and the
/// energy without drift. [`RungeKutta4`](super::RungeKutta4), and all schemes in (q, v), keep them to their
/// order. The length of a quaternion is no matter: nothing but its own rate depends on it.
///
/// ```
/// use costate::robot::{JointSpec, LinkInertia, Robot};
/// use costate::step::{FreeStep, RungeKutta4};
///
/// let body = LinkInertia::about_com(2.0, [0.0; 3], nalgebra::Matrix3::identity() * 0.5);
/// let drone = Robot::builder("drone").joint(JointSpec::floating("root").carrying(body)).build()?;
/// let mut step = FreeStep::in_rates(&drone, RungeKutta4::<f64, _>::new);
/// // A turn about z at 2 rad/s for 0.1 s.
/// let x = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0];
/// let next = step.evaluate(&x, &[0.0; 6], 0.1)?;
/// assert!((next[5] - 0.1_f64.sin()).abs() < 1e-7 && (next[2] + 9.81 * 0.005).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FreeStep<S, P> {
    plain: P,
    space: ConfigurationSpace,
    charts: Charts<S>,
    /// The plain numbers of x.
    numbers: Vec<S>,
    /// Phi, with unit quaternions.
    next: Vec<S>,
    /// Phi of plain numbers by (d, e), u and h, row by row; the same by phi.
    wide: Matrix<S>,
    phi_z: Matrix<S>,
    phi_h: Vec<S>,
    /// y for the plain numbers of the next state, and y'Phi by those of x.
    y: Vec<S>,
    pull: Vec<S>,
    /// A row by plain numbers, and y'phi by (d, e) from one side.
    half: Matrix<S>,
    y_phi_zz: Matrix<S>,
}

impl<S: Scalar, P: Step<S, Error = StepError<EvalError>>> FreeStep<S, P> {
    /// A scheme of the robot in x = (q, p), such as `ImplicitMidpoint::new`. Later calls do not allocate.
    ///
    /// States have the body's momenta, those of [`QuaternionDynamics::new`]; the scheme itself steps
    /// [`QuaternionDynamics::canonical`], whose momenta are conjugate to the entries of q.
    pub fn in_momenta(
        robot: &Robot,
        scheme: impl FnOnce(QuaternionDynamics<S, HamiltonianSecondOrder<S>>) -> P,
    ) -> Self {
        Self::new(robot, scheme(QuaternionDynamics::canonical(robot)), SecondHalf::Conjugate)
    }

    /// The same in x = (q, v); the scheme steps [`QuaternionDynamics::in_rates`], whose x this is.
    pub fn in_rates(
        robot: &Robot,
        scheme: impl FnOnce(QuaternionDynamics<S, LagrangianSecondOrder<S>>) -> P,
    ) -> Self {
        Self::new(robot, scheme(QuaternionDynamics::in_rates(robot)), SecondHalf::Tangent)
    }

    fn new(robot: &Robot, plain: P, second: SecondHalf) -> Self {
        let (n, nq, size) = (robot.dof(), robot.nq(), plain.states());
        let inputs = 3 * n;
        Self {
            plain,
            space: ConfigurationSpace::new(robot),
            charts: Charts::new(robot, second),
            numbers: filled(S::zero(), size),
            next: filled(S::zero(), nq + n),
            wide: Matrix::zeros(size, inputs + 1),
            phi_z: Matrix::zeros(2 * n, inputs + 1),
            phi_h: filled(S::zero(), 2 * n),
            y: filled(S::zero(), size),
            pull: filled(S::zero(), size),
            half: Matrix::zeros(2 * n, size),
            y_phi_zz: Matrix::zeros(inputs, inputs),
        }
    }

    /// Number of entries of q; x has n more.
    pub fn nq(&self) -> usize {
        self.space.nq()
    }

    /// Number of degrees of freedom, n.
    pub fn dof(&self) -> usize {
        self.space.dof()
    }

    /// The quaternions of x have length 1, and everything has its length.
    fn check(&self, x: &[S], u: &[S], h: S, y: Option<&[S]>) -> Result<(), StepError<EvalError>> {
        check([self.nq() + self.dof(), self.dof()], [x, u], h, None)?;
        if let Some(y) = y {
            LengthError::check("y", 2 * self.dof(), y.len()).map_err(StepError::WrongLength)?;
        }
        Ok(self.space.check(&x[..self.nq()])?)
    }

    /// Phi(x, u, h), nq + n entries, its quaternions of length 1.
    ///
    /// # Errors
    /// A wrong length, a quaternion of x that is not unit, those of the robot, or an implicit equation that
    /// was not solved.
    pub fn evaluate(&mut self, x: &[S], u: &[S], h: S) -> Result<&[S], StepError<EvalError>> {
        self.check(x, u, h, None)?;
        self.charts.leave(x, &mut self.numbers);
        self.charts.arrive(self.plain.evaluate(&self.numbers, u, h)?, &mut self.next);
        Ok(&self.next)
    }

    /// Phi, and phi by (d, e), u and h.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn linearise(
        &mut self,
        x: &[S],
        u: &[S],
        h: S,
    ) -> Result<StepLinearisation<'_, S>, StepError<EvalError>> {
        self.check(x, u, h, None)?;
        self.charts.leave(x, &mut self.numbers);
        let first = self.plain.linearise(&self.numbers, u, h)?;
        self.charts.arrive(first.next, &mut self.next);
        self.charts.spread(&first, &mut self.wide);
        Ok(self.first())
    }

    /// The same with the second derivatives of y'phi by (d, e) and u.
    ///
    /// # Errors
    /// As [`evaluate`](Self::evaluate).
    pub fn contract(
        &mut self,
        x: &[S],
        u: &[S],
        h: S,
        y: &[S],
    ) -> Result<StepContraction<'_, S>, StepError<EvalError>> {
        self.check(x, u, h, Some(y))?;
        let n = self.dof();
        // The chart of the end has to be known before the costate.
        self.charts.leave(x, &mut self.numbers);
        self.charts.arrive(self.plain.evaluate(&self.numbers, u, h)?, &mut self.next);
        self.charts.costate(y, &mut self.y);
        let Self { plain, charts, wide, half, y_phi_zz, pull, .. } = self;
        let second = plain.contract(&self.numbers, u, h, &self.y)?;
        charts.spread(&second.first, wide);
        pull.fill(S::zero());
        for (&y, row) in self.y.iter().zip(second.first.phi_x.iter_rows()) {
            add_scaled(pull, y, row);
        }
        y_phi_zz.fill_zero();
        charts.hessian(&second, half, y_phi_zz);
        charts.bend_start(pull, y_phi_zz);
        charts.bend_end(y, wide, y_phi_zz);
        self.first();
        let [xx, ux, uu] = [[0, 0, 2 * n, 2 * n], [2 * n, 0, n, 2 * n], [2 * n, 2 * n, n, n]]
            .map(|[top, left, rows, columns]| self.y_phi_zz.block(top, left, rows, columns));
        let first = linearisation(&self.next, &self.phi_z, &self.phi_h);
        Ok(StepContraction { first, xx, ux: Some(ux), uu: Some(uu) })
    }

    /// phi by its arguments, once `wide` is filled.
    fn first(&mut self) -> StepLinearisation<'_, S> {
        self.charts.project(&self.wide, &mut self.phi_z);
        let last = self.phi_z.columns() - 1;
        self.phi_h.iter_mut().enumerate().for_each(|(i, phi_h)| *phi_h = self.phi_z[(i, last)]);
        linearisation(&self.next, &self.phi_z, &self.phi_h)
    }
}

fn linearisation<'a, S: Scalar>(
    next: &'a [S],
    phi_z: &'a Matrix<S>,
    phi_h: &'a [S],
) -> StepLinearisation<'a, S> {
    let size = phi_h.len();
    let controls = phi_z.columns() - 1 - size;
    let [phi_x, phi_u] =
        [(0, size), (size, controls)].map(|(left, columns)| phi_z.block(0, left, size, columns));
    StepLinearisation { next, phi_x, phi_u, phi_h }
}
