//! Newton's equations, factorised: steps for right-hand sides.

use super::system::System;
use crate::direct::limits::ends::Ends;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::Points;
use crate::numerics::chain::NotPositiveDefinite;

impl System {
    /// Factorises, with `damping` times the metric of `weights` added to K.
    pub fn factorise(
        &mut self,
        damping: f64,
        ends: &Ends,
        spline: &Spline,
        points: &Points,
        weights: &[f64],
    ) -> Result<(), NotPositiveDefinite> {
        self.factor.copy_from(&self.matrix);
        if damping > 0.0 {
            if !self.damping_is_current {
                self.collect_metric(spline, points, weights);
                self.border.collect_metric(&self.time_metric, &self.damping, ends, &spline.mesh);
                ends.removed(&spline.mesh).for_each(|(k, i)| self.damping.remove(k, i));
                self.damping_is_current = true;
            }
            self.factor.add(damping, &self.damping);
        }
        self.factor.factorise()?;
        match self.border.factorise(damping, &mut self.factor) {
            true => Ok(()),
            false => Err(NotPositiveDefinite { block: spline.mesh.nodes.len() }),
        }
    }

    /// Collects the metric of all unknowns of the spline.
    pub fn collect_metric(&mut self, spline: &Spline, points: &Points, weights: &[f64]) {
        self.damping.reset(spline.mesh.intervals());
        self.metric.fill(&mut self.damping, spline, points, weights);
    }

    /// Makes room for the metric of damping.
    pub fn reserve_damping(&mut self, intervals: usize) {
        self.damping.reset(intervals);
        self.damping_is_current = false;
    }

    /// Solves for the part of the step that belongs to the gradient `part`; without what is removed.
    pub fn solve(&mut self, part: usize, dx: &mut Vec<f64>, shared: &mut Vec<f64>) {
        dx.clear();
        dx.extend(self.gradient[part].iter().map(|g| -g));
        shared.clear();
        shared.extend(self.shared_gradient[part].iter().map(|g| -g));
        self.finish_solution(dx, shared);
    }

    /// Solves with a right-hand side.
    pub(crate) fn finish_solution(&mut self, dx: &mut [f64], shared: &mut [f64]) {
        self.factor.solve(dx);
        self.border.finish(dx, shared);
    }

    /// Solves with another right-hand side, whose last entries are those of the shared unknowns.
    pub fn solve_column(&mut self, column: &mut [f64]) {
        let (dx, shared) = column.split_at_mut(self.gradient[0].len());
        self.finish_solution(dx, shared);
    }
}
