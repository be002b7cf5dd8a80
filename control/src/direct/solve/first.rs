//! A guess before it is a motion on a mesh.

use crate::cubics::Disturbance;
use crate::direct::motion::guess::guess;
use crate::direct::motion::reached::with_tools_reached;
use crate::direct::motion::shape::Shape;
use crate::direct::motion::spline::Spline;
use crate::options::SolverOptions;
use crate::problem::{FinalTime, Problem};
use crate::result::start::GuessKind;
use crate::result::trajectory::Trajectory;
use crate::task::build::TaskRows;
use std::borrow::Cow;

/// Where a motion begins: cubics between positions, with waves, or a saved motion.
#[derive(Clone, Debug)]
pub(crate) struct First<'a> {
    pub kind: GuessKind,
    /// The problem with positions at the ends of its phases at which tools are where they shall be.
    pub reached: Cow<'a, Problem>,
    pub disturbance: Disturbance,
    pub saved: Option<&'a Trajectory>,
}

impl<'a> First<'a> {
    /// The guess of a start.
    pub fn new(
        problem: &'a Problem,
        rows: &TaskRows,
        options: &SolverOptions,
        number: usize,
        saved: Option<&'a Trajectory>,
    ) -> Self {
        let reached = with_tools_reached(problem, rows, number);
        let disturbance = Disturbance::draw(&reached, options.seed, number);
        let kind = match (saved, number) {
            (Some(_), _) => GuessKind::Saved,
            (None, 0) => GuessKind::Straight,
            (None, _) => GuessKind::Disturbed,
        };
        Self { kind, reached, disturbance, saved }
    }

    /// The motion on these nodes, with this final time if one is given and it is free.
    pub fn spline(&self, nodes: Vec<f64>, time: Option<f64>) -> Spline {
        let smooth = self.saved.filter(|_| Shape::of(&self.reached).is_smooth());
        let complete = smooth.and_then(|saved| saved.completed(&self.reached));
        let saved = complete.as_ref().or(self.saved);
        match time {
            None => guess(&self.reached, saved, &self.disturbance, nodes),
            Some(guessed) => {
                let problem = self.reached.clone().into_owned().with_time(FinalTime::Free { guess: guessed });
                guess(&problem, saved, &self.disturbance, nodes)
            }
        }
    }
}
