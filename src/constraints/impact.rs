//! Constraints that set in: inelastic impacts, landing and release.

use super::blocks::Moving;
use super::lagrangian_rows::add_forces;
use super::{ConstrainedHamiltonian, ConstrainedHamiltonianSecondOrder};
use crate::error::{EvalError, check_length};
use crate::matrix::{Block, Matrix, add_scaled, filled};
use crate::robot::Robot;
use crate::scalar::Scalar;

/// Workspace for inelastic impacts of one robot: what its constraints do at the instant at which they set in;
/// no call allocates.
///
/// At an impact the position stays, and impulses Lambda of the constraints change the velocity so that they
/// are satisfied after it, without a rebound:
///
/// $$ M v^+ = M v^- + J^T \Lambda, \qquad J v^+ = 0 $$
///
/// This is the constrained Legendre transform at the same (q, p): with `p = M v-` it gives v+, and its
/// multiplier is Lambda. In the state (q, p) of [`ConstrainedHamiltonian`] an impact is therefore no jump:
/// the Hamiltonian changes from H to H_c, and q, p and, unless the instant itself is free, the costates are
/// continuous. What jumps are v, and the momentum in the form in which the multiplier is zero,
///
/// $$ p^+ = M v^+ = p + J^T \mu(q, p) $$
///
/// the same map as the release of constraints: before some of them are let go, p becomes p+, since otherwise
/// the impulses they have given would be lost. Constraints that hold before the impact and stay are part of
/// the robot too: p with what they have given so far leads to the same v+ and p+ as M v-.
///
/// The loss of energy is `(v- - v+)' M (v- - v+) / 2 = Lambda' (J M^-1 J') Lambda / 2`, and is never
/// negative.
///
/// Slices q (rad, m) and p (kg m^2/s, kg m/s) have n entries, Lambda has k (N s, N m s). Every method can
/// fail as those of [`ConstrainedHamiltonian`]. With floating and spherical joints q has nq entries, and
/// derivatives are those in the tangent space. Impulses of rows that depend on others are zero.
///
/// ```
/// use costate::constraints::Impact;
/// use costate::hamiltonian::Hamiltonian;
/// use costate::robot::{ConstraintSpec, Placement, Robot};
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let arm = Robot::from_file("robots/two_link.toml")?;
/// let p = Hamiltonian::<f64>::new(&arm).momentum(&[0.3, -0.8], &[1.0, 0.5])?.to_vec();
/// // The tip gets stuck.
/// let tip = Placement::from_xyz_rpy([1.0, 0.0, 0.0], [0.0; 3]);
/// let caught = arm.with_constraint(ConstraintSpec::pinned("tip", "elbow", "world").placed(tip))?;
/// let mut impact = Impact::<f64>::new(&caught);
/// let after = impact.evaluate(&[0.3, -0.8], &p)?;
/// println!("impulse {:?} N s, {} J are lost", after.impulse, after.loss);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Impact<S: Scalar> {
    second: ConstrainedHamiltonianSecondOrder<S>,
    /// The rows with the impulses, along a direction.
    held: Moving<S>,
    momentum: Vec<S>,
    weights: Vec<S>,
    p_x: Matrix<S>,
    xx: Matrix<S>,
}

/// The state after an impact; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct AfterImpact<'a, S> {
    /// v+, n, with `J v+ = 0`.
    pub velocity: &'a [S],
    /// `p+ = M v+ = p + J'Lambda`, n.
    pub momentum: &'a [S],
    /// Lambda, k: what the constraints give at this instant, on the joints as `J'Lambda`; in axes of their
    /// second frames, on the links of their first ones (N s, N m s).
    pub impulse: &'a [S],
    /// Energy that is lost (J), if `p = M v-`.
    pub loss: S,
}

/// An impact and its Jacobians in x = (q, p), the state before it; borrowed from the workspace.
#[derive(Clone, Copy, Debug)]
pub struct ImpactLinearisation<'a, S> {
    /// The state after it.
    pub after: AfterImpact<'a, S>,
    v_x: Block<'a, S>,
    p_x: &'a Matrix<S>,
    impulse_x: &'a Matrix<S>,
}

impl<'a, S: Scalar> ImpactLinearisation<'a, S> {
    /// dv+/dx, n x 2n.
    pub fn velocity_x(&self) -> Block<'a, S> {
        self.v_x
    }

    /// dp+/dx, n x 2n.
    pub fn momentum_x(&self) -> Block<'a, S> {
        self.p_x.view()
    }

    /// dLambda/dx, k x 2n.
    pub fn impulse_x(&self) -> Block<'a, S> {
        self.impulse_x.view()
    }
}

/// Weights of what is differentiated twice.
#[derive(Clone, Copy, Debug)]
pub struct ImpactWeights<'a, S> {
    /// Of v+, n.
    pub velocity: &'a [S],
    /// Of p+, n: the costate after a release.
    pub momentum: &'a [S],
    /// Of Lambda, k.
    pub impulse: &'a [S],
}

impl<S: Scalar> Impact<S> {
    /// Builds the workspace for a robot with the constraints that hold after the impact. Later calls do not
    /// allocate.
    pub fn new(robot: &Robot) -> Self {
        let second = ConstrainedHamiltonianSecondOrder::<S>::new(robot);
        let (n, k) = (second.dof(), second.constrained().mu.len());
        Self {
            held: second.constrained().moving.clone(),
            momentum: filled(S::zero(), n),
            weights: filled(S::zero(), k),
            p_x: Matrix::zeros(n, 2 * n),
            xx: Matrix::zeros(2 * n, 2 * n),
            second,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.second.dof()
    }

    /// The workspace of the state equation after the impact.
    pub fn hamiltonian(&mut self) -> &mut ConstrainedHamiltonian<S> {
        self.second.first()
    }

    /// v+, p+, Lambda and the loss.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn evaluate(&mut self, q: &[S], p: &[S]) -> Result<AfterImpact<'_, S>, EvalError> {
        self.second.first().velocity(q, p)?;
        self.finish(p);
        Ok(self.after())
    }

    /// The same, with its Jacobians in x = (q, p): those of `ConstrainedHamiltonian` for v+ and Lambda, and
    /// `p+_x = (0, 1) + ((Lambda . J)_q, 0) + J' Lambda_x`.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn linearise(&mut self, q: &[S], p: &[S]) -> Result<ImpactLinearisation<'_, S>, EvalError> {
        self.second.first().linearise_velocity(q, p)?;
        self.finish(p);
        self.differentiate();
        let first = self.second.constrained();
        let (v_x, impulse_x) = (first.velocity_x(), &first.mu_x);
        Ok(ImpactLinearisation { after: self.after(), v_x, p_x: &self.p_x, impulse_x })
    }

    /// `sum of weights times d2 (v+, p+, Lambda) / dx dx`, 2n x 2n, symmetric, x = (q, p).
    ///
    /// With y the weights of p+, `y . p+ = y . p + Lambda . J y`, so that its Hessian is that of `(J y) .
    /// Lambda` for constant J y, with `(Lambda . J y)_qq` and products of `(J y)_q` and Lambda_x.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`]; [`EvalError::WrongLength`] for weights of other lengths.
    pub fn contract(
        &mut self,
        q: &[S],
        p: &[S],
        weights: ImpactWeights<'_, S>,
    ) -> Result<&Matrix<S>, EvalError> {
        let (n, y) = (self.dof(), weights.momentum);
        check_length("velocity", weights.velocity, n)?;
        check_length("momentum", y, n)?;
        check_length("impulse", weights.impulse, self.weights.len())?;
        self.second.first().constraint_rate(q, y)?;
        let rate = self.second.constrained().drift.iter();
        for (to, (&c, &rate)) in self.weights.iter_mut().zip(weights.impulse.iter().zip(rate)) {
            *to = c + rate;
        }
        let xx = self.second.velocity_hessian(q, p, weights.velocity, &self.weights)?;
        self.xx.copy_from(xx);
        let ConstrainedHamiltonian { mu, mu_x, .. } = self.second.constrained();
        self.held.place(q, y, mu);
        for i in 0..n {
            add_scaled(&mut self.xx.row_mut(i)[..n], S::one(), self.held.blocks.bend.row(i));
        }
        for (l, slope) in (0..mu.len()).map(|l| (l, self.held.blocks.slope.row(l))) {
            for (i, &slope) in slope.iter().enumerate() {
                for (j, &along) in mu_x.row(l).iter().enumerate() {
                    self.xx[(i, j)] += slope * along;
                    self.xx[(j, i)] += slope * along;
                }
            }
        }
        Ok(&self.xx)
    }

    /// p+, after v+ and Lambda.
    fn finish(&mut self, p: &[S]) {
        let first = self.second.constrained();
        self.momentum.copy_from_slice(p);
        add_forces(&first.rows, &first.mu, &mut self.momentum);
    }

    fn after(&self) -> AfterImpact<'_, S> {
        let first = self.second.constrained();
        let loss = first.kkt.square(&first.mu).times(0.5);
        AfterImpact { velocity: &first.v, momentum: &self.momentum, impulse: &first.mu, loss }
    }

    /// `p+_x`.
    fn differentiate(&mut self) {
        let n = self.dof();
        let ConstrainedHamiltonian { rows, moving, mu_x, .. } = self.second.constrained();
        self.p_x.fill_zero();
        for i in 0..n {
            self.p_x.row_mut(i)[..n].copy_from_slice(moving.blocks.curvature.row(i));
        }
        for i in 0..n {
            let row = self.p_x.row_mut(i);
            row[n + i] += S::one();
            for l in 0..mu_x.rows() {
                add_scaled(row, rows.jacobian()[(l, i)], mu_x.row(l));
            }
        }
    }
}
