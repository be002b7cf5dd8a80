//! Guesses: where a search begins.

use crate::bvp::timed::Switch;
use crate::constants::direct::ACTIVE as NEAR;
use crate::cubics::{Cubics, Disturbance};
use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::{BoundSide, SideChange};
use crate::problem::Problem;
use crate::solve::crossings::Crossing;

/// Where a search begins: z at s = t/T.
pub(crate) trait Guess {
    /// A saved motion, or a simple one that covers the part `goal` of the distance to the end.
    fn simple(&mut self, goal: f64, s: f64, z: &mut [f64]);

    /// Duration of the saved motion (s), if the simple guess is one.
    fn saved_duration(&self) -> Option<f64> {
        None
    }

    /// Lengths of the intervals between the nodes of the saved motion, in parts of its duration.
    fn saved_mesh(&self) -> Option<Vec<f64>> {
        None
    }

    /// Where the controls of the saved motion jump from bound to bound, in the order of time.
    fn saved_crossings(&self) -> Vec<Crossing> {
        Vec::new()
    }

    /// The simple guess is another one from here on.
    fn forget_saved(&mut self) {}

    /// Whether a motion is at hand that keeps all bounds, so that it is no loss if no extremal is found.
    fn is_replaceable(&self) -> bool {
        false
    }
}

/// A guess of z alone.
pub(crate) struct Plain<F>(pub F);

impl<F: FnMut(f64, &mut [f64])> Guess for Plain<F> {
    fn simple(&mut self, _: f64, s: f64, z: &mut [f64]) {
        (self.0)(s, z);
    }
}

/// A motion at its nodes, in rows of n.
#[derive(Clone, Copy)]
pub(crate) struct SavedMotion<'a> {
    /// Times (s).
    pub t: &'a [f64],
    /// q, p, y_q, y_p.
    pub parts: [&'a [Vec<f64>]; 4],
    /// Every how many rows are the nodes of its mesh.
    pub stride: usize,
    /// Controls.
    pub u: &'a [Vec<f64>],
}

impl SavedMotion<'_> {
    /// From the first to the last node (s).
    pub fn duration(&self) -> f64 {
        self.t.last().zip(self.t.first()).map_or(0.0, |(last, first)| last - first)
    }

    /// Where the controls without effort of a problem pass the middle between their bounds, and the others
    /// reach or leave theirs, in the order of time.
    pub fn crossings(&self, problem: &Problem) -> Vec<Crossing> {
        let Some(bounds) = &problem.bounds else { return Vec::new() };
        let mut found = Vec::new();
        for (control, &effort) in problem.cost.effort.iter().enumerate() {
            let (low, high) = (bounds.u_min[control], bounds.u_max[control]);
            let (middle, near) = (0.5 * (low + high), NEAR * (high - low));
            // The value that u passes on its way between two sides.
            let levels = if effort == 0.0 { [middle; 2] } else { [low + near, high - near] };
            let side = |u: f64| match u {
                u if u <= levels[0] => BoundSide::Low,
                u if u >= levels[1] => BoundSide::High,
                _ => BoundSide::Inside,
            };
            for (t, u) in self.t.windows(2).zip(self.u.windows(2)) {
                let (before, after) = (u[0][control], u[1][control]);
                let change = SideChange::new(side(before), side(after));
                if change.before != change.after {
                    let at = if effort == 0.0 { (middle - before) / (after - before) } else { 0.5 };
                    let time = t[0] + at.clamp(0.0, 1.0) * (t[1] - t[0]);
                    found.push(Crossing { time, switch: Switch { control, change } });
                }
            }
        }
        found.sort_by(|a, b| a.time.total_cmp(&b.time));
        found
    }

    /// Lengths of the intervals between its nodes, in parts of its duration.
    pub fn lengths(&self) -> Vec<f64> {
        let (duration, last) = (self.duration(), self.t.len() - 1);
        let nodes = (0..last).step_by(self.stride);
        let lengths = nodes.map(|k| (self.t[(k + self.stride).min(last)] - self.t[k]) / duration);
        lengths.filter(|&length| length > 0.0).collect()
    }

    /// z at s = t/T, linearly between nodes.
    pub fn sample(&self, s: f64, z: &mut [f64]) {
        let (t, last) = (self.t, self.t.len() - 1);
        let now = t[0] + s * (t[last] - t[0]);
        let right = t.partition_point(|&node| node <= now).clamp(1, last.max(1)).min(last);
        let left = right.saturating_sub(1);
        let length = t[right] - t[left];
        let part = if length > 0.0 { ((now - t[left]) / length).clamp(0.0, 1.0) } else { 0.0 };
        let n = z.len() / 4;
        for (target, values) in z.chunks_exact_mut(n).zip(self.parts) {
            for (i, target) in target.iter_mut().enumerate() {
                *target = values[left][i] + part * (values[right][i] - values[left][i]);
            }
        }
    }
}

/// Guesses for a robot in z = (q, p, y_q, y_p): a saved motion or cubics.
pub(crate) struct RobotGuess<'a> {
    pub problem: &'a Problem,
    pub disturbance: Disturbance,
    pub saved: Option<SavedMotion<'a>>,
    /// Whether the direct method found a motion.
    pub begun: bool,
    /// Evaluates momenta.
    pub momenta: RobotExtremal,
}

impl RobotGuess<'_> {
    /// Cubics in the joint coordinates, p = M v, costates zero. Where the mass matrix cannot be evaluated, p
    /// = 0.
    fn cubics(&mut self, goal: f64, s: f64, z: &mut [f64]) {
        let n = self.problem.robot.dof();
        let cubics = Cubics { problem: self.problem, disturbance: &self.disturbance, goal };
        let mut v = vec![0.0; n];
        for i in 0..n {
            let at = cubics.at(i, s);
            (z[i], v[i]) = (at.q, at.v);
        }
        let (q, rest) = z.split_at_mut(n);
        rest.fill(0.0);
        if let Ok(p) = self.momenta.momentum(q, &v) {
            rest[..n].copy_from_slice(p);
        }
    }
}

impl Guess for RobotGuess<'_> {
    fn simple(&mut self, goal: f64, s: f64, z: &mut [f64]) {
        match self.saved {
            Some(saved) if goal == 1.0 => saved.sample(s, z),
            _ => self.cubics(goal, s, z),
        }
    }

    fn saved_duration(&self) -> Option<f64> {
        self.saved.as_ref().map(SavedMotion::duration)
    }

    fn saved_mesh(&self) -> Option<Vec<f64>> {
        self.saved.as_ref().map(SavedMotion::lengths)
    }

    fn saved_crossings(&self) -> Vec<Crossing> {
        self.saved.as_ref().map_or_else(Vec::new, |saved| saved.crossings(self.problem))
    }

    fn forget_saved(&mut self) {
        self.saved = None;
    }

    fn is_replaceable(&self) -> bool {
        self.begun
    }
}
