//! Derivatives of inverse dynamics, momentum and energy by parameters: regressors.

use super::mixed::Mixed;
use super::set::ParameterSet;
use crate::error::EvalError;
use crate::matrix::Matrix;
use crate::scalar::Scalar;
use crate::spatial::Motion;

/// Workspace for the derivatives of tau, p, L_q and energy by the parameters of a set; no call allocates.
///
/// `tau(q, v, a)` is linear in the parameters for which [`is_linear`](super::Parameter::is_linear) is true.
/// If pi are the values of all of them that the robot has, `tau = Y(q, v, a) pi` with `Y = tau_pi`: the
/// regressor of identification. By other parameters the columns are derivatives at the values of the model.
/// Wrenches from outside are no parameters: with their generalised forces Q, `tau + Q = Y pi`.
///
/// Slices q (rad, m), v (rad/s, m/s), a (rad/s^2, m/s^2) and w have n entries. Every method can fail with
/// [`EvalError::WrongLength`] or [`EvalError::NonFinite`]. No mass matrix is inverted, so that links may have
/// no mass.
///
/// ```
/// use costate::{lagrangian::Lagrangian, parameters::{ParameterSet, Regressor}, robot::Robot};
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let set = ParameterSet::new(&robot).links();
/// let mut regressor = Regressor::<f64>::new(&set);
/// let (q, v, a) = ([0.3, -0.8], [1.0, 0.5], [0.2, -4.0]);
/// let y = regressor.inverse_dynamics(&q, &v, &a)?.view().to_nalgebra(); // 2 x 20
/// let tau = y * nalgebra::DVector::from_column_slice(set.values());
/// let expected = Lagrangian::<f64>::new(&robot).inverse_dynamics(&q, &v, &a)?.to_vec();
/// assert!((tau[0] - expected[0]).abs() < 1e-12 && (tau[1] - expected[1]).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Regressor<S: Scalar> {
    mixed: Mixed<S>,
    tau: Matrix<S>,
    force: Matrix<S>,
    row: Vec<S>,
    motions: Vec<Motion<S>>,
}

/// Derivatives of the two sides of `dp/dt = L_q + D + Q + u`; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct MomentumRegressor<'a, S> {
    /// `p_theta`, n x n_theta.
    pub momentum: &'a Matrix<S>,
    /// `L_q,theta + D_theta + Q_theta`, n x n_theta.
    pub force: &'a Matrix<S>,
}

impl<S: Scalar> Regressor<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(set: &ParameterSet) -> Self {
        let mixed = Mixed::new(set);
        let columns = Matrix::zeros(mixed.layout.dof(), mixed.layout.len);
        Self {
            tau: columns.clone(),
            force: columns,
            row: vec![S::zero(); mixed.layout.len],
            motions: vec![Motion::zero(); mixed.layout.rows.len()],
            mixed,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.mixed.layout.dof()
    }

    /// Number of parameters, n_theta.
    pub fn parameters(&self) -> usize {
        self.mixed.layout.len
    }

    /// Changes wrench `k` of [`Robot::wrenches`](crate::robot::Robot::wrenches) to this moment (N m) and
    /// force (N), in the axes that it was given in.
    ///
    /// # Errors
    /// [`EvalError::NoWrench`] or [`EvalError::BadWrench`].
    pub fn set_wrench(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        self.mixed.set_wrench(k, moment, force)
    }

    /// `tau_theta = D_(v,a) p_theta - L_q,theta - D_theta - Q_theta`, n x n_theta: the regressor of inverse
    /// dynamics.
    ///
    /// A link or payload has entries for the joints before it only.
    ///
    /// # Errors
    /// See [`Regressor`].
    pub fn inverse_dynamics(&mut self, q: &[S], v: &[S], a: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.check(&[("q", q), ("v", v), ("a", a)])?;
        self.move_along(q, v, a)?;
        let Self { mixed, tau, .. } = self;
        if !mixed.layout.bodies.is_empty() {
            mixed.bodies.carry_axes(&mixed.layout.tree);
            mixed.bodies.torques(&mixed.layout.bodies, tau);
        }
        for &(column, _) in &mixed.layout.sources {
            for i in 0..mixed.layout.dof() {
                tau[(i, column)] = mixed.d_p[(i, column)] - mixed.l_q[(i, column)];
            }
        }
        for (column, i, by) in mixed.layout.friction_columns(v) {
            tau[(i, column)] = -by.value;
        }
        mixed.add_force_slopes(-1.0, 0, tau);
        Ok(&self.tau)
    }

    /// `w' tau_theta`, n_theta: the derivative of `w . tau(q, v, a)` for constant w. O(n + n_theta) for
    /// inertial parameters.
    ///
    /// # Errors
    /// See [`Regressor`].
    pub fn adjoint(&mut self, q: &[S], v: &[S], a: &[S], w: &[S]) -> Result<&[S], EvalError> {
        self.check(&[("q", q), ("v", v), ("a", a), ("w", w)])?;
        self.move_along(q, v, a)?;
        let Self { mixed, row, motions, .. } = self;
        if !mixed.layout.bodies.is_empty() {
            mixed.bodies.motions(&mixed.layout.tree, w, motions);
            mixed.bodies.powers(&mixed.layout.bodies, motions, row);
        }
        for &(column, _) in &mixed.layout.sources {
            let entry = |i: usize| mixed.d_p[(i, column)] - mixed.l_q[(i, column)];
            row[column] = w.iter().enumerate().fold(S::zero(), |sum, (i, &w)| w.mul_add(entry(i), sum));
        }
        for (column, i, by) in mixed.layout.friction_columns(v) {
            row[column] = -(w[i] * by.value);
        }
        mixed.add_force_products(-1.0, w, row);
        Ok(&self.row)
    }

    /// p_theta and `L_q,theta + D_theta + Q_theta`, for identification without accelerations: over any time,
    ///
    /// $$ \left\[ p\_\theta \theta \right\]\_{t\_1}^{t\_2} - \int\_{t\_1}^{t\_2} (L\_{q,\theta} +
    /// D\_\theta) \theta \\, dt = \int\_{t\_1}^{t\_2} (u + Q) \\, dt $$
    ///
    /// for the linear parameters, if the set contains all that the robot has.
    ///
    /// # Errors
    /// See [`Regressor`].
    pub fn momentum(&mut self, q: &[S], v: &[S]) -> Result<MomentumRegressor<'_, S>, EvalError> {
        self.check(&[("q", q), ("v", v)])?;
        self.set_state(q, v)?;
        let Self { mixed, force, .. } = self;
        mixed.take_gradients(q, v);
        force.copy_from(&mixed.l_q);
        for (column, i, by) in mixed.layout.friction_columns(v) {
            force[(i, column)] = by.value;
        }
        mixed.add_force_slopes(1.0, 0, force);
        Ok(MomentumRegressor { momentum: &mixed.p, force })
    }

    /// `E_theta = v' p_theta - L_theta`, n_theta, of the energy `E = 1/2 v' M v + V` at fixed (q, v); zero
    /// for friction. Along a motion dE/dt = v'(u + D + Q).
    ///
    /// # Errors
    /// See [`Regressor`].
    pub fn energy(&mut self, q: &[S], v: &[S]) -> Result<&[S], EvalError> {
        self.momentum(q, v)?;
        let Self { mixed, row, .. } = self;
        row.fill(S::zero());
        mixed.values(q, v, row);
        for (column, energy) in row.iter_mut().enumerate() {
            *energy = (0..v.len()).fold(-*energy, |sum, i| v[i].mul_add(mixed.p[(i, column)], sum));
        }
        Ok(&self.row)
    }

    pub(super) fn mixed(&self) -> &Mixed<S> {
        &self.mixed
    }

    pub(super) fn mixed_mut(&mut self) -> &mut Mixed<S> {
        &mut self.mixed
    }

    /// What all derivatives of inverse dynamics need: bodies with their accelerations, and kernels one and
    /// two along (v, a) if a parameter is a displacement.
    #[inline(never)]
    fn move_along(&mut self, q: &[S], v: &[S], a: &[S]) -> Result<(), EvalError> {
        self.set_state(q, v)?;
        let mixed = &mut self.mixed;
        if mixed.layout.is_extended() {
            mixed.differentiate(v, a)?;
        }
        mixed.bodies.set_direction(&mixed.layout.tree, v, a);
        mixed.take_source_gradients(q, v);
        mixed.take_source_changes(v, a);
        Ok(())
    }

    /// Bodies with their velocities, and kernel one if a parameter is a displacement.
    fn set_state(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        let mixed = &mut self.mixed;
        if mixed.layout.is_extended() {
            mixed.set_position(q)?;
            mixed.set_velocity(q, v)?;
        } else {
            mixed.bodies.set_state(&mixed.layout.tree, q, v);
        }
        Ok(())
    }

    /// Every argument has n finite entries.
    fn check(&self, arguments: &[(&'static str, &[S])]) -> Result<(), EvalError> {
        self.mixed.layout.check(arguments)
    }
}
