//! What was found: verified by an independent integration, and told.

use super::interior::Interior;
use super::points::{Layout, POINTS};
use super::problem::DirectDynamics;
use super::solution::StateMotion;
use crate::constants::direct as shared;
use crate::extremal::dynamics::response::eval_error;
use crate::numerics::dormand_prince::DormandPrince;
use costate::dynamics::{Cost, Dynamics};

/// Ends that are missed by less than this part of the size of their component are met.
const MET: f64 = 1e-9;

impl<D: Dynamics<f64>, C: Cost<f64>> DirectDynamics<D, C> {
    /// What is missed when the controls are integrated from the start, or interval by interval.
    pub(super) fn verify(&mut self, mesh: &Interior) -> f64 {
        let Layout { n, m, intervals } = mesh.layout;
        let sizes = mesh.sizes();
        let mut integrator = DormandPrince::new(n, shared::INTEGRATION);
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
    pub(super) fn report(&mut self, mesh: &Interior, mut motion: StateMotion) -> StateMotion {
        let Layout { n, m, intervals } = mesh.layout;
        let (mut start, time) = (0.0, mesh.time());
        (motion.cost, motion.final_time, motion.intervals) = (mesh.cost, time, intervals);
        for &i in &mesh.fixed {
            let missed = mesh.missed(self, i).abs();
            if missed > motion.end_missed.max(MET * mesh.size(i)) {
                (motion.end_missed, motion.missed_component) = (missed, Some(i));
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
                let y: Vec<f64> = (0..n).map(|i| mesh.costate(k, s, i)).collect();
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
