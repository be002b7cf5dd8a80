//! Derivatives of forward dynamics by parameters.

use super::regressor::Regressor;
use super::response::Response;
use super::set::ParameterSet;
use crate::error::EvalError;
use crate::lagrangian::Lagrangian;
use crate::matrix::{Matrix, filled};
use crate::scalar::Scalar;

/// Workspace for the derivatives of forward dynamics a(q, v, u) by the parameters of a set; no call
/// allocates.
///
/// Slices q (rad, m), v (rad/s, m/s), u (N m, N) and y, a costate of the velocities, have n entries. Every
/// method can fail with [`EvalError::WrongLength`], [`EvalError::NonFinite`] or
/// [`EvalError::SingularMassMatrix`].
///
/// ```
/// use costate::parameters::{LagrangianParameters, ParameterSet};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let set = ParameterSet::new(&robot).named("elbow.mass")?.named("elbow.x")?;
/// let mut parameters = LagrangianParameters::<f64>::new(&set);
/// let (q, v, u) = ([0.3, -0.8], [1.0, 0.5], [0.2, -4.0]);
/// let linear = parameters.linearise_forward_dynamics(&q, &v, &u)?;
/// println!("a = {:?}\na_theta = {}", linear.acceleration, linear.a_theta.view().as_nalgebra());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct LagrangianParameters<S: Scalar> {
    lagrangian: Lagrangian<S>,
    regressor: Regressor<S>,
    response: Response<S>,
    zero: Vec<S>,
    a: Vec<S>,
    w: Vec<S>,
    y_a_theta: Vec<S>,
    a_theta: Matrix<S>,
}

/// Forward dynamics and its derivative by parameters; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ParameterLinearisation<'a, S> {
    /// `a = M^-1 (u + D + Q - C v - g)`, n (rad/s^2, m/s^2).
    pub acceleration: &'a [S],
    /// `a_theta = -M^-1 tau_theta`, n x n_theta.
    pub a_theta: &'a Matrix<S>,
}

impl<S: Scalar> LagrangianParameters<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(set: &ParameterSet) -> Self {
        let regressor = Regressor::new(set);
        let (n, len) = (regressor.dof(), regressor.parameters());
        Self {
            lagrangian: Lagrangian::new(set.robot()),
            response: Response::new(regressor.mixed()),
            regressor,
            zero: filled(S::zero(), n),
            a: filled(S::zero(), n),
            w: filled(S::zero(), n),
            y_a_theta: filled(S::zero(), len),
            a_theta: Matrix::zeros(n, len),
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.regressor.dof()
    }

    /// Number of parameters, n_theta.
    pub fn parameters(&self) -> usize {
        self.regressor.parameters()
    }

    /// Changes wrench `k` of [`Robot::wrenches`](crate::robot::Robot::wrenches) to this moment (N m) and
    /// force (N), in the axes that it was given in.
    ///
    /// # Errors
    /// [`EvalError::NoWrench`] or [`EvalError::BadWrench`].
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        self.lagrangian.set_wrench(k, moment, force)?;
        self.regressor.set_wrench(k, moment, force)
    }

    /// a(q, v, u) and `a_theta = -M^-1 tau_theta(q, v, a)`.
    ///
    /// # Errors
    /// See [`LagrangianParameters`].
    pub fn linearise_forward_dynamics(
        &mut self,
        q: &[S],
        v: &[S],
        u: &[S],
    ) -> Result<ParameterLinearisation<'_, S>, EvalError> {
        self.accelerate(q, v, u)?;
        let tau_theta = self.regressor.inverse_dynamics(q, v, &self.a)?;
        self.response.respond(tau_theta, &mut self.a_theta);
        Ok(ParameterLinearisation { acceleration: &self.a, a_theta: &self.a_theta })
    }

    /// `y'a_theta = -(M^-1 y)' tau_theta`, n_theta, without a_theta.
    ///
    /// # Errors
    /// See [`LagrangianParameters`].
    pub fn adjoint_forward_dynamics(
        &mut self,
        q: &[S],
        v: &[S],
        u: &[S],
        y: &[S],
    ) -> Result<&[S], EvalError> {
        self.regressor.mixed().layout.check(&[("y", y)])?;
        self.accelerate(q, v, u)?;
        self.w.copy_from_slice(y);
        self.response.solve(&mut self.w);
        let w_tau = self.regressor.adjoint(q, v, &self.a, &self.w)?;
        self.y_a_theta.iter_mut().zip(w_tau).for_each(|(entry, &w_tau)| *entry = -w_tau);
        Ok(&self.y_a_theta)
    }

    /// `a = M^-1 (u - tau(q, v, 0))`.
    fn accelerate(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<(), EvalError> {
        self.regressor.mixed().layout.check(&[("q", q), ("v", v), ("u", u)])?;
        let bias = self.lagrangian.inverse_dynamics(q, v, &self.zero)?;
        for (a, (&u, &bias)) in self.a.iter_mut().zip(u.iter().zip(bias)) {
            *a = u - bias;
        }
        let mixed = self.regressor.mixed_mut();
        mixed.set_position(q)?;
        self.response.factor(mixed)?;
        self.response.solve(&mut self.a);
        Ok(())
    }
}
