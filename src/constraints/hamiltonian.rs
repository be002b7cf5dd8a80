//! The constrained state equation, its Jacobian and adjoint product.

use super::Constraints;
use super::blocks::Moving;
use super::elimination::Elimination;
use super::kkt::Kkt;
use super::linearisation::{ConstrainedAdjoint, ConstrainedLinearisation, ConstrainedRate};
use super::position::check_position;
use crate::configuration::Brackets;
use crate::error::EvalError;
use crate::hamiltonian::FirstKernel;
use crate::kernels::{Factor, FrictionDerivatives, KernelOne, check_entries};
use crate::kinematics::ExternalForces;
use crate::matrix::{Matrix, Panel, add_scaled, dot, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;

/// Workspace for the Hamiltonian state equation of a robot with holonomic constraints; no call allocates but
/// [`close`](Self::close), [`project`](Self::project) and [`singular_row`](Self::singular_row).
///
/// With k rows g(q), `J = g_q` and the multipliers mu, the constrained Legendre transform
///
/// $$ H\_c(q, p) = \operatorname{ext}\_{v, \mu} \; p \cdot v - L(q, v) + \mu \cdot J v
/// \quad\Rightarrow\quad p = M v - J^T \mu, \qquad J v = 0 $$
///
/// defines H_c for all (q, p). Its state equation is one of 2n entries without constraints,
///
/// $$ F = (v, \; L\_q - (\mu \cdot J v)\_q + D(v)), \qquad \dot x = F(x) + (0, u) $$
///
/// along which g stays what it is at the start. A start at rest or in motion is `p = M v` with `J v = 0`
/// ([`momentum`](Self::momentum)): then mu = 0. From there mu is the impulse of the constraints, its rate
/// lambda their forces, and `p + J'kappa` means the same motion for every kappa. With
/// `MM = (M, -J'; -J, 0)` and `PP = (P - (mu . J)_q ; -(J v)_q)`,
///
/// $$ \begin{pmatrix} v \\\\ \mu \end{pmatrix}\_{\! x} = MM^{-1} \begin{pmatrix} -PP & (1; 0) \end{pmatrix},
/// \qquad F^p\_q = L\_{qq} - (\mu \cdot J v)\_{qq} - PP^T MM^{-1} PP, \qquad F^p\_p = -(F^q\_q)^T $$
///
/// without friction: J F_x is symmetric.
///
/// Slices q (rad, m), v (rad/s, m/s), p (kg m^2/s, kg m/s), u (N m, N) have n entries, in the order of
/// [`Robot::independent_joints`]. Every method can fail with [`EvalError::WrongLength`],
/// [`EvalError::NonFinite`], [`EvalError::SingularMassMatrix`]. Rows that depend on others are left out: see
/// [`rank`](Self::rank). With floating and spherical joints q has [`Tree::nq`] entries, and F, F_x, y'F_xx
/// and mu_x are those in the left-trivialised tangent space, as in
/// [`Hamiltonian`](crate::hamiltonian::Hamiltonian).
/// Without constraints the results are those of [`Hamiltonian`](crate::hamiltonian::Hamiltonian).
///
/// ```
/// use costate::constraints::ConstrainedHamiltonian;
/// use costate::robot::Robot;
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let four_bar = Robot::from_file("robots/four_bar.toml")?;
/// let mut hamiltonian = ConstrainedHamiltonian::<f64>::new(&four_bar);
/// let mut q = [1.0, -0.6, -2.0];
/// hamiltonian.close(&mut q, &[true, false, false])?; // the crank stays
/// let p = [0.0; 3]; // at rest
/// let all = hamiltonian.linearise(&q, &p, &[2.0, 0.0, 0.0])?;
/// println!("accelerations {:?}, force of the pivot {:?} N", all.acceleration(), all.lambda());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct ConstrainedHamiltonian<S: Scalar> {
    pub(super) tree: Tree,
    pub(super) kernel: FirstKernel<S, KernelOne<S>>,
    pub(super) factor: Factor<S>,
    pub(super) rows: Constraints<S>,
    pub(super) moving: Moving<S>,
    pub(super) kkt: Kkt<S>,
    /// F_x block by block, where it is computed so.
    pub(super) elimination: Option<Box<Elimination<S>>>,
    pub(super) v: Vec<S>,
    pub(super) mu: Vec<S>,
    /// Directions (w_q, w_p), and the changes of v and mu along them.
    pub(super) direction: [Vec<S>; 2],
    pub(super) change: [Vec<S>; 2],
    /// `P - (mu . J)_q`.
    pub(super) cross: Matrix<S>,
    pub(super) friction: Vec<FrictionDerivatives<S>>,
    pub(super) external: Option<Box<ExternalForces<S>>>,
    pub(super) f: Vec<S>,
    pub(super) f_x: Matrix<S>,
    /// mu_x, k x 2n.
    pub(super) mu_x: Matrix<S>,
    pub(super) f_u: Matrix<S>,
    pub(super) product: Vec<S>,
    pub(super) brackets: Brackets<S>,
    /// `L_q - (mu . J v)_q`.
    pub(super) l_q: Vec<S>,
    /// Acceleration and lambda.
    pub(super) rates: [Vec<S>; 2],
    pub(super) drift: Vec<S>,
}

impl<S: Scalar> ConstrainedHamiltonian<S> {
    /// Builds the workspace. Later calls do not allocate, but for searches of positions.
    pub fn new(robot: &Robot) -> Self {
        let tree = Tree::from(robot);
        let rows = Constraints::from_tree(&tree);
        let (n, k) = (tree.dof(), rows.count());
        let none = FrictionDerivatives { value: S::zero(), first: S::zero(), second: S::zero() };
        let (zeros, multipliers) = (filled(S::zero(), n), filled(S::zero(), k));
        let mut f_u = Matrix::zeros(2 * n, n);
        (0..n).for_each(|i| f_u[(n + i, i)] = S::one());
        let factor = Factor::new(&tree);
        Self {
            kernel: FirstKernel::new(&tree),
            elimination: Panel::<S>::for_blocks(n, || Elimination::new(&factor, rows.pattern())),
            factor,
            rows,
            moving: Moving::new(&tree),
            kkt: Kkt::new(n, k),
            v: zeros.clone(),
            mu: multipliers.clone(),
            direction: [zeros.clone(), zeros.clone()],
            change: [zeros.clone(), multipliers.clone()],
            cross: Matrix::zeros(n, n),
            friction: filled(none, n),
            external: ExternalForces::where_any(&tree),
            f: filled(S::zero(), 2 * n),
            f_x: Matrix::zeros(2 * n, 2 * n),
            mu_x: Matrix::zeros(k, 2 * n),
            f_u,
            product: filled(S::zero(), 2 * n),
            brackets: Brackets::new(&tree),
            l_q: zeros.clone(),
            rates: [zeros, multipliers.clone()],
            drift: multipliers,
            tree,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.tree.dof()
    }

    /// The constraints, at the position of the last call.
    pub fn constraints(&self) -> &Constraints<S> {
        &self.rows
    }

    /// `dx/dt = F + (0, u)`, 2n, with v and mu.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn evaluate(&mut self, q: &[S], p: &[S], u: &[S]) -> Result<ConstrainedRate<'_, S>, EvalError> {
        self.check(&[("q", q), ("p", p), ("u", u)])?;
        self.first_order(q, p)?;
        self.l_q.copy_from_slice(self.kernel.l_q());
        let curvature = self.rows.contract(&self.mu);
        for (j, &v) in self.v.iter().enumerate() {
            add_scaled(&mut self.l_q, -v, curvature.row(j));
        }
        self.add_outer_forces([q, p, u]);
        Ok(ConstrainedRate { f: &self.f, mu: &self.mu })
    }

    /// F and F_x, the accelerations and the forces of the constraints, from one sweep.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn linearise(
        &mut self,
        q: &[S],
        p: &[S],
        u: &[S],
    ) -> Result<ConstrainedLinearisation<'_, S>, EvalError> {
        self.check(&[("q", q), ("p", p), ("u", u)])?;
        self.prepare_alone(q, p)?;
        self.assemble([q, p, u]);
        Ok(self.linearisation())
    }

    /// F and y'F_x for the costate y = (y_q, y_p) of length 2n, without F_x.
    ///
    /// # Errors
    /// See [`ConstrainedHamiltonian`].
    pub fn adjoint(
        &mut self,
        q: &[S],
        p: &[S],
        u: &[S],
        y: &[S],
    ) -> Result<ConstrainedAdjoint<'_, S>, EvalError> {
        let n = self.dof();
        self.check(&[("q", q), ("p", p), ("u", u)])?;
        check_entries(&self.tree, "y", y, 2 * n)?;
        if !self.tree.free().is_empty() {
            self.linearise(q, p, u)?;
            self.product.fill(S::zero());
            y.iter().zip(0..).for_each(|(&y, i)| add_scaled(&mut self.product, y, self.f_x.row(i)));
            return Ok(ConstrainedAdjoint { f: &self.f, y_f_x: &self.product });
        }
        self.prepare(q, p)?;
        self.rate([q, p, u]);
        self.set_costate(p, y);
        let Self { kernel, moving, cross, direction: [w_q, _], change: [dv, dmu], product, .. } = self;
        let (product_q, product_p) = product.split_at_mut(n);
        product_p.copy_from_slice(dv);
        for (i, entry) in product_q.iter_mut().enumerate() {
            *entry = dot(moving.blocks.bend.row(i), w_q) - dot(kernel.body.l_qq().row(i), w_q);
        }
        dv.iter().enumerate().for_each(|(i, &dv)| add_scaled(product_q, -dv, cross.row(i)));
        dmu.iter().enumerate().for_each(|(i, &dmu)| add_scaled(product_q, dmu, moving.blocks.slope.row(i)));
        if let Some(external) = &mut self.external {
            let slopes = external.slopes(q);
            y[n..].iter().enumerate().for_each(|(i, &y)| add_scaled(product_q, y, slopes.row(i)));
        }
        Ok(ConstrainedAdjoint { f: &self.f, y_f_x: &self.product })
    }

    /// Every argument has n finite entries, positions nq.
    pub(super) fn check(&self, arguments: &[(&'static str, &[S])]) -> Result<(), EvalError> {
        self.tree.refuse_free_and_wrench()?;
        let n = self.dof();
        arguments.iter().try_for_each(|&(what, values)| match what {
            "q" | "q_0" => check_position(&self.tree, what, values),
            _ => check_entries(&self.tree, what, values, n),
        })
    }
}
