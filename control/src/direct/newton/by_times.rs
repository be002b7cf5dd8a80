//! Derivatives by the times of phases.
//!
//! A point in phase p at the place s is passed at the time $t = \sum\_{i<p} T\_i + (s - p) T\_p$. So where
//! the running cost depends on t it depends on the times of the phase and of all before it.

use super::interval::add_gradient;
use super::point_terms::Work;
use crate::direct::motion::shape::MOST_COEFFICIENTS;
use crate::direct::motion::spline::Spline;
use crate::numerics::chain::dot;

/// Derivatives by the time of each phase.
#[derive(Clone, Debug, Default)]
pub(in crate::direct) struct ByTimes {
    /// Gradients, as those in x.
    pub gradient: [Vec<f64>; 2],
    /// Of the gradient in x.
    pub columns: Vec<Vec<f64>>,
    /// Second ones, K x K for K phases. Two phases have some together where the cost depends on the time
    /// since the start of the motion.
    pub second: Vec<f64>,
    /// Derivatives by a delay of all points: of the gradient in x, and second ones with the time of each
    /// phase, then with the delay itself.
    pub delay: [Vec<f64>; 2],
}

impl ByTimes {
    /// Zero, for so many phases and unknowns.
    pub fn reset(&mut self, phases: usize, size: usize) {
        for (list, count) in
            self.gradient.iter_mut().zip([phases; 2]).chain([(&mut self.second, phases * phases)])
        {
            list.clear();
            list.resize(count, 0.0);
        }
        self.columns.resize_with(phases, Vec::new);
        for column in &mut self.columns {
            column.clear();
            column.resize(size, 0.0);
        }
        for (list, count) in self.delay.iter_mut().zip([size, phases + 1]) {
            list.clear();
            list.resize(count, 0.0);
        }
    }

    /// Adds to the second derivatives by the times of two phases.
    #[inline(always)]
    pub fn add_second(&mut self, [a, b]: [usize; 2], value: f64) {
        let phases = self.columns.len();
        self.second[phases * a + b] += value;
        if a != b {
            self.second[phases * b + a] += value;
        }
    }

    /// Adds what the clock makes of a place s of interval `k` that was [collected](Work::collect), to the
    /// derivatives by the times of its phase and of those before it.
    #[inline(never)]
    pub fn add_clock(
        &mut self,
        (k, s): (usize, f64),
        spline: &Spline,
        factors: &[[f64; MOST_COEFFICIENTS]; 3],
        work: &Work,
    ) {
        let (phase, clock) = (spline.mesh.phase(k), &work.clock);
        let part = s - phase as f64;
        let mixed = dot(&clock.mixed, &work.z_t);
        // dt/dT of each phase.
        let by = |i: usize| if i == phase { part } else { 1.0 };
        for i in 0..=phase {
            self.gradient[0][i] += by(i) * clock.first;
            // The weight and z depend on the time of the own phase.
            let own = by(i) * (clock.rate + mixed);
            self.add_second([i, phase], if i == phase { 2.0 * own } else { own });
            for j in 0..=i {
                self.add_second([i, j], by(i) * by(j) * clock.second);
            }
        }
        // A delay shifts the clock alone.
        let (phases, [of_delay, second]) = (self.columns.len(), &mut self.delay);
        for (i, to) in second[..=phase].iter_mut().enumerate() {
            *to += by(i) * clock.second;
        }
        second[phase] += clock.rate + mixed;
        second[phases] += clock.second;
        add_gradient(spline, k, factors, &clock.mixed, of_delay);
        for (i, column) in self.columns[..=phase].iter_mut().enumerate() {
            let scaled = factors.map(|row| row.map(|factor| by(i) * factor));
            add_gradient(spline, k, &scaled, &clock.mixed, column);
        }
    }
}
