//! What small motions cost: below that, costs are not resolved.

use crate::constants::direct as constants;
use crate::direct::points::running::Running;

/// Cost of the efforts, of the energy, of the jerks and of the rates of torques that move each joint alone by
/// [`constants::SMALL_MOTION`] s within a time T. The torque is `M_ii s / T^2`, so the cost is
///
/// ```text
/// sum_i T (r_i/2 (M_ii s/T^2)^2 + e_i M_ii s^2/T^3 + w_i/2 (s/T^3)^2 + d_i/2 (M_ii s/T^3)^2)
/// ```
///
/// with weights r of efforts, e of the energy, w of jerks, d of torque rates. It is that of the present T: a
/// guess that is a thousand times too short would make costs look small that are not.
#[derive(Clone, Copy, Debug)]
pub(super) struct SmallCost {
    effort: f64,
    energy: f64,
    rates: f64,
}

impl SmallCost {
    /// With the moment of inertia, or the mass, that each joint moves alone.
    pub fn new(running: &Running, inertia: impl Fn(usize) -> f64) -> Self {
        let (mut effort, mut energy, mut rates) = (0.0, 0.0, 0.0);
        for (i, r) in running.effort.iter().enumerate() {
            let of = |weights: &[f64]| weights.get(i).copied().unwrap_or(0.0);
            let (motion, force) = (constants::SMALL_MOTION, inertia(i) * constants::SMALL_MOTION);
            effort += 0.5 * r * force * force;
            energy += of(&running.energy.weights) * force * motion;
            rates +=
                0.5 * (of(&running.rates.jerk) * motion * motion + of(&running.rates.torque) * force * force);
        }
        Self { effort, energy, rates }
    }

    /// The cost within a time (s).
    pub fn within(&self, time: f64) -> f64 {
        let squared = time * time;
        ((self.effort + self.rates / squared) / time + self.energy) / squared
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn costs_are_those_of_each_power_of_the_time() {
        let cost = SmallCost { effort: 3.0, energy: 5.0, rates: 7.0 };
        for time in [0.5_f64, 2.0] {
            let expected = time * (3.0 / time.powi(4) + 5.0 / time.powi(3) + 7.0 / time.powi(6));
            assert!((cost.within(time) - expected).abs() < 1e-12 * expected, "{time}");
        }
    }
}
