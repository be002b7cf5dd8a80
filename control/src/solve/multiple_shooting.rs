//! Solving by multiple shooting, and the solution on a mesh of collocation.

use crate::bvp::collocation::Collocation;
use crate::bvp::collocation::error::Estimate;
use crate::bvp::mesh::Span;
use crate::bvp::shooting::Shooting;
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::bvp::{Discretised, Failure, Solvable};
use crate::constants::shooting::{MOST_PIECES, ROUNDS, SHARPER, SHARPEST};
use crate::extremal::Extremal;
use crate::solve::{Attempt, Discretisation, Recorder, Solved};
use crate::status::Status;

impl Discretisation {
    /// Solves by multiple shooting over at most `nodes - 1` segments of each arc, from the values at their
    /// borders.
    ///
    /// The error is estimated by the Newton correction with a sharper integration. Then the motion is
    /// integrated once more from segment to segment, onto a mesh on which polynomials represent it to the
    /// tolerance.
    pub(crate) fn shoot(
        mut self,
        extremal: &mut dyn Extremal,
        attempt: &Attempt,
        recorder: &mut Recorder<'_>,
    ) -> Solved {
        let relaxation = extremal.relaxation();
        let mut timed = self.timed(extremal);
        let tolerance = attempt.tolerance;
        let (mesh, pieces) = self.equations.mesh.coarsened(attempt.nodes - 1);
        let mut shooting = Shooting::new(&timed, mesh, (SHARPER * tolerance).max(SHARPEST), |arc, s, w| {
            self.equations.at_node(arc, s, w);
        });
        let (mut status, estimate) = shooting.solve(&mut timed, attempt, recorder);
        let points = self.equations.method.len();
        if !status.is_converged() {
            self.equations = shooting.joined(&timed, points);
            return Solved { found: self, status, relaxation, estimate, violation: None };
        }
        shooting.set_tolerance((SHARPER * tolerance).max(SHARPEST));
        let limits = Representation { points, tolerance, max_intervals: attempt.max_intervals() };
        match shooting.traced(&mut timed, pieces, limits) {
            Ok((traced, fine)) => {
                self.equations = traced;
                if !fine {
                    status = Status::MeshLimit;
                }
            }
            Err(failure) => status = failure.into(),
        }
        Solved { found: self, status, relaxation, estimate, violation: None }
    }
}

/// How a motion is represented by polynomials.
#[derive(Clone, Copy)]
struct Representation {
    /// Lobatto points of an interval.
    points: usize,
    tolerance: f64,
    max_intervals: usize,
}

impl Shooting {
    /// Newton's method with sharper and sharper integration until that changes nothing.
    fn solve(
        &mut self,
        timed: &mut Timed<'_>,
        attempt: &Attempt,
        recorder: &mut Recorder<'_>,
    ) -> (Status, Option<Estimate>) {
        let mut sharpness = (SHARPER * attempt.tolerance).max(SHARPEST);
        let mut correction = self.zeros();
        let mut last = None;
        for _ in 0..ROUNDS {
            let status = recorder.newton(self, timed, attempt);
            if !status.is_converged() {
                return (status, last);
            }
            sharpness = (SHARPER * sharpness).max(SHARPEST);
            self.set_tolerance(sharpness);
            let values = self.current.clone();
            if let Err(failure) = self.evaluate(timed, &values) {
                return (failure.into(), last);
            }
            self.correction(&mut correction);
            let mut components = vec![0.0_f64; self.scale.len()];
            for (i, error) in correction.nodes.iter().enumerate() {
                let c = i % components.len();
                components[c] = components[c].max(error.abs());
            }
            let estimate = Estimate { components, local: Vec::new() };
            let largest = estimate.largest();
            last = Some(estimate);
            if largest <= attempt.tolerance {
                return (Status::Converged, last);
            }
        }
        (Status::MeshLimit, last)
    }
}

impl Collocation {
    /// w at a scaled time of an arc; at a node exactly its values.
    fn at_node(&self, arc: usize, s: f64, w: &mut [f64]) {
        let m = self.m;
        let mut at = 0.0;
        for (k, span) in self.mesh.spans.iter().enumerate() {
            if let Span::Interval { arc: of, length } = *span
                && of == arc
            {
                for (node, position) in [(k, at), (k + 1, at + length)] {
                    if (s - position).abs() < 1e-12 {
                        w.copy_from_slice(&self.current.nodes[node * m..(node + 1) * m]);
                        return;
                    }
                }
                at += length;
            }
        }
        self.sample(arc, s, w);
    }
}

impl Shooting {
    /// The values at the nodes, with linear interpolation between them.
    fn joined(&self, timed: &Timed<'_>, points: usize) -> Collocation {
        let mut found = Collocation::new(timed, self.mesh.clone(), points, |_, _, w| w.fill(0.0));
        let (m, inner) = (self.scale.len(), points - 2);
        found.current.nodes.copy_from_slice(&self.current.nodes);
        let Values { nodes, inner: between, .. } = &mut found.current;
        for (i, value) in between.iter_mut().enumerate() {
            let (k, j, c) = (i / (inner * m), i / m % inner, i % m);
            let (left, right) = (nodes[k * m + c], nodes[(k + 1) * m + c]);
            *value = left + found.method.points[j + 1] * (right - left);
        }
        found.scale.copy_from_slice(&self.scale);
        found
    }

    /// The motion, integrated from segment to segment, on a mesh that cuts each segment into pieces until the
    /// polynomials of all of them satisfy the equations to the tolerance; false if that takes too many
    /// intervals.
    fn traced(
        &mut self,
        timed: &mut Timed<'_>,
        mut pieces: Vec<Vec<f64>>,
        limits: Representation,
    ) -> Result<(Collocation, bool), Failure> {
        let Representation { points, tolerance, max_intervals } = limits;
        let power = 1.0 / (points + 1) as f64;
        loop {
            let mesh = self.mesh.cut(&pieces);
            let mut found = Collocation::new(timed, mesh, points, |_, _, w| w.fill(0.0));
            found.scale.copy_from_slice(&self.scale);
            found.current = self.values_on(timed, &found, &pieces)?;
            let values = found.current.clone();
            found.evaluate(timed, &values)?;
            let (defects, mut at, mut fine) = (found.defects(), 0, true);
            for pieces in &mut pieces {
                let own = &defects[at..at + pieces.len()];
                at += own.len().max(1);
                let cut = |(&length, &defect): (&f64, &f64)| {
                    let count = match (defect / tolerance).powf(power).ceil() {
                        count if count > 1.0 => count.min(MOST_PIECES as f64) as usize,
                        _ => 1,
                    };
                    std::iter::repeat_n(length / count as f64, count)
                };
                let finer: Vec<f64> = pieces.iter().zip(own).flat_map(cut).collect();
                fine &= finer.len() == pieces.len();
                *pieces = finer;
            }
            if fine || pieces.iter().map(Vec::len).sum::<usize>() > max_intervals {
                return Ok((found, fine));
            }
        }
    }

    /// The motion, integrated from segment to segment, at nodes and inner points.
    fn values_on(
        &mut self,
        timed: &mut Timed<'_>,
        target: &Collocation,
        pieces: &[Vec<f64>],
    ) -> Result<Values, Failure> {
        let (m, inner) = (target.m, target.method.len() - 2);
        let (mut values, mut w, mut at) = (target.zeros(), vec![0.0; m], 0);
        for (k, pieces) in pieces.iter().enumerate() {
            w.copy_from_slice(&self.current.nodes[k * m..(k + 1) * m]);
            values.nodes[at * m..(at + 1) * m].copy_from_slice(&w);
            if let Span::Interval { arc, .. } = self.mesh.spans[k] {
                for (piece, length) in (at..).zip(pieces) {
                    values.nodes[piece * m..(piece + 1) * m].copy_from_slice(&w);
                    for (j, pair) in target.method.points.windows(2).enumerate() {
                        let end = self.carry(timed, arc, (pair[1] - pair[0]) * length, &w)?;
                        w.copy_from_slice(end);
                        if j < inner {
                            let to = (piece * inner + j) * m;
                            values.inner[to..to + m].copy_from_slice(&w);
                        }
                    }
                }
            }
            at += pieces.len().max(1);
        }
        values.nodes[at * m..].copy_from_slice(&self.current.nodes[self.mesh.spans.len() * m..]);
        Ok(values)
    }
}
