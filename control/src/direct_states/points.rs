//! Radau's points, and the unknowns of a mesh.

use crate::numerics::lagrange;

/// Points of an interval.
pub(crate) const POINTS: usize = 3;

/// Radau's points in (0, 1], their weights, and derivatives of Lagrange's polynomials through 0 and them.
pub(super) struct Radau {
    /// 0 and the points.
    pub places: [f64; POINTS + 1],
    pub weights: [f64; POINTS],
    /// Row j: derivatives at point j of the polynomials of 0 and of the points.
    pub slopes: [[f64; POINTS + 1]; POINTS],
}

impl Radau {
    pub fn new() -> Self {
        let root = 6.0_f64.sqrt();
        let places = [0.0, (4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0];
        let weights = [(16.0 - root) / 36.0, (16.0 + root) / 36.0, 1.0 / 9.0];
        let slopes = std::array::from_fn(|j| lagrange::slopes(&places, places[j + 1]));
        Self { places, weights, slopes }
    }

    /// What component i of the polynomial of the unknowns w misses at point j of interval k, where its slope
    /// is to be `rate`.
    pub fn defect(&self, layout: &Layout, w: &[f64], (k, j): (usize, usize), i: usize, rate: f64) -> f64 {
        let mut defect = self.slopes[j][0] * w[layout.node(k) + i] - rate;
        for l in 0..POINTS {
            defect += self.slopes[j][l + 1] * w[layout.point(k, l) + i];
        }
        defect
    }
}

/// Where the unknowns are: x at the start, (x, u) at each point, T.
#[derive(Clone, Copy)]
pub(super) struct Layout {
    pub n: usize,
    pub m: usize,
    pub intervals: usize,
}

impl Layout {
    /// First index of point j of interval k.
    pub fn point(&self, k: usize, j: usize) -> usize {
        self.n + (k * POINTS + j) * (self.n + self.m)
    }

    /// First index of x at node k.
    pub fn node(&self, k: usize) -> usize {
        if k == 0 { 0 } else { self.point(k - 1, POINTS - 1) }
    }

    /// Index of T.
    pub fn time(&self) -> usize {
        self.point(self.intervals, 0)
    }

    /// Number of unknowns.
    pub fn count(&self) -> usize {
        self.time() + 1
    }
}
