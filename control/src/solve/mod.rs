//! Newton's method and better meshes by turns.

pub(crate) mod arcs;
pub(crate) mod free_time;
pub(crate) mod homotopy;
pub(crate) mod multiple_shooting;

use crate::bvp::Solvable;
use crate::bvp::collocation::Collocation;
use crate::bvp::collocation::error::{Estimate, estimate, next_mesh};
use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::newton::{LEAST_DAMPING, Limits, Outcome, newton};
use crate::bvp::timed::{Arcs, Clock, Timed};
use crate::extremal::{Extremal, Relaxation};
use crate::options::{Iteration, Method, SolverOptions};
use crate::status::Status;

/// A solution of the boundary-value problem on its mesh, or the best that was found.
pub(crate) struct Extremum {
    pub equations: Collocation,
    pub clock: Clock,
    pub arcs: Arcs,
    pub status: Status,
    /// The problem that it belongs to.
    pub ease: Relaxation,
    /// Estimated errors on the last mesh, where it came to that.
    pub estimate: Option<Estimate>,
}

/// Who is told each Newton step.
pub(crate) type Listener<'a> = Box<dyn FnMut(&Iteration) + 'a>;

/// What all parts of a solution share: options, the table of iterations and who listens.
pub(crate) struct Context<'a> {
    pub options: SolverOptions,
    pub iterations: Vec<Iteration>,
    pub listener: Option<Listener<'a>>,
    pub phase: &'static str,
    /// Most Newton steps on one mesh.
    pub steps: usize,
    /// Smallest damping.
    pub damping: f64,
}

impl<'a> Context<'a> {
    pub fn new(options: &SolverOptions, listener: Option<Listener<'a>>) -> Self {
        let steps = options.max_iterations;
        Self {
            options: options.clone(),
            iterations: Vec::new(),
            listener,
            phase: "fixed time",
            steps,
            damping: LEAST_DAMPING,
        }
    }

    /// Newton's method, its steps in the table.
    pub fn newton<Q: Solvable<E>, E: Extremal>(
        &mut self,
        equations: &mut Q,
        timed: &mut Timed<'_, E>,
        tolerance: f64,
    ) -> Status {
        let limits = Limits { tolerance, steps: self.steps, damping: self.damping };
        let outcome = newton(equations, timed, limits, |equations, timed, step| {
            let (cost, penalty) = equations.costs(timed);
            self.record(Iteration {
                phase: self.phase.into(),
                nodes: equations.mesh().nodes(),
                number: step.number,
                residual: step.correction,
                step: step.damping,
                final_time: equations.final_time(timed),
                cost: cost + penalty,
            });
        });
        match outcome {
            Outcome::Converged => Status::Converged,
            Outcome::Stalled => Status::NewtonFailed,
            Outcome::Limit => Status::IterationLimit,
            Outcome::Failed(failure) => failure.into(),
        }
    }

    pub fn record(&mut self, iteration: Iteration) {
        if let Some(listener) = &mut self.listener {
            listener(&iteration);
        }
        self.iterations.push(iteration);
    }
}

impl Extremum {
    /// Equations on a mesh with a guess, not yet solved.
    pub fn guess<E: Extremal>(
        extremal: &mut E,
        (clock, arcs): (Clock, Arcs),
        mesh: Mesh,
        points: usize,
        guess: impl FnMut(usize, f64, &mut [f64]),
    ) -> Self {
        let timed = Timed::new(extremal, clock, arcs);
        let equations = Collocation::new(&timed, mesh, points, guess);
        let Timed { arcs, .. } = timed;
        let (status, ease) = (Status::NewtonFailed, extremal.relaxation());
        Self { equations, clock, arcs, status, ease, estimate: None }
    }

    /// Solves to the tolerance by the method asked for, with as many nodes as that takes.
    pub fn solve<E: Extremal>(mut self, extremal: &mut E, tolerance: f64, context: &mut Context<'_>) -> Self {
        self.ease = extremal.relaxation();
        match context.options.method {
            Method::Collocation => self.collocate(extremal, tolerance, context),
            Method::Shooting => self.shoot(extremal, tolerance, context),
        }
    }

    fn collocate<E: Extremal>(mut self, extremal: &mut E, tolerance: f64, context: &mut Context<'_>) -> Self {
        let mut timed = Timed::new(extremal, self.clock, self.arcs.clone());
        let mut before = None;
        loop {
            self.status = context.newton(&mut self.equations, &mut timed, 0.1 * tolerance);
            if !self.status.is_converged() {
                return self;
            }
            let estimate = match estimate(&mut self.equations, &mut timed, Collocation::response) {
                Ok(estimate) => estimate,
                Err(error) => {
                    self.status = Status::evaluation_failed(error);
                    return self;
                }
            };
            if estimate.largest() <= tolerance {
                self.estimate = Some(estimate);
                return self;
            }
            let equations = &self.equations;
            let most = context.options.max_nodes - 1;
            let exhausted = equations.mesh.intervals() >= most - most / 20;
            let order = (equations.method.order(), most);
            let mesh = next_mesh(&equations.mesh, &estimate, before, order, tolerance);
            before = Some(estimate.largest());
            self.estimate = Some(estimate);
            if exhausted {
                self.status = Status::MeshLimit;
                return self;
            }
            let points = equations.method.len();
            let finer = Collocation::new(&timed, mesh, points, |arc, s, w| equations.sample(arc, s, w));
            self.equations = finer;
        }
    }

    /// T (s).
    pub fn final_time<E: Extremal>(&self, extremal: &mut E) -> f64 {
        self.equations.final_time(&Timed::new(extremal, self.clock, self.arcs.clone()))
    }

    /// Cost and penalties.
    pub fn costs<E: Extremal>(&self, extremal: &mut E) -> (f64, f64) {
        self.equations.costs(&Timed::new(extremal, self.clock, self.arcs.clone()))
    }

    /// Cost and penalties together.
    pub fn total<E: Extremal>(&self, extremal: &mut E) -> f64 {
        let (cost, penalty) = self.costs(extremal);
        cost + penalty
    }

    /// Duration of each arc (s).
    pub fn durations(&self, z_len: usize) -> Vec<f64> {
        let (m, mesh) = (self.equations.m, &self.equations.mesh);
        let mut durations = vec![0.0; mesh.arcs()];
        for (k, span) in mesh.spans.iter().enumerate() {
            if let Span::Interval { arc, .. } = *span {
                durations[arc] = match self.clock {
                    Clock::Fixed(time) => time,
                    _ => self.equations.current.nodes[k * m + z_len],
                };
            }
        }
        durations
    }
}
