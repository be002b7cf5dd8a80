//! How many operations each quantity takes by each method.

// `#[inline]` in this file: compiled where it is used, with all instances of the pipeline that it needs, not
// by everyone who builds the library.

use super::called::ByCalls;
use super::function::DerivativeError;
use super::{CHUNK, Hessian, Jacobian, NestedHessian, PhaseVelocity};
use crate::configuration::ConfigurationSpace;
use crate::error::EvalError;
use crate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use crate::kernels::{Contracted, Route};
use crate::robot::{Robot, Tree};
use crate::scalar::{Constants, Count, Operations, count_with};
use crate::tensors::Christoffel;

/// Operations of M, F, F_x and y'F_xx of one robot, each with all that it needs, by every method.
///
/// | quantity | what is evaluated | tensors, analytic | dual | hyperdual |
/// |---|---|---|---|---|
/// | `mass_matrix` | M(q) | by that method | as analytic | as analytic |
/// | `f` | F | by that method | as analytic | as analytic |
/// | `f_x` | F and F_x | by hand | [`Jacobian`] of F | [`Hessian`] of F, which gives all second derivatives |
/// | `y_f_xx` | F, F_x and y'F_xx | one dual pass through F_x; 2n+1 rule | and [`NestedHessian`] of F | and contracted with y |
///
/// After these come quantities of some methods only, see [`MORE`](Self::MORE).
///
/// The pipeline itself runs on [`Count`] numbers; q, p and y are variables. So is u in what is derived by
/// hand; automatic differentiation lifts it as a constant like any other number, which is the same but where
/// it meets a force that is a constant too. M and F are evaluated as the library does, with what the same
/// stage finds for the stages after it. Dual numbers carry [`CHUNK`] derivatives at once. The counts do not
/// depend on the state.
///
/// With floating and spherical joints derivatives are those in the tangent space: automatic differentiation
/// evaluates F at q (+) d, by d at d = 0. Methods that take no such joints are not counted: tensors, the dual
/// pass and the whole tensor by hand.
///
/// ```
/// use costate::derivative::OperationTable;
/// use costate::{robot::Robot, scalar::Constants};
/// # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
/// let table = OperationTable::new(&Robot::from_file("robots/ur5.urdf")?, Constants::Folded)?;
/// for row in table.rows() {
///     println!("{} by {}: {} multiplications", row.quantity, row.route, row.operations.mul);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OperationTable {
    /// By quantity, then by method; `None` where it was not counted.
    counts: [[Option<Operations>; 4]; 4],
    /// In the order of [`Self::MORE`].
    more: [Option<Operations>; 5],
}

/// One quantity by one method, see [`OperationTable`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct OperationRow {
    /// One of [`OperationTable::QUANTITIES`] or [`OperationTable::MORE`].
    pub quantity: &'static str,
    /// One of [`OperationTable::ROUTES`] or [`OperationTable::MORE`].
    pub route: &'static str,
    /// What it takes.
    pub operations: Operations,
}

/// Where the operations are counted; they must not depend on it.
struct State {
    /// Positions, nq.
    q: Vec<Count>,
    /// (q, p), 2n; with quaternions (d, p), d = 0.
    x: Vec<Count>,
    /// Actuation, n.
    u: Vec<Count>,
    /// Costate, 2n.
    y: Vec<Count>,
}

impl State {
    fn new(robot: &Robot, number: impl Fn(usize) -> f64) -> Self {
        let n = robot.dof();
        let is_direction = |i: usize| i < n && !robot.free_joints().is_empty();
        let number_at = |i| if is_direction(i) { 0.0 } else { number(i) };
        let mut all = (0..5 * n).map(|i| Count::variable(number_at(i)));
        let mut take = |count: usize| all.by_ref().take(count).collect();
        let q = (0..robot.nq()).map(|i| Count::variable(number(i))).collect();
        Self { q, x: take(2 * n), u: take(n), y: take(2 * n) }
    }
}

impl OperationTable {
    /// The quantities, in the order of the rows.
    pub const QUANTITIES: [&'static str; 4] = ["mass_matrix", "f", "f_x", "y_f_xx"];

    /// The methods, in the order of the rows of one quantity.
    pub const ROUTES: [&'static str; 4] = ["tensors", "analytic", "dual", "hyperdual"];

    /// Quantities of some methods only, as (quantity, method): `y_f_x` is F and y'F_x, `y_f_xx_d` a product
    /// y'F_xx d, both without the matrix; `f_xx` F_x and the whole tensor; `dual pass` the one dual number
    /// through the analytic F_x.
    pub const MORE: [(&'static str, &'static str); 5] = [
        ("y_f_xx", "dual pass"),
        ("y_f_x", "analytic"),
        ("y_f_xx_d", "analytic"),
        ("f_xx", "analytic"),
        ("f_xx", "hyperdual"),
    ];

    /// Counts everything, by running it.
    ///
    /// # Errors
    /// [`EvalError::FreeJointAndWrench`] of robots with floating or spherical joints; no other: `Count`
    /// values are not checked.
    #[inline]
    pub fn new(robot: &Robot, constants: Constants) -> Result<Self, DerivativeError<EvalError>> {
        Self::counted_at(robot, constants, &|i| (1.0 + i as f64).sqrt())
    }

    /// The same at another state: `number(i)` for entry i of (q, p, u, y). For tests, which want the counts
    /// of all states to be the same.
    ///
    /// # Errors
    /// As for [`Self::new`].
    #[doc(hidden)]
    #[inline]
    pub fn counted_at(
        robot: &Robot,
        constants: Constants,
        number: &dyn Fn(usize) -> f64,
    ) -> Result<Self, DerivativeError<EvalError>> {
        let state = State::new(robot, number);
        let automatic = automatic(robot, constants, &state)?.map(|counts| counts.map(Some));
        Ok(Self::at(robot, constants, &state, automatic)?)
    }

    /// The rows of [`Self::new`] without derivatives by dual and hyper-dual numbers, whose operations grow
    /// with n^2 times those of F: counting them for a humanoid takes minutes.
    ///
    /// # Errors
    /// As for [`Self::new`].
    #[inline]
    pub fn by_hand(robot: &Robot, constants: Constants) -> Result<Self, EvalError> {
        let state = State::new(robot, |i| (1.0 + i as f64).sqrt());
        Self::at(robot, constants, &state, [[None; 2]; 2])
    }

    /// With F_x and y'F_xx by dual, then by hyper-dual numbers.
    #[inline]
    fn at(
        robot: &Robot,
        constants: Constants,
        state: &State,
        [dual, hyperdual]: [[Option<Operations>; 2]; 2],
    ) -> Result<Self, EvalError> {
        let tree = Tree::from(robot);
        let is_plain = tree.free().is_empty();
        let tensors = if is_plain { by_dual_pass(&tree, Christoffel, constants, state)? } else { [None; 4] };
        let [mass_matrix, f, f_x, dual_pass] = by_dual_pass(&tree, Contracted, constants, state)?;
        let [y_f_xx, y_f_x, y_f_xx_d, f_xx] = by_rule(&tree, constants, state)?;
        let by_route = [
            tensors,
            [mass_matrix, f, f_x, y_f_xx],
            [mass_matrix, f, dual[0], dual[1]],
            [mass_matrix, f, hyperdual[0], hyperdual[1]],
        ];
        Ok(Self {
            counts: [0, 1, 2, 3].map(|quantity| by_route.map(|counts| counts[quantity])),
            more: [dual_pass, y_f_x, y_f_xx_d, f_xx, hyperdual[0]],
        })
    }

    /// Every quantity by every method, then [`MORE`](Self::MORE), as far as it was counted.
    pub fn rows(&self) -> impl Iterator<Item = OperationRow> {
        let every = Self::QUANTITIES.into_iter().zip(self.counts).flat_map(|(quantity, counts)| {
            Self::ROUTES.into_iter().zip(counts).map(move |(route, counts)| ((quantity, route), counts))
        });
        let more = Self::MORE.into_iter().zip(self.more);
        every.chain(more).filter_map(|((quantity, route), operations)| {
            operations.map(|operations| OperationRow { quantity, route, operations })
        })
    }

    /// One quantity by one method, `None` if there is no such name or if it was not counted.
    pub fn get(&self, quantity: &str, route: &str) -> Option<Operations> {
        self.rows().find(|row| row.quantity == quantity && row.route == route).map(|row| row.operations)
    }
}

/// Every quantity by a method through a Hessian of the Lagrangian, y'F_xx by one dual pass, which takes no
/// quaternions.
fn by_dual_pass<R: Route>(
    tree: &Tree,
    route: R,
    constants: Constants,
    State { q, x, u, y }: &State,
) -> Result<[Option<Operations>; 4], EvalError> {
    let p = &x[tree.dof()..];
    let mut first = Hamiltonian::with_route(tree.clone(), route.clone());
    let mut second = DualPass::with_route(tree.clone(), route);
    let pass = || counted(constants, || second.contract(q, p, u, y).map(drop));
    let pass = tree.free().is_empty().then(pass).transpose()?;
    Ok([
        Some(counted(constants, || first.mass_matrix(q).map(drop))?),
        Some(counted(constants, || first.evaluate(q, p, u).map(drop))?),
        Some(counted(constants, || first.linearise(q, p, u).map(drop))?),
        pass,
    ])
}

/// What the 2n+1 rule gives: F, F_x and y'F_xx; F and y'F_x; y'F_xx d; F_x and the whole tensor, which has no
/// quaternions.
#[inline]
fn by_rule(
    tree: &Tree,
    constants: Constants,
    State { q, x, u, y }: &State,
) -> Result<[Option<Operations>; 4], EvalError> {
    let p = &x[tree.dof()..];
    let mut second = HamiltonianSecondOrder::from_tree(tree.clone());
    let mut full = FullHessian::from_tree(tree.clone());
    let tensor = || counted(constants, || full.hessian_tensor(q, p).map(drop));
    let tensor = tree.free().is_empty().then(tensor).transpose()?;
    Ok([
        Some(counted(constants, || second.contract(q, p, u, y).map(drop))?),
        Some(counted(constants, || second.first().adjoint(q, p, u, y).map(drop))?),
        Some(counted(constants, || second.hessian_product(q, p, y, x).map(drop))?),
        tensor,
    ])
}

/// F_x and y'F_xx by dual numbers, then by hyper-dual numbers.
#[inline]
fn automatic(
    robot: &Robot,
    constants: Constants,
    State { x, y, .. }: &State,
) -> Result<[[Operations; 2]; 2], DerivativeError<EvalError>> {
    let mut velocity = PhaseVelocity::new(robot).under(&vec![0.5; robot.dof()]);
    velocity.set_centre(&general_position(robot)?).map_err(DerivativeError::WrongLength)?;
    let function = || ByCalls(velocity.clone());
    let mut jacobian = Jacobian::<_, CHUNK, Count>::over(function());
    let mut nested = NestedHessian::<_, CHUNK, Count>::over(function());
    let mut hessian = Hessian::<_, Count>::over(function());
    let first = counted(constants, || jacobian.linearise(x).map(drop))?;
    let second = counted(constants, || nested.contract(x, y).map(drop))?;
    let whole = counted(constants, || hessian.hessian_tensor(x).map(drop))?;
    let contracted = counted(constants, || hessian.contract(x, y).map(drop))?;
    Ok([[first, first + second], [whole, contracted]])
}

/// Where directions begin: quaternions of length 1 without an entry 0 or 1, products with which are free.
fn general_position(robot: &Robot) -> Result<Vec<f64>, EvalError> {
    let space = ConfigurationSpace::new(robot);
    let by: Vec<f64> = (0..space.dof()).map(|i| 0.3 + 0.1 * i as f64).collect();
    let mut q = space.neutral();
    space.integrate(&space.neutral(), &by, &mut q)?;
    Ok(q)
}

/// The operations of an evaluation, or why it failed.
fn counted<E>(constants: Constants, evaluate: impl FnOnce() -> Result<(), E>) -> Result<Operations, E> {
    let (outcome, operations) = count_with(constants, evaluate);
    outcome.map(|()| operations)
}
