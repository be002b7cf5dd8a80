//! Motions as piecewise polynomials in s = t/T.

use super::basis::Basis;
use super::shape::{PLACES, POINTS, Shape, WEIGHTS};
use std::sync::Arc;

/// Intervals of [0, 1] with the points at which a motion is evaluated.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    /// The ends of the intervals, from 0 to 1.
    pub nodes: Vec<f64>,
    pub shape: Shape,
    /// The basis at all points, those that two intervals share once for each of them.
    basis: Vec<Basis>,
    /// The same at Gauss's points, where accelerations are continuous.
    gauss: Vec<Basis>,
}

impl Mesh {
    /// With these nodes.
    pub fn new(nodes: Vec<f64>, shape: Shape) -> Arc<Self> {
        let at = |places: &'static [f64]| {
            let widths = nodes.windows(2).map(|ends| ends[1] - ends[0]);
            widths.flat_map(|h| places.iter().map(move |&x| Basis::at(shape, x, h))).collect()
        };
        let (basis, gauss) = (at(shape.places()), if shape.is_smooth() { at(&PLACES) } else { Vec::new() });
        Arc::new(Self { basis, gauss, shape, nodes })
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.nodes.len() - 1
    }

    /// Number of points at which the motion is evaluated.
    pub fn points(&self) -> usize {
        self.shape.stride() * self.intervals() + self.shape.places().len() - self.shape.stride()
    }

    /// The interval of a point, and its number there: the one to the right of a point that two share.
    #[inline(always)]
    pub fn interval_of(&self, p: usize) -> (usize, usize) {
        let stride = self.shape.stride();
        let k = (p / stride).min(self.intervals() - 1);
        (k, p - stride * k)
    }

    /// Number of points of an interval that are not those of the next one.
    pub fn own_points(&self, k: usize) -> usize {
        if k + 1 == self.intervals() { self.shape.places().len() } else { self.shape.stride() }
    }

    /// The basis at point `j` of an interval.
    #[inline(always)]
    pub(super) fn basis(&self, k: usize, j: usize) -> &Basis {
        &self.basis[self.shape.places().len() * k + j]
    }

    /// The basis at one of Gauss's points, where accelerations are continuous.
    pub(super) fn gauss_basis(&self, k: usize, j: usize) -> &Basis {
        &self.gauss[POINTS * k + j]
    }

    /// Number of Gauss's points at which jerks and rates of torques are known.
    pub fn gauss_points(&self) -> usize {
        self.gauss.len()
    }

    /// s of one of Gauss's points, and its weight.
    pub fn gauss_point(&self, p: usize) -> (f64, f64) {
        let (k, j) = (p / POINTS, p % POINTS);
        let h = self.width(k);
        (self.nodes[k] + PLACES[j] * h, WEIGHTS[j] * h)
    }

    /// Width of an interval.
    pub fn width(&self, k: usize) -> f64 {
        self.nodes[k + 1] - self.nodes[k]
    }

    /// s of a point, and its weight in the integral over s.
    #[inline(always)]
    pub fn point(&self, p: usize) -> (f64, f64) {
        let (k, j) = self.interval_of(p);
        let (h, shape) = (self.width(k), self.shape);
        let mut weight = shape.weights()[j] * h;
        if shape.is_smooth() && j == 0 && k > 0 {
            weight += shape.weights()[shape.stride()] * self.width(k - 1);
        }
        (self.nodes[k] + shape.places()[j] * h, weight)
    }

    /// Nodes with all intervals in two that are not too narrow.
    pub fn halved(&self, narrowest: f64) -> Vec<f64> {
        let parts = self.nodes.windows(2).flat_map(|ends| {
            let middle = (ends[1] - ends[0] > narrowest).then_some(0.5 * (ends[0] + ends[1]));
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

/// q(s) on [0, 1], a polynomial of degree four or five on each interval ([`Shape`]); and T.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spline {
    /// Number of joints.
    pub dof: usize,
    pub mesh: Arc<Mesh>,
    /// q and dq/ds at each node, n entries each, and the second derivative where it is continuous; then the
    /// heights of the bubbles of each interval, n entries, where there are any.
    pub unknowns: Vec<f64>,
    /// T (s).
    pub time: f64,
}

impl Spline {
    /// The number of unknowns of n joints.
    pub fn size(n: usize, intervals: usize, shape: Shape) -> usize {
        shape.node() * n * (intervals + 1) + shape.inner() * n * intervals
    }

    /// Number of unknowns at a node.
    #[inline(always)]
    pub fn node(&self) -> usize {
        self.mesh.shape.node() * self.dof
    }

    /// Takes another motion; allocates only if that is longer than ever before.
    pub fn copy_from(&mut self, other: &Self) {
        (self.dof, self.time) = (other.dof, other.time);
        self.mesh.clone_from(&other.mesh);
        self.unknowns.clone_from(&other.unknowns);
    }

    /// The unknowns of an interval: heights of bubbles, states of both ends.
    #[inline(always)]
    pub fn of_interval<'a>(&self, unknowns: &'a [f64], k: usize) -> (&'a [f64], &'a [f64]) {
        let (node, inner) = (self.node(), self.mesh.shape.inner() * self.dof);
        let (ends, inners) = unknowns.split_at(node * self.mesh.nodes.len());
        (&inners[inner * k..inner * (k + 1)], &ends[node * k..node * (k + 2)])
    }

    /// The unknowns of the start (0) or end (1) among all.
    pub fn end_unknowns(&self, end: usize) -> std::ops::Range<usize> {
        let first = self.node() * end * self.mesh.intervals();
        first..first + self.node()
    }

    /// q and v at the start (0) or end (1), 2n numbers.
    pub fn end(&self, end: usize, state: &mut [f64]) {
        let n = self.dof;
        state.copy_from_slice(&self.unknowns[self.end_unknowns(end)][..2 * n]);
        let rate = 1.0 / self.time;
        state[n..].iter_mut().for_each(|v| *v *= rate);
    }

    /// q, v, a at all points, 3n numbers a point.
    pub fn evaluate(&self, z: &mut [f64]) {
        for (p, z) in z.chunks_exact_mut(3 * self.dof).enumerate() {
            let (k, j) = self.mesh.interval_of(p);
            let (inner, ends) = self.of_interval(&self.unknowns, k);
            self.mesh.basis(k, j).combine(self.dof, inner, ends, z);
            self.scale(z);
        }
    }

    /// q, v, a at the part `x` of interval `k`, 3n numbers; with the jerk 4n.
    pub fn in_interval(&self, k: usize, x: f64, z: &mut [f64]) {
        let (inner, ends) = self.of_interval(&self.unknowns, k);
        Basis::at(self.mesh.shape, x, self.mesh.width(k)).combine(self.dof, inner, ends, z);
        self.scale(z);
    }

    /// Derivatives in s become derivatives in time.
    #[inline(always)]
    fn scale(&self, z: &mut [f64]) {
        let (rate, mut factor) = (1.0 / self.time, 1.0);
        for derivatives in z.chunks_exact_mut(self.dof).skip(1) {
            factor *= rate;
            derivatives.iter_mut().for_each(|derivative| *derivative *= factor);
        }
    }

    /// A motion through the states and positions that `at` gives: q and its first two derivatives in s, n
    /// numbers each, at nodes and in the middle of intervals.
    pub fn through(n: usize, mesh: Arc<Mesh>, time: f64, mut at: impl FnMut(f64, &mut [f64])) -> Self {
        let shape = mesh.shape;
        let (mut unknowns, node) = (vec![0.0; Self::size(n, mesh.intervals(), shape)], shape.node() * n);
        let (ends, inner) = unknowns.split_at_mut(node * mesh.nodes.len());
        let (mut state, mut z) = (vec![0.0; 3 * n], vec![0.0; 3 * n]);
        for (&s, unknowns) in mesh.nodes.iter().zip(ends.chunks_exact_mut(node)) {
            at(s, &mut state);
            unknowns.copy_from_slice(&state[..node]);
        }
        for (k, bubble) in inner.chunks_exact_mut(n).enumerate() {
            let h = mesh.width(k);
            at(mesh.nodes[k] + 0.5 * h, &mut state);
            Basis::at(shape, 0.5, h).combine(n, bubble, &ends[node * k..node * (k + 2)], &mut z);
            bubble.iter_mut().zip(state.iter().zip(&z)).for_each(|(bubble, (q, cubic))| *bubble = q - cubic);
        }
        Self { dof: n, mesh, unknowns, time }
    }

    /// The same motion on other nodes: exact where they contain those of this motion.
    pub fn on_nodes(&self, nodes: Vec<f64>) -> Self {
        let (n, shape) = (self.dof, self.mesh.shape);
        let at = |s: f64, z: &mut [f64]| {
            let (k, x) = self.mesh.place(s);
            let (inner, ends) = self.of_interval(&self.unknowns, k);
            Basis::at(shape, x, self.mesh.width(k)).combine(n, inner, ends, z);
        };
        Self::through(n, Mesh::new(nodes, shape), self.time, at)
    }
}

#[cfg(test)]
mod tests {
    use super::{Mesh, Shape, Spline};

    #[test]
    fn a_finer_mesh_carries_the_same_motion() {
        for shape in [Shape::Quartic, Shape::Quintic] {
            let mut random = fastrand::Rng::with_seed(3);
            let mesh = Mesh::new(vec![0.0, 0.3, 0.4, 1.0], shape);
            let unknowns = (0..Spline::size(2, 3, shape)).map(|_| random.f64() - 0.5).collect();
            let spline = Spline { dof: 2, mesh, unknowns, time: 1.7 };
            let finer = spline.on_nodes(vec![0.0, 0.1, 0.3, 0.35, 0.4, 0.9, 1.0]);
            let (mut found, mut expected) = ([0.0; 8], [0.0; 8]);
            let sample = |spline: &Spline, s: f64, z: &mut [f64]| {
                let (k, x) = spline.mesh.place(s);
                spline.in_interval(k, x, z);
            };
            for i in 0..=50 {
                let s = f64::from(i) / 50.0;
                sample(&finer, s, &mut found);
                sample(&spline, s, &mut expected);
                let size = expected.iter().fold(1.0, |most: f64, z| most.max(z.abs()));
                assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-11 * size), "{s}");
            }
            let mut z = vec![0.0; 6 * spline.mesh.points()];
            spline.evaluate(&mut z);
            for p in 0..spline.mesh.points() {
                sample(&spline, spline.mesh.point(p).0, &mut expected);
                assert!(z[6 * p..6 * p + 6].iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-11));
            }
            let sum: f64 = (0..spline.mesh.points()).map(|p| spline.mesh.point(p).1).sum();
            assert!((sum - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn accelerations_of_quintics_do_not_jump() {
        let mut random = fastrand::Rng::with_seed(5);
        let mesh = Mesh::new(vec![0.0, 0.3, 0.4, 1.0], Shape::Quintic);
        let unknowns = (0..Spline::size(2, 3, Shape::Quintic)).map(|_| random.f64() - 0.5).collect();
        let spline = Spline { dof: 2, mesh, unknowns, time: 1.7 };
        for k in 0..2 {
            let (mut left, mut right) = ([0.0; 6], [0.0; 6]);
            spline.in_interval(k, 1.0, &mut left);
            spline.in_interval(k + 1, 0.0, &mut right);
            assert!(left.iter().zip(&right).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }
}
