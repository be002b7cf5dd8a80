//! The iteration on one mesh: the program of the motion, solved by [`costate_nlp`].

use super::iterate::{End, Interior};
use crate::constants::direct as constants;
use crate::direct::limits::barrier::Barrier;
use crate::direct::points::values::PointDynamics;
use crate::direct::program::staged::{Program, Work};
use crate::direct::program::structure::{Row, Structure};
use crate::result::stage_times::Stage;
use crate::solve::recorder::Interruption;
use costate::EvalError;
use costate_nlp::{BarrierSettings, Settings, SolveError, Solver, Start, Status};

/// Largest part of the cost that the barrier may have at the start.
const FIRST_BARRIER: f64 = 0.1;

/// The conditions of optimality are met to this part of the tolerance of the cost, where that is not known to be
/// reached before.
const OF_TOLERANCE: f64 = 1e-3;

/// .. and no further than this.
const LEAST_TOLERANCE: f64 = 1e-12;

/// Slacks are at least this part of the range.
const LEAST_ROOM: f64 = 1e-12;

/// The program of a motion on its mesh, with its solver.
struct OnMesh {
    structure: Structure,
    work: Work,
    solver: Solver,
    /// Multipliers of the equations and of the ranges.
    multipliers: [Vec<f64>; 2],
    /// That of squares of equations, for what is done outside of the solver.
    stiffness: f64,
    /// Number of bounds, at least 1.
    bounds: f64,
}

impl<D: PointDynamics> Interior<D> {
    /// The same as [`iterate`](Self::iterate) by the solver for staged programs, whose equations have true
    /// multipliers: it begins with the slacks and multipliers of the barrier, and leaves those of its last iterate there.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn iterate_program(
        &mut self,
        tolerance: f64,
        most: usize,
        mut watch: impl FnMut(&mut Self, f64) -> Option<Interruption>,
    ) -> Result<End, EvalError> {
        (self.figures.is_minimum, self.figures.shortfall) = (false, 0.0);
        let mut on = self.on_mesh(tolerance, most);
        let first_gap = self.mu * self.barrier.total_weight() / self.figures.size;
        let first_most = std::env::var("MU0").ok().and_then(|s| s.parse().ok()).unwrap_or(FIRST_BARRIER);
        let gap = first_gap.clamp(0.1 * tolerance, first_most);
        let is_cold = on.multipliers[0].iter().all(|y| *y == 0.0);
        let first_step = self.figures.iterations;
        let start = on.work.origin.clone();
        let [y, v] = on.multipliers.clone();
        let start = Start {
            point: &start,
            equalities: (!is_cold).then_some(&y[..]),
            ranges: Some(&v),
            mu: Some(gap / on.bounds),
        };
        let (mut program, solver) = self.program(&mut on);
        let mut ended = match solver.begin(&mut program, start) {
            Ok(ended) => ended,
            Err(error) => return self.stopped(on, error),
        };
        loop {
            let seen = on.solver.iteration();
            self.take_iterate(&mut on, ended.is_some())?;
            if std::env::var("VV").is_ok() { eprintln!("DBG N {} tol {:.0e} {:3} cost {:.7e} viol {:8.1e} err {:8.1e} {:8.1e} {:8.1e} mu {:7.1e} gap {:7.1e} dec {:7.1e} reg {:7.1e} len {:.3} {}", self.spline.mesh.intervals(), tolerance, seen.number, seen.cost, seen.violation, seen.error.stationarity, seen.error.feasibility, seen.error.complementarity, seen.mu, seen.gap, seen.decrement, seen.regularisation, seen.length, if seen.is_restoration {"R"} else {""}); }
            let figures = &mut self.figures;
            figures.iterations = first_step + seen.number;
            figures.decrement = seen.decrement * on.structure.scales.cost;
            self.damping = if seen.regularisation > 0.0 { 2.0 * constants::SOLVED_DAMPING } else { 0.0 };
            let is_near = !seen.is_restoration && seen.length == 1.0 && seen.regularisation == 0.0;
            let is_solved = match ended {
                Some(Status::Solved | Status::SolvedToRounding) => true,
                _ => is_near && self.is_solved(tolerance),
            };
            if is_solved {
                self.figures.is_minimum = seen.regularisation == 0.0;
                self.damping = 0.0;
                return Ok(End::Solved);
            }
            match ended {
                Some(Status::IterationLimit) => return Ok(End::IterationLimit),
                Some(_) => return Ok(End::NoProgress),
                None => {}
            }
            if seen.number > 0
                && let Some(interruption) = watch(self, seen.length)
            {
                return Ok(End::Interrupted(interruption));
            }
            let (mut program, solver) = self.program(&mut on);
            ended = match solver.advance(&mut program) {
                Ok(ended) => ended,
                Err(error) => return self.stopped(on, error),
            };
            self.clock.lap(Stage::Equations);
        }
    }

    /// The program on the mesh of the iterate, and its multipliers there.
    fn on_mesh(&mut self, tolerance: f64, most: usize) -> OnMesh {
        let of_both = self.model.tasks.rows_of_both_ends();
        let Self { spline, barrier, ends, figures, .. } = self;
        let structure = Structure::new(spline, barrier, ends, (of_both, figures.size));
        let of = |rows: &[Row]| rows.iter().map(|row| row.multiplier(barrier)).collect();
        let multipliers = [of(&structure.equalities), of(&structure.ranges)];
        let stiffness = barrier.stiffness;
        let work = Work::new(spline, barrier, ends, &structure);
        let bounds = structure.bounds().max(1) as f64;
        let settings = Settings {
            tolerance: (OF_TOLERANCE * tolerance / bounds.sqrt()).max(LEAST_TOLERANCE),
            feasibility: self.least_violation,
            iterations: most,
            barrier: BarrierSettings { least: constants::LEAST_GAP * tolerance / bounds, ..BarrierSettings::default() },
            ..Settings::default()
        };
        let solver = Solver::new(&structure.layout, settings);
        OnMesh { structure, work, solver, multipliers, stiffness, bounds }
    }

    /// The program of the motion, and its solver.
    fn program<'a>(&'a mut self, on: &'a mut OnMesh) -> (Program<'a, D>, &'a mut Solver) {
        let Self { spline, points, barrier, running, model, system, ends, .. } = self;
        let OnMesh { structure, work, solver, .. } = on;
        (Program { spline, points, barrier, running, model, system, ends, structure, work }, solver)
    }

    /// Takes the iterate of the solver, with slacks, multipliers and figures.
    fn take_iterate(&mut self, on: &mut OnMesh, ends: bool) -> Result<(), EvalError> {
        let seen = on.solver.iteration();
        let is_placed = on.work.last == on.solver.point();
        if !is_placed {
            let point = on.solver.point().to_vec();
            let (mut program, _) = self.program(on);
            program.place(&point);
            self.measure_distances();
        }
        let size = on.structure.scales.cost;
        let mu = seen.mu * size;
        self.mu = mu * on.bounds / self.barrier.total_weight().max(f64::MIN_POSITIVE);
        self.barrier.stiffness = on.stiffness;
        let solution = on.solver.solution(Status::Stopped);
        let barrier = &mut self.barrier;
        for (row, y) in on.structure.equalities.iter().zip(solution.equalities) {
            barrier.multiplier[row.entry] = -row.sign * y;
        }
        for (row, v) in on.structure.ranges.iter().zip(solution.ranges) {
            take_range(barrier, row, *v, mu);
        }
        let cost = match seen.is_restoration || !is_placed {
            true => self.running.cost(&self.spline, &self.points),
            false => seen.cost * size,
        };
        self.measure_figures_of(cost);
        if ends && !is_placed { self.refresh() } else { Ok(()) }
    }

    /// The end of an iteration with an error.
    fn stopped(&mut self, mut on: OnMesh, error: SolveError<EvalError>) -> Result<End, EvalError> {
        match error {
            SolveError::Problem(error) => Err(error),
            // Where a motion has no finite values or derivatives, nothing leads on.
            _ => self.take_iterate(&mut on, true).map(|()| End::NoProgress),
        }
    }
}

/// Gives both sides of a limit the slacks that their distances leave, at least where the multiplier v of their
/// row is on the central path, and multipliers with this difference.
fn take_range(barrier: &mut Barrier, row: &Row, v: f64, mu: f64) {
    let sides = [(Some(row.entry), -row.sign * v), (row.other, row.sign * v)];
    let mut central = [0.0; 2];
    for ((at, own), central) in sides.into_iter().zip(&mut central) {
        let Some(at) = at else { continue };
        let range = 1.0 / barrier.unit[at];
        let least = (mu / own.max(f64::MIN_POSITIVE)).min(constants::FIRST_SLACK * range);
        barrier.slack[at] = barrier.distance[at].max(least).max(LEAST_ROOM * range);
        *central = mu / barrier.slack[at];
    }
    for (side, (at, own)) in sides.into_iter().enumerate() {
        let Some(at) = at else { continue };
        let is_alone = sides[1 - side].0.is_none();
        barrier.multiplier[at] = match own > 0.0 {
            true if is_alone => own,
            true => own + central[1 - side],
            false => central[side],
        };
    }
}
