//! Differential dynamic programming with control bounds, and iLQR, its Gauss-Newton variant.
//!
//! Each iteration sweeps backwards ([`sweep`](super::sweep)) for the policy of each stage and the predicted
//! change of the cost, then rolls out the policy for alpha = 1, 1/2, ... until the cost falls by a fraction
//! of the prediction.
//!
//! Away from a minimum, Q_uu with exact second derivatives may be indefinite. Then the fraction of these
//! derivatives is reduced first, down to zero: the Gauss-Newton model, which is convex if the costs are. Only
//! if that is not enough, or if no step length is accepted, mu is added to the diagonal of Q_uu. Both are
//! reset as soon as possible: near a minimum with positive definite Q_uu the fraction is exactly 1, mu is
//! exactly 0, and the iteration is Newton's.
//!
//! Control bounds: Y. Tassa, N. Mansard, E. Todorov, "Control-limited differential dynamic programming", ICRA
//! 2014.

use super::problem::{Curvature, Evaluations, Failure, Iteration, Options, Problem, Solution, Status};
use super::roll_out::Following;
use super::sweep::{Policy, Promise, Stage, Value};
use super::trajectory::Trajectory;
use costate::dynamics::Cost;
use costate::step::Step;
use nalgebra::DVector;
use std::error::Error;
use std::time::Instant;

/// Required fraction of the predicted decrease.
const ARMIJO: f64 = 1e-4;
/// Smallest step length.
const SHORTEST: f64 = 1e-4;
/// Smallest fraction of the second derivatives; below it they are dropped.
const SMALLEST_SHARE: f64 = 1.0 / 16.0;
/// Smallest nonzero mu, and largest, above which the search is stuck.
const MU: [f64; 2] = [1e-6, 1e10];
/// Initial factors of increase and decrease of mu. Decreasing slowly avoids a barely positive definite Q_uu,
/// which gives long, useless steps.
const MU_UP: f64 = 4.0;
const MU_DOWN: f64 = 0.5;
/// Number of iterations below the rounding of the cost and without a better gradient, after which the search
/// ends.
const PATIENCE: usize = 5;

/// Regularisation of the model.
struct Regularisation {
    share: f64,
    largest_share: f64,
    mu: f64,
    /// The last factor of mu; it accelerates.
    factor: f64,
}

impl Regularisation {
    fn none(curvature: Curvature) -> Self {
        let share = if curvature == Curvature::Exact { 1.0 } else { 0.0 };
        Self { share, largest_share: share, mu: 0.0, factor: 1.0 }
    }

    /// Q_uu was indefinite.
    fn convexify(&mut self) {
        if self.share > 0.0 {
            self.share *= 0.25;
            if self.share < SMALLEST_SHARE {
                self.share = 0.0;
            }
        } else {
            self.damp();
        }
    }

    /// No step length was accepted.
    fn damp(&mut self) {
        self.factor = f64::max(MU_UP, MU_UP * self.factor);
        self.mu = f64::max(MU[0], self.mu * self.factor);
    }

    /// A step was accepted.
    fn relax(&mut self) {
        self.share = self.largest_share.min(f64::max(SMALLEST_SHARE, 2.0 * self.share));
        self.factor = f64::min(MU_DOWN, MU_DOWN * self.factor);
        self.mu *= self.factor;
        if self.mu < MU[0] {
            self.mu = 0.0;
        }
    }

    fn is_spent(&self) -> bool {
        self.mu > MU[1]
    }
}

/// The buffers of a search.
struct Search {
    now: Trajectory,
    trial: Trajectory,
    stages: Vec<Stage>,
    end: Stage,
    policies: Vec<Policy>,
    regular: Regularisation,
}

impl<P: Step<f64>, L: Cost<f64>, T: Cost<f64>> Problem<P, L, T> {
    /// Searches a local minimum from state `x` and controls `u`, one per stage.
    ///
    /// # Errors
    /// Inconsistent lengths, or a failure at the start or in the derivatives along a trajectory.
    pub fn solve(&mut self, x: &[f64], u: &[DVector<f64>], options: &Options) -> Result<Solution, Failure> {
        self.check(x, u)?;
        self.count = Evaluations::default();
        let clock = Instant::now();
        let mut search = self.start(x, u, options.curvature)?;
        let mut log: Vec<Iteration> = Vec::new();
        let (mut best, mut patience) = (f64::INFINITY, PATIENCE);
        let status = loop {
            let mut line = Iteration::of(&search.now);
            let mut promise = self.sweep(&mut search, &mut line)?;
            line.measure(&search.now, &search.policies, [&self.lower, &self.upper]);
            line.seconds = clock.elapsed().as_secs_f64();
            let invisible = promise.change(1.0).abs() < search.now.rounding();
            match () {
                () if line.gradient < best => (best, patience) = (line.gradient, PATIENCE),
                () if invisible => patience -= 1,
                () => {}
            }
            let mut end = match () {
                () if line.gradient <= options.tolerance => Some(Status::Converged),
                () if log.len() == options.iterations => Some(Status::Iterations),
                () if patience == 0 => Some(Status::Rounding),
                () => None,
            };
            while end.is_none() && !self.search_line(&mut search, promise, &mut line) {
                search.regular.damp();
                if search.regular.is_spent() {
                    end = Some(Status::Stuck);
                } else {
                    promise = self.sweep(&mut search, &mut line)?;
                }
            }
            log.push(line);
            if let Some(status) = end {
                break status;
            }
            search.regular.relax();
        };
        Ok(Solution { trajectory: search.now, log, status, count: self.count })
    }

    /// The policies of all stages and the predicted change, with sufficient regularisation.
    fn sweep(&mut self, search: &mut Search, line: &mut Iteration) -> Result<Promise, Failure> {
        loop {
            line.sweeps += 1;
            (line.share, line.mu) = (search.regular.share, search.regular.mu);
            if let Some(promise) = self.sweep_once(search)? {
                return Ok(promise);
            }
            if search.regular.is_spent() {
                return Err(Failure::Indefinite);
            }
            search.regular.convexify();
        }
    }

    /// The recursion over all stages; `None` if one of them has an indefinite Q_uu.
    fn sweep_once(&mut self, search: &mut Search) -> Result<Option<Promise>, Failure> {
        let Search { now, stages, end, policies, regular, .. } = search;
        let last = stages.len();
        if !end.fresh {
            let cost = self.terminal.hessian(now.x[last].as_slice(), &[]);
            end.set_cost(&cost.map_err(|source| Failure::at(last, source))?, 1.0);
            end.fresh = true;
        }
        let mut value = Value::at_end(end);
        let mut promise = Promise::default();
        for (k, stage) in stages.iter_mut().enumerate().rev() {
            let (x, u) = (&now.x[k], &now.u[k]);
            self.differentiate(stage, [x.as_slice(), u.as_slice()], &value.v_x, regular.share)
                .map_err(|source| Failure::Evaluation { stage: k, source })?;
            let bounds = [&(&self.lower - u), &(&self.upper - u)];
            let Ok(policy) = stage.recur(&mut value, regular.mu, bounds) else { return Ok(None) };
            promise.slope += policy.promise.slope;
            promise.curvature += policy.promise.curvature;
            policies[k] = policy;
        }
        Ok(Some(promise))
    }

    /// The derivatives at one stage, unless known from the previous sweep.
    fn differentiate(
        &mut self,
        stage: &mut Stage,
        [x, u]: [&[f64]; 2],
        v_x: &DVector<f64>,
        share: f64,
    ) -> Result<(), Box<dyn Error>> {
        if !stage.fresh {
            stage.set_cost(&self.running.hessian(x, u)?, self.h);
        }
        if share > 0.0 {
            let step = self.step.contract(x, u, self.h, v_x.as_slice())?;
            self.count.contractions += 1;
            stage.set_step(&step.first);
            stage.set_curvature(&step, share);
        } else {
            if !stage.fresh {
                stage.set_step(&self.step.linearise(x, u, self.h)?);
                self.count.linearisations += 1;
            }
            stage.drop_curvature();
        }
        stage.fresh = true;
        Ok(())
    }

    /// Line search with steps 1, 1/2, ...; returns whether one has sufficient decrease.
    ///
    /// A trajectory that cannot be evaluated counts as no decrease. Changes below the rounding of the cost
    /// count as zero.
    fn search_line(&mut self, search: &mut Search, promise: Promise, line: &mut Iteration) -> bool {
        let Search { now, trial, stages, end, policies, .. } = search;
        let rounding = now.rounding();
        let mut alpha = 1.0;
        while alpha >= SHORTEST {
            line.roll_outs += 1;
            let done = self.roll_out(now, Some(Following { policies, alpha }), trial);
            if done.is_ok() && trial.cost - now.cost <= ARMIJO * promise.change(alpha) + rounding {
                std::mem::swap(now, trial);
                stages.iter_mut().chain([end]).for_each(|stage| stage.fresh = false);
                line.alpha = alpha;
                return true;
            }
            alpha *= 0.5;
        }
        false
    }

    /// The buffers of a search from `x` and `u`, rolled out.
    fn start(&mut self, x: &[f64], u: &[DVector<f64>], curvature: Curvature) -> Result<Search, Failure> {
        let (states, controls) = (self.step.states(), self.step.controls());
        let given = Trajectory::start(x, u);
        let mut now = given.clone();
        self.roll_out(&given, None, &mut now)?;
        Ok(Search {
            trial: now.clone(),
            now,
            stages: u.iter().map(|_| Stage::zeros(states, controls)).collect(),
            end: Stage::zeros(states, 0),
            policies: u.iter().map(|_| Policy::none(states, controls)).collect(),
            regular: Regularisation::none(curvature),
        })
    }
}
