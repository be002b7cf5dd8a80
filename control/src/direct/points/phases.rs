//! Robots that carry something else in each phase, or stand on other feet.

use super::values::{PointDynamics, Points};
use costate::EvalError;
use costate::robot::Robot;
use std::ops::Range;

/// Inverse dynamics at many points, by the robot of their phase.
#[derive(Debug)]
pub(crate) struct PhaseDynamics<D> {
    /// Those of different robots.
    models: Vec<D>,
    /// That of each phase.
    of_phase: Vec<usize>,
}

impl<D: PointDynamics> PhaseDynamics<D> {
    /// With a model for each different robot of the phases.
    pub fn new(robots: &[Robot], model: impl Fn(&Robot) -> D) -> Self {
        let mut different: Vec<&Robot> = Vec::new();
        let mut number = |robot| {
            let known = different.iter().position(|other| *other == robot);
            known.unwrap_or_else(|| {
                different.push(robot);
                different.len() - 1
            })
        };
        let of_phase = robots.iter().map(&mut number).collect();
        Self { models: different.into_iter().map(model).collect(), of_phase }
    }

    /// With these models, one for each phase.
    pub fn of_each(models: Vec<D>) -> Self {
        let of_phase = (0..models.len()).collect();
        Self { models, of_phase }
    }

    /// Does `work` with the model of each phase and those of the points that are in it.
    fn each(
        &mut self,
        points: &mut Points,
        which: &Range<usize>,
        work: impl Fn(&mut D, &mut Points, Range<usize>) -> Result<(), EvalError>,
    ) -> Result<(), EvalError> {
        for (phase, &model) in self.of_phase.iter().enumerate() {
            let own = points.phase(phase);
            let own = own.start.max(which.start)..own.end.min(which.end);
            if !own.is_empty() {
                work(&mut self.models[model], points, own)?;
            }
        }
        Ok(())
    }
}

impl<D: PointDynamics> PointDynamics for PhaseDynamics<D> {
    fn evaluate_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        self.each(points, &which, D::evaluate_some)
    }

    fn contract_some(&mut self, points: &mut Points, which: Range<usize>) -> Result<(), EvalError> {
        self.each(points, &which, D::contract_some)
    }
}
