//! Solving by multiple shooting, and the solution on a mesh as collocation leaves it.

use crate::bvp::collocation::Collocation;
use crate::bvp::collocation::error::Estimate;
use crate::bvp::mesh::Span;
use crate::bvp::shooting::Shooting;
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::bvp::{Discretised, Failure, Solvable};
use crate::extremal::Extremal;
use crate::solve::{Context, Extremum};
use crate::status::Status;

/// Tolerance of a step of the integration, in parts of that of the solution.
const SHARPER: f64 = 0.01;
/// Smallest tolerance of a step.
const SHARPEST: f64 = 1e-14;
/// How often the integration is made sharper.
const ROUNDS: usize = 3;

impl Extremum {
    /// Solves to the tolerance by multiple shooting over at most `nodes - 1` segments of each arc, beginning with the values at
    /// their borders.
    ///
    /// The error is estimated by the correction that a sharper integration asks for. Then the motion is integrated once
    /// more from segment to segment, onto a mesh on which polynomials represent it to the tolerance.
    pub(crate) fn shoot<E: Extremal>(
        mut self,
        extremal: &mut E,
        tolerance: f64,
        context: &mut Context<'_>,
    ) -> Self {
        let mut timed = Timed::new(extremal, self.clock, self.arcs.clone());
        let (mesh, pieces) = self.equations.mesh.coarsened(context.options.nodes - 1);
        let mut sharpness = (SHARPER * tolerance).max(SHARPEST);
        let mut shooting =
            Shooting::new(&timed, mesh, sharpness, |arc, s, w| self.equations.at_node(arc, s, w));
        let mut correction = shooting.zeros();
        for round in 0..ROUNDS {
            self.status = context.newton(&mut shooting, &mut timed, 0.1 * tolerance);
            if !self.status.is_converged() {
                break;
            }
            sharpness = (SHARPER * sharpness).max(SHARPEST);
            shooting.set_tolerance(sharpness);
            let values = shooting.current.clone();
            if let Err(failure) = shooting.evaluate(&mut timed, &values) {
                self.status = failure.into();
                break;
            }
            shooting.correction(&mut correction);
            let mut components = vec![0.0_f64; shooting.scale.len()];
            for (i, error) in correction.nodes.iter().enumerate() {
                let c = i % components.len();
                components[c] = components[c].max(error.abs());
            }
            let estimate = Estimate { components, local: Vec::new() };
            let largest = estimate.largest();
            self.estimate = Some(estimate);
            if largest <= tolerance {
                break;
            }
            if round + 1 == ROUNDS {
                self.status = Status::MeshLimit;
            }
        }
        if !self.status.is_converged() {
            self.equations = shooting.joined(&timed, self.equations.method.len());
            return self;
        }
        let most = context.options.max_nodes - 1;
        shooting.set_tolerance((SHARPER * tolerance).max(SHARPEST));
        match shooting.traced(&mut timed, pieces, (self.equations.method.len(), most), tolerance) {
            Ok((traced, fine)) => {
                self.equations = traced;
                if !fine {
                    self.status = Status::MeshLimit;
                }
            }
            Err(failure) => self.status = failure.into(),
        }
        self
    }
}

impl Collocation {
    /// w at a scaled time of an arc; at a node exactly what stands there.
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
    /// The values at the nodes, joined by straight lines.
    fn joined<E: Extremal>(&self, timed: &Timed<'_, E>, points: usize) -> Collocation {
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

    /// The motion, integrated from segment to segment, on a mesh that cuts each segment into pieces until the polynomials of
    /// all of them satisfy the equations to the tolerance; false where that takes more than `most` intervals.
    fn traced<E: Extremal>(
        &mut self,
        timed: &mut Timed<'_, E>,
        mut pieces: Vec<Vec<f64>>,
        (points, most): (usize, usize),
        tolerance: f64,
    ) -> Result<(Collocation, bool), Failure> {
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
                        count if count > 1.0 => count.min(4.0) as usize,
                        _ => 1,
                    };
                    std::iter::repeat_n(length / count as f64, count)
                };
                let finer: Vec<f64> = pieces.iter().zip(own).flat_map(cut).collect();
                fine &= finer.len() == pieces.len();
                *pieces = finer;
            }
            if fine || pieces.iter().map(Vec::len).sum::<usize>() > most {
                return Ok((found, fine));
            }
        }
    }

    /// The motion, integrated from segment to segment, at nodes and inner points.
    fn values_on<E: Extremal>(
        &mut self,
        timed: &mut Timed<'_, E>,
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
