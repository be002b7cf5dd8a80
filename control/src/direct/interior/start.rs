//! Where an iteration starts: values at the points, slacks and multipliers.

use super::iterate::Interior;
use crate::constants::direct as constants;
use crate::direct::newton::side_terms::weigh;
use crate::direct::points::values::PointDynamics;
use costate::EvalError;

impl<D: PointDynamics> Interior<D> {
    /// Evaluates the spline, and makes slacks and multipliers for it with the barrier `mu`; `None` chooses
    /// it.
    pub fn start(&mut self, mu: Option<f64>) -> Result<(), EvalError> {
        self.prepare();
        self.begin(mu)
    }

    /// The same in room that is there.
    pub(crate) fn begin(&mut self, mu: Option<f64>) -> Result<(), EvalError> {
        self.spline.evaluate(&mut self.points.z);
        if self.small_cost.is_none() {
            self.model.dynamics.contract(&mut self.points)?;
            self.measure_small_cost();
        }
        self.evaluate()?;
        self.measure_cost();
        self.barrier.stiffness = constants::STIFFNESS * self.figures.size;
        let total = self.barrier.total_weight().max(f64::MIN_POSITIVE);
        self.mu = mu.unwrap_or(constants::FIRST_GAP * self.figures.size / total);
        for at in 0..self.barrier.count() {
            let weight = self.barrier.weight[at];
            let side = self.barrier.side(at);
            let slack = match weight > 0.0 {
                true if side.is_equation => 0.0,
                true => self.barrier.distance[at].max(constants::FIRST_SLACK * side.range),
                false => f64::INFINITY,
            };
            self.barrier.slack[at] = slack;
            self.barrier.multiplier[at] = if slack > 0.0 { self.mu * weight / slack } else { 0.0 };
        }
        self.damping = 0.0;
        self.least_violation = self.find_least_violation();
        self.measure_figures();
        Ok(())
    }

    /// Room for the points and entries of the mesh.
    pub(crate) fn prepare(&mut self) {
        self.model.resize(&self.spline, &mut self.points);
        self.barrier.resize(&self.spline.mesh, &self.ends);
    }

    /// Values at the points of the motion, and distances to all limits.
    pub(crate) fn evaluate(&mut self) -> Result<(), EvalError> {
        self.model.evaluate(&self.spline, &mut self.points)?;
        self.measure_distances();
        Ok(())
    }

    /// Weights and derivatives at the points of this iterate.
    pub fn refresh(&mut self) -> Result<(), EvalError> {
        weigh(&self.spline, &mut self.points, &self.barrier, &self.running);
        self.model.contract(&self.spline, &mut self.points)
    }
}
