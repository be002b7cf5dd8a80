//! What H* changes by where the cost depends on the time since the start of the motion.

use crate::direct::interior::iterate::Interior;
use crate::direct::motion::shape::{PLACES, WEIGHTS};
use crate::direct::points::values::PointDynamics;

/// What is still ahead of the clock.
pub(super) struct Ahead {
    pub at_points: Vec<f64>,
    /// The means over the intervals.
    pub means: Vec<f64>,
}

impl<D: PointDynamics> Interior<D> {
    /// [`clock_ahead`](Self::clock_ahead) at the points.
    pub(super) fn ahead_of_points(&mut self) -> Ahead {
        let times: Vec<f64> = (0..self.spline.mesh.points()).map(|p| self.spline.time_of(p)).collect();
        let (at_points, mesh) = (self.clock_ahead(&times), &self.spline.mesh);
        let mean = |k: usize| -> f64 {
            let parts = mesh.shape.weights().iter().enumerate();
            parts.map(|(j, part)| part * at_points[mesh.first_point(k) + j]).sum()
        };
        Ahead { means: (0..mesh.intervals()).map(mean).collect(), at_points }
    }

    /// The integral of l_t from each of these times, in their order, to the end of the motion. Along an
    /// optimal motion dH*/dt = -l_t, so that H* less this is constant, and H* at the end.
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
            let mut left = from;
            while left < to {
                // References bend at their knots.
                let right = references.next_knot(left).min(to);
                for (place, weight) in PLACES.iter().zip(WEIGHTS) {
                    let time = left + place * (right - left);
                    let (k, x) = spline.mesh.place(spline.place_of(time));
                    spline.in_interval(k, x, &mut z);
                    // What cannot be evaluated is no motion, and has no H*.
                    let rate = references.contract(time, &z[..spline.dof]).map_or(f64::NAN, |l| l.by_time[0]);
                    sum += (right - left) * weight * rate;
                }
                // Rounding of times may find a knot once more.
                left = if right > left { right } else { to };
            }
            ahead[i] = sum;
        }
        ahead
    }
}
