//! Optimal motions nearby: how the motion changes with its ends, from the factorised equations.
//!
//! At a solution the gradient of the Lagrangian of the barrier problem vanishes in the free unknowns x and in
//! T. The given unknowns are those of the start, the vias and the end. If they change by delta at constant T,
//!
//! $$ \begin{pmatrix} K & b \\\\ b^\top & c \end{pmatrix} \begin{pmatrix} \Delta x \\\\ \Delta T
//!    \end{pmatrix} = - \begin{pmatrix} K_\delta \delta \\\\ b_\delta \cdot \delta \end{pmatrix} $$
//!
//! with the columns of the given unknowns on the right: one substitution, no evaluation. The slacks and
//! multipliers are eliminated in K, which holds the barrier at its mu.

use super::feedback::Feedback;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::ends::Ends;
use crate::direct::motion::spline::Spline;
use crate::direct::newton::system::System;
use crate::direct::points::values::PointDynamics;
use crate::numerics::chain::dot;
use costate::EvalError;

impl System {
    /// How the unknowns and the times change with what is given at the ends of phases, by the changes of the
    /// unknowns there; those of free ones do not count.
    fn respond(
        &mut self,
        ends: &Ends,
        spline: &Spline,
        changes: &[Vec<f64>],
        (dx, shared, times): (&mut Vec<f64>, &mut Vec<f64>, &mut Vec<f64>),
    ) {
        let given = || {
            changes.iter().enumerate().flat_map(|(end, change)| {
                let entries = change.iter().zip(&ends.given[end]).enumerate();
                let entries = entries.filter(|(_, (change, given))| **given && **change != 0.0);
                entries.map(move |(i, (change, _))| (end, i, *change))
            })
        };
        dx.clear();
        dx.resize(spline.unknowns.len(), 0.0);
        times.clear();
        times.resize(spline.times.len(), 0.0);
        for (end, i, change) in given() {
            self.at_ends.add_column(end, i, -change, dx);
            for (phase, time) in times.iter_mut().enumerate() {
                *time -= self.at_ends.by_time(end, phase, i) * change;
            }
        }
        shared.clear();
        shared.resize(ends.shared(), 0.0);
        ends.reduce(&spline.mesh, dx, times, shared);
        self.finish_solution(dx, shared);
        ends.expand(&spline.mesh, shared, dx, times);
        for (end, i, change) in given() {
            dx[spline.end_unknowns(end).start + i] = change;
        }
    }
}

impl<D: PointDynamics> Interior<D> {
    /// The first part of the step: how the motion changes with the unknowns at the ends of phases.
    pub(super) fn respond(&mut self, changes: &[Vec<f64>]) {
        let to = (&mut self.steps[0], &mut self.shared_steps[0], &mut self.time_steps[0]);
        self.system.respond(&self.ends, &self.spline, changes, to);
    }

    /// Newton's equations at the iterate, factorised without damping, with limits that are no stiffer than
    /// the equations resolve. Whether the matrix is positive definite.
    pub fn linearise(&mut self) -> Result<bool, EvalError> {
        self.barrier.soften(constants::STIFFEST_LIMIT * self.figures.size);
        self.refresh()?;
        self.system.exact = true;
        self.assemble();
        Ok(self.factorise(0.0))
    }

    /// Fills the derivatives by the states at both ends and the gains, from points that are contracted and
    /// equations that are factorised at this iterate; they are so afterwards.
    pub fn fill_feedback(&mut self, feedback: &mut Feedback) {
        feedback.resize(&self.spline);
        self.fill_gains(feedback);
        let (last, m) = (self.spline.times.len(), self.spline.node());
        for (end, side) in [(0, 0), (last, 1)] {
            for j in 0..m {
                // The end of a periodic motion follows.
                let other = if end == 0 && self.ends.is_periodic { last } else { end };
                [end, other].into_iter().for_each(|end| feedback.changes[end][j] = 1.0);
                self.respond(&feedback.changes);
                [end, other].into_iter().for_each(|end| feedback.changes[end][j] = 0.0);
                feedback.time_by[side][j] = self.time_steps[0].iter().sum();
                self.take_response(side, j, feedback);
                if end == 0 {
                    self.take_costate_response(j, feedback);
                }
            }
        }
    }

    /// Writes column `j` of the derivatives of states and torques at all points.
    fn take_response(&mut self, side: usize, j: usize, feedback: &mut Feedback) {
        let (n, m) = (self.spline.dof, self.spline.node());
        for p in 0..self.points.count() {
            self.change_of_z(p, 0);
            let (dz, tau_z) = (&self.trial.dz, self.points.tau_z(p));
            let states = &mut feedback.states_by[side][m * m * p..][..m * m];
            for (i, row) in states.chunks_exact_mut(m).enumerate() {
                row[j] = dz[i];
            }
            let torques = &mut feedback.torques_by[side][n * m * p..][..n * m];
            for (row, tau_z) in torques.chunks_exact_mut(m).zip(tau_z.chunks_exact(3 * n)) {
                row[j] = dot(tau_z, dz);
            }
        }
    }

    /// Writes column `j` of the second derivatives of the cost by the state at the start. That of a periodic
    /// motion is its end too.
    fn take_costate_response(&mut self, j: usize, feedback: &mut Feedback) {
        let (m, at_ends) = (self.spline.node(), &self.system.at_ends);
        let ends = [Some(0), self.ends.is_periodic.then_some(self.spline.times.len())];
        for i in 0..m {
            let ends = || ends.into_iter().flatten();
            let product = |end| at_ends.product(end, i, &self.steps[0], &self.time_steps[0]);
            feedback.cost_xx[m * i + j] = ends().map(product).sum();
            feedback.cost_x[i] = ends().map(|end| at_ends.gradient(end, i)).sum();
        }
    }
}
