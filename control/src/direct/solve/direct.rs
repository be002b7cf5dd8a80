//! From a problem to a motion: starts, meshes, verification.

use super::meshes::{Refined, refine};
use super::prepare::{Dynamics, interior};
use crate::direct::interior::iterate::Interior;
use crate::direct::outcome::found::{Found, found};
use crate::direct::outcome::report::report;
use crate::direct::outcome::verify::{Again, integrate_again};
use crate::direct::refine::resolution::Resolution;
use crate::options::{SolverOptions, Verify};
use crate::parallel::best_of_starts;
use crate::problem::check::CheckedProblem;
use crate::result::motion::{Certificate, Motion};
use crate::result::solution::{RobotNames, Solution};
use crate::result::stage_times::{Clock, Stage};
use crate::result::trajectory::Trajectory;
use crate::solve::Recorder;
use crate::status::Status;
use crate::task::build::TaskRows;
use costate::EvalError;

/// A problem that the direct method solves from one or several guesses.
pub(crate) struct Direct<'a> {
    pub problem: CheckedProblem<'a>,
    /// The functions of its task.
    pub rows: &'a TaskRows,
    pub options: &'a SolverOptions,
    /// Where the first start begins.
    pub saved: Option<&'a Trajectory>,
}

impl Direct<'_> {
    /// The best solution of all starts: the cheapest solved one if there is any.
    pub fn solve(&self, recorder: &mut Recorder<'_>) -> Solution {
        let missing = |status| Solution::missing(&self.problem.robot, status, self.problem.time.value());
        let solve = |number, recorder: &mut Recorder<'_>| {
            let failed = |error: EvalError| missing(Status::EvaluationFailed(error.into()));
            self.start(number, recorder).unwrap_or_else(failed)
        };
        best_of_starts(self.options, recorder, solve).unwrap_or_else(|| missing(Status::Cancelled))
    }

    /// One start.
    pub fn start(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let problem = self.problem.problem();
        let saved = self.saved.filter(|_| number == 0);
        let clock = Clock::new(recorder.takes_times);
        let mut interior = interior(problem, self.rows, self.options, number, saved);
        interior.clock = clock;
        let mut resolution = Resolution::default();
        let is_given = self.saved.is_some();
        let refined = refine(problem, self.options, is_given, &mut interior, &mut resolution, recorder)?;
        self.finish(&mut interior, &resolution, refined, recorder)
    }

    /// The solution, verified by integration where it converged.
    fn finish(
        &self,
        interior: &mut Interior<Dynamics>,
        resolution: &Resolution,
        Refined { status, error, again, infeasible }: Refined,
        recorder: &mut Recorder<'_>,
    ) -> Result<Solution, EvalError> {
        let problem = self.problem.problem();
        interior.clock.lap(Stage::Meshes);
        let Found { trajectory, hamiltonians } = found(problem, interior)?;
        // What exceeds its limits leads nowhere.
        let exceeds = matches!(status, Status::LimitsNotKept | Status::Infeasible);
        let again = again.unwrap_or_else(|| match status.is_interruption() || exceeds {
            true => Again::unknown(f64::INFINITY),
            false => integrate_again(problem, self.options.verify, interior, resolution),
        });
        let iterations = std::mem::take(&mut recorder.iterations);
        let penalty_cost = interior.running.penalty_cost(&interior.spline, &interior.points);
        let motion = Motion {
            cost: resolution.cost - penalty_cost,
            penalty_cost,
            hamiltonian: hamiltonians.phases[hamiltonians.phases.len() - 1],
            phase_hamiltonians: hamiltonians.phases,
            hamiltonian_drift: hamiltonians.drift,
            end_state: again.state,
            verification: match status {
                Status::Converged | Status::NotVerified => self.options.verify,
                _ => Verify::None,
            },
            certificate: match status.is_converged() && interior.figures.is_minimum {
                true => Certificate::LocalMinimumOnMesh,
                false => Certificate::NotChecked,
            },
            errors: vec![error],
            iterations,
            ..Motion::missing(status, interior.spline.duration())
        };
        let limits = report(problem, interior, resolution, infeasible);
        interior.clock.lap(Stage::Verification);
        Ok(Solution {
            newton_iterations: interior.figures.iterations,
            end_defect: again.defect,
            limits,
            polish: None,
            stage_times: interior.clock.times(),
            trajectory,
            starts: Vec::new(),
            options: self.options.clone(),
            robot: RobotNames::of(&problem.robot),
            motion,
        })
    }
}
