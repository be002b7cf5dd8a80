//! Accelerations and forces of the constraints in (q, v, u), with their Jacobians.

use super::blocks::{Moving, displace, pair};
use super::{ConstrainedHamiltonian, Constraints};
use crate::error::EvalError;
use crate::lagrangian::Lagrangian;
use crate::matrix::{Block, Matrix, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::{Scalar, Tangent};

/// Workspace for the accelerations a and the forces lambda of a robot with holonomic constraints as
/// functions of z = (q, v, u); no call allocates.
///
/// $$ M a + C v + g - D - J^T \lambda = u, \qquad J a + \dot J v = 0 $$
///
/// With r(z, s) the residual of these equations, s = (a, lambda), the Jacobian is `s_z = -r_s^-1 r_z`. It
/// holds for every v. Where `J v = 0` the results are those of [`ConstrainedHamiltonian`] at p = M v:
/// [`ForceMap`](crate::contacts::ForceMap) has the derivatives of lambda by (q, p, u).
///
/// Slices q (rad, m), v (rad/s, m/s) and u (N m, N) have n entries, in the order of
/// [`Robot::independent_joints`]; a (rad/s^2, m/s^2) has n, lambda k, with units and axes as in
/// [`ConstrainedLinearisation::lambda`](super::ConstrainedLinearisation::lambda). With floating and
/// spherical joints q has nq entries, v and a are the twist of the moved frame in its axes and its rate,
/// and derivatives by q are those in the tangent space, as those of [`Lagrangian`]. Every method can fail
/// with
/// [`EvalError::WrongLength`], [`EvalError::NonFinite`], [`EvalError::NotUnit`] and
/// [`EvalError::SingularMassMatrix`]. Rows that depend on others are left out, and their forces are zero: see
/// [`ConstrainedHamiltonian::counted`].
///
/// ```
/// use costate::constraints::ConstrainedLagrangian;
/// use costate::robot::Robot;
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let four_bar = Robot::from_file("robots/four_bar.toml")?;
/// let mut lagrangian = ConstrainedLagrangian::<f64>::new(&four_bar);
/// let mut q = [1.0, -0.6, -2.0];
/// lagrangian.hamiltonian().close(&mut q, &[true, false, false])?;
/// let all = lagrangian.linearise(&q, &[0.0; 3], &[2.0, 0.0, 0.0])?;
/// println!("force of the pivot {:?} N, by the torques {}", all.lambda(), all.lambda_u().to_nalgebra());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ConstrainedLagrangian<S: Scalar> {
    /// M, J and the factors of their matrix.
    pub(super) solver: ConstrainedHamiltonian<S>,
    /// The open tree.
    open: Lagrangian<S>,
    pub(super) twice: Moments<S>,
    pub(super) zero: Vec<S>,
    pub(super) a: Vec<S>,
    pub(super) lambda: Vec<S>,
    pub(super) a_z: Matrix<S>,
    pub(super) lambda_z: Matrix<S>,
    /// `(lambda . J)_q`, n x n; `(J a + J'v)_q` and `(J a + J'v)_v`, k x n.
    pub(super) curvature: Matrix<S>,
    pub(super) moving: [Matrix<S>; 2],
    pub(super) column: [Vec<S>; 2],
}

/// The rows of the constraints along a motion.
#[derive(Clone, Debug)]
pub(super) struct Moments<S: Scalar> {
    pub rows: Moving<Tangent<S>>,
    q: Vec<Tangent<S>>,
    pub v: Vec<Tangent<S>>,
}

impl<S: Scalar> Moments<S> {
    fn new(tree: &Tree) -> Self {
        let zero = Tangent::zero();
        Self { rows: Moving::new(tree), q: filled(zero, tree.nq()), v: filled(zero, tree.dof()) }
    }

    /// `q (+) t v` and `v + t a`, with the derivatives by t.
    #[inline(never)]
    pub fn place(&mut self, q: &[S], v: &[S], a: &[S]) {
        displace(self.rows.rows.tree(), q, v, &mut self.q);
        pair(v, a, &mut self.v);
        self.rows.place_rows(&self.q, &self.v);
    }
}

impl<S: Scalar> ConstrainedLagrangian<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        let solver = ConstrainedHamiltonian::new(robot);
        let (n, k) = (solver.dof(), solver.mu.len());
        let (zeros, forces) = (filled(S::zero(), n), filled(S::zero(), k));
        Self {
            open: Lagrangian::new(&robot.without_constraints()),
            twice: Moments::new(&solver.tree),
            curvature: Matrix::zeros(n, n),
            moving: [Matrix::zeros(k, n), Matrix::zeros(k, n)],
            zero: zeros.clone(),
            a: zeros.clone(),
            lambda: forces.clone(),
            a_z: Matrix::zeros(n, 3 * n),
            lambda_z: Matrix::zeros(k, 3 * n),
            column: [zeros, forces],
            solver,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.solver.dof()
    }

    /// The workspace of the Hamiltonian state equation: momenta, closing of loops, rank, drift.
    pub fn hamiltonian(&mut self) -> &mut ConstrainedHamiltonian<S> {
        &mut self.solver
    }

    /// The constraints, at the position of the last call.
    pub fn constraints(&self) -> &Constraints<S> {
        self.solver.constraints()
    }

    /// a (n) and lambda (k).
    ///
    /// # Errors
    /// See [`ConstrainedLagrangian`].
    pub fn evaluate(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<(&[S], &[S]), EvalError> {
        self.solver.check(&[("q", q), ("v", v), ("u", u)])?;
        self.solve(q, v, u)?;
        Ok((&self.a, &self.lambda))
    }

    /// a, lambda and their Jacobians in z = (q, v, u).
    ///
    /// # Errors
    /// See [`ConstrainedLagrangian`].
    pub fn linearise(
        &mut self,
        q: &[S],
        v: &[S],
        u: &[S],
    ) -> Result<AccelerationLinearisation<'_, S>, EvalError> {
        self.solver.check(&[("q", q), ("v", v), ("u", u)])?;
        self.solve(q, v, u)?;
        self.differentiate(q, v)?;
        Ok(self.linearisation())
    }

    pub(super) fn linearisation(&self) -> AccelerationLinearisation<'_, S> {
        let Self { a, lambda, a_z, lambda_z, .. } = self;
        AccelerationLinearisation { a, lambda, a_z, lambda_z }
    }

    /// `(a; lambda)` from `(M -J'; -J 0) (a; lambda) = (u - tau(q, v, 0); J' v)`.
    #[inline(never)]
    pub(super) fn solve(&mut self, q: &[S], v: &[S], u: &[S]) -> Result<(), EvalError> {
        self.solver.factor(q)?;
        let Self { solver, open, twice, zero, a, lambda, .. } = self;
        let bias = open.inverse_dynamics(q, v, zero)?;
        a.iter_mut().zip(u.iter().zip(bias)).for_each(|(a, (&u, &bias))| *a = u - bias);
        twice.place(q, v, zero);
        lambda.iter_mut().zip(twice.rows.rows.values()).for_each(|(to, g)| *to = g.eps.eps);
        solver.kkt.solve(&solver.factor, a, lambda);
        Ok(())
    }

    /// The columns of `s_z = -r_s^-1 r_z`, with `r_q = (tau_q - (lambda . J)_q; (J a + J'v)_q)`, `r_v =
    /// (tau_v; 2 (J v)_q)` and `r_u = (-1; 0)`.
    #[inline(never)]
    fn differentiate(&mut self, q: &[S], v: &[S]) -> Result<(), EvalError> {
        self.move_rows(q, v);
        let Self { solver, open, a, a_z, lambda_z, curvature, moving, column: [x, m], .. } = self;
        let n = v.len();
        let torque = open.linearise_inverse_dynamics(q, v, a)?;
        for j in 0..3 * n {
            x.fill(S::zero());
            m.fill(S::zero());
            match (j / n, j % n) {
                (0, j) => {
                    for (i, x) in x.iter_mut().enumerate() {
                        *x = curvature[(i, j)] - torque.tau_q[(i, j)];
                    }
                    m.iter_mut().enumerate().for_each(|(i, m)| *m = moving[0][(i, j)]);
                }
                (1, j) => {
                    x.iter_mut().enumerate().for_each(|(i, x)| *x = -torque.tau_v[(i, j)]);
                    m.iter_mut().enumerate().for_each(|(i, m)| *m = moving[1][(i, j)]);
                }
                (_, j) => x[j] = S::one(),
            }
            solver.kkt.solve(&solver.factor, x, m);
            x.iter().enumerate().for_each(|(i, &x)| a_z[(i, j)] = x);
            m.iter().enumerate().for_each(|(i, &m)| lambda_z[(i, j)] = m);
        }
        Ok(())
    }
}

/// a, lambda and their Jacobians at one state, z = (q, v, u); borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct AccelerationLinearisation<'a, S> {
    a: &'a [S],
    lambda: &'a [S],
    a_z: &'a Matrix<S>,
    lambda_z: &'a Matrix<S>,
}

impl<'a, S: Scalar> AccelerationLinearisation<'a, S> {
    /// Accelerations, n (rad/s^2, m/s^2).
    pub fn acceleration(&self) -> &'a [S] {
        self.a
    }

    /// Forces of the constraints, k.
    pub fn lambda(&self) -> &'a [S] {
        self.lambda
    }

    /// `[a_q, a_v, a_u]`, n x 3n.
    pub fn a_z(&self) -> Block<'a, S> {
        self.a_z.view()
    }

    /// `[lambda_q, lambda_v, lambda_u]`, k x 3n.
    pub fn lambda_z(&self) -> Block<'a, S> {
        self.lambda_z.view()
    }

    fn part(&self, k: usize) -> Block<'a, S> {
        let n = self.a.len();
        self.lambda_z.block(0, k * n, self.lambda.len(), n)
    }

    /// `lambda_q`, k x n.
    pub fn lambda_q(&self) -> Block<'a, S> {
        self.part(0)
    }

    /// `lambda_v`, k x n.
    pub fn lambda_v(&self) -> Block<'a, S> {
        self.part(1)
    }

    /// `lambda_u`, k x n.
    pub fn lambda_u(&self) -> Block<'a, S> {
        self.part(2)
    }
}
