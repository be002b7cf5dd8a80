//! Inverse dynamics of open trees and of robots whose loops are closed.

use super::closed_points::ClosedPoints;
#[cfg(not(feature = "jit"))]
use super::generic_points::LanePoints as OpenPoints;
#[cfg(feature = "jit")]
use super::program_points::ProgramPoints as OpenPoints;
use super::values::{PointDynamics, Points};
use crate::options::SolverOptions;
use crate::problem::Problem;
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
    /// For the robot of a phase of a problem; `options` say whether machine code is used.
    pub fn new(problem: &Problem, robot: &Robot, options: &SolverOptions) -> Self {
        if let Some(loops) = &problem.loops {
            return Self::Closed(Box::new(ClosedPoints::new(loops)));
        }
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
