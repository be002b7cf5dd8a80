//! Motions as piecewise polynomials in s = t/T.

use super::basis::{Basis, PLACES, POINTS, WEIGHTS};
use crate::constants::direct::NARROWEST;
use std::sync::Arc;

/// Intervals of [0, 1] with the points at which a motion is evaluated.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    /// The ends of the intervals, from 0 to 1.
    pub nodes: Vec<f64>,
    /// The basis at all points.
    pub(super) basis: Vec<Basis>,
}

impl Mesh {
    /// With these nodes.
    pub fn new(nodes: Vec<f64>) -> Arc<Self> {
        let basis = nodes.windows(2).flat_map(|ends| PLACES.map(|x| Basis::at(x, ends[1] - ends[0])));
        Arc::new(Self { basis: basis.collect(), nodes })
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.nodes.len() - 1
    }

    /// Number of points at which the motion is evaluated.
    pub fn points(&self) -> usize {
        self.basis.len()
    }

    /// Width of an interval.
    pub fn width(&self, k: usize) -> f64 {
        self.nodes[k + 1] - self.nodes[k]
    }

    /// s of a point, and its weight in the integral over s.
    pub fn point(&self, p: usize) -> (f64, f64) {
        let (k, j) = (p / POINTS, p % POINTS);
        let h = self.width(k);
        (self.nodes[k] + PLACES[j] * h, WEIGHTS[j] * h)
    }

    /// Nodes with all intervals in two that are not too narrow.
    pub fn halved(&self) -> Vec<f64> {
        let parts = self.nodes.windows(2).flat_map(|ends| {
            let middle = (ends[1] - ends[0] > NARROWEST).then_some(0.5 * (ends[0] + ends[1]));
            middle.into_iter().chain([ends[1]])
        });
        std::iter::once(self.nodes[0]).chain(parts).collect()
    }

    /// The interval that holds s, and the part of it before s.
    pub fn place(&self, s: f64) -> (usize, f64) {
        let k = self.nodes.partition_point(|&node| node <= s).clamp(1, self.intervals()) - 1;
        (k, (s - self.nodes[k]) / self.width(k))
    }
}

/// q(s) on [0, 1], continuous with its first derivative, a polynomial of degree four on each interval; and T.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spline {
    /// Number of joints.
    pub dof: usize,
    pub mesh: Arc<Mesh>,
    /// q and dq/ds at each node, n entries each; then the heights of the bubbles of each interval, n entries.
    pub unknowns: Vec<f64>,
    /// T (s).
    pub time: f64,
}

impl Spline {
    /// The number of unknowns of n joints.
    pub fn size(n: usize, intervals: usize) -> usize {
        2 * n * (intervals + 1) + n * intervals
    }

    /// Takes another motion; allocates only if that is longer than ever before.
    pub fn copy_from(&mut self, other: &Self) {
        (self.dof, self.time) = (other.dof, other.time);
        self.mesh.clone_from(&other.mesh);
        self.unknowns.clone_from(&other.unknowns);
    }

    /// The unknowns of an interval: heights of bubbles (n), states of both ends (4n).
    pub fn of_interval<'a>(&self, unknowns: &'a [f64], k: usize) -> (&'a [f64], &'a [f64]) {
        let n = self.dof;
        let (ends, inner) = unknowns.split_at(2 * n * self.mesh.nodes.len());
        (&inner[n * k..n * (k + 1)], &ends[2 * n * k..2 * n * (k + 2)])
    }

    /// q and v at the start (0) or end (1), 2n numbers.
    pub fn end(&self, end: usize, state: &mut [f64]) {
        let n = self.dof;
        let first = 2 * n * end * self.mesh.intervals();
        state.copy_from_slice(&self.unknowns[first..first + 2 * n]);
        let rate = 1.0 / self.time;
        state[n..].iter_mut().for_each(|v| *v *= rate);
    }

    /// q, v, a at all points, 3n numbers a point.
    pub fn evaluate(&self, z: &mut [f64]) {
        for (p, (z, basis)) in z.chunks_exact_mut(3 * self.dof).zip(&self.mesh.basis).enumerate() {
            let (inner, ends) = self.of_interval(&self.unknowns, p / POINTS);
            basis.combine(self.dof, inner, ends, z);
            self.scale(z);
        }
    }

    /// q, v, a at the part `x` of interval `k`, 3n numbers.
    pub fn in_interval(&self, k: usize, x: f64, z: &mut [f64]) {
        let (inner, ends) = self.of_interval(&self.unknowns, k);
        Basis::at(x, self.mesh.width(k)).combine(self.dof, inner, ends, z);
        self.scale(z);
    }

    /// Derivatives in s become derivatives in time.
    fn scale(&self, z: &mut [f64]) {
        let (rate, n) = (1.0 / self.time, self.dof);
        z[n..2 * n].iter_mut().for_each(|v| *v *= rate);
        z[2 * n..].iter_mut().for_each(|a| *a *= rate * rate);
    }

    /// A motion through the states and positions that `at` gives: q and dq/ds, at nodes and in the middle of
    /// intervals.
    pub fn through(
        n: usize,
        mesh: Arc<Mesh>,
        time: f64,
        mut at: impl FnMut(f64, &mut [f64], &mut [f64]),
    ) -> Self {
        let mut unknowns = vec![0.0; Self::size(n, mesh.intervals())];
        let (ends, inner) = unknowns.split_at_mut(2 * n * mesh.nodes.len());
        for (&s, state) in mesh.nodes.iter().zip(ends.chunks_exact_mut(2 * n)) {
            let (q, rate) = state.split_at_mut(n);
            at(s, q, rate);
        }
        let (mut q, mut rate, mut z) = (vec![0.0; n], vec![0.0; n], vec![0.0; 3 * n]);
        for (k, bubble) in inner.chunks_exact_mut(n).enumerate() {
            let h = mesh.width(k);
            at(mesh.nodes[k] + 0.5 * h, &mut q, &mut rate);
            Basis::at(0.5, h).combine(n, bubble, &ends[2 * n * k..2 * n * (k + 2)], &mut z);
            bubble.iter_mut().zip(q.iter().zip(&z)).for_each(|(bubble, (q, cubic))| *bubble = q - cubic);
        }
        Self { dof: n, mesh, unknowns, time }
    }

    /// The same motion on other nodes: exact where they contain those of this motion.
    pub fn on_nodes(&self, nodes: Vec<f64>) -> Self {
        let n = self.dof;
        let mut z = vec![0.0; 3 * n];
        let at = |s: f64, q: &mut [f64], rate: &mut [f64]| {
            let (k, x) = self.mesh.place(s);
            let (inner, ends) = self.of_interval(&self.unknowns, k);
            Basis::at(x, self.mesh.width(k)).combine(n, inner, ends, &mut z);
            q.copy_from_slice(&z[..n]);
            rate.copy_from_slice(&z[n..2 * n]);
        };
        Self::through(n, Mesh::new(nodes), self.time, at)
    }
}

#[cfg(test)]
mod tests {
    use super::{Mesh, Spline};

    #[test]
    fn a_finer_mesh_carries_the_same_motion() {
        let mut random = fastrand::Rng::with_seed(3);
        let mesh = Mesh::new(vec![0.0, 0.3, 0.4, 1.0]);
        let unknowns = (0..Spline::size(2, 3)).map(|_| random.f64() - 0.5).collect();
        let spline = Spline { dof: 2, mesh, unknowns, time: 1.7 };
        let finer = spline.on_nodes(vec![0.0, 0.1, 0.3, 0.35, 0.4, 0.9, 1.0]);
        let (mut found, mut expected) = ([0.0; 6], [0.0; 6]);
        let sample = |spline: &Spline, s: f64, z: &mut [f64]| {
            let (k, x) = spline.mesh.place(s);
            spline.in_interval(k, x, z);
        };
        for i in 0..=50 {
            let s = f64::from(i) / 50.0;
            sample(&finer, s, &mut found);
            sample(&spline, s, &mut expected);
            assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-11), "{s}");
        }
        let mut z = vec![0.0; 6 * spline.mesh.points()];
        spline.evaluate(&mut z);
        for p in 0..spline.mesh.points() {
            sample(&spline, spline.mesh.point(p).0, &mut expected);
            assert!(z[6 * p..6 * p + 6].iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
        }
        let sum: f64 = (0..spline.mesh.points()).map(|p| spline.mesh.point(p).1).sum();
        assert!((sum - 1.0).abs() < 1e-15);
    }
}
