//! Inverse dynamics of open trees and of robots whose loops are closed.

use super::closed_points::ClosedPoints;
#[cfg(not(feature = "jit"))]
use super::generic_points::LanePoints as OpenPoints;
use super::phases::PhaseDynamics;
#[cfg(feature = "jit")]
use super::program_points::ProgramPoints as OpenPoints;
use super::values::{PointDynamics, Points};
use crate::options::SolverOptions;
use crate::problem::Problem;
use crate::problem::loop_rows::Loops;
use costate::EvalError;
use costate::robot::Robot;
use std::ops::Range;

/// Of either kind.
#[derive(Debug)]
pub(crate) enum AnyPoints {
    Open(Box<OpenPoints>),
    Closed(Box<ClosedPoints>),
}

impl AnyPoints {
    /// Those of all phases of a problem; `options` say whether machine code is used.
    pub fn of_phases(problem: &Problem, options: &SolverOptions) -> PhaseDynamics<Self> {
        let closed = |loops: &Loops, phase| Self::Closed(Box::new(ClosedPoints::new(loops, phase)));
        match &problem.loops {
            Some(loops) => {
                PhaseDynamics::of_each((0..loops.phases.len()).map(|phase| closed(loops, phase)).collect())
            }
            None => PhaseDynamics::new(&problem.robots(), |robot| Self::open(robot, options)),
        }
    }

    fn open(robot: &Robot, options: &SolverOptions) -> Self {
        #[cfg(feature = "jit")]
        let points = OpenPoints::new(robot, options.machine_code);
        #[cfg(not(feature = "jit"))]
        let points = {
            let _ = options;
            OpenPoints::new(robot)
        };
        Self::Open(Box::new(points))
    }
}

impl PointDynamics for AnyPoints {
    fn evaluate_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        match self {
            Self::Open(open) => open.evaluate_some(points, which),
            Self::Closed(closed) => closed.evaluate_some(points, which),
        }
    }

    fn contract_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        match self {
            Self::Open(open) => open.contract_some(points, which),
            Self::Closed(closed) => closed.contract_some(points, which),
        }
    }
}
