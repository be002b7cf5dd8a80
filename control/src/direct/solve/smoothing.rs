//! A cost of torques for the first steps of a motion whose torques cost nothing.
//!
//! Torques without a cost are at their limits at an optimum. Far from it nothing but the barrier bends the
//! cost, and steps lead anywhere. So the first motion minimises time and a cost of these torques, which is
//! about that of time where they are at their limits; it is where the problem itself begins.

use crate::constants::direct as constants;
use crate::direct::interior::iterate::{End, Interior};
use crate::direct::limits::side::{Limited, Side};
use crate::direct::points::values::PointDynamics;
use crate::solve::recorder::Interruption;
use costate::EvalError;

impl<D: PointDynamics> Interior<D> {
    /// Whether time costs something and torques with limits on both sides cost nothing.
    pub fn needs_smoothing(&self) -> bool {
        let shape = self.spline.mesh.shape;
        self.running.time > 0.0
            && !shape.is_smooth()
            && (0..self.spline.dof).any(|i| self.half_range(i).is_some())
    }

    /// Half the distance between the limits of a torque without a cost.
    fn half_range(&self, joint: usize) -> Option<f64> {
        let own = |side: &&Side| side.limited == Limited::Torque && side.joint == joint && !side.is_equation;
        let sides = self.barrier.sides();
        let range = sides.iter().filter(own).map(|side| side.range).find(|range| range.is_finite())?;
        (self.running.effort[joint] == 0.0 && range > 0.0).then_some(0.5 * range)
    }

    /// The costs of torques, those without one with that of [`constants::SMOOTHING`].
    pub fn smooth_effort(&self) -> Vec<f64> {
        let price = |half: f64| 2.0 * constants::SMOOTHING * self.running.time / (half * half);
        let of = |joint: usize| self.half_range(joint).map_or(self.running.effort[joint], price);
        (0..self.spline.dof).map(of).collect()
    }

    /// Minimises with other costs of torques, roughly; then the problem begins there.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn begin_smoothed(
        &mut self,
        mut effort: Vec<f64>,
        most: usize,
        watch: impl FnMut(&mut Self, f64) -> Option<Interruption>,
    ) -> Result<End, EvalError> {
        std::mem::swap(&mut self.running.effort, &mut effort);
        let found = self.start(None).and_then(|()| self.iterate(constants::FIRST_PRECISION, most, watch));
        std::mem::swap(&mut self.running.effort, &mut effort);
        self.measure_cost();
        self.begin_again();
        found
    }
}
