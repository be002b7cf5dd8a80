//! Where a branch begins.

use super::Parameter;
use super::walk::{Aim, Found, Walker};
use crate::bvp::Solvable;
use crate::bvp::mesh::Mesh;
use crate::bvp::timed::{Arcs, Clock, Timed};
use crate::extremal::{Homotopy, Relaxation};
use crate::problem::{FinalTime, Problem};
use crate::result::trajectory::Trajectory;
use crate::search::guess::{Disturbance, RobotGuess, saved};
use crate::search::{LOOSE, at_fixed_time};
use crate::solve::Extremum;
use crate::solve::arcs::solve_arcs;
use crate::solve::free_time::free_time;
use crate::solve::homotopy::follow;
use crate::status::Status;

/// Bounds this many times as far apart are hardly felt.
const WIDE: f64 = 1000.0;

impl Walker<'_> {
    /// The values of a solution at its nodes, on one arc; not yet solved.
    pub fn extremum(&mut self, trajectory: &Trajectory, time: FinalTime) -> Extremum {
        // By its own times: a file may say anything about the final time.
        let duration =
            trajectory.t.last().zip(trajectory.t.first()).map_or(0.0, |(last, first)| last - first);
        let steps = trajectory.t.windows(2).map(|pair| (pair[1] - pair[0]) / duration);
        let mesh = Mesh::from_lengths([steps.filter(|&length| length > 0.0).collect()]);
        let clock = match time {
            FinalTime::Fixed(time) => Clock::Fixed(time),
            FinalTime::Free { .. } => Clock::Free,
        };
        let (points, z) = (self.context.options.points, 4 * self.problem.robot.len());
        Extremum::guess(&mut self.extremal, (clock, Arcs::one()), mesh, points, |_, s, w| {
            saved(trajectory, s, &mut w[..z]);
            w[z..].fill(duration);
        })
    }

    /// A solution with smooth controls: without bounds first, at a fixed time, then with bounds that draw nearer.
    pub fn smoothed(&mut self, problem: &Problem) -> Result<Extremum, Status> {
        let momenta = self.extremal.clone();
        let mut guess =
            RobotGuess { problem, disturbance: Disturbance::default(), saved: None, momenta, path: None };
        let (extremal, context) = (&mut self.extremal, &mut self.context);
        let loose = LOOSE.max(context.options.tolerance);
        extremal.set_relaxation(Relaxation { bounds: f64::INFINITY, ..Relaxation::NONE });
        let at = at_fixed_time(extremal, problem.time, (1.0, &mut guess), context);
        let mut at = at.solve(extremal, loose, context);
        if let FinalTime::Free { .. } = problem.time {
            at = free_time(at, extremal, loose, context);
        }
        at = follow(at, extremal, context, |extremal, s| {
            extremal.set_relaxation(Relaxation { bounds: WIDE.powf(1.0 - s), ..Relaxation::NONE });
        });
        if at.status.is_converged() { Ok(at) } else { Err(at.status) }
    }

    /// The first point, from a solution: on the arcs of the controls that cost nothing, else on one arc.
    pub fn begun(&mut self, mut start: Extremum) -> Result<Found, Status> {
        let tolerance = self.tolerance(&start);
        let free = self.problem.cost.effort.contains(&0.0) && self.parameter != Parameter::Smoothing;
        if free {
            let mut timed = Timed::new(&mut self.extremal, start.clock, start.arcs.clone());
            let values = start.equations.current.clone();
            let evaluated = start.equations.evaluate(&mut timed, &values);
            evaluated.map_err(Status::from)?;
            let arcs = solve_arcs(&start, &mut self.extremal, tolerance, &mut self.context);
            start = arcs.ok_or(Status::SwitchesNotRefined)?;
        } else {
            start = start.solve(&mut self.extremal, tolerance, &mut self.context);
        }
        if !start.status.is_converged() {
            return Err(start.status);
        }
        // The direction of s at first is that of the way.
        let found = Found { extremum: start, position: 0.0, slope: 1.0, bend: 0.0 };
        let found = self.on_its_arcs(found)?;
        self.go(&found, Aim::At(0.0)).and_then(|found| self.on_its_arcs(found))
    }
}
