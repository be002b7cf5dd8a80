//! How well the motion that was found meets the conditions of first order.

use super::interval_part::IntervalPart;
use crate::constants::direct::LEAST_SCALE;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::at_node::AtNode;
use crate::direct::motion::spline::Spline;
use crate::direct::newton::side_terms::side_terms;

/// The gradient of the Lagrange function by all unknowns of a motion, with its multipliers; and for each
/// unknown the sum of the magnitudes that the points add to it, which cancel.
pub(super) struct Stationarity {
    gradient: Vec<f64>,
    terms: Vec<f64>,
}

impl Stationarity {
    /// Nothing added yet.
    pub fn new(spline: &Spline) -> Self {
        let zeros = || vec![0.0; spline.unknowns.len()];
        Self { gradient: zeros(), terms: zeros() }
    }

    /// Adds the part of interval `k`.
    pub fn add(&mut self, part: &IntervalPart, spline: &Spline, k: usize) {
        part.add_to(spline, k, [&mut self.gradient, &mut self.terms]);
    }

    /// The largest entry of the gradient by positions at nodes, by rates there and so on, of each joint, in
    /// parts of the largest sum of magnitudes of these of this joint. A joint to which next to nothing is
    /// added is measured by the others. Unknowns that are given do not count; those that both ends of a
    /// periodic motion share count once. The times of phases are left to H*.
    pub fn residual<D>(mut self, interior: &Interior<D>) -> f64 {
        self.complete(interior);
        self.largest_part(&interior.spline)
    }

    fn largest_part(&self, spline: &Spline) -> f64 {
        let (n, node, mesh) = (spline.dof, spline.node(), &spline.mesh);
        let states = node * mesh.nodes.len();
        let inner = mesh.shape.inner() * n;
        // v = x/T, a = x/T^2 inside of phases.
        let in_time = |i: usize| match i / node {
            k if i < states && !mesh.is_end(k) => spline.clock_at(k).powi((i % node / n) as i32),
            _ => 1.0,
        };
        let column = |i: usize| if i < states { i % node } else { node + (i - states) % inner };
        let mut largest = vec![[0.0_f64; 2]; node + inner];
        for (i, (gradient, terms)) in self.gradient.iter().zip(&self.terms).enumerate() {
            let scale = in_time(i);
            for (most, value) in largest[column(i)].iter_mut().zip([gradient.abs(), *terms]) {
                let value = scale * value;
                *most = if value.is_nan() { f64::INFINITY } else { most.max(value) };
            }
        }
        let of_kind = |kind: &[[f64; 2]]| {
            let least = LEAST_SCALE * kind.iter().fold(0.0, |most: f64, [_, terms]| most.max(*terms));
            let parts = kind.iter().map(|[gradient, terms]| gradient / terms.max(least));
            // Where nothing is added nothing is left.
            parts.filter(|part| !part.is_nan()).fold(0.0, f64::max)
        };
        largest.chunks(n).map(of_kind).fold(0.0, f64::max)
    }

    /// Adds what limits at nodes and rows at ends make of it, and takes out what is given.
    fn complete<D>(&mut self, interior: &Interior<D>) {
        let Interior { spline, points, barrier, ends, .. } = interior;
        let (n, node, mesh) = (spline.dof, spline.node(), &spline.mesh);
        for k in 0..mesh.nodes.len() {
            let at_node = AtNode::new(spline, k);
            for at in barrier.at_node(k) {
                let side = barrier.side(at);
                let ([first, ..], value) = (side_terms(barrier, at, side.sign).0, at_node.of(side));
                self.gradient[value.unknown] += value.scale * first;
                self.terms[value.unknown] += (value.scale * first).abs();
            }
        }
        let mut far = points.ends.far.chunks_exact(2 * n);
        let last = spline.end_unknowns(mesh.phases());
        for (at, row) in barrier.at_ends().zip(points.ends.g_x.chunks_exact(2 * n)) {
            let [first, ..] = side_terms(barrier, at, barrier.side(at).sign).0;
            let own = spline.end_unknowns(barrier.end_of(at)).zip(row);
            let others = last.clone().zip(far.next().unwrap_or_default());
            for (i, entry) in own.chain(others) {
                self.gradient[i] += first * entry;
                self.terms[i] += (first * entry).abs();
            }
        }
        let mut tied = vec![0.0; ends.shared()];
        ends.reduce(mesh, &mut self.gradient, &vec![0.0; mesh.phases()], &mut tied);
        let last = node * mesh.intervals();
        for (tie, sum) in ends.tied.iter().zip(&tied[ends.times.count()..]) {
            self.gradient[tie.start] = *sum;
            self.terms[tie.start] += tie.end.map_or(0.0, |i| self.terms[last + i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::interior::iterate::tests::started;
    use crate::direct::motion::shape::Shape;

    /// Where slacks are the distances and multipliers on the central path, the gradient is that of cost and
    /// barrier, which Newton's equations have.
    #[test]
    fn the_gradient_is_that_of_the_equations() {
        for shape in [Shape::Quartic, Shape::Quintic] {
            let mut interior = started(shape);
            let count = interior.barrier.count();
            for at in 0..count {
                if !interior.barrier.is_on(at) {
                    continue;
                }
                let barrier = &mut interior.barrier;
                barrier.distance[at] = barrier.slack[at];
                if !barrier.is_limit(at) {
                    barrier.multiplier[at] = 0.3;
                }
            }
            interior.refresh().unwrap();
            interior.system.exact = true;
            interior.assemble();
            let spline = interior.spline.clone();
            let mut part = IntervalPart::new(&spline, interior.rows());
            let mut found = Stationarity::new(&spline);
            for k in 0..spline.mesh.intervals() {
                part.take(&mut interior, k);
                found.add(&part, &spline, k);
            }
            found.complete(&interior);
            let [at_zero, of_mu] = &interior.system.gradient;
            let size = at_zero.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
            for (i, (g, terms)) in found.gradient.iter().zip(&found.terms).enumerate() {
                let expected = at_zero[i] + interior.mu * of_mu[i];
                assert!((g - expected).abs() < 1e-10 * size, "{shape:?} {i}: {g} instead of {expected}");
                assert!(g.abs() <= terms * (1.0 + 1e-12), "{shape:?} {i}: {g} of {terms}");
            }
            let residual = found.largest_part(&spline);
            assert!(residual > 1e-3, "a guess is not stationary: {residual}");
        }
    }
}
