//! Derivatives of the Hamiltonian state equation by parameters.

use super::mixed::Mixed;
use super::response::Response;
use super::set::ParameterSet;
use crate::error::EvalError;
use crate::hamiltonian::check;
use crate::kernels::friction_of;
use crate::matrix::{Matrix, add_scaled, filled};
use crate::scalar::Scalar;

/// Workspace for the derivatives of `F(q, p)` by the parameters of a set; no call allocates.
///
/// The actuation u adds to F: derivatives by parameters do not depend on it. Derivatives are at fixed (q, p);
/// if rates are given instead, p = M v depends on the parameters too, by [`Regressor::momentum`].
///
/// Slices q (rad, m) and p (kg m^2/s, kg m/s) have n entries, a costate y = (y_q, y_p) 2n. Every method can
/// fail with [`EvalError::WrongLength`], [`EvalError::NonFinite`] or [`EvalError::SingularMassMatrix`].
///
/// ```
/// use costate::parameters::{HamiltonianParameters, ParameterSet};
/// use costate::robot::Robot;
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let set = ParameterSet::new(&robot).named("shoulder.mass")?.named("elbow.x")?;
/// let mut parameters = HamiltonianParameters::<f64>::new(&set);
/// let (q, p, y) = ([0.3, -0.8], [1.0, 0.5], [1.0, -2.0, 0.5, 0.3]);
/// let all = parameters.contract(&q, &p, &y)?;
/// println!("F_theta = {}", all.f_theta().view().as_nalgebra()); // 4 x 2
/// println!("y'F_theta = {:?}", all.y_f_theta());
/// println!("y'F_x,theta = {}", all.y_f_x_theta().view().as_nalgebra());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// [`Regressor::momentum`]: super::Regressor::momentum
#[derive(Clone, Debug)]
pub struct HamiltonianParameters<S: Scalar> {
    mixed: Mixed<S>,
    response: Response<S>,
    v: Vec<S>,
    v_theta: Matrix<S>,
    /// `w~ = (w_q, V w)`.
    direction_q: Vec<S>,
    direction_v: Vec<S>,
    f_theta: Matrix<S>,
    y_f_theta: Vec<S>,
    /// `D_w~ p_theta + D_w~ M v_theta`, friction included.
    pull: Matrix<S>,
    /// Minus M^-1 times it.
    pulled: Matrix<S>,
    y_f_x_theta: Matrix<S>,
}

/// F_theta, y'F_theta and y'F_x,theta at one state; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ParameterContraction<'a, S> {
    f_theta: &'a Matrix<S>,
    y_f_theta: &'a [S],
    y_f_x_theta: &'a Matrix<S>,
}

impl<'a, S: Scalar> ParameterContraction<'a, S> {
    /// `dF/dtheta`, 2n x n_theta.
    pub fn f_theta(&self) -> &'a Matrix<S> {
        self.f_theta
    }

    /// `sum_k y_k dF_k/dtheta`, n_theta.
    pub fn y_f_theta(&self) -> &'a [S] {
        self.y_f_theta
    }

    /// `sum_k y_k d2 F_k / dx dtheta`, 2n x n_theta.
    pub fn y_f_x_theta(&self) -> &'a Matrix<S> {
        self.y_f_x_theta
    }
}

impl<S: Scalar> HamiltonianParameters<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(set: &ParameterSet) -> Self {
        let mixed = Mixed::new(set);
        let (n, len) = (mixed.layout.dof(), mixed.layout.len);
        let (zeros, state_rows) = (filled(S::zero(), n), Matrix::zeros(2 * n, len));
        Self {
            response: Response::new(&mixed),
            v_theta: Matrix::zeros(n, len),
            pulled: Matrix::zeros(n, len),
            v: zeros.clone(),
            direction_q: zeros.clone(),
            direction_v: zeros,
            f_theta: state_rows.clone(),
            y_f_theta: filled(S::zero(), len),
            pull: Matrix::zeros(n, len),
            y_f_x_theta: state_rows,
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

    /// `F_theta = (v_theta ; L_q,theta + P'v_theta + D_v v_theta + D_theta + Q_theta)`, `v_theta = -M^-1
    /// p_theta`, at fixed (q, p); 2n x n_theta.
    ///
    /// # Errors
    /// See [`HamiltonianParameters`].
    pub fn linearise(&mut self, q: &[S], p: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.mixed.layout.check(&[("q", q), ("p", p)])?;
        self.set_state(q, p)?;
        self.respond(q);
        Ok(&self.f_theta)
    }

    /// `y'F_theta = -D_w~ L_theta + y_p . (D_theta + Q_theta)`, n_theta, without F_theta: O(n) and ten
    /// products for each inertial parameter after the first order of the state equation.
    ///
    /// `w = (-y_p, y_q + D_v y_p)`, `w~ = (w_q, M^-1 (w_p - P w_q))` is the direction of y'F_xx.
    ///
    /// # Errors
    /// See [`HamiltonianParameters`].
    pub fn adjoint(&mut self, q: &[S], p: &[S], y: &[S]) -> Result<&[S], EvalError> {
        self.check(q, p, y)?;
        self.set_state(q, p)?;
        self.set_costate(y);
        self.contract_values(q, y);
        Ok(&self.y_f_theta)
    }

    /// F_theta, y'F_theta and
    ///
    /// $$ y^T F\_{x\theta} = -E^T \left( D\_{\tilde w} \begin{pmatrix} L\_{q\theta} \\\\ p\_\theta
    /// \end{pmatrix} + \begin{pmatrix} (D\_{\tilde w} P)^T \\\\ D\_{\tilde w} M \end{pmatrix} v\_\theta
    /// \right), \qquad E = \begin{pmatrix} 1 & 0 \\\\ -M^{-1} P & M^{-1} \end{pmatrix} $$
    ///
    /// Friction adds `V' (y_p . D_vv v_theta + y_p . D_v,theta)`, V the lower rows of E, and wrenches from
    /// outside `y_p . Q_q,theta`. With y'F_xx this is
    /// what the derivatives of extremals by parameters need.
    ///
    /// # Errors
    /// See [`HamiltonianParameters`].
    pub fn contract(&mut self, q: &[S], p: &[S], y: &[S]) -> Result<ParameterContraction<'_, S>, EvalError> {
        self.check(q, p, y)?;
        self.set_state(q, p)?;
        self.respond(q);
        self.set_costate(y);
        self.contract_values(q, y);
        self.mixed.differentiate(&self.direction_q, &self.direction_v)?;
        self.mixed.take_changes(&self.direction_q, &self.direction_v);
        self.combine(y);
        let Self { f_theta, y_f_theta, y_f_x_theta, .. } = &*self;
        Ok(ParameterContraction { f_theta, y_f_theta, y_f_x_theta })
    }

    fn check(&self, q: &[S], p: &[S], y: &[S]) -> Result<(), EvalError> {
        let layout = &self.mixed.layout;
        layout.check(&[("q", q), ("p", p)])?;
        check(&layout.tree, "y", y, 2 * layout.dof())
    }

    /// `v = M^-1 p` and kernel one.
    fn set_state(&mut self, q: &[S], p: &[S]) -> Result<(), EvalError> {
        self.mixed.set_position(q)?;
        self.response.factor(&self.mixed)?;
        self.v.copy_from_slice(p);
        self.response.solve(&mut self.v);
        self.mixed.set_velocity(q, &self.v)
    }

    /// F_theta.
    #[inline(never)]
    fn respond(&mut self, q: &[S]) {
        let Self { mixed, response, v, v_theta, f_theta, .. } = self;
        mixed.take_gradients(q, v);
        response.respond(&mixed.p, v_theta);
        let n = mixed.layout.dof();
        for i in 0..n {
            f_theta.row_mut(i).copy_from_slice(v_theta.row(i));
            let row = f_theta.row_mut(n + i);
            row.copy_from_slice(mixed.l_q.row(i));
            for k in 0..n {
                add_scaled(row, mixed.entry(mixed.one.l_vq(), k, i), v_theta.row(k));
            }
        }
        for &i in mixed.layout.tree.with_friction() {
            let slope = friction_of(&mixed.layout.tree, i, v[i]).first;
            add_scaled(f_theta.row_mut(n + i), slope, v_theta.row(i));
        }
        for (column, i, by) in mixed.layout.friction_columns(v) {
            f_theta[(n + i, column)] = by.value;
        }
        mixed.add_force_slopes(1.0, n, f_theta);
    }

    /// The direction w~ of a costate.
    fn set_costate(&mut self, y: &[S]) {
        let Self { mixed, response, v, direction_q, direction_v, .. } = self;
        let (y_q, y_p) = y.split_at(v.len());
        direction_q.iter_mut().zip(y_p).for_each(|(w, &y_p)| *w = -y_p);
        direction_v.copy_from_slice(y_q);
        for &i in mixed.layout.tree.with_friction() {
            direction_v[i] += friction_of(&mixed.layout.tree, i, v[i]).first * y_p[i];
        }
        for (i, w) in direction_v.iter_mut().enumerate() {
            for (k, &w_q) in direction_q.iter().enumerate() {
                *w -= mixed.entry(mixed.one.l_vq(), i, k) * w_q;
            }
        }
        response.solve(direction_v);
    }

    /// y'F_theta.
    fn contract_values(&mut self, q: &[S], y: &[S]) {
        let Self { mixed, v, direction_q, direction_v, y_f_theta, .. } = self;
        y_f_theta.fill(S::zero());
        mixed.values_along([q, v, direction_q, direction_v], y_f_theta);
        y_f_theta.iter_mut().for_each(|entry| *entry = -*entry);
        for (column, i, by) in mixed.layout.friction_columns(v) {
            y_f_theta[column] = y[v.len() + i] * by.value;
        }
        mixed.add_force_products(1.0, &y[v.len()..], y_f_theta);
    }

    /// y'F_x,theta from the changes along w~.
    #[inline(never)]
    fn combine(&mut self, y: &[S]) {
        let Self { mixed, response, v, v_theta, pull, pulled, y_f_x_theta, .. } = self;
        let (n, tree) = (mixed.layout.dof(), &mixed.layout.tree);
        for i in 0..n {
            let row = pull.row_mut(i);
            row.copy_from_slice(mixed.d_p.row(i));
            for k in 0..n {
                add_scaled(row, mixed.entry(mixed.two.mass_matrix(), i, k), v_theta.row(k));
            }
        }
        for &i in tree.with_friction() {
            let curvature = y[n + i] * friction_of(tree, i, v[i]).second;
            add_scaled(pull.row_mut(i), -curvature, v_theta.row(i));
        }
        for (column, i, by) in mixed.layout.friction_columns(v) {
            pull[(i, column)] -= y[n + i] * by.slope;
        }
        response.respond(pull, pulled);
        for i in 0..n {
            let row = y_f_x_theta.row_mut(i);
            row.iter_mut().zip(mixed.d_l_q.row(i)).for_each(|(entry, &change)| *entry = -change);
            for k in 0..n {
                add_scaled(row, -mixed.entry(mixed.two.l_vq(), k, i), v_theta.row(k));
                add_scaled(row, -mixed.entry(mixed.one.l_vq(), k, i), pulled.row(k));
            }
            y_f_x_theta.row_mut(n + i).copy_from_slice(pulled.row(i));
        }
        mixed.add_force_curvature(&y[n..], y_f_x_theta);
    }
}
