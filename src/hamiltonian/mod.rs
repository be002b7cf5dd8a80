//! The Hamiltonian state equation, its Jacobian and its contracted Hessian.
//!
//! State x = (q, p) with conjugate momentum p = M v. With D the friction and u the actuation of the joints,
//!
//! $$ F^q = M^{-1} p = v, \qquad F^p = L\_q(q, v) + D(v), \qquad \dot x = F(x) + (0, u) \qquad (17), (19) $$
//!
//! The Jacobian, with $P = L\_{vq}$, is
//!
//! $$ F\_x = \begin{pmatrix} -M^{-1} P & M^{-1} \\\\
//! L\_{qq} - P^T M^{-1} P - D\_v M^{-1} P & P^T M^{-1} + D\_v M^{-1} \end{pmatrix}
//! \qquad (21), (22) $$
//!
//! [`Hamiltonian`] computes F, F_x and the adjoint product y'F_x for any scalar, [`HamiltonianSecondOrder`]
//! adds y'F_xx and its product with a vector, and [`FullHessian`] the whole tensor. [`DualPass`] is an
//! alternative for y'F_xx, and works with every route. [`PhaseVelocity`](crate::derivative::PhaseVelocity) is
//! F as a function for automatic differentiation.

mod adjoint;
mod blocked;
mod congruence;
mod conservative;
mod contraction;
mod direction;
mod dual_pass;
mod elimination;
mod free;
mod full;
mod kernels;
mod legendre;
mod linearisation;
mod second_order;
mod state;
mod tensor;
mod world;
mod wrenches;

pub use adjoint::AdjointProduct;
pub use contraction::HamiltonianContraction;
pub use dual_pass::DualPass;
pub use full::FullHessian;
pub use legendre::{MomentumLinearisation, VelocityLinearisation};
pub use linearisation::HamiltonianLinearisation;
pub use second_order::HamiltonianSecondOrder;
pub use tensor::HessianTensor;

use crate::configuration::Brackets;
use crate::error::EvalError;
pub(crate) use crate::kernels::check;
use crate::kernels::{Contracted, LagrangianHessian, Route, check_entries};
use crate::matrix::{Matrix, Panel, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use conservative::Conservative;
use direction::Direction;
pub(crate) use kernels::{FirstKernel, SecondKernel};
use state::StateEquation;

/// Workspace for the Hamiltonian state equation of one robot; no call allocates.
///
/// `R` is the method for the Hessian of the Lagrangian: [`Contracted`] by default, or the paper's
/// [`Christoffel`](crate::tensors::Christoffel).
///
/// Slices q (rad, m), v (rad/s, m/s), p (kg m^2/s, kg m/s) and u (N m, N) have n entries, in the order of
/// [`Robot::independent_joints`]. Every method can fail with [`EvalError::WrongLength`] or
/// [`EvalError::NonFinite`], and with [`EvalError::SingularMassMatrix`] if it inverts the mass matrix.
/// Results are not checked: if a product overflows, they are infinite.
///
/// With floating and spherical joints q has [`Tree::nq`] entries, and F, F_x and y'F_xx are those in the
/// left-trivialised tangent space, 2n: see [`FreeKind`](crate::robot::FreeKind) and
/// [`ConfigurationSpace`](crate::configuration::ConfigurationSpace). What does not take such joints returns
/// [`EvalError::FreeJoint`]; a quaternion whose length is not 1 is [`EvalError::NotUnit`].
///
/// The generalised forces Q(q) of wrenches from outside ([`Robot::with_wrench`]) act as u does: F gains Q,
/// F_x and y'F_xx its derivatives. Robots with floating or spherical joints take none:
/// [`EvalError::FreeJointAndWrench`].
#[derive(Clone, Debug)]
pub struct Hamiltonian<S: Scalar, R: Route = Contracted> {
    tree: Tree,
    flow: Conservative<S, R::Hessian<S>>,
    state: StateEquation<S>,
    direction: Direction<S>,
    inverse: Matrix<S>,
    /// y'F_x.
    product: Vec<S>,
    brackets: Brackets<S>,
}

/// Kinetic and potential energy (J).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Energy<S> {
    /// `1/2 p' M^-1 p`.
    pub kinetic: S,
    /// V: gravity (zero with all masses at the height of the world origin) and springs.
    pub potential: S,
}

impl<S: Scalar> Hamiltonian<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        Self::with_route(tree, Contracted)
    }
}

impl<S: Scalar, R: Route> Hamiltonian<S, R> {
    /// The workspace for another route.
    ///
    /// ```
    /// use costate::{hamiltonian::Hamiltonian, robot::{Robot, Tree}, tensors::Christoffel};
    /// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
    /// let tree = Tree::from(&Robot::from_file("robots/two_link.toml")?);
    /// let mut hamiltonian = Hamiltonian::<f64, _>::with_route(tree, Christoffel);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_route(tree: Tree, _: R) -> Self {
        let n = tree.dof();
        Self {
            flow: Conservative::new(&tree),
            state: StateEquation::new(&tree),
            direction: Direction::new(n),
            inverse: Matrix::zeros(n, n),
            product: filled(S::zero(), 2 * n),
            brackets: Brackets::new(&tree),
            tree,
        }
    }

    /// Number of coordinates, n.
    pub fn dof(&self) -> usize {
        self.tree.dof()
    }

    /// The model.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// `dx/dt = (M^-1 p, L_q + D + u)` (17), (19); length 2n.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn evaluate(&mut self, q: &[S], p: &[S], u: &[S]) -> Result<&[S], EvalError> {
        self.check(&[("q", q), ("p", p), ("u", u)])?;
        self.flow.first_order_alone(&self.tree, [q, p], false)?;
        self.set_rate([q, p, u]);
        Ok(&self.state.f)
    }

    /// F and its Jacobian F_x in x = (q, p) (21)-(24), from one sweep. `F_u = (0; 1)` is constant.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn linearise(
        &mut self,
        q: &[S],
        p: &[S],
        u: &[S],
    ) -> Result<HamiltonianLinearisation<'_, S>, EvalError> {
        self.check(&[("q", q), ("p", p), ("u", u)])?;
        self.prepare([q, p, u])?;
        self.assemble();
        self.add_slopes([q, p]);
        Ok(self.state.linearisation(self.flow.mass_matrix()))
    }

    /// F, and all that F_x and kernel two are made of, in the axes of the world where these take less time.
    fn prepare(&mut self, [q, p, u]: [&[S]; 3]) -> Result<(), EvalError> {
        self.flow.first_order_alone(&self.tree, [q, p], true)?;
        self.flow.second_order(&self.tree);
        self.set_rate([q, p, u]);
        Ok(())
    }

    /// F after the first order.
    fn set_rate(&mut self, [q, p, u]: [&[S]; 3]) {
        self.state.rate_of_change(&self.tree, &self.flow.v, self.flow.l_q(), u);
        self.state.add_wrenches(q);
        self.brackets.add_rate(p, &mut self.state.f);
    }

    /// Assembles F_x without what [`add_slopes`](Self::add_slopes) adds.
    fn assemble(&mut self) {
        if !Panel::<S>::ONE_LANE && self.flow.in_blocks() {
            self.state.assemble_by_blocks(&mut self.flow);
        } else {
            self.state.assemble(&self.tree, &self.flow);
        }
    }

    /// Adds the derivatives of friction, wrenches and brackets to F_x.
    fn add_slopes(&mut self, [q, p]: [&[S]; 2]) {
        self.state.add_slopes(&self.tree);
        self.state.add_wrench_slopes(q);
        self.brackets.add_slopes([p, &self.flow.v, self.flow.l_q()], &mut self.state.f_x);
    }

    /// Kinetic and potential energy (J); their sum is H(q, p).
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn energy(&mut self, q: &[S], p: &[S]) -> Result<Energy<S>, EvalError> {
        self.check(&[("q", q), ("p", p)])?;
        self.flow.solve_velocity(&self.tree, q, p)?;
        let twice = self.flow.v.iter().zip(p).fold(S::zero(), |sum, (&v, &p)| sum + v * p);
        Ok(Energy { kinetic: twice.times(0.5), potential: self.flow.kernel.potential(&self.tree, q)? })
    }

    /// `H(q, p) = 1/2 p' M^-1 p + V(q)` (J).
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn hamiltonian(&mut self, q: &[S], p: &[S]) -> Result<S, EvalError> {
        self.energy(q, p).map(|energy| energy.kinetic + energy.potential)
    }

    /// Potential energy V(q) (J): gravity and springs.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn potential(&mut self, q: &[S]) -> Result<S, EvalError> {
        self.check(&[("q", q)])?;
        self.flow.kernel.body.set_position(&self.tree, q)?;
        Ok(self.flow.kernel.body.potential(&self.tree))
    }

    /// Mass matrix M(q), armature included, n x n.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn mass_matrix(&mut self, q: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.check(&[("q", q)])?;
        self.flow.kernel.set_mass_matrix(&self.tree, q)?;
        Ok(self.flow.mass_matrix())
    }

    /// `M^-1`, n x n, exactly symmetric.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn inverse_mass_matrix(&mut self, q: &[S]) -> Result<&Matrix<S>, EvalError> {
        self.check(&[("q", q)])?;
        self.flow.factor_alone(&self.tree, q)?;
        self.flow.factor.inverse(&mut self.inverse);
        Ok(&self.inverse)
    }

    /// `x <- M^-1 x`, length n.
    ///
    /// # Errors
    /// See [`Hamiltonian`].
    pub fn solve_mass_matrix(&mut self, q: &[S], x: &mut [S]) -> Result<(), EvalError> {
        self.check(&[("q", q), ("x", x)])?;
        self.flow.factor_alone(&self.tree, q)?;
        self.flow.factor.solve(x);
        Ok(())
    }

    /// Every argument has n finite entries, positions nq.
    fn check(&self, arguments: &[(&'static str, &[S])]) -> Result<(), EvalError> {
        let (tree, n) = (&self.tree, self.tree.dof());
        if tree.free().is_empty() {
            return arguments.iter().try_for_each(|&(what, values)| check(tree, what, values, n));
        }
        if !R::Hessian::<S>::FREE_JOINTS {
            tree.refuse_free()?;
        }
        tree.refuse_free_and_wrench()?;
        arguments.iter().try_for_each(|&(what, values)| match what {
            "q" => tree.check_configuration(values),
            _ => check_entries(tree, what, values, n),
        })
    }
}
