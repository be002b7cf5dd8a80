//! What is told of a gait: its speed, what it costs, the impact at its end.

use crate::problem::loop_rows::{Walk, exchanged};
use crate::result::trajectory::Trajectory;
use costate::EvalError;
use costate::constraints::Impact;
use serde::{Deserialize, Serialize};

/// What a step of a [`Gait`](crate::Gait) is and costs.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct GaitReport {
    /// Length of the step over its duration (m/s).
    pub speed: f64,
    /// `sum of |tau v|`, integrated over the step, over weight times length; from the nodes by trapezoids. A
    /// motor that brakes counts like one that drives. Without the cost of time.
    pub cost_of_transport: f64,
    /// Weight times length of a step (J).
    pub weight_times_length: f64,
    /// Impulses of the ground on the feet that land, in the axes of the world (N s).
    pub impulses: Vec<[f64; 3]>,
    /// Energy that the impact takes (J).
    pub loss: f64,
    /// Largest difference (rad, m, rad/s, m/s) of the state after the impact at the end, legs exchanged, from
    /// the state at the start. The impact is that of [`Impact`](costate::constraints::Impact), which the
    /// solver does not use.
    pub miss: f64,
}

impl GaitReport {
    /// That of a motion, with the actuation as torques (N m, N).
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub(crate) fn of(walk: &Walk, motion: &Trajectory, gain: &[f64]) -> Result<Option<Self>, EvalError> {
        let (Some(first), Some(last)) = (motion.t.first(), motion.t.last()) else { return Ok(None) };
        let duration = last - first;
        let power = |k: usize| {
            let parts = motion.u[k].iter().zip(&motion.v[k]).zip(gain);
            parts.map(|((u, v), gain)| (gain * u * v).abs()).sum::<f64>()
        };
        let widths = motion.t.windows(2).map(|ends| ends[1] - ends[0]).enumerate();
        let work: f64 = widths.map(|(k, width)| 0.5 * width * (power(k) + power(k + 1))).sum();
        let (Some(q), Some(v)) = (motion.q.last(), motion.v.last()) else { return Ok(None) };
        let landing = Landing::of(walk, q, v)?;
        let miss = landing.miss(&motion.q[0], &motion.v[0]);
        let Landing { impulses, loss, .. } = landing;
        let (weight_times_length, speed) = (walk.weight() * walk.gait.length, walk.gait.length / duration);
        let cost_of_transport = work / weight_times_length;
        Ok(Some(Self { speed, cost_of_transport, weight_times_length, impulses, loss, miss }))
    }
}

/// The state after a step.
pub(crate) struct Landing {
    /// With the legs exchanged.
    q: Vec<f64>,
    v: Vec<f64>,
    impulses: Vec<[f64; 3]>,
    loss: f64,
}

impl Landing {
    /// That of the state before the foot lands.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub fn of(walk: &Walk, q: &[f64], v: &[f64]) -> Result<Self, EvalError> {
        let mut open = costate::hamiltonian::Hamiltonian::<f64>::new(&walk.swing.without_constraints());
        let p = open.momentum(q, v)?.to_vec();
        let mut impact = Impact::<f64>::new(&walk.swing);
        let after = impact.evaluate(q, &p)?;
        let exchanged = |list: &[f64]| exchanged(&walk.exchange, list);
        let places = exchanged(q).iter().zip(&walk.shift).map(|(q, shift)| q + shift).collect();
        let impulses = after.impulse.chunks_exact(2).map(|foot| [foot[0], 0.0, foot[1]]).collect();
        Ok(Self { q: places, v: exchanged(after.velocity), impulses, loss: after.loss })
    }

    /// The largest difference from a state (rad, m, rad/s, m/s).
    pub fn miss(&self, q: &[f64], v: &[f64]) -> f64 {
        let pairs = self.q.iter().zip(q).chain(self.v.iter().zip(v));
        pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
    }
}
