//! Robots with floating and spherical joints as models whose states are plain numbers.

mod bend;
#[cfg(test)]
mod canonical_tests;
mod evaluation;
mod local;
mod model;
mod places;
mod tangent;
#[cfg(test)]
mod tests;
mod turn;

pub(crate) use local::{Local, Parts};
pub use model::TangentModel;
pub(crate) use places::{Places, Plain, plain_entries};
pub(crate) use turn::{SecondHalf, Turn};

use super::Structure;
use crate::error::{EvalError, LengthError, check_length};
use crate::hamiltonian::HamiltonianSecondOrder;
use crate::lagrangian::LagrangianSecondOrder;
use crate::matrix::{Matrix, filled};
use crate::robot::Robot;
use crate::scalar::Scalar;
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
/// With [`canonical`](Self::canonical) x = (q, P) has the momenta conjugate to the entries of q: f is
/// Hamilton's equation in nq coordinates, and symplectic schemes keep what they promise.
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
    structure: Structure,
    plain: Vec<Plain>,
    turns: Vec<Turn<S>>,
    /// B, and what its columns do on the momenta or rates; f_u has that below zeros.
    actuation: Matrix<S>,
    driven: Matrix<S>,
    f_u: Matrix<S>,
    /// Second derivatives of y'f by (u, q), where f_u depends on q.
    y_f_uq: Matrix<S>,
    /// q with unit quaternions, the momenta or rates, and B u.
    q: Vec<S>,
    w: Vec<S>,
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
    ///
    /// The momenta of floating and spherical joints are the body's, not conjugate to the entries of q.
    /// Schemes are symplectic on [`canonical`](Self::canonical), which
    /// [`FreeStep::in_momenta`](crate::step::FreeStep::in_momenta) steps, though its x is that of this model.
    pub fn new(robot: &Robot) -> Self {
        Self::of_robot(robot, SecondHalf::Tangent)
    }

    /// The same in canonical coordinates x = (q, P), 2 nq entries. Joints of one degree of freedom have P =
    /// p; floating and spherical ones, with the body's momenta (p_v, pi) of [`new`](Self::new),
    ///
    /// $$ P\_r = R(a)\\, p\_v, \qquad P\_a = \tfrac{2}{|a|^2}\\, a \circ (\pi, 0) $$
    ///
    /// in the axes of the frame before the joint. f = (H_P, -H_q) + forces, with H of degree zero in a, and
    /// pi = vec(conj(a) o P_a) / 2, whatever P_a . a is: it and |a| are constant along every motion. Since
    /// momenta about the origin, `r x P_r + vec(P_a o conj(a)) / 2`, are bilinear in (q, P), symplectic
    /// Runge-Kutta schemes, partitioned ones too, keep those that are constant to rounding.
    ///
    /// ```
    /// use costate::dynamics::{Dynamics, QuaternionDynamics};
    /// use costate::robot::{JointSpec, LinkInertia, Robot};
    ///
    /// let body = LinkInertia::about_com(2.0, [0.0; 3], nalgebra::Matrix3::identity() * 0.5);
    /// let drone = Robot::builder("drone").joint(JointSpec::floating("root").carrying(body)).build()?;
    /// let mut model = QuaternionDynamics::<f64>::canonical(&drone);
    /// let x = [1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.6, 0.0]; // (r, a, P_r, P_a)
    /// let f = model.evaluate(&x, &[0.0; 6])?;
    /// assert!((f[5] - 0.8).abs() < 1e-15 && (f[9] + 2.0 * 9.81).abs() < 1e-12); // as above; gravity
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// Source of the latter: E. Hairer, C. Lubich, G. Wanner, "Geometric Numerical Integration", Springer
    /// 2006, IV.2.
    pub fn canonical(robot: &Robot) -> Self {
        Self::of_robot(robot, SecondHalf::Conjugate)
    }
}

impl<S: Scalar> QuaternionDynamics<S, LagrangianSecondOrder<S>> {
    /// The same in rates: x = (q, v).
    pub fn in_rates(robot: &Robot) -> Self {
        Self::of_robot(robot, SecondHalf::Tangent)
    }
}

impl<S: Scalar, M: TangentModel<S>> QuaternionDynamics<S, M> {
    /// The model of a robot, every coordinate driven.
    fn of_robot(robot: &Robot, second: SecondHalf) -> Self {
        let (n, nq) = (robot.dof(), robot.nq());
        let turns: Vec<Turn<S>> =
            robot.free_joints().iter().map(|joint| Turn::new(joint, nq, second)).collect();
        let mut structure = M::structure(nq);
        if second.is_conjugate() && !turns.is_empty() {
            structure = Structure { constant_f_u: false, f_u_depends_on: nq, ..structure };
        }
        let size = nq + second.length(robot);
        let whole = Self {
            model: M::of(robot),
            nq,
            structure,
            plain: plain_entries(robot, second),
            turns,
            actuation: Matrix::zeros(0, 0),
            driven: Matrix::zeros(0, 0),
            f_u: Matrix::zeros(0, 0),
            y_f_uq: Matrix::zeros(0, 0),
            q: filled(S::zero(), nq),
            w: filled(S::zero(), n),
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
        let (mut actuation, mut f_u) = (Matrix::zeros(n, m), Matrix::zeros(self.f.len(), m));
        let y_f_uq = Matrix::zeros(m, self.structure.f_u_depends_on);
        for (i, j) in (0..n).flat_map(|i| (0..m).map(move |j| (i, j))) {
            actuation[(i, j)] = S::from_f64(entry(i, j));
        }
        if self.structure.constant_f_u {
            Places { plain: &self.plain, turns: &self.turns }.drive(&actuation, &mut f_u);
        }
        Self { driven: actuation.clone(), actuation, f_u, y_f_uq, ..self }
    }

    /// Number of entries of q: x has n more, in canonical coordinates as many.
    pub fn nq(&self) -> usize {
        self.nq
    }

    /// Number of degrees of freedom, n.
    pub fn dof(&self) -> usize {
        self.model.dof()
    }

    /// q with unit quaternions, the momenta or rates, and B u.
    fn set(&mut self, x: &[S], u: &[S]) -> Result<(), EvalError> {
        check_length("x", x, self.f.len())?;
        check_length("u", u, self.actuation.columns())?;
        for plain in &self.plain {
            self.q[plain.position] = x[plain.position];
            self.w[plain.coordinate] = x[plain.momentum];
        }
        for turn in &mut self.turns {
            turn.set(x, &mut self.q, &mut self.w);
        }
        for (i, tau) in self.tau.iter_mut().enumerate() {
            let row = self.actuation.row(i).iter().zip(u);
            *tau = row.fold(S::zero(), |sum, (&b, &u)| b.mul_add(u, sum));
        }
        Ok(())
    }
}
