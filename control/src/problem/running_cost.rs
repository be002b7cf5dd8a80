//! User terms of the running cost.

use costate::codegen::Expr;
use costate::scalar::{Scalar, Tangent};
use std::fmt;
use std::sync::Arc;

/// A term l(q, v) of the running cost, generic over the [`Scalar`]: its derivatives come from dual numbers.
///
/// q (rad, m) and v (rad/s, m/s) have n entries. Build the term from the functions of [`Scalar`], with
/// choices by [`select`](Scalar::select). It must be twice differentiable along the motion. Its integral
/// counts as cost, not as penalty. In x = (q, p) its gradient is $E^\top (l_q, l_v)$ and its Hessian
/// $E^\top l_{zz} E$ up to second derivatives of v, with z = (q, v), $E = \partial z / \partial x$;
/// [`RobotExtremal`](crate::RobotExtremal) has all terms.
///
/// ```
/// use costate_control::{SolverOptions, Problem, RunningCost, Solver, UserTerm};
/// use costate::robot::Robot;
/// use costate::scalar::Scalar;
///
/// /// A cost of high rates.
/// struct Rates {
///     weight: f64,
/// }
///
/// impl RunningCost for Rates {
///     fn evaluate<S: Scalar>(&self, _: &[S], v: &[S]) -> S {
///         v.iter().fold(S::zero(), |sum, &v| sum + v * v).times(self.weight)
///     }
/// }
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/pendulum.toml")?;
/// let mut problem = Problem::rest_to_rest(robot, &[0.0], &[0.5], 1.0);
/// let cheap = Solver::new(&problem, SolverOptions::default())?.solve();
/// problem.terms.push(UserTerm::new(Rates { weight: 10.0 }));
/// let slow = Solver::new(&problem, SolverOptions::default())?.solve();
/// assert!(slow.motion.status.is_converged() && slow.motion.cost > cheap.motion.cost);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait RunningCost: Send + Sync {
    /// l(q, v), in cost per second.
    fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S;
}

/// A [`RunningCost`] of a [`Problem`](crate::Problem). Equal only to its clones.
#[derive(Clone)]
pub struct UserTerm {
    cost: Arc<dyn Evaluated>,
    name: &'static str,
}

impl UserTerm {
    /// The term of this cost.
    pub fn new<C: RunningCost + 'static>(cost: C) -> Self {
        Self { cost: Arc::new(cost), name: std::any::type_name::<C>() }
    }

    /// l(q, v), in cost per second.
    pub fn value(&self, q: &[f64], v: &[f64]) -> f64 {
        self.cost.value(q, v)
    }
}

impl fmt::Debug for UserTerm {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "UserTerm({})", self.name)
    }
}

impl PartialEq for UserTerm {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::addr_eq(Arc::as_ptr(&self.cost), Arc::as_ptr(&other.cost))
    }
}

/// A running cost at every scalar that the equations of extremals use.
trait Evaluated: Send + Sync {
    fn value(&self, q: &[f64], v: &[f64]) -> f64;
    fn first(&self, q: &[Once<f64>], v: &[Once<f64>]) -> Once<f64>;
    fn second(&self, q: &[Twice<f64>], v: &[Twice<f64>]) -> Twice<f64>;
    fn recorded_first(&self, q: &[Once<Expr>], v: &[Once<Expr>]) -> Once<Expr>;
    fn recorded_second(&self, q: &[Twice<Expr>], v: &[Twice<Expr>]) -> Twice<Expr>;
}

/// One derivative.
pub(crate) type Once<S> = Tangent<S>;
/// Two derivatives and a mixed second one.
pub(crate) type Twice<S> = Tangent<Tangent<S>>;

impl<C: RunningCost> Evaluated for C {
    fn value(&self, q: &[f64], v: &[f64]) -> f64 {
        self.evaluate(q, v)
    }
    fn first(&self, q: &[Once<f64>], v: &[Once<f64>]) -> Once<f64> {
        self.evaluate(q, v)
    }
    fn second(&self, q: &[Twice<f64>], v: &[Twice<f64>]) -> Twice<f64> {
        self.evaluate(q, v)
    }
    fn recorded_first(&self, q: &[Once<Expr>], v: &[Once<Expr>]) -> Once<Expr> {
        self.evaluate(q, v)
    }
    fn recorded_second(&self, q: &[Twice<Expr>], v: &[Twice<Expr>]) -> Twice<Expr> {
        self.evaluate(q, v)
    }
}

/// A scalar of the equations of extremals: numbers, and expressions that record them.
pub(crate) trait ExtremalScalar: Scalar {
    /// l with a derivative in one direction.
    fn first(term: &UserTerm, q: &[Once<Self>], v: &[Once<Self>]) -> Once<Self>;
    /// l with the derivatives in two directions and the second one in both.
    fn second(term: &UserTerm, q: &[Twice<Self>], v: &[Twice<Self>]) -> Twice<Self>;
}

impl ExtremalScalar for f64 {
    fn first(term: &UserTerm, q: &[Once<f64>], v: &[Once<f64>]) -> Once<f64> {
        term.cost.first(q, v)
    }
    fn second(term: &UserTerm, q: &[Twice<f64>], v: &[Twice<f64>]) -> Twice<f64> {
        term.cost.second(q, v)
    }
}

impl ExtremalScalar for Expr {
    fn first(term: &UserTerm, q: &[Once<Expr>], v: &[Once<Expr>]) -> Once<Expr> {
        term.cost.recorded_first(q, v)
    }
    fn second(term: &UserTerm, q: &[Twice<Expr>], v: &[Twice<Expr>]) -> Twice<Expr> {
        term.cost.recorded_second(q, v)
    }
}
