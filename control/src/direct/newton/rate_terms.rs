//! What the Lagrange function makes of jerks and rates of torques.

use super::side_terms::entry_terms;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::side::Limited;
use crate::direct::motion::shape::POINTS;
use crate::direct::motion::spline::Spline;
use crate::direct::points::rates::{RateCosts, Rates, SLOPES, Term};

impl Rates {
    /// Derivatives of the Lagrange function by all values, and by the torques through their rates.
    pub(super) fn collect(&mut self, spline: &Spline, barrier: &Barrier, costs: &RateCosts) {
        let (n, mesh) = (spline.dof, &spline.mesh);
        let limits = |limited| barrier.rate_sides().iter().any(|side| side.limited == limited);
        self.has_jerks = !costs.jerk.is_empty() || limits(Limited::Jerk);
        self.has_torques = !costs.torque.is_empty() || limits(Limited::TorqueRate);
        self.jerk_terms.clear();
        self.torque_terms.clear();
        for by_torques in &mut self.by_torques {
            by_torques.clear();
            if self.has_torques {
                by_torques.resize(n * mesh.points(), 0.0);
            }
        }
        for p in 0..mesh.gauss_points() {
            let (weight, time) = (mesh.gauss_point(p).1, spline.clock(p / POINTS));
            let of_costs = |weights: &[f64], i: usize, y: f64| {
                let slope = weight * weights.get(i).copied().unwrap_or(0.0) * y;
                let second = time * weight * weights.get(i).copied().unwrap_or(0.0);
                Term { first: [time * slope, time * slope, 0.0], second, slope, cost: 0.5 * slope * y }
            };
            self.jerk_terms.extend((0..n).map(|i| of_costs(&costs.jerk, i, self.jerk[n * p + i])));
            self.torque_terms.extend((0..n).map(|i| of_costs(&costs.torque, i, self.torque[n * p + i])));
            for (i, side) in barrier.rate_sides().iter().enumerate() {
                let (at, number) = (barrier.at_gauss_point(p).start + i, barrier.sides().len() + i);
                let (parts, sigma) = entry_terms(barrier, (p / POINTS, p % POINTS), number, at);
                let terms = match side.limited {
                    Limited::Jerk => &mut self.jerk_terms,
                    _ => &mut self.torque_terms,
                };
                let term = &mut terms[n * p + side.joint];
                term.first.iter_mut().zip(parts).for_each(|(to, part)| *to += part);
                term.second += sigma;
            }
            if self.has_torques {
                let (k, j) = (p / POINTS, p % POINTS);
                let scale = 1.0 / (mesh.width(k) * time);
                for (variant, to) in self.by_torques.iter_mut().enumerate() {
                    let to = to[n * mesh.first_point(k)..].chunks_exact_mut(n);
                    for (to, slope) in to.zip(SLOPES[j]) {
                        for (to, term) in to.iter_mut().zip(&self.torque_terms[n * p..]) {
                            *to += scale * slope * term.first[variant];
                        }
                    }
                }
            }
        }
    }
}
