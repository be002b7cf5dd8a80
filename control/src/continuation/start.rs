//! Where a branch begins.

use super::Parameter;
use super::walk::{Aim, Found, Walker};
use crate::bvp::mesh::Mesh;
use crate::bvp::timed::{Arcs, Clock};
use crate::constants::branch::WIDE;
use crate::cubics::Disturbance;
use crate::extremal::{BoundaryValueProblem, Homotopy, Relaxation};
use crate::problem::{FinalTime, Problem};
use crate::progress::Phase;
use crate::result::trajectory::Trajectory;
use crate::search::Search;
use crate::search::guess::RobotGuess;
use crate::solve::arcs::solve_arcs;
use crate::solve::free_time::free_time;
use crate::solve::homotopy::follow;
use crate::solve::{Discretisation, Layout, Solved};
use crate::starts::saved;
use crate::status::Status;

impl Walker<'_, '_> {
    /// The values of a motion at its nodes, on one arc.
    pub fn rough(&mut self, trajectory: &Trajectory, time: FinalTime) -> Discretisation {
        let motion = saved(trajectory);
        // Its own times: those of a saved file need not agree with its final time.
        let duration = motion.duration();
        let clock = match time {
            FinalTime::Fixed(time) => Clock::Fixed(time),
            FinalTime::Free { .. } => Clock::Free,
        };
        let layout = Layout {
            clock,
            arcs: Arcs::one(),
            mesh: Mesh::from_lengths([motion.lengths()]),
            points: self.attempt.points,
        };
        let z = 2 * self.extremal.states();
        Discretisation::new(&mut self.extremal, layout, |_, s, w| {
            motion.sample(s, &mut w[..z]);
            w[z..].fill(duration);
        })
    }

    /// A solution with smooth controls: first without bounds at a fixed time, then with bounds that tighten.
    pub fn smoothed(&mut self, problem: &Problem) -> Result<Discretisation, Status> {
        let momenta = self.extremal.clone();
        let mut guess =
            RobotGuess { problem, disturbance: Disturbance::default(), saved: None, begun: false, momenta };
        let mut phase = Phase::FixedTime;
        let rough = self.attempt.loose();
        self.extremal.set_relaxation(Relaxation { bounds: f64::INFINITY, ..Relaxation::NONE });
        let mut search = Search {
            extremal: &mut self.extremal,
            time: problem.time,
            guess: &mut guess,
            recorder: &mut self.recorder,
        };
        let first = search.at_fixed_time(problem.time, 1.0, &rough);
        let mut at = search.solve(first, &rough.in_phase(phase));
        let (extremal, recorder) = (&mut self.extremal, &mut self.recorder);
        if let FinalTime::Free { .. } = problem.time {
            at = free_time(at, extremal, &rough.in_phase(phase), recorder);
            phase = Phase::FreeTime;
        }
        at = follow(at, extremal, &rough.in_phase(phase), recorder, |extremal, s| {
            extremal.set_relaxation(Relaxation { bounds: WIDE.powf(1.0 - s), ..Relaxation::NONE });
        });
        if at.is_converged() { Ok(at.found) } else { Err(at.status) }
    }

    /// The first point from a rough solution: on the arcs of controls without effort, else on one arc.
    pub fn begun(&mut self, start: Discretisation) -> Result<Found, Status> {
        let attempt = self.attempt_for(&start);
        let (extremal, recorder) = (&mut self.extremal, &mut self.recorder);
        let without_effort = self.family.problem.cost.effort.contains(&0.0);
        let solved: Solved = if without_effort && self.family.parameter != Parameter::Smoothing {
            let rough = start.evaluated(extremal)?;
            solve_arcs(&rough, extremal, &attempt, recorder).ok_or(Status::SwitchesNotRefined)?
        } else {
            start.solve(extremal, &attempt, recorder)
        };
        if !solved.is_converged() {
            return Err(solved.status);
        }
        // The direction of s at first is that of the continuation.
        let found = Found { solved, position: 0.0, slope: 1.0, bend: 0.0 };
        let found = self.on_its_arcs(found)?;
        self.go(&found, Aim::At(0.0)).and_then(|found| self.on_its_arcs(found))
    }
}
