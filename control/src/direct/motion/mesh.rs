//! The intervals of a motion and its points.

use super::basis::Basis;
use super::shape::{PLACES, POINTS, Shape, WEIGHTS};
use std::sync::Arc;

/// Intervals of [0, K], K the number of phases, with the points at which a motion is evaluated.
///
/// Phase p is [p, p + 1]. The ends of the phases, at whole numbers, are nodes: the start, the vias, the end.
#[derive(Clone, Debug, Default)]
pub(crate) struct Mesh {
    /// The ends of the intervals, from 0 to K.
    pub nodes: Vec<f64>,
    pub shape: Shape,
    /// The basis at all points, those that two intervals share once for each of them.
    basis: Vec<Basis>,
    /// The same at Gauss's points, where accelerations are continuous.
    gauss: Vec<Basis>,
    /// The phase of each interval.
    phases: Vec<usize>,
    /// The node of each end of a phase.
    ends: Vec<usize>,
    /// Whether each node is one.
    is_end: Vec<bool>,
    /// The interval of each point.
    intervals: Vec<usize>,
}

impl Mesh {
    /// With these nodes, whole numbers among them.
    pub fn new(nodes: Vec<f64>, shape: Shape) -> Arc<Self> {
        let at = |places: &'static [f64]| {
            let widths = nodes.windows(2).map(|ends| ends[1] - ends[0]);
            widths.flat_map(|h| places.iter().map(move |&x| Basis::at(shape, x, h))).collect()
        };
        let (basis, gauss) = (at(shape.places()), if shape.is_smooth() { at(&PLACES) } else { Vec::new() });
        let phases: Vec<usize> = nodes.iter().skip(1).map(|node| node.ceil() as usize - 1).collect();
        let is_end: Vec<bool> = nodes.iter().map(|node| node.fract() == 0.0).collect();
        let ends = (0..nodes.len()).filter(|&k| is_end[k]).collect();
        let mut mesh = Self { basis, gauss, shape, nodes, phases, ends, is_end, intervals: Vec::new() };
        for k in 0..mesh.intervals() {
            mesh.intervals.extend(std::iter::repeat_n(k, mesh.own_points(k)));
        }
        Arc::new(mesh)
    }

    /// The same number of equal intervals in each phase.
    pub fn even(phases: usize, intervals: usize) -> Vec<f64> {
        let of_phase = |p: usize| (0..intervals).map(move |k| p as f64 + k as f64 / intervals as f64);
        (0..phases).flat_map(of_phase).chain([phases as f64]).collect()
    }

    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.nodes.len() - 1
    }

    /// Number of phases, K.
    pub fn phases(&self) -> usize {
        self.ends.len() - 1
    }

    /// The phase of an interval.
    #[inline(always)]
    pub fn phase(&self, k: usize) -> usize {
        self.phases[k]
    }

    /// The nodes of the ends of the phases, K + 1.
    pub fn ends(&self) -> &[usize] {
        &self.ends
    }

    /// Whether a node is an end of a phase.
    #[inline(always)]
    pub fn is_end(&self, node: usize) -> bool {
        self.is_end[node]
    }

    /// The end of a phase at a node, if it is one.
    pub fn end_at(&self, node: usize) -> Option<usize> {
        self.is_end(node).then(|| self.nodes[node] as usize)
    }

    /// Number of points at which the motion is evaluated.
    pub fn points(&self) -> usize {
        self.intervals.len()
    }

    /// The first point of an interval. Where intervals share points, those of different phases do not.
    #[inline(always)]
    pub fn first_point(&self, k: usize) -> usize {
        self.shape.stride() * k + if self.shape.is_smooth() { self.phases[k] } else { 0 }
    }

    /// The points of a phase.
    pub fn points_of_phase(&self, phase: usize) -> std::ops::Range<usize> {
        let last = self.ends[phase + 1] - 1;
        self.first_point(self.ends[phase])..self.first_point(last) + self.own_points(last)
    }

    /// The point after the last one of each phase.
    pub fn ends_of_points(&self) -> impl Iterator<Item = usize> {
        (0..self.phases()).map(|phase| self.points_of_phase(phase).end)
    }

    /// The interval of a point, and its number there: the one to the right of a point that two share.
    #[inline(always)]
    pub fn interval_of(&self, p: usize) -> (usize, usize) {
        let k = self.intervals[p];
        (k, p - self.first_point(k))
    }

    /// Number of points of an interval that are not those of the next one.
    pub fn own_points(&self, k: usize) -> usize {
        if self.is_end(k + 1) { self.shape.places().len() } else { self.shape.stride() }
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
    #[inline(always)]
    pub fn width(&self, k: usize) -> f64 {
        self.nodes[k + 1] - self.nodes[k]
    }

    /// s of a point, and its weight in the integral over s.
    #[inline(always)]
    pub fn point(&self, p: usize) -> (f64, f64) {
        let (k, j) = self.interval_of(p);
        let (h, shape) = (self.width(k), self.shape);
        let mut weight = shape.weights()[j] * h;
        if shape.is_smooth() && j == 0 && !self.is_end(k) {
            weight += shape.weights()[shape.stride()] * self.width(k - 1);
        }
        let place = shape.places()[j];
        // The ends of phases exactly.
        let s = if place == 1.0 { self.nodes[k + 1] } else { self.nodes[k] + place * h };
        (s, weight)
    }

    /// Nodes with all intervals in two that are not too narrow.
    pub fn halved(&self, narrowest: f64) -> Vec<f64> {
        self.divided(2, narrowest)
    }

    /// Nodes with all intervals divided into so many parts, those that are at most this wide not.
    pub fn divided(&self, parts: usize, narrowest: f64) -> Vec<f64> {
        let inner = self.nodes.windows(2).flat_map(|ends| {
            let width = ends[1] - ends[0];
            let parts = if width > narrowest { parts } else { 1 };
            let inside = (1..parts).map(move |part| ends[0] + width * (part as f64 / parts as f64));
            inside.chain([ends[1]])
        });
        std::iter::once(self.nodes[0]).chain(inner).collect()
    }

    /// The interval that holds s, and the part of it before s.
    pub fn place(&self, s: f64) -> (usize, f64) {
        let k = self.nodes.partition_point(|&node| node <= s).clamp(1, self.intervals()) - 1;
        (k, (s - self.nodes[k]) / self.width(k))
    }

    /// The same in the intervals of a phase.
    pub fn place_in(&self, phase: usize, s: f64) -> (usize, f64) {
        let own = self.ends[phase] + 1..=self.ends[phase + 1];
        let k = self.nodes.partition_point(|&node| node <= s).clamp(*own.start(), *own.end()) - 1;
        (k, (s - self.nodes[k]) / self.width(k))
    }
}
