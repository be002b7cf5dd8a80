//! What one attempt to solve a boundary-value problem may do.

use crate::bvp::newton::Limits;
use crate::constants::attempts::LOOSE;
use crate::constants::newton::{LEAST_DAMPING, PART_OF_TOLERANCE};
use crate::options::{Method, SolverOptions};
use crate::progress::Phase;

/// Settings of one attempt, passed by value: who needs others makes a copy.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    /// What is being solved, for the log.
    pub phase: Phase,
    pub method: Method,
    /// Nodes of the first mesh.
    pub nodes: usize,
    /// Lobatto points of an interval.
    pub points: usize,
    /// Largest relative error of the motion.
    pub tolerance: f64,
    /// Most Newton steps on one mesh.
    pub max_steps: usize,
    pub least_damping: f64,
    pub max_nodes: usize,
}

impl Attempt {
    /// As the options say.
    pub fn new(options: &SolverOptions, phase: Phase) -> Self {
        Self {
            phase,
            method: options.method,
            nodes: options.nodes,
            points: options.points,
            tolerance: options.tolerance,
            max_steps: options.max_iterations,
            least_damping: LEAST_DAMPING,
            max_nodes: options.max_nodes,
        }
    }

    /// The same in another phase.
    pub fn in_phase(self, phase: Phase) -> Self {
        Self { phase, ..self }
    }

    /// For a solution that only leads to the next one.
    pub fn loose(self) -> Self {
        self.no_sharper_than(LOOSE)
    }

    /// With at least this tolerance.
    pub fn no_sharper_than(self, tolerance: f64) -> Self {
        Self { tolerance: tolerance.max(self.tolerance), ..self }
    }

    /// Most intervals of a mesh.
    pub fn max_intervals(&self) -> usize {
        self.max_nodes - 1
    }

    /// When Newton's method stops on one mesh.
    pub fn limits(&self) -> Limits {
        Limits {
            tolerance: PART_OF_TOLERANCE * self.tolerance,
            max_steps: self.max_steps,
            least_damping: self.least_damping,
        }
    }
}
