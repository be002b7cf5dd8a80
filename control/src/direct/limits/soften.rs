//! Active limits that are no stiffer than Newton's equations resolve.

use super::barrier::Barrier;
use super::side::Limited;

impl Barrier {
    /// Moves slacks of active limits away from them, until the second derivative of each, its multiplier over
    /// its slack, is at most `most` times its weight over the square of its range.
    ///
    /// The multiplier over the slack grows as the reciprocal of the barrier. An active limit is an equation
    /// long before rounding of it hides all other second derivatives: those of positions and rates then stand
    /// in the equations as those of torques do, since torques contain a second derivative of positions in s;
    /// where accelerations are continuous all stand there as those of jerks do.
    pub fn soften(&mut self, most: f64) {
        let highest = if self.is_smooth() { 3 } else { 2 };
        for at in 0..self.count() {
            if !self.is_limit(at) {
                continue;
            }
            // About a third of the width of an interval.
            let width = self.weight[at];
            // The order of the derivative, of those that may jump.
            let order = match self.side(at).limited {
                Limited::Position => 0,
                Limited::Rate | Limited::Task => 1,
                Limited::Jerk | Limited::TorqueRate => 3,
                _ => 2,
            };
            let squared = width.powi(2 * (highest - order));
            let stiffest = most * width * self.unit[at] * self.unit[at] / squared;
            self.slack[at] = self.slack[at].max(self.multiplier[at] / stiffest);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::motion::shape::Shape;

    #[test]
    fn stiff_limits_become_softer_and_others_stay() {
        let mut barrier = started(Shape::Quartic).barrier;
        let limits: Vec<usize> = (0..barrier.count()).filter(|&at| barrier.is_limit(at)).collect();
        // Every other one is far too stiff.
        for &at in limits.iter().step_by(2) {
            barrier.slack[at] = 1e-30 * barrier.multiplier[at];
        }
        let before = barrier.clone();
        barrier.soften(1e9);
        assert!(limits.len() > 4 && barrier.multiplier == before.multiplier);
        for (k, &at) in limits.iter().enumerate() {
            match k % 2 {
                0 => assert!(barrier.curvature(at) < 1e-3 * before.curvature(at), "{at}"),
                _ => assert_eq!(barrier.slack[at], before.slack[at], "{at}"),
            }
        }
        // No more than once.
        let softened = barrier.clone();
        barrier.soften(1e9);
        let same = |at: &usize| (barrier.slack[*at] / softened.slack[*at] - 1.0).abs() < 1e-15;
        assert!(limits.iter().all(same));
    }
}
