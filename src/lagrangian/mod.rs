//! The Lagrangian state equation: inverse and forward dynamics, their Jacobians and contracted Hessians.
//!
//! State x = (q, v). With `L = 1/2 v' M v - V`, D the friction and u the actuation of the joints,
//!
//! $$ M(q) a + C(q, v) v + g(q) = u + D(v), \qquad \dot x = (v, a) \qquad (9) $$
//!
//! The Jacobian of forward dynamics follows from that of inverse dynamics, $\tau(q, v, a)$:
//!
//! $$ a\_q = -M^{-1} \tau\_q, \qquad a\_v = -M^{-1} \tau\_v, \qquad a\_u = M^{-1} $$
//!
//! M is the mass matrix with armature, C the Coriolis matrix, `g = V_q` the force of gravity and springs.
//! Friction opposes the motion: D is negative where v is positive. Inverse dynamics computes u, forward
//! dynamics a. [`Lagrangian`] computes both with their Jacobians for any scalar, [`LagrangianSecondOrder`]
//! adds contracted Hessians, [`LegendreTransform`] converts between (q, v) and (q, p);
//! [`ForwardDynamics`](crate::derivative::ForwardDynamics) is a(q, v, u) as a function for automatic
//! differentiation.

mod adjoint;
mod blocked;
mod chain_rule;
mod choice;
mod contraction;
mod coriolis;
mod dual_pass;
mod dynamics;
mod forward;
#[cfg(test)]
mod free_tests;
mod hessian_product;
mod inverse;
mod legendre_transform;
mod newton_euler;
mod products;
mod routes;
mod second_order;
mod wrenches;

pub use contraction::{InverseDynamicsContraction, LagrangianContraction, whole_hessian};
pub use forward::{ForwardDynamicsLinearisation, StateLinearisation};
pub use inverse::InverseDynamicsLinearisation;
pub use legendre_transform::LegendreTransform;
pub use second_order::LagrangianSecondOrder;

use crate::error::EvalError;
use crate::kernels::{ArticulatedBodies, Factor, KernelOne, KernelTwo, WorldKernel, check_entries};
use crate::kinematics::ExternalForces;
use crate::matrix::{Matrix, Panel, filled};
use crate::robot::{Robot, Tree};
use crate::scalar::Scalar;
use blocked::Blocked;
use choice::Routes;
use newton_euler::NewtonEuler;

/// Workspace for the Lagrangian state equation of one robot; no call allocates.
///
/// Slices q (rad, m), v (rad/s, m/s), a (rad/s^2, m/s^2) and u, tau (N m, N) have n entries, in the order of
/// [`Robot::independent_joints`]. Every method can fail with [`EvalError::WrongLength`] or
/// [`EvalError::NonFinite`], and with [`EvalError::SingularMassMatrix`] if it inverts the mass matrix.
/// Results are not checked: if a product overflows, they are infinite.
///
/// With floating and spherical joints q has [`Tree::nq`] entries, and derivatives by q are those in the
/// left-trivialised tangent space: see [`FreeKind`](crate::robot::FreeKind). The Coriolis matrix, the rate of
/// M and [`LegendreTransform`] take no such joints: [`EvalError::FreeJoint`].
///
/// The generalised forces Q(q) of wrenches from outside ([`Robot::with_wrench`]) act as u does, with all
/// their derivatives: inverse dynamics subtracts them, forward dynamics adds them. Robots with floating or
/// spherical joints take none: [`EvalError::FreeJointAndWrench`].
///
/// ```
/// use costate::lagrangian::Lagrangian;
/// use costate::robot::Robot;
///
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let mut lagrangian = Lagrangian::<f64>::new(&robot);
/// let (q, v, a) = ([0.3, -0.8], [1.0, 0.5], [0.2, -4.0]);
/// let tau = lagrangian.inverse_dynamics(&q, &v, &a)?.to_vec();
/// let linear = lagrangian.linearise_forward_dynamics(&q, &v, &tau)?;
/// assert!((linear.acceleration()[1] + 4.0).abs() < 1e-12);
/// println!("da/dq = {}", linear.a_q().as_nalgebra());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Lagrangian<S: Scalar> {
    tree: Tree,
    kernel: KernelOne<S>,
    along: KernelTwo<S>,
    routes: Routes,
    /// The dynamics in the axes of the world, where a route needs them.
    world: Option<WorldKernel<S>>,
    /// Forward dynamics in O(n), where that is faster.
    bodies: Option<ArticulatedBodies<S>>,
    factor: Factor<S>,
    newton_euler: NewtonEuler<S>,
    zero: Vec<S>,
    tau: Vec<S>,
    tau_q: Matrix<S>,
    tau_v: Matrix<S>,
    coriolis: Matrix<S>,
    /// `(v, a)`, 2n.
    rate: Vec<S>,
    inverse: Panel<S>,
    /// tau_q and tau_v as panels, and the same times M^-1 (where a_z is computed block by block, one row).
    torque: [Panel<S>; 2],
    solved: [Panel<S>; 2],
    /// How a_z is computed block by block, where it is.
    blocked: Option<Box<Blocked<S>>>,
    /// `[a_q, a_v, a_u]`, n x 3n.
    a_z: Matrix<S>,
    /// `[0 1 ; a_q a_v]`, 2n x 2n.
    f_x: Matrix<S>,
    /// `[0 ; M^-1]`, 2n x n.
    f_u: Matrix<S>,
    /// Wrenches from outside, if the robot has any.
    external: Option<Box<ExternalForces<S>>>,
}

impl<S: Scalar> Lagrangian<S> {
    /// Builds the workspace. Later calls do not allocate.
    pub fn new(robot: &Robot) -> Self {
        Self::from_tree(Tree::from(robot))
    }

    /// As [`new`](Self::new), from an existing [`Tree`].
    pub fn from_tree(tree: Tree) -> Self {
        Self::as_numbers::<S>(tree)
    }

    /// As [`from_tree`](Self::from_tree), by the algorithms that numbers of type T take.
    pub(crate) fn as_numbers<T: Scalar>(tree: Tree) -> Self {
        Self::with_routes(Routes::of::<T>(&tree), tree)
    }

    /// As [`from_tree`](Self::from_tree), by these algorithms.
    #[inline(never)]
    fn with_routes(routes: Routes, tree: Tree) -> Self {
        let n = tree.dof();
        let square = Matrix::zeros(n, n);
        let panels = |rows: usize| [Panel::zeros(rows, n), Panel::zeros(rows, n)];
        // Block by block, a_z needs neither M^-1 nor more than a row of products.
        let in_blocks = Panel::<S>::in_blocks(n);
        let (inverse, solved) = if in_blocks { (0, 1) } else { (n, n) };
        let factor = Factor::new(&tree);
        let mut f_x = Matrix::zeros(2 * n, 2 * n);
        (0..n).for_each(|i| f_x[(i, n + i)] = S::one());
        Self {
            kernel: KernelOne::new(&tree),
            along: KernelTwo::new(&tree),
            routes,
            world: routes.world().then(|| WorldKernel::new(&tree)),
            bodies: routes.bodies.then(|| ArticulatedBodies::new(&tree)),
            newton_euler: NewtonEuler::new(&tree),
            zero: filled(S::zero(), n),
            tau: filled(S::zero(), n),
            tau_q: square.clone(),
            tau_v: square.clone(),
            coriolis: square,
            rate: filled(S::zero(), 2 * n),
            inverse: Panel::zeros(inverse, inverse),
            solved: panels(solved),
            torque: panels(n),
            blocked: Panel::<S>::for_blocks(n, || Blocked::new(&factor)),
            factor,
            a_z: Matrix::zeros(n, 3 * n),
            f_x,
            f_u: Matrix::zeros(2 * n, n),
            external: ExternalForces::where_any(&tree),
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

    /// q is a configuration, and every other argument has n finite entries.
    fn check(&self, q: &[S], others: &[(&'static str, &[S])]) -> Result<(), EvalError> {
        self.tree.refuse_constraints()?;
        self.tree.refuse_free_and_wrench()?;
        self.tree.check_configuration(q)?;
        let n = self.tree.dof();
        others.iter().try_for_each(|&(what, values)| check_entries(&self.tree, what, values, n))
    }

    /// The same of what takes no floating or spherical joints.
    fn check_plain(&self, q: &[S], others: &[(&'static str, &[S])]) -> Result<(), EvalError> {
        self.tree.refuse_free()?;
        self.check(q, others)
    }
}
