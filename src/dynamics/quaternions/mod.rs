//! Robots with floating and spherical joints as models whose states are plain numbers.

mod bend;
mod model;
mod places;
#[cfg(test)]
mod tests;
mod turn;

pub use model::TangentModel;
pub(crate) use places::{Places, plain_entries};
pub(crate) use turn::{Turn, four, vector};

use super::{Contraction, Dynamics, Linearisation, Structure};
use crate::error::{EvalError, LengthError, check_length};
use crate::hamiltonian::HamiltonianSecondOrder;
use crate::lagrangian::LagrangianSecondOrder;
use crate::matrix::{Block, Matrix, add_scaled, filled};
use crate::robot::Robot;
use crate::scalar::Scalar;
use bend::Bend;
use nalgebra::DMatrix;

/// The state equation of a robot with quaternions as plain states:
///
/// $$ x = (q, p), \qquad a' = \tfrac12\\, a \circ (\omega, 0), \quad r' = R(a)\\, v, \quad
///    \theta' = v\_\theta, \quad p' = F^p(q, p) + B u $$
///
/// q has [`Robot::nq`] entries, in the order of
/// [`ConfigurationSpace`](crate::configuration::ConfigurationSpace), p has n: of a floating or spherical
/// joint the momentum about the origin of the moved frame, in its axes. A quaternion `a = (x, y, z, w)` may
/// have any length but zero, and f is homogeneous in it: of degree one in a', of degree zero in all else.
/// |a| is constant along every motion, and so are the products `y_a . a` of costates that belong to it. So x
/// is a vector without constraints, and any optimiser or integrator of vectors takes it; where it fixes the
/// end $a\_T$ of a quaternion it fixes three functions, `vec(conj(a_T) o a) = 0`.
///
/// With [`in_rates`](Self::in_rates) x = (q, v), v the rates, and v' is the acceleration of forward dynamics.
///
/// f_x and y'f_xx are exact: those of [`TangentModel`] in the tangent space, by the chain rule.
/// Without floating and spherical joints they are the same. Units are rad, m, kg, s. u has one entry for each
/// column of B (N m, N if B is the unit matrix).
///
/// ```
/// use costate::dynamics::{Dynamics, QuaternionDynamics};
/// use costate::robot::{JointSpec, LinkInertia, Robot};
///
/// let body = LinkInertia::about_com(2.0, [0.0; 3], nalgebra::Matrix3::identity() * 0.5);
/// let drone = Robot::builder("drone").joint(JointSpec::floating("root").carrying(body)).build()?;
/// let mut model = QuaternionDynamics::<f64>::new(&drone);
/// // At rest but for a turn about z: x = (r, a, p).
/// let x = [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.8];
/// let f = model.evaluate(&x, &[0.0; 6])?;
/// assert!((f[5] - 0.8).abs() < 1e-15 && f[6].abs() < 1e-15); // half of omega = 1.6 rad/s
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct QuaternionDynamics<S: Scalar, M = HamiltonianSecondOrder<S>> {
    model: M,
    nq: usize,
    /// Entries of q of joints of one degree of freedom, with their coordinates.
    plain: Vec<(usize, usize)>,
    turns: Vec<Turn<S>>,
    /// B; f_u has it below zeros, or its accelerations.
    actuation: Matrix<S>,
    f_u: Matrix<S>,
    /// Second derivatives of y'f by (u, q), where f_u depends on q.
    y_f_uq: Matrix<S>,
    /// q with unit quaternions, and B u.
    q: Vec<S>,
    tau: Vec<S>,
    f: Vec<S>,
    f_x: Matrix<S>,
    y_f_xx: Matrix<S>,
    /// The costate in the tangent space, and y'F_x there.
    l: Vec<S>,
    pull: Vec<S>,
    /// F_x and y'F_xx of the tangent space, their columns by x; the transpose of the latter.
    slopes: Matrix<S>,
    half: Matrix<S>,
}

impl<S: Scalar> QuaternionDynamics<S> {
    /// The model of a robot in momenta, every coordinate driven: B is the unit matrix. Later calls do not
    /// allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::of_robot(robot)
    }
}

impl<S: Scalar> QuaternionDynamics<S, LagrangianSecondOrder<S>> {
    /// The same in rates: x = (q, v).
    pub fn in_rates(robot: &Robot) -> Self {
        Self::of_robot(robot)
    }
}

impl<S: Scalar, M: TangentModel<S>> QuaternionDynamics<S, M> {
    /// The model of a robot, every coordinate driven.
    pub(crate) fn of_robot(robot: &Robot) -> Self {
        let (n, nq) = (robot.dof(), robot.nq());
        let size = nq + n;
        let whole = Self {
            model: M::of(robot),
            nq,
            plain: plain_entries(robot),
            turns: robot.free_joints().iter().map(Turn::new).collect(),
            actuation: Matrix::zeros(0, 0),
            f_u: Matrix::zeros(0, 0),
            y_f_uq: Matrix::zeros(0, 0),
            q: filled(S::zero(), nq),
            tau: filled(S::zero(), n),
            f: filled(S::zero(), size),
            f_x: Matrix::zeros(size, size),
            y_f_xx: Matrix::zeros(size, size),
            l: filled(S::zero(), 2 * n),
            pull: filled(S::zero(), 2 * n),
            slopes: Matrix::zeros(2 * n, size),
            half: Matrix::zeros(size, 2 * n),
        };
        whole.driven_by(n, |i, j| if i == j { 1.0 } else { 0.0 })
    }

    /// With these columns of B, n rows: what each control does on the coordinates. The actuators of a drone
    /// act on several; a free base that nothing drives has rows of zeros.
    ///
    /// # Errors
    /// [`LengthError`] unless B has n rows.
    pub fn with_actuation(self, b: &DMatrix<f64>) -> Result<Self, LengthError> {
        LengthError::check("B", self.model.dof(), b.nrows())?;
        Ok(self.driven_by(b.ncols(), |i, j| b[(i, j)]))
    }

    fn driven_by(self, m: usize, entry: impl Fn(usize, usize) -> f64) -> Self {
        let n = self.model.dof();
        let (mut actuation, mut f_u) = (Matrix::zeros(n, m), Matrix::zeros(self.nq + n, m));
        let y_f_uq = Matrix::zeros(m, M::structure(self.nq).f_u_depends_on);
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            actuation[(i, j)] = S::from_f64(entry(i, j));
            f_u[(self.nq + i, j)] = actuation[(i, j)];
        }
        Self { actuation, f_u, y_f_uq, ..self }
    }

    /// Number of entries of q: x has n more.
    pub fn nq(&self) -> usize {
        self.nq
    }

    /// Number of degrees of freedom, n.
    pub fn dof(&self) -> usize {
        self.model.dof()
    }

    /// q with unit quaternions, and B u.
    fn set(&mut self, x: &[S], u: &[S]) -> Result<(), EvalError> {
        check_length("x", x, self.nq + self.model.dof())?;
        check_length("u", u, self.actuation.columns())?;
        self.q.copy_from_slice(&x[..self.nq]);
        for turn in &mut self.turns {
            turn.set(x, &mut self.q);
        }
        for (i, tau) in self.tau.iter_mut().enumerate() {
            let row = self.actuation.row(i).iter().zip(u);
            *tau = row.fold(S::zero(), |sum, (&b, &u)| b.mul_add(u, sum));
        }
        Ok(())
    }
}

/// f_u where it depends on q: what the columns of B do, by the last n rows of F_tau.
fn drive<S: Scalar>(f_tau: Block<'_, S>, actuation: &Matrix<S>, f_u: &mut Matrix<S>) {
    let (n, nq) = (f_tau.columns(), f_u.rows() - f_tau.columns());
    for i in 0..n {
        let row = f_u.row_mut(nq + i);
        row.fill(S::zero());
        for (k, &by_tau) in f_tau.row(n + i).iter().enumerate() {
            add_scaled(row, by_tau, actuation.row(k));
        }
    }
}

impl<S: Scalar, M: TangentModel<S>> Dynamics<S> for QuaternionDynamics<S, M> {
    type Error = EvalError;

    fn states(&self) -> usize {
        self.nq + self.model.dof()
    }

    fn controls(&self) -> usize {
        self.actuation.columns()
    }

    fn structure(&self) -> Structure {
        M::structure(self.nq)
    }

    fn evaluate(&mut self, x: &[S], u: &[S]) -> Result<&[S], EvalError> {
        self.set(x, u)?;
        let Self { model, nq, plain, turns, q, tau, f, .. } = self;
        let rate = model.rate(q, &x[*nq..], tau)?;
        Places { nq: *nq, plain, turns }.rate(rate, f);
        Ok(&self.f)
    }

    fn linearise(&mut self, x: &[S], u: &[S]) -> Result<Linearisation<'_, S>, EvalError> {
        self.set(x, u)?;
        let Self { model, nq, plain, turns, q, tau, f, f_x, f_u, slopes, actuation, .. } = self;
        let of_tangent = model.linear(q, &x[*nq..], tau)?;
        let places = Places { nq: *nq, plain, turns };
        places.rate(of_tangent.f, f);
        for (i, row) in of_tangent.f_x.iter_rows().enumerate() {
            places.spread(row, slopes.row_mut(i));
        }
        places.jacobian(of_tangent.f, slopes, f_x);
        if !M::structure(*nq).constant_f_u {
            drive(of_tangent.f_u, actuation, f_u);
        }
        Ok(Linearisation { f, f_x: f_x.view(), f_u: f_u.view() })
    }

    fn contract(&mut self, x: &[S], u: &[S], y: &[S]) -> Result<Contraction<'_, S>, EvalError> {
        self.set(x, u)?;
        check_length("y", y, x.len())?;
        let Self { model, nq, plain, turns, q, tau, f, f_x, f_u, slopes, half, y_f_xx, l, pull, .. } = self;
        let (actuation, y_f_uq) = (&self.actuation, &mut self.y_f_uq);
        let places = Places { nq: *nq, plain, turns };
        places.costate(y, l);
        let all = model.second(q, &x[*nq..], tau, l)?;
        let of_tangent = all.first;
        let rate = of_tangent.f;
        places.rate(rate, f);
        // Rows of y_f_xx are space for one of the tangent space here.
        if let Some(by_tau) = all.ux {
            drive(of_tangent.f_u, actuation, f_u);
            let n = by_tau.rows();
            for j in 0..y_f_uq.rows() {
                pull.fill(S::zero());
                for (k, row) in by_tau.iter_rows().enumerate() {
                    add_scaled(&mut pull[..n], actuation[(k, j)], row);
                }
                places.spread(pull, y_f_xx.row_mut(0));
                y_f_uq.row_mut(j).copy_from_slice(&y_f_xx.row(0)[..*nq]);
            }
        }
        pull.fill(S::zero());
        for (i, row) in of_tangent.f_x.iter_rows().enumerate() {
            places.spread(row, slopes.row_mut(i));
            add_scaled(pull, l[i], row);
        }
        places.jacobian(rate, slopes, f_x);
        // The Hessian of the tangent space from both sides.
        for (i, row) in all.xx.iter_rows().enumerate() {
            places.spread(row, y_f_xx.row_mut(0));
            for c in 0..half.rows() {
                half[(c, i)] = y_f_xx[(0, c)];
            }
        }
        for c in 0..half.rows() {
            places.spread(half.row(c), y_f_xx.row_mut(c));
        }
        let bend = Bend { y, l, pull, rate, slopes };
        turns.iter().for_each(|turn| bend.add(turn, y_f_xx));
        let first = Linearisation { f, f_x: f_x.view(), f_u: f_u.view() };
        let ux = (y_f_uq.columns() > 0).then(|| y_f_uq.view());
        Ok(Contraction { first, xx: y_f_xx.view(), ux, uu: None })
    }
}
