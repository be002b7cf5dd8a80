//! Cubics in the joint coordinates from start to end, with disturbances.

use crate::constants::cubics::{AMPLITUDE, ONE_WAVE};
use crate::problem::Problem;

/// Position and rate of a joint (rad, rad/s or m, m/s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct JointState {
    pub q: f64,
    pub v: f64,
}

/// For each joint the cubic in time from its start to its end, disturbed.
#[derive(Clone, Copy)]
pub(crate) struct Cubics<'a> {
    pub problem: &'a Problem,
    pub disturbance: &'a Disturbance,
    /// Part of the distance to the end: 1 for the end itself.
    pub goal: f64,
}

impl Cubics<'_> {
    /// Joint i at s = t/T.
    pub fn at(&self, i: usize, s: f64) -> JointState {
        let (start, end, goal) = (&self.problem.start, &self.problem.end, self.goal);
        let from = JointState { q: start.q[i], v: start.v[i] };
        let part = |from: f64, to: f64| if goal == 1.0 { to } else { from + goal * (to - from) };
        let to = JointState { q: part(from.q, end.q[i]), v: part(from.v, end.v[i]) };
        let time = self.problem.time.value();
        self.disturbance.add(i, time, s, cubic(from, to, time, s))
    }
}

/// The cubic in t that takes a joint from one state to another, at s = t/T.
pub(crate) fn cubic(from: JointState, to: JointState, time: f64, s: f64) -> JointState {
    let (a, b) = (from.v * time, to.v * time);
    let difference = to.q - from.q;
    let q = from.q + s * (a + s * (3.0 * difference - 2.0 * a - b + s * (a + b - 2.0 * difference)));
    let v = (a + s * (2.0 * (3.0 * difference - 2.0 * a - b) + 3.0 * s * (a + b - 2.0 * difference))) / time;
    JointState { q, v }
}

/// Adds `amplitude sin^2(pi k s)` to the path of each joint; position and rate at the ends stay.
#[derive(Clone, Debug, Default)]
pub(crate) struct Disturbance {
    waves: Vec<Wave>,
}

/// The disturbance of a joint.
#[derive(Clone, Copy, Debug)]
struct Wave {
    /// rad or m.
    amplitude: f64,
    /// k.
    count: f64,
}

impl Disturbance {
    /// None for number 0; else one that seed and number determine. Amplitudes are about half a revolution and
    /// the distance from start to end.
    pub fn draw(problem: &Problem, seed: u64, number: usize) -> Self {
        if number == 0 {
            return Self::default();
        }
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(number as u64);
        let distances = problem.start.q.iter().zip(&problem.end.q).map(|(from, to)| (to - from).abs());
        let wave = |distance: f64| {
            let amplitude = (2.0 * uniform(&mut state) - 1.0) * (AMPLITUDE + distance);
            Wave { amplitude, count: if uniform(&mut state) < ONE_WAVE { 1.0 } else { 2.0 } }
        };
        Self { waves: distances.map(wave).collect() }
    }

    /// One joint of n out and back by this amplitude (rad, m).
    pub fn bend(n: usize, joint: usize, amplitude: f64) -> Self {
        let wave = |i: usize| Wave { amplitude: if i == joint { amplitude } else { 0.0 }, count: 1.0 };
        Self { waves: (0..n).map(wave).collect() }
    }

    /// An entry of q that was moved out of its way, at s = t/T.
    pub fn add(&self, joint: usize, time: f64, s: f64, at: JointState) -> JointState {
        let Some(&Wave { amplitude, count: k }) = self.waves.get(joint) else { return at };
        let (sin, cos) = (std::f64::consts::PI * k * s).sin_cos();
        JointState {
            q: at.q + amplitude * sin * sin,
            v: at.v + amplitude * 2.0 * sin * cos * std::f64::consts::PI * k / time,
        }
    }
}

/// A number in [0, 1) (the generator SplitMix64).
fn uniform(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut bits = *state;
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::{JointState, cubic};

    #[test]
    fn cubics_meet_their_ends() {
        let (from, to, time) = (JointState { q: 0.3, v: -0.2 }, JointState { q: 1.4, v: 0.7 }, 2.5);
        let (start, end) = (cubic(from, to, time, 0.0), cubic(from, to, time, 1.0));
        assert!((start.q - 0.3).abs() + (start.v + 0.2).abs() < 1e-14);
        assert!((end.q - 1.4).abs() + (end.v - 0.7).abs() < 1e-14);
        let slope =
            (cubic(from, to, time, 0.4 + 1e-6).q - cubic(from, to, time, 0.4 - 1e-6).q) / (2e-6 * time);
        assert!((slope - cubic(from, to, time, 0.4).v).abs() < 1e-9);
    }
}
