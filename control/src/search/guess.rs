//! Where a search begins.

use crate::extremal::hamiltonian::RobotExtremal;
use crate::path::{Path, Wish, lowest_path};
use crate::problem::Problem;
use crate::result::trajectory::Trajectory;
use crate::search::Guess;
use crate::solve::Context;

/// The cubic in t that takes a joint from (q, v) at 0 to (q, v) at T: position and rate at s = t/T.
fn cubic((q0, v0): (f64, f64), (q1, v1): (f64, f64), time: f64, s: f64) -> (f64, f64) {
    let (a, b) = (v0 * time, v1 * time);
    let difference = q1 - q0;
    let q = q0 + s * (a + s * (3.0 * difference - 2.0 * a - b + s * (a + b - 2.0 * difference)));
    let v = (a + s * (2.0 * (3.0 * difference - 2.0 * a - b) + 3.0 * s * (a + b - 2.0 * difference))) / time;
    (q, v)
}

/// Adds `amplitude sin^2(pi k s)` for some k to the path of each joint, none at the ends in position and rate.
#[derive(Clone, Debug, Default)]
pub(crate) struct Disturbance {
    /// For each joint (amplitude, k).
    waves: Vec<(f64, f64)>,
}

impl Disturbance {
    /// None for number 0; else one drawn for this seed and number: half a turn and the length of the way are usual sizes.
    pub fn draw(problem: &Problem, seed: u64, number: usize) -> Self {
        if number == 0 {
            return Self::default();
        }
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(number as u64);
        let ways = problem.start.q.iter().zip(&problem.end.q).map(|(from, to)| (to - from).abs());
        let wave = |way: f64| {
            let amplitude = (2.0 * uniform(&mut state) - 1.0) * (1.5 + way);
            (amplitude, if uniform(&mut state) < 0.7 { 1.0 } else { 2.0 })
        };
        Self { waves: ways.map(wave).collect() }
    }

    fn add(&self, joint: usize, time: f64, s: f64, (q, v): (f64, f64)) -> (f64, f64) {
        let Some(&(amplitude, k)) = self.waves.get(joint) else { return (q, v) };
        let (sin, cos) = (std::f64::consts::PI * k * s).sin_cos();
        (q + amplitude * sin * sin, v + amplitude * 2.0 * sin * cos * std::f64::consts::PI * k / time)
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

/// Position and rate of joint i at s = t/T on the disturbed cubic to a part of the way to the end.
pub(crate) fn disturbed_cubic(
    problem: &Problem,
    (disturbance, goal): (&Disturbance, f64),
    i: usize,
    s: f64,
) -> (f64, f64) {
    let (from, to, time) = (
        (problem.start.q[i], problem.start.v[i]),
        (problem.end.q[i], problem.end.v[i]),
        problem.time.value(),
    );
    let part = |from: f64, to: f64| if goal == 1.0 { to } else { from + goal * (to - from) };
    disturbance.add(i, time, s, cubic(from, (part(from.0, to.0), part(from.1, to.1)), time, s))
}

/// z at s = t/T: cubics in the joint coordinates to a part of the way to the end, p = M v, costates zero. Where the mass
/// matrix cannot be formed, p = 0.
pub(crate) fn cubics(
    problem: &Problem,
    extremal: &mut RobotExtremal,
    (disturbance, goal): (&Disturbance, f64),
    s: f64,
    z: &mut [f64],
) {
    let n = problem.robot.len();
    let mut v = vec![0.0; n];
    for i in 0..n {
        (z[i], v[i]) = disturbed_cubic(problem, (disturbance, goal), i, s);
    }
    let (q, rest) = z.split_at_mut(n);
    rest.fill(0.0);
    if let Ok(p) = extremal.momentum(q, &v) {
        rest[..n].copy_from_slice(p);
    }
}

/// Guesses for a robot: a saved motion or cubics, and paths of low cost.
pub(crate) struct RobotGuess<'a> {
    pub problem: &'a Problem,
    pub disturbance: Disturbance,
    pub saved: Option<&'a Trajectory>,
    /// What gives momenta.
    pub momenta: RobotExtremal,
    pub path: Option<Path>,
}

impl Guess for RobotGuess<'_> {
    fn simple(&mut self, goal: f64, s: f64, z: &mut [f64]) {
        match self.saved {
            Some(start) if goal == 1.0 => saved(start, s, z),
            _ => cubics(self.problem, &mut self.momenta, (&self.disturbance, goal), s, z),
        }
    }

    fn saved(&self) -> Option<f64> {
        self.saved.and_then(|motion| Some(motion.t.last()? - motion.t.first()?))
    }

    fn find_path(&mut self, wish: Wish, context: &mut Context<'_>) -> Option<(f64, f64)> {
        self.path = lowest_path(self.problem, &self.disturbance, wish, |step| context.record(step));
        self.path.as_ref().map(|path| (path.cost(), path.time()))
    }

    fn path(&mut self, s: f64, z: &mut [f64]) {
        if self.path.as_mut().is_none_or(|path| path.sample(s, z).is_err()) {
            z.fill(f64::NAN);
        }
    }
}

/// z at s = t/T between the nodes of a saved motion, linearly.
pub(crate) fn saved(trajectory: &Trajectory, s: f64, z: &mut [f64]) {
    let (t, last) = (&trajectory.t, trajectory.t.len() - 1);
    let now = t[0] + s * (t[last] - t[0]);
    let right = t.partition_point(|&node| node <= now).clamp(1, last.max(1)).min(last);
    let left = right.saturating_sub(1);
    let length = t[right] - t[left];
    let part = if length > 0.0 { ((now - t[left]) / length).clamp(0.0, 1.0) } else { 0.0 };
    let parts = [&trajectory.q, &trajectory.p, &trajectory.y_q, &trajectory.y_p];
    let n = z.len() / 4;
    for (target, values) in z.chunks_exact_mut(n).zip(parts) {
        for (i, target) in target.iter_mut().enumerate() {
            *target = values[left][i] + part * (values[right][i] - values[left][i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::cubic;

    #[test]
    fn cubics_meet_their_ends() {
        let (from, to, time) = ((0.3, -0.2), (1.4, 0.7), 2.5);
        let (start, end) = (cubic(from, to, time, 0.0), cubic(from, to, time, 1.0));
        assert!((start.0 - 0.3).abs() + (start.1 + 0.2).abs() < 1e-14);
        assert!((end.0 - 1.4).abs() + (end.1 - 0.7).abs() < 1e-14);
        let slope =
            (cubic(from, to, time, 0.4 + 1e-6).0 - cubic(from, to, time, 0.4 - 1e-6).0) / (2e-6 * time);
        assert!((slope - cubic(from, to, time, 0.4).1).abs() < 1e-9);
    }
}
