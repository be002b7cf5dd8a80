//! Newton's step by condensation and recursion.

use super::interior::Interior;
use super::points::{Layout, POINTS};
use super::problem::DirectDynamics;
use crate::constants::{direct as shared, states as constants};
use crate::status::Status;

impl Interior {
    /// Solves Newton's equations for the step of w and the new multipliers, which are left in the workspace.
    /// The Hessian is damped until it is positive definite along the linearised defects.
    ///
    /// # Errors
    /// Singular if the defects do not determine the states of an interval, which no damping changes; failed
    /// if no damping makes the Hessian positive definite.
    pub(super) fn find_step<D, C>(&mut self, task: &DirectDynamics<D, C>) -> Result<(), Status> {
        self.add_barriers();
        for i in 0..self.ends.len() {
            let size = self.end_size(i);
            self.work.end_weights[i] = constants::END_WEIGHT * self.cost_size() / (size * size);
        }
        let (layout, radau, scratch) = (&self.layout, &self.radau, &mut self.work.scratch);
        if !self.intervals.iter_mut().all(|interval| interval.eliminate(layout, radau, scratch)) {
            return Err(Status::Singular);
        }
        let mut damping = 0.0;
        while !self.factorise(task, damping) {
            damping = if damping == 0.0 {
                (self.damping / constants::DAMPING_DOWN).max(shared::DAMPING)
            } else {
                constants::DAMPING_UP * damping
            };
            if damping > constants::MOST_DAMPING {
                return Err(Status::NewtonFailed);
            }
        }
        self.definite = damping == 0.0;
        if damping > 0.0 {
            self.damping = damping;
        }
        self.go_forward(damping);
        Ok(())
    }

    /// Solves the last equations again with other defects. False if the factors fail by rounding.
    pub(super) fn correct_step<D, C>(&mut self, task: &DirectDynamics<D, C>) -> bool {
        let damping = if self.definite { 0.0 } else { self.damping };
        self.intervals.iter_mut().for_each(|interval| interval.change_defects(&self.layout));
        let is_factorised = self.factorise(task, damping);
        if is_factorised {
            self.go_forward(damping);
        }
        is_factorised
    }

    /// Adds the barriers of the points to their derivatives.
    fn add_barriers(&mut self) {
        let layout = self.layout;
        let size = layout.n + layout.m;
        for k in 0..layout.intervals {
            for j in 0..POINTS {
                for i in 0..size {
                    let (curvature, force) = self.barrier(layout.point(k, j) + i);
                    self.intervals[k].hessian[(j * size + i) * size + i] += curvature;
                    self.intervals[k].gradient[j * size + i] += force;
                }
            }
        }
    }

    /// Condenses the intervals and goes back over the nodes, to (dx, dT) at the start.
    fn factorise<D, C>(&mut self, task: &DirectDynamics<D, C>, damping: f64) -> bool {
        let layout = self.layout;
        let n = layout.n;
        let z = n + 1;
        let (p, p_1) = self.recursion.end();
        p.fill(0.0);
        p_1.fill(0.0);
        for ((end, nu), weight) in self.ends.iter().zip(&self.nu).zip(&self.work.end_weights) {
            let force = nu + weight * end.missed(&layout, &self.w);
            for (i, c) in end.entries() {
                end.entries().for_each(|(j, other)| p[i * z + j] += weight * c * other);
                p_1[i] += c * force;
            }
        }
        let scratch = &mut self.work.scratch;
        self.intervals.iter_mut().for_each(|interval| interval.condense(&layout, damping, scratch));
        if !self.recursion.go_back(&layout, &self.intervals) {
            return false;
        }
        for at in 0..self.free.len() {
            let i = self.free[at];
            let (unknown, weight) = if i == n { (layout.time(), task.time_weight()) } else { (i, 0.0) };
            let (curvature, force) = self.barrier(unknown);
            let (p, p_1) = self.recursion.start();
            p[i * z + i] += curvature + damping;
            p_1[i] += force + weight;
        }
        self.recursion.first(&self.free, &mut self.work.state)
    }

    /// Steps of all unknowns and multipliers from that of the start.
    fn go_forward(&mut self, damping: f64) {
        let layout = self.layout;
        let Layout { n, intervals, .. } = layout;
        let (z, work) = (n + 1, &mut self.work);
        work.step[..n].copy_from_slice(&work.state[..n]);
        work.step[layout.time()] = work.state[n];
        for k in 0..intervals {
            work.y[..z].copy_from_slice(&work.state);
            self.recursion.controls(k, &mut work.y);
            let range = layout.point(k, 0)..layout.point(k + 1, 0);
            self.intervals[k].expand(&layout, &work.y, &mut work.step[range.clone()]);
            work.state[..n].copy_from_slice(&work.step[layout.node(k + 1)..][..n]);
            self.recursion.gradient(k + 1, &work.state, &mut work.after);
            let out = &mut work.lambda[k * POINTS * n..(k + 1) * POINTS * n];
            let dt = work.state[n];
            self.intervals[k].multipliers(&layout, &work.step[range], dt, damping, &work.after, out);
        }
        let last = layout.node(intervals);
        for (i, end) in self.ends.iter().enumerate() {
            let missed = end.missed(&layout, &self.w) + end.of_state(&work.step[last..]);
            work.nu[i] = self.nu[i] + work.end_weights[i] * missed;
        }
    }
}
