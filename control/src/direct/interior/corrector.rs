//! Corrections of a step that keep the products of slacks and multipliers close to each other.
//!
//! A step of Newton's method leaves out the products `ds deta`. Where they are large, single slacks or
//! multipliers come close to zero long before the others, and the step is cut short. A correction aims at
//! products between a part and a multiple of `mu w` after a step that is longer than the one that is
//! possible, with the matrix that is factorised already (J. Gondzio, Multiple centrality corrections in a
//! primal-dual method for linear programming, Computational Optimization and Applications 6, 1996, pages
//! 137-156).

use super::iterate::{Interior, Trial};
use crate::constants::direct as constants;
use crate::direct::limits::at_node::{AtNode, NodeValue};
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
use crate::direct::limits::entries::add_corrections;
use crate::direct::motion::spline::Spline;
use crate::direct::newton::interval::{add_gradient, add_local};
use crate::direct::newton::side_terms::add_row;
use crate::direct::newton::system::System;
use crate::direct::points::values::{PointDynamics, Points};
use crate::numerics::chain::dot;
use crate::result::stage_times::Stage;
use costate_numerics::widest_fused;

impl<D: PointDynamics> Interior<D> {
    /// Corrects the step for the barrier that was chosen, as long as that makes it longer. How far slacks and
    /// multipliers may go along their [steps](Self::steps_of).
    pub(super) fn correct(&mut self) -> (f64, f64) {
        let mut reached = self.steps_of(self.mu);
        if self.barrier.total_weight() == 0.0 || self.relaxation.is_on() {
            return reached;
        }
        for _ in 0..constants::CORRECTIONS {
            if reached.0.min(reached.1) > constants::LONG_ENOUGH {
                break;
            }
            let aims = [reached.0, reached.1].map(|part| (part + constants::LONGER).min(1.0));
            self.aim(aims);
            self.solve_correction();
            self.swap_corrections();
            let corrected = self.steps_of(self.mu);
            let gain = (corrected.0 - reached.0) + (corrected.1 - reached.1);
            let worse = corrected.0 < reached.0 || corrected.1 < reached.1;
            if worse || gain < constants::LEAST_GAIN {
                self.swap_corrections();
                return self.steps_of(self.mu);
            }
            reached = corrected;
        }
        reached
    }

    /// Puts what is kept aside in the place of the corrections, and those aside.
    pub(super) fn swap_corrections(&mut self) {
        self.steps.swap(2, 3);
        self.changes.swap(2, 3);
        self.time_steps.swap(2, 3);
        self.shared_steps.swap(2, 3);
        self.corrections.swap(0, 1);
    }

    /// Adds to the corrections what the products after these parts of the step lack or have too much.
    pub(super) fn aim(&mut self, [primal, dual]: [f64; 2]) {
        let [now, next] = &mut self.corrections;
        next.clone_from(now);
        let Trial { slack_step, multiplier_step, .. } = &self.trial;
        add_corrections(&self.barrier, self.mu, [(primal, slack_step), (dual, multiplier_step)], next);
    }

    /// Solves for the part of the step that belongs to the corrections aside.
    pub(super) fn solve_correction(&mut self) {
        let Self { system, spline, points, barrier, ends, corrections, .. } = self;
        system.collect_corrections(spline, points, barrier, ends, &corrections[1]);
        self.clock.lap(Stage::Limits);
        self.system.solve_for_corrections(&mut self.steps[3], &mut self.shared_steps[3]);
        self.clock.lap(Stage::Equations);
        self.finish_part(3);
    }
}

impl System {
    /// Gradient of the corrections c of the products: of the terms `c/s` of multipliers.
    pub(super) fn collect_corrections(
        &mut self,
        spline: &Spline,
        points: &Points,
        barrier: &Barrier,
        ends: &Ends,
        corrections: &[f64],
    ) {
        self.correction.clear();
        self.correction.resize(spline.unknowns.len(), 0.0);
        self.time_correction.clear();
        self.time_correction.resize(spline.mesh.phases(), 0.0);
        let of = |at: usize, sign: f64| {
            let is_limit = barrier.is_limit(at) && corrections[at] != 0.0;
            if is_limit { -sign * corrections[at] / barrier.slack[at] } else { 0.0 }
        };
        let Self { work, correction, time_correction, .. } = self;
        widest_fused(
            #[inline(always)]
            |_| {
                for p in 0..points.count() {
                    let own = &corrections[barrier.at_point(p)];
                    if !barrier.has_hulls() && own.iter().all(|&correction| correction == 0.0) {
                        continue;
                    }
                    let [z, ..] = &mut work.z;
                    z.fill(0.0);
                    let (k, j) = spline.mesh.interval_of(p);
                    for ((i, side), at) in barrier.sides().iter().enumerate().zip(barrier.at_point(p)) {
                        let value = match barrier.is_hull(i) {
                            true => barrier.by_value((k, j), i, |at| of(at, side.sign)),
                            false => of(at, side.sign),
                        };
                        if value == 0.0 {
                            continue;
                        }
                        add_row(points, p, side, value, z);
                    }
                    let factors = spline.factors(k, j);
                    work.differentiate_in_time(points.z(p), spline, k, &factors);
                    time_correction[spline.mesh.phase(k)] += dot(&work.z[0], &work.z_t);
                    add_gradient(spline, k, &factors, &work.z[0], correction);
                }
            },
        );
        for k in 0..if barrier.rate_sides().is_empty() { 0 } else { spline.mesh.intervals() } {
            let phase = spline.mesh.phase(k);
            let (to, by_times) = (&mut self.correction, &mut self.time_correction);
            let wanted = |at: usize| barrier.is_limit(at) && corrections[at] != 0.0;
            self.rate_rows.for_each(k, (spline, points, barrier), wanted, |at, i, row, by_time| {
                let value = of(at, barrier.rate_sides()[i].sign);
                add_local(spline, k, row, value, to);
                by_times[phase] += by_time * value;
            });
        }
        for k in 0..spline.mesh.nodes.len() {
            let node = AtNode::new(spline, k);
            for at in barrier.at_node(k) {
                let side = barrier.side(at);
                let (value, NodeValue { unknown, scale, by_time, .. }) = (of(at, side.sign), node.of(side));
                self.correction[unknown] += scale * value;
                if let Some(by_time) = by_time {
                    self.time_correction[by_time.phase] += by_time.first * value;
                }
            }
        }
        self.shared_correction.resize(ends.shared(), 0.0);
        let shared = &mut self.shared_correction;
        ends.reduce(&spline.mesh, &mut self.correction, &self.time_correction, shared);
    }

    /// Solves for the part of the step that belongs to the corrections.
    fn solve_for_corrections(&mut self, dx: &mut Vec<f64>, shared: &mut Vec<f64>) {
        dx.clear();
        dx.extend(self.correction.iter().map(|g| -g));
        shared.clear();
        shared.extend(self.shared_correction.iter().map(|g| -g));
        self.finish_solution(dx, shared);
    }
}
