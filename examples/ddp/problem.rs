//! The problem, the options and the solution.

use super::box_qp::pushed_against;
use super::sweep::Policy;
use super::trajectory::Trajectory;
use costate::dynamics::Cost;
use costate::step::Step;
use nalgebra::DVector;
use std::error::Error;

/// `min h sum_k l(x_k, u_k) + l_end(x_N)  subject to  x_{k+1} = Phi(x_k, u_k, h),  lower <= u_k <= upper`.
pub struct Problem<P, L, T> {
    /// Phi.
    pub step: P,
    /// l, a cost per time.
    pub running: L,
    /// l_end.
    pub terminal: T,
    /// Duration of a step (s).
    pub h: f64,
    /// Bounds of the controls; infinite if there is none.
    pub lower: DVector<f64>,
    pub upper: DVector<f64>,
    /// Evaluation counters of the solver.
    pub count: Evaluations,
}

impl<P: Step<f64>, L: Cost<f64>, T: Cost<f64>> Problem<P, L, T> {
    pub fn new(step: P, (running, terminal): (L, T), h: f64, bounds: [&[f64]; 2]) -> Self {
        let [lower, upper] = bounds.map(DVector::from_column_slice);
        Self { step, running, terminal, h, lower, upper, count: Evaluations::default() }
    }

    /// Checks all lengths and bounds.
    ///
    /// # Errors
    /// The mismatch.
    pub fn check(&self, x: &[f64], u: &[DVector<f64>]) -> Result<(), Failure> {
        let (states, controls) = (self.step.states(), self.step.controls());
        let lengths = [
            ("x", x.len(), states),
            ("the lower bound", self.lower.len(), controls),
            ("the upper bound", self.upper.len(), controls),
            ("x of the running cost", self.running.states(), states),
            ("u of the running cost", self.running.controls(), controls),
            ("x of the terminal cost", self.terminal.states(), states),
            ("u of the terminal cost", self.terminal.controls(), 0),
        ];
        let of_u = u.iter().map(|u| ("u", u.len(), controls));
        for (what, found, expected) in lengths.into_iter().chain(of_u) {
            if found != expected {
                return Err(Failure::WrongLength { what, expected, found });
            }
        }
        for (control, (&lower, &upper)) in self.lower.iter().zip(&self.upper).enumerate() {
            if lower > upper || lower.is_nan() || upper.is_nan() {
                return Err(Failure::Bounds { control, lower, upper });
            }
        }
        Ok(())
    }
}

/// Evaluations of single steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Evaluations {
    /// Values only.
    pub advances: usize,
    /// With first derivatives.
    pub linearisations: usize,
    /// With first and second derivatives.
    pub contractions: usize,
}

/// Treatment of the second derivatives of the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Curvature {
    /// They are used: differential dynamic programming.
    Exact,
    /// They are dropped: iLQR.
    GaussNewton,
}

/// Options of the search.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    pub curvature: Curvature,
    /// Maximum number of iterations.
    pub iterations: usize,
    /// Tolerance of the relative projected gradient.
    pub tolerance: f64,
}

/// How the search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// The projected gradient is below the tolerance.
    Converged,
    /// Changes of the cost are below rounding, and the gradient no longer falls.
    Rounding,
    /// No step, with any regularisation, reduced the cost.
    Stuck,
    /// The iteration limit was reached.
    Iterations,
}

/// One line of the log: a trajectory and the step from it.
#[derive(Clone, Copy, Debug)]
pub struct Iteration {
    /// Cost of the trajectory.
    pub cost: f64,
    /// Largest component of the projected gradient over all stages, relative to the terms that cancel in it.
    pub gradient: f64,
    /// Number of controls at an active bound.
    pub held: usize,
    /// Fraction of the second derivatives that was used; 0 for Gauss-Newton.
    pub share: f64,
    /// The regularisation added to the diagonal of Q_uu.
    pub mu: f64,
    /// Length of the step; 0 if there was none.
    pub alpha: f64,
    /// Number of sweeps and roll-outs.
    pub sweeps: usize,
    pub roll_outs: usize,
    /// Time since the start of the search, until the gradient was known (s).
    pub seconds: f64,
}

impl Iteration {
    /// A row with the cost only.
    pub fn of(now: &Trajectory) -> Self {
        Self {
            cost: now.cost,
            gradient: f64::NAN,
            held: 0,
            share: 0.0,
            mu: 0.0,
            alpha: 0.0,
            sweeps: 0,
            roll_outs: 0,
            seconds: 0.0,
        }
    }

    /// The projected gradient and the held controls.
    pub fn measure(&mut self, now: &Trajectory, policies: &[Policy], [lower, upper]: [&DVector<f64>; 2]) {
        let (mut largest, mut terms) = (0.0_f64, 0.0_f64);
        for (u, policy) in now.u.iter().zip(policies) {
            terms = terms.max(policy.gradient_terms);
            for (i, &gradient) in policy.gradient.iter().enumerate() {
                if pushed_against(gradient, u[i], [lower[i], upper[i]]) {
                    self.held += 1;
                } else {
                    largest = largest.max(gradient.abs());
                }
            }
        }
        self.gradient = if largest > 0.0 { largest / terms } else { 0.0 };
    }
}

/// The best trajectory and the log of the search.
#[derive(Clone, Debug)]
pub struct Solution {
    pub trajectory: Trajectory,
    pub log: Vec<Iteration>,
    pub status: Status,
    pub count: Evaluations,
}

/// Why there is no solution. Errors within a line search only shorten the step.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The parts of a problem have inconsistent lengths.
    #[error("{what} has {found} entries, not {expected}")]
    WrongLength { what: &'static str, expected: usize, found: usize },
    /// A lower bound is above an upper one, or a bound is NaN.
    #[error("control {control}: the bounds {lower} and {upper} leave nothing between them")]
    Bounds { control: usize, lower: f64, upper: f64 },
    /// The step or the cost could not be evaluated along the current trajectory.
    #[error("stage {stage}: {source}")]
    Evaluation { stage: usize, source: Box<dyn Error> },
    /// No regularisation made Q_uu positive definite.
    #[error("the second derivatives in the controls are no finite numbers, or far below zero")]
    Indefinite,
    /// A cost is infinite or NaN.
    #[error("stage {stage}: the cost is not a finite number; start from other controls")]
    NotFinite { stage: usize },
}

impl Failure {
    pub fn at(stage: usize, source: impl Error + 'static) -> Self {
        Self::Evaluation { stage, source: Box::new(source) }
    }
}
