//! From a problem to a motion.

use super::interior::Interior;
use super::points::{Layout, POINTS};
use super::problem::DirectDynamics;
use super::solution::StateMotion;
use crate::extremal::dynamics::response::eval_error;
use crate::numerics::dormand_prince::DormandPrince;
use crate::options::SolverOptions;
use crate::result::motion::Certificate;
use crate::status::Status;
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};
use std::time::Instant;

/// Intervals of the first mesh, and most meshes.
const INTERVALS: usize = 20;
const MESHES: usize = 14;
/// Barrier with which later meshes begin.
const WARM: f64 = 1e-4;
/// The problem on a mesh is solved to this part of the tolerance.
const PART: f64 = 0.01;
/// Errors of x may be this part of the root of the tolerance: the cost is stationary.
const OF_ROOT: f64 = 0.3;
/// Relative tolerance of the independent integration.
const INTEGRATION: f64 = 1e-10;

impl<D: Dynamics<f64>, C: Cost<f64>> DirectDynamics<D, C> {
    /// $\tfrac12 u^\top R u + l$.
    pub(super) fn running(&mut self, x: &[f64], u: &[f64]) -> Result<f64, EvalError> {
        let effort: f64 = self.problem.cost.effort.iter().zip(u).map(|(r, u)| 0.5 * r * u * u).sum();
        let l = match &mut self.cost {
            Some(cost) => {
                let of = cost.controls();
                cost.evaluate(x, &u[..of]).map_err(eval_error)?
            }
            None => 0.0,
        };
        Ok(effort + l)
    }

    /// The same with its gradient and Hessian in (x, u).
    pub(super) fn running_derivatives(
        &mut self,
        x: &[f64],
        u: &[f64],
        first: &mut [f64],
        second: &mut [f64],
    ) -> Result<f64, EvalError> {
        let (n, size) = (x.len(), first.len());
        first.fill(0.0);
        second.fill(0.0);
        let mut value = 0.0;
        for (i, (r, u)) in self.problem.cost.effort.iter().zip(u).enumerate() {
            value += 0.5 * r * u * u;
            first[n + i] = r * u;
            second[(n + i) * size + n + i] = *r;
        }
        if let Some(cost) = &mut self.cost {
            let of = cost.controls();
            let all = cost.hessian(x, &u[..of]).map_err(eval_error)?;
            value += all.gradient.value;
            let gradient = all.gradient.x.iter().chain(all.gradient.u);
            first.iter_mut().zip(gradient).for_each(|(sum, part)| *sum += part);
            for (i, row) in all.xx.iter_rows().enumerate() {
                row.iter().enumerate().for_each(|(j, part)| second[i * size + j] += part);
            }
            if of > 0 {
                for (i, row) in all.uu.iter_rows().enumerate() {
                    row.iter().enumerate().for_each(|(j, part)| second[(n + i) * size + n + j] += part);
                }
            }
            for (i, row) in all.ux.iter().flat_map(|ux| ux.iter_rows()).enumerate() {
                for (j, part) in row.iter().enumerate() {
                    second[(n + i) * size + j] += part;
                    second[j * size + n + i] += part;
                }
            }
        }
        Ok(value)
    }

    /// Straight line between the ends, controls at zero.
    fn guess(&self, layout: &Layout) -> Vec<f64> {
        let mut w = vec![0.0; layout.count()];
        let radau = super::points::Radau::new();
        let (start, end) = (&self.problem.start.x, &self.problem.end.x);
        w[..layout.n].copy_from_slice(start);
        for k in 0..layout.intervals {
            for j in 0..POINTS {
                let s = (k as f64 + radau.places[j + 1]) / layout.intervals as f64;
                for i in 0..layout.n {
                    w[layout.point(k, j) + i] = start[i] + s * (end[i] - start[i]);
                }
            }
        }
        w[layout.time()] = self.problem.time.value();
        w
    }

    /// Solves the problem from a straight line between its ends.
    ///
    /// Of the options `tolerance`, `max_nodes`, `max_iterations` and `time_limit` are used. Errors of x are
    /// held below 0.3 times the root of the tolerance, relative to the largest values along the motion.
    pub fn solve(&mut self, options: &SolverOptions) -> StateMotion {
        let deadline = options.time_limit.map(|limit| Instant::now() + limit);
        let layout = Layout { n: self.model.states(), m: self.model.controls(), intervals: INTERVALS };
        let accuracy = OF_ROOT * options.tolerance.sqrt();
        let widths = vec![1.0 / INTERVALS as f64; INTERVALS];
        let mut mesh = Interior::new(self, widths, self.guess(&layout), None);
        let (mut iterations, mut change, mut error, mut excess) = (0, f64::INFINITY, f64::INFINITY, 0.0);
        let mut status = Status::MeshLimit;
        let mut last = f64::NAN;
        for _ in 0..MESHES {
            let solved = mesh.solve(self, PART * options.tolerance, options.max_iterations, deadline);
            iterations += mesh.iterations;
            if let Err(failure) = solved {
                status = failure;
                break;
            }
            change = (mesh.cost - last).abs() / mesh.cost.abs().max(1e-12);
            let between = match mesh.between(self) {
                Ok(between) => between,
                Err(failure) => {
                    status = Status::EvaluationFailed(failure.into());
                    break;
                }
            };
            error = between.errors.iter().fold(0.0, |most: f64, error| most.max(*error));
            excess = between.excess;
            let settled = last.is_nan() || change <= options.tolerance.sqrt();
            if error <= accuracy && settled {
                status = Status::Converged;
                break;
            }
            let Some((widths, w)) = mesh.divided(&between.errors, accuracy, options.max_nodes) else { break };
            last = mesh.cost;
            mesh = Interior::new(self, widths, w, Some(WARM));
        }
        let end_error = self.verify(&mesh);
        if status.is_converged() && !(end_error <= accuracy) {
            status = Status::NotVerified;
        }
        let certificate = if status.is_converged() && mesh.definite {
            Certificate::LocalMinimumOnMesh
        } else {
            Certificate::NotChecked
        };
        self.report(
            &mesh,
            StateMotion {
                status,
                cost: mesh.cost,
                final_time: mesh.time(),
                t: Vec::new(),
                x: Vec::new(),
                u: Vec::new(),
                y: Vec::new(),
                hamiltonian: Vec::new(),
                defect: 0.0,
                defect_time: 0.0,
                error,
                largest_violation: excess,
                cost_change: change,
                end_error,
                certificate,
                iterations,
                intervals: mesh.layout.intervals,
            },
        )
    }

    /// What is missed when the controls are integrated from the start, or interval by interval.
    fn verify(&mut self, mesh: &Interior) -> f64 {
        let Layout { n, m, intervals } = mesh.layout;
        let sizes = mesh.sizes();
        let mut integrator = DormandPrince::new(n, INTEGRATION);
        let mut u = vec![0.0; m];
        let (mut whole, mut parts) = (0.0_f64, 0.0_f64);
        let mut open = mesh.w[..n].to_vec();
        for k in 0..intervals {
            let mut part = mesh.w[mesh.layout.node(k)..][..n].to_vec();
            let width = mesh.widths[k] * mesh.time();
            let end = &mesh.w[mesh.layout.node(k + 1)..][..n];
            for (x, is_whole) in [(&mut open, true), (&mut part, false)] {
                let reached = integrator.integrate(x, 0.0..1.0, |s, x, rate| {
                    mesh.control(k, s, &mut u);
                    let f = self.model.evaluate(x, &u).map_err(eval_error)?;
                    rate.iter_mut().zip(f).for_each(|(rate, f)| *rate = width * f);
                    Ok(())
                });
                let missed = |i: usize| (x[i] - end[i]).abs() / sizes[i];
                let now =
                    if reached.is_ok() { (0..n).map(missed).fold(0.0, f64::max) } else { f64::INFINITY };
                // Of the whole motion only the end counts.
                if is_whole { whole = now } else { parts = parts.max(now) }
            }
        }
        whole.min(parts)
    }

    /// Values along the motion.
    fn report(&mut self, mesh: &Interior, mut motion: StateMotion) -> StateMotion {
        let Layout { n, m, intervals } = mesh.layout;
        let (mut start, time) = (0.0, mesh.time());
        let (mut x, mut slope, mut u) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
        for k in 0..intervals {
            for j in 0..=POINTS {
                let s = mesh.radau.places[j];
                if j == 0 && k > 0 {
                    continue;
                }
                mesh.state(k, s, &mut x, &mut slope);
                mesh.control(k, s, &mut u);
                let y_of = |point: usize, i: usize| {
                    mesh.lambda[(k * POINTS + point) * n + i] / mesh.radau.weights[point]
                };
                let [_, a, b, c] = mesh.radau.places;
                let (values, _) = super::points::lagrange(&[a, b, c], s);
                let y: Vec<f64> = (0..n).map(|i| (0..POINTS).map(|p| values[p] * y_of(p, i)).sum()).collect();
                let l = self.running(&x, &u).unwrap_or(f64::NAN);
                let f = self
                    .model
                    .evaluate(&x, &u)
                    .map_or(f64::NAN, |f| f.iter().zip(&y).map(|(f, y)| f * y).sum());
                motion.hamiltonian.push(f - l);
                motion.t.push((start + s * mesh.widths[k]) * time);
                motion.x.push(x.clone());
                motion.u.push(u.clone());
                motion.y.push(y);
            }
            for defect in &mesh.intervals[k].defect {
                if defect.abs() > motion.defect {
                    (motion.defect, motion.defect_time) = (defect.abs(), start * time);
                }
            }
            start += mesh.widths[k];
        }
        motion
    }
}
