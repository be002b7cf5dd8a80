//! Motions as piecewise polynomials in s = t/T.

use super::basis::{Basis, COEFFICIENTS, END_WEIGHT, INNER_WEIGHTS, PLACES, POINTS};

/// q(s) on [0, 1], twice continuously differentiable, a polynomial of degree five on each interval; and T.
#[derive(Clone, Debug, Default)]
pub(crate) struct Spline {
    /// Number of joints.
    pub dof: usize,
    /// The ends of the intervals, from 0 to 1.
    pub nodes: Vec<f64>,
    /// At each node q, dq/ds and d2q/ds2, n entries each.
    pub unknowns: Vec<f64>,
    /// T (s).
    pub time: f64,
}

impl Spline {
    /// Number of intervals.
    pub fn intervals(&self) -> usize {
        self.nodes.len() - 1
    }

    /// Number of points at which the motion is evaluated: nodes, and those inside of intervals.
    pub fn points(&self) -> usize {
        POINTS * self.intervals() + 1
    }

    /// Width of an interval.
    pub fn width(&self, k: usize) -> f64 {
        self.nodes[k + 1] - self.nodes[k]
    }

    /// s of a point, and its weight in the integral over s.
    pub fn point(&self, p: usize) -> (f64, f64) {
        let (k, j) = (p / POINTS, p % POINTS);
        if j > 0 {
            let h = self.width(k);
            return (self.nodes[k] + PLACES[j - 1] * h, INNER_WEIGHTS[j - 1] * h);
        }
        let left = if k > 0 { self.width(k - 1) } else { 0.0 };
        let right = if k < self.intervals() { self.width(k) } else { 0.0 };
        (self.nodes[k], END_WEIGHT * (left + right))
    }

    /// q, v, a at all points, 3n numbers a point.
    pub fn evaluate(&self, z: &mut [f64]) {
        for (p, z) in z.chunks_exact_mut(3 * self.dof).enumerate() {
            let (k, j) = (p / POINTS, p % POINTS);
            if j == 0 {
                z.copy_from_slice(&self.unknowns[3 * self.dof * k..][..3 * self.dof]);
                self.scale(z);
            } else {
                self.in_interval(k, PLACES[j - 1], z);
            }
        }
    }

    /// q, v, a at the part `x` of interval `k`, 3n numbers.
    pub fn in_interval(&self, k: usize, x: f64, z: &mut [f64]) {
        combine(&Basis::at(x, self.width(k)), self.dof, &self.unknowns[3 * self.dof * k..], z);
        self.scale(z);
    }

    /// Derivatives in s become derivatives in time.
    fn scale(&self, z: &mut [f64]) {
        let (rate, n) = (1.0 / self.time, self.dof);
        z[n..2 * n].iter_mut().for_each(|v| *v *= rate);
        z[2 * n..].iter_mut().for_each(|a| *a *= rate * rate);
    }

    /// The same motion on other nodes: exact where they contain those of this motion.
    pub fn on_nodes(&self, nodes: Vec<f64>) -> Self {
        let width = 3 * self.dof;
        let mut unknowns = vec![0.0; width * nodes.len()];
        for (&s, block) in nodes.iter().zip(unknowns.chunks_exact_mut(width)) {
            let k = self.nodes.partition_point(|&node| node <= s).clamp(1, self.intervals()) - 1;
            let h = self.width(k);
            combine(&Basis::at((s - self.nodes[k]) / h, h), self.dof, &self.unknowns[width * k..], block);
        }
        Self { nodes, unknowns, ..*self }
    }
}

/// q, q', q'' from the coefficients of an interval, both ends in a row.
pub(super) fn combine(basis: &Basis, n: usize, coefficients: &[f64], z: &mut [f64]) {
    z.fill(0.0);
    for (row, z) in basis.rows().into_iter().zip(z.chunks_exact_mut(n)) {
        for (&factor, part) in row.iter().zip(coefficients[..COEFFICIENTS * n].chunks_exact(n)) {
            z.iter_mut().zip(part).for_each(|(z, part)| *z += factor * part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Spline;

    #[test]
    fn a_finer_mesh_carries_the_same_motion() {
        let mut random = fastrand::Rng::with_seed(3);
        let nodes = vec![0.0, 0.3, 0.4, 1.0];
        let unknowns = (0..4 * 6).map(|_| random.f64() - 0.5).collect();
        let spline = Spline { dof: 2, nodes, unknowns, time: 1.7 };
        let finer = spline.on_nodes(vec![0.0, 0.1, 0.3, 0.35, 0.4, 0.9, 1.0]);
        let (mut found, mut expected) = ([0.0; 6], [0.0; 6]);
        let sample = |spline: &Spline, s: f64, z: &mut [f64]| {
            let k = spline.nodes.partition_point(|&node| node <= s).clamp(1, spline.intervals()) - 1;
            spline.in_interval(k, (s - spline.nodes[k]) / spline.width(k), z);
        };
        for i in 0..=50 {
            let s = f64::from(i) / 50.0;
            sample(&finer, s, &mut found);
            sample(&spline, s, &mut expected);
            assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-11), "{s}");
        }
        let mut z = vec![0.0; 6 * spline.points()];
        spline.evaluate(&mut z);
        for p in 0..spline.points() {
            let (s, _) = spline.point(p);
            sample(&spline, s, &mut expected);
            assert!(z[6 * p..6 * p + 6].iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
        }
        assert!(((0..spline.points()).map(|p| spline.point(p).1).sum::<f64>() - 1.0).abs() < 1e-15);
    }
}
