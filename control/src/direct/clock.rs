//! Costs that depend on the time since the start of a motion.
//!
//! A point in phase p at the place s is passed at the time $t = \sum\_{i<p} T\_i + (s - p) T\_p$. So where the
//! running cost depends on t it depends on the times of the phase and of all before it.

use super::interior::Interior;
use super::interval::add_gradient;
use super::point_terms::Work;
use super::points::PointDynamics;
use super::shape::{MOST_COEFFICIENTS, PLACES, WEIGHTS};
use super::spline::Spline;
use super::system::ByTimes;
use crate::numerics::chain::dot;

/// Adds what the clock makes of a point that was [collected](Work::collect), to the derivatives by the times
/// of its phase and of those before it.
#[inline(always)]
pub(super) fn add_clock(
    p: usize,
    spline: &Spline,
    factors: &[[f64; MOST_COEFFICIENTS]; 3],
    work: &Work,
    by_times: &mut ByTimes,
) {
    let (k, clock) = (spline.mesh.interval_of(p).0, &work.clock);
    let phase = spline.mesh.phase(k);
    let part = spline.mesh.point(p).0 - phase as f64;
    let mixed = dot(&clock.mixed, &work.z_t);
    // dt/dT of each phase.
    let by = |i: usize| if i == phase { part } else { 1.0 };
    for i in 0..=phase {
        by_times.gradient[0][i] += by(i) * clock.first;
        // The weight and z depend on the time of the own phase.
        let own = by(i) * (clock.rate + mixed);
        by_times.add_second([i, phase], if i == phase { 2.0 * own } else { own });
        for j in 0..=i {
            by_times.add_second([i, j], by(i) * by(j) * clock.second);
        }
    }
    for (i, column) in by_times.columns[..=phase].iter_mut().enumerate() {
        let scaled = factors.map(|row| row.map(|factor| by(i) * factor));
        add_gradient(spline, k, &scaled, &clock.mixed, column);
    }
}

impl<D: PointDynamics> Interior<D> {
    /// The integral of l_t from each of these times, in their order, to the end of the motion. Along an optimal
    /// motion dH*/dt = -l_t, so that H* less this is constant, and H* at the end.
    pub(super) fn clock_ahead(&mut self, times: &[f64]) -> Vec<f64> {
        let mut ahead = vec![0.0; times.len()];
        if !self.running.references.any() {
            return ahead;
        }
        let (spline, references) = (&self.spline, &mut self.running.references);
        let (mut z, end) = (vec![0.0; 3 * spline.dof], spline.duration());
        let mut sum = 0.0;
        for (i, &from) in times.iter().enumerate().rev() {
            let to = times.get(i + 1).copied().unwrap_or(end);
            for (place, weight) in PLACES.iter().zip(WEIGHTS) {
                let time = from + place * (to - from);
                let (k, x) = spline.mesh.place(spline.place_of(time));
                spline.in_interval(k, x, &mut z);
                // What cannot be evaluated is no motion, and has no H*.
                let rate = references.contract(time, &z[..spline.dof]).map_or(f64::NAN, |l| l.by_time[0]);
                sum += (to - from) * weight * rate;
            }
            ahead[i] = sum;
        }
        ahead
    }
}
