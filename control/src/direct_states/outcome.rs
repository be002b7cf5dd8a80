//! What was found: verified by an independent integration, and told.

use super::interior::Interior;
use super::points::{Layout, POINTS};
use super::problem::DirectDynamics;
use super::solution::StateMotion;
use crate::bvp::collocation::error::defined;
use crate::constants::{direct as shared, states as constants};
use crate::extremal::dynamics::response::eval_error;
use crate::numerics::dormand_prince::DormandPrince;
use crate::solve::Recorder;
use costate::dynamics::{Cost, Dynamics};

impl<D: Dynamics<f64>, C: Cost<f64>> DirectDynamics<D, C> {
    /// What the end is missed by when the controls are integrated from the start; where that is more than
    /// `bound` and more than what the parts of the motion miss together, that.
    pub(super) fn verify(&mut self, mesh: &Interior, bound: f64, recorder: &mut Recorder<'_>) -> f64 {
        let whole = self.missed_by_parts(mesh, f64::INFINITY, recorder);
        if whole <= bound {
            return whole;
        }
        whole.min(self.missed_by_parts(mesh, mesh.time() / shared::PARTS, recorder))
    }

    /// Sum of the distances from the motion, relative to its sizes, after each `part` (s), integrated from
    /// its own start. Infinite where a part cannot be integrated, or not in time.
    fn missed_by_parts(&mut self, mesh: &Interior, part: f64, recorder: &mut Recorder<'_>) -> f64 {
        let Layout { n, m, intervals } = mesh.layout;
        let sizes = mesh.sizes();
        let mut integrator = DormandPrince::new(n, shared::INTEGRATION);
        let mut u = vec![0.0; m];
        let mut x = mesh.w[..n].to_vec();
        let (mut sum, mut since) = (0.0, 0.0);
        for k in 0..intervals {
            let width = mesh.widths[k] * mesh.time();
            let reached = integrator.integrate(&mut x, 0.0..1.0, |s, x, rate| {
                mesh.control(k, s, &mut u);
                let f = self.model.evaluate(x, &u).map_err(eval_error)?;
                rate.iter_mut().zip(f).for_each(|(rate, f)| *rate = width * f);
                Ok(())
            });
            if reached.is_err() || recorder.interruption().is_some() {
                return f64::INFINITY;
            }
            since += width;
            if since >= part * (1.0 - constants::MET) || k + 1 == intervals {
                let end = &mesh.w[mesh.layout.node(k + 1)..][..n];
                let misses = x.iter().zip(end).zip(&sizes).map(|((x, end), size)| defined((x - end) / size));
                sum += misses.fold(0.0, f64::max);
                x.copy_from_slice(end);
                since = 0.0;
            }
        }
        sum
    }

    /// Values along the motion.
    pub(super) fn report(&mut self, mesh: &mut Interior, mut motion: StateMotion) -> StateMotion {
        let Layout { n, m, intervals } = mesh.layout;
        let (mut start, time, reference) = (0.0, mesh.time(), self.reference);
        (motion.cost, motion.final_time, motion.intervals) = (reference * mesh.cost, time, intervals);
        motion.u_limits.clone_from(&self.u_limits);
        for step in &mut motion.steps {
            (step.cost, step.barrier) = (reference * step.cost, reference * step.barrier);
        }
        // Again, since the last step has changed the iterate.
        let linearised = mesh.linearise(self);
        let figure = mesh.figure(self, &mesh.w);
        let is_known = linearised.is_ok() && figure.is_ok();
        motion.residual = match (linearised, figure) {
            (Ok(stationarity), Ok(figure)) => mesh.error(0.0, stationarity, figure.theta),
            _ => f64::INFINITY,
        };
        for i in 0..mesh.ends.len() {
            let missed = mesh.missed(i).abs();
            if missed > motion.end_missed.max(constants::MET * mesh.end_size(i)) {
                (motion.end_missed, motion.missed_component) = (missed, mesh.ends[i].component());
            }
        }
        let (mut x, mut slope, mut u) = (vec![0.0; n], vec![0.0; n], vec![0.0; m]);
        for k in 0..intervals {
            for j in 0..=POINTS {
                let s = mesh.radau.places[j];
                if j == 0 && k > 0 {
                    continue;
                }
                mesh.state(k, s, &mut x, &mut slope);
                mesh.control(k, s, &mut u);
                let y: Vec<f64> = (0..n).map(|i| reference * mesh.costate(k, s, i)).collect();
                let l = reference * self.running(&x, &u).unwrap_or(f64::NAN);
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
                let defect = if is_known { defined(*defect) } else { f64::INFINITY };
                if defect > motion.defect {
                    (motion.defect, motion.defect_time) = (defect, start * time);
                }
            }
            start += mesh.widths[k];
        }
        motion
    }
}
