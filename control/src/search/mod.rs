//! The search for a solution: from guesses through several attempts to an extremal.

pub(crate) mod attempts;
pub(crate) mod guess;
pub(crate) mod mapped;
pub(crate) mod stages;

use crate::bvp::mesh::Mesh;
use crate::bvp::timed::{Arcs, Clock};
use crate::extremal::Extremal;
use crate::problem::FinalTime;
use crate::progress::Phase;
use crate::search::guess::Guess;
use crate::solve::arcs::solve_arcs;
use crate::solve::free_time::free_time;
use crate::solve::{Attempt, Discretisation, Layout, Recorder, Solved};

/// What all attempts to solve one extremal share.
pub(crate) struct Search<'s, 'r> {
    pub extremal: &'s mut (dyn Extremal + 's),
    pub time: FinalTime,
    pub guess: &'s mut dyn Guess,
    pub recorder: &'s mut Recorder<'r>,
}

impl Search<'_, '_> {
    /// The equations of one arc at a fixed time, with the guess of a motion that covers the part `goal` of
    /// the distance to the end; a saved motion keeps its mesh.
    pub fn at_fixed_time(&mut self, time: FinalTime, goal: f64, attempt: &Attempt) -> Discretisation {
        let saved =
            self.guess.saved_mesh().filter(|mesh| goal == 1.0 && mesh.len() <= attempt.max_intervals());
        let layout = Layout {
            clock: Clock::Fixed(time.value()),
            arcs: Arcs::one(),
            mesh: match &saved {
                Some(lengths) => Mesh::from_lengths([lengths.clone()]),
                None => Mesh::uniform(&[attempt.nodes - 1]),
            },
            points: attempt.points,
        };
        let guess = &mut *self.guess;
        let mut found = Discretisation::new(self.extremal, layout, |_, s, z| guess.simple(goal, s, z));
        if saved.is_some() {
            found.smooth_between_nodes(self.extremal);
        }
        found
    }

    /// Solves as the attempt says.
    pub fn solve(&mut self, from: Discretisation, attempt: &Attempt) -> Solved {
        from.solve(self.extremal, attempt, self.recorder)
    }

    /// From a rough solution at a fixed time to an exact one with the final time of the problem.
    pub fn finish(&mut self, first: Solved, time: FinalTime, attempt: &Attempt) -> Solved {
        if !first.is_converged() {
            return first;
        }
        match time {
            FinalTime::Fixed(_) => self.sharpen(first, attempt),
            FinalTime::Free { .. } => {
                let found = free_time(first, self.extremal, &attempt.loose(), self.recorder);
                self.sharpen(found, &attempt.in_phase(Phase::FreeTime))
            }
        }
    }

    /// From a rough solution to an exact one: on arcs if a control reaches a bound; otherwise, or if that
    /// fails, on finer meshes.
    pub fn sharpen(&mut self, rough: Solved, attempt: &Attempt) -> Solved {
        if !rough.is_converged() {
            return rough;
        }
        match solve_arcs(&rough.found, self.extremal, attempt, self.recorder) {
            Some(found) => found,
            None => self.solve(rough.found, attempt),
        }
    }
}
