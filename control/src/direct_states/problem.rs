//! Problems of models that are solved by the direct method.

use super::guess::Guess;
use crate::extremal::dynamics::problem::{DynamicsProblem, DynamicsProblemError};
use crate::problem::error::ProblemError;
use costate::dynamics::{Cost, Dynamics, QuadraticCost};

/// A [`DynamicsProblem`] for the direct method: any [`Dynamics`], affine in u or not, with bounds on u and x.
///
/// $$ J = c_t T + \int_0^T \left( \tfrac12 \sum_i r_i u_i^2 + l(x, u) \right) dt, \qquad
///    u_{min} \le u \le u_{max}, \quad x_{min} \le x \le x_{max} $$
///
/// ```
/// use costate::derivative::Function;
/// use costate::dynamics::Automatic;
/// use costate::scalar::Scalar;
/// use costate_control::{DirectDynamics, DynamicsProblem, EndState, FinalTime, Objective, SolverOptions};
///
/// /// A boat of speed 1 that chooses its heading u in a current: not affine in u.
/// #[derive(Clone)]
/// struct Boat;
///
/// impl Function for Boat {
///     type Workspace<S: Scalar> = ();
///     type Error = std::convert::Infallible;
///     fn inputs(&self) -> usize { 3 }
///     fn outputs(&self) -> usize { 2 }
///     fn workspace<S: Scalar>(&self) {}
///     fn evaluate<S: Scalar>(&self, _: &mut (), z: &[S], f: &mut [S]) -> Result<(), Self::Error> {
///         (f[0], f[1]) = (z[2].sin_cos().1, z[2].sin_cos().0 + S::from_f64(0.6));
///         Ok(())
///     }
/// }
///
/// let (start, end) = (EndState::fixed(&[0.0, 0.0]), EndState::fixed(&[1.0, 0.0]));
/// let cost = Objective::new(1.0, vec![1e-12]);
/// let problem = DynamicsProblem::new(start, end, FinalTime::Free { guess: 1.0 }, 1).with_cost(cost);
/// let mut task = DirectDynamics::new(Automatic::<Boat>::new(Boat), &problem)?;
/// let motion = task.solve(&SolverOptions::default())?;
/// // It heads against the current by sin u = -0.6, and cos u = 0.8 is left.
/// assert!(motion.status.is_converged() && (motion.final_time - 1.25).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct DirectDynamics<D, C = QuadraticCost> {
    pub(super) model: D,
    pub(super) cost: Option<C>,
    pub(super) problem: DynamicsProblem,
    pub(super) x_limits: [Vec<f64>; 2],
    pub(super) u_limits: [Vec<f64>; 2],
    pub(super) guess: Option<Guess>,
    /// All costs are divided by this while they are solved.
    pub(super) reference: f64,
}

/// Why a [`DirectDynamics`], its limits, its guess or options were refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DirectDynamicsError {
    /// The problem itself.
    #[error(transparent)]
    Problem(#[from] DynamicsProblemError),
    /// Options of the solver.
    #[error(transparent)]
    Options(#[from] ProblemError),
    /// Nothing moves.
    #[error("the model has no states: x must have one component or more")]
    NoStates,
    /// Lists of a guess that do not belong together.
    #[error("{field} has {found} entries for {times} times: give one for each time")]
    GuessLength {
        /// Number of times.
        times: usize,
        /// The list.
        field: &'static str,
        /// Its length.
        found: usize,
    },
    /// Times that do not increase.
    #[error("t of the guess must have two or more times, each finite and larger than the one before it")]
    GuessTimes,
    /// No state lies between its limits.
    #[error("x_min[{component}] = {low} must be less than x_max[{component}] = {high}")]
    Empty {
        /// Index in x.
        component: usize,
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
    /// An end beyond limits.
    #[error("{end}.x[{component}] = {value} is outside of its limits [{low}, {high}]")]
    EndOutside {
        /// "start" or "end".
        end: &'static str,
        /// Index in x.
        component: usize,
        /// The value.
        value: f64,
        /// Lower limit.
        low: f64,
        /// Upper limit.
        high: f64,
    },
}

impl<D: Dynamics<f64>> DirectDynamics<D> {
    /// The problem of this model, without further running cost.
    ///
    /// # Errors
    /// A problem that does not fit the model, or a model without states.
    pub fn new(model: D, problem: &DynamicsProblem) -> Result<Self, DirectDynamicsError> {
        Self::build(model, None, problem)
    }
}

impl<D: Dynamics<f64>, C: Cost<f64>> DirectDynamics<D, C> {
    /// The problem of this model with a running cost l(x, u), or l(x): a [`Cost`] without controls.
    ///
    /// # Errors
    /// A problem or a cost that does not fit the model.
    pub fn with_running_cost(
        model: D,
        cost: C,
        problem: &DynamicsProblem,
    ) -> Result<Self, DirectDynamicsError> {
        let sizes = [
            ("x of the running cost", cost.states(), model.states()),
            ("u of the running cost", cost.controls(), model.controls()),
        ];
        for (field, found, expected) in sizes {
            if found != expected && (found != 0 || field.starts_with('x')) {
                return Err(DynamicsProblemError::WrongLength { field, expected, found }.into());
            }
        }
        Self::build(model, Some(cost), problem)
    }

    fn build(model: D, cost: Option<C>, problem: &DynamicsProblem) -> Result<Self, DirectDynamicsError> {
        let (n, m) = (model.states(), model.controls());
        if n == 0 {
            return Err(DirectDynamicsError::NoStates);
        }
        let weighs_u = cost.as_ref().is_some_and(|cost| cost.controls() > 0);
        problem.check(n, m, cost.is_some(), weighs_u)?;
        let free = |count, value| vec![value; count];
        let u_limits = match &problem.bounds {
            Some(bounds) => [bounds.u_min.clone(), bounds.u_max.clone()],
            None => [free(m, f64::NEG_INFINITY), free(m, f64::INFINITY)],
        };
        let x_limits = [free(n, f64::NEG_INFINITY), free(n, f64::INFINITY)];
        Ok(Self { model, cost, problem: problem.clone(), x_limits, u_limits, guess: None, reference: 1.0 })
    }

    /// With limits $x_{min} \le x \le x_{max}$, infinite for none. They hold at the points; what is exceeded
    /// between them is [`largest_violation`](crate::StateMotion::largest_violation).
    ///
    /// # Errors
    /// Lists of the wrong length, limits that leave nothing, and fixed components of an end beyond them.
    pub fn with_state_limits(self, x_min: &[f64], x_max: &[f64]) -> Result<Self, DirectDynamicsError> {
        let expected = self.model.states();
        for (field, found) in [("x_min", x_min.len()), ("x_max", x_max.len())] {
            if found != expected {
                return Err(DynamicsProblemError::WrongLength { field, expected, found }.into());
            }
        }
        for (component, (&low, &high)) in x_min.iter().zip(x_max).enumerate() {
            // Not true for NaN.
            let has_room = low < high;
            if !has_room {
                return Err(DirectDynamicsError::Empty { component, low, high });
            }
            for (end, state) in [("start", &self.problem.start), ("end", &self.problem.end)] {
                let value = state.x[component];
                if !state.free.contains(&component) && !(low..=high).contains(&value) {
                    return Err(DirectDynamicsError::EndOutside { end, component, value, low, high });
                }
            }
        }
        Ok(Self { x_limits: [x_min.to_vec(), x_max.to_vec()], ..self })
    }
}
