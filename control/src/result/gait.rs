//! What is told of a gait: its speed, what it costs, the impact at its end.

use crate::problem::loop_rows::{Foot, Walk, exchanged};
use crate::result::trajectory::Trajectory;
use costate::EvalError;
use costate::constraints::Impact;
use serde::{Deserialize, Serialize};

/// What a step of a [`Gait`](crate::Gait) is and costs.
///
/// The cost of transport is the mechanical one of S. Collins, A. Ruina, R. Tedrake, M. Wisse, "Efficient
/// bipedal robots based on passive-dynamic walkers", Science 307 (2005) 1082-1085: the work of the motors
/// where they drive, over weight times distance. What they brake is not given back.
///
/// $$ c = \frac{W}{m g L}, \qquad W = \int_0^T \sum_i \max(\tau_i v_i, 0) \thinspace dt $$
///
/// After a step on level ground the robot has the energy with which it began, so W is `braking` and `loss`
/// together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct GaitReport {
    /// Length of the step over its duration (m/s).
    pub speed: f64,
    /// Mechanical cost of transport c: `work` over `weight_times_length`, without a unit.
    pub cost_of_transport: f64,
    /// Work W of the motors where they drive (J), by the rule of the direct method on its points: of second
    /// order in the intervals where a power changes its sign.
    pub work: f64,
    /// The same of the negative parts of all powers (J), not negative.
    pub braking: f64,
    /// Weight times length of a step (J).
    pub weight_times_length: f64,
    /// Impulses of the ground on the feet that land, in the axes of the world (N s).
    pub impulses: Vec<[f64; 3]>,
    /// How long the phase of double support is (s); `None` in a gait without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub double_support: Option<f64>,
    /// With double support: those on the feet that stay on the ground when the others land (N s).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub standing_impulses: Vec<[f64; 3]>,
    /// Energy that the impact takes (J).
    pub loss: f64,
    /// Largest difference (rad, m, rad/s, m/s) of the state after the impact at the end, legs exchanged, from
    /// the state at the start. The impact is that of [`Impact`](costate::constraints::Impact), which the
    /// solver does not use.
    pub miss: f64,
}

impl GaitReport {
    /// That of a motion whose intervals have as rows both ends and, between them, the points of a rule with
    /// these weights; with the gain of the actuation.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub(crate) fn of(
        walk: &Walk,
        motion: &Trajectory,
        gain: &[f64],
        weights: &[f64],
    ) -> Result<Option<Self>, EvalError> {
        let (Some(first), Some(last)) = (motion.t.first(), motion.t.last()) else { return Ok(None) };
        let (Some(q), Some(v)) = (motion.q.last(), motion.v.last()) else { return Ok(None) };
        let [work, braking] = works(motion, gain, weights);
        let landing = Landing::of(walk, q, v)?;
        let miss = landing.miss(&motion.q[0], &motion.v[0]);
        let Landing { impulses, standing_impulses, loss, .. } = landing;
        let double_support = walk.gait.double_support.and(motion.via_times.first());
        let double_support = double_support.map(|lift_off| lift_off - first);
        let weight_times_length = walk.weight() * walk.gait.length;
        let (speed, cost_of_transport) = (walk.gait.length / (last - first), work / weight_times_length);
        Ok(Some(Self {
            speed,
            cost_of_transport,
            work,
            braking,
            weight_times_length,
            impulses,
            double_support,
            standing_impulses,
            loss,
            miss,
        }))
    }
}

/// The integrals of the positive and of the negative parts of all powers (J), both not negative.
fn works(motion: &Trajectory, gain: &[f64], weights: &[f64]) -> [f64; 2] {
    let rows = weights.len() + 2;
    let mut works = [0.0; 2];
    for interval in 0..motion.t.len() / rows {
        let first = rows * interval;
        let width = motion.t[first + rows - 1] - motion.t[first];
        for (k, weight) in (first + 1..).zip(weights) {
            let parts = motion.u[k].iter().zip(&motion.v[k]).zip(gain);
            for power in parts.map(|((u, v), gain)| gain * u * v) {
                works[usize::from(power < 0.0)] += weight * width * power.abs();
            }
        }
    }
    works
}

/// The state after a step.
pub(crate) struct Landing {
    /// With the legs exchanged.
    q: Vec<f64>,
    v: Vec<f64>,
    impulses: Vec<[f64; 3]>,
    standing_impulses: Vec<[f64; 3]>,
    loss: f64,
}

impl Landing {
    /// That of the state before the foot lands.
    ///
    /// # Errors
    /// States that cannot be evaluated.
    pub fn of(walk: &Walk, q: &[f64], v: &[f64]) -> Result<Self, EvalError> {
        let mut open = costate::hamiltonian::Hamiltonian::<f64>::new(&walk.landing.without_constraints());
        let p = open.momentum(q, v)?.to_vec();
        let mut impact = Impact::<f64>::new(&walk.landing);
        let after = impact.evaluate(q, &p)?;
        let exchanged = |list: &[f64]| exchanged(&walk.exchange, list);
        let places = exchanged(q).iter().zip(&walk.shift).map(|(q, shift)| q + shift).collect();
        // Those that stay have as many rows as where they stand.
        let impulse = |foot: &Foot| walk.gait.force_of(&after.impulse[foot.rows.clone()]);
        let mut impulses: Vec<[f64; 3]> = walk.feet.iter().map(impulse).collect();
        let standing_impulses = impulses.split_off(walk.stance().len());
        Ok(Self { q: places, v: exchanged(after.velocity), impulses, standing_impulses, loss: after.loss })
    }

    /// The largest difference from a state (rad, m, rad/s, m/s).
    pub fn miss(&self, q: &[f64], v: &[f64]) -> f64 {
        let pairs = self.q.iter().zip(q).chain(self.v.iter().zip(v));
        pairs.fold(0.0, |most, (a, b)| most.max((a - b).abs()))
    }
}
