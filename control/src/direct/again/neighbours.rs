//! Optimal motions nearby: how the motion changes with its ends, from the factorised equations.
//!
//! At a solution the gradient of the Lagrangian of the barrier problem vanishes in the free unknowns x and in
//! T. The given unknowns are q and v of the ends. If they change by delta at constant T,
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
use crate::numerics::lu::eliminate;
use costate::EvalError;

impl System {
    /// How the unknowns and the shared ones change with the given q and v at start and end of a motion in one
    /// phase (2n entries each; those of free ones do not count).
    fn respond(
        &mut self,
        ends: &Ends,
        spline: &Spline,
        changes: [&[f64]; 2],
        dx: &mut Vec<f64>,
        shared: &mut Vec<f64>,
    ) {
        dx.clear();
        dx.resize(spline.unknowns.len(), 0.0);
        let mut by_time = 0.0;
        let given = |end: usize, i: usize, change: f64| change != 0.0 && ends.given[end][i];
        for (end, change) in changes.into_iter().enumerate() {
            for (i, &change) in change.iter().enumerate().filter(|&(i, change)| given(end, i, *change)) {
                self.at_ends.add_column(end, i, -change, dx);
                by_time -= self.at_ends.border[end][i] * change;
            }
        }
        shared.clear();
        shared.resize(ends.shared(), 0.0);
        ends.reduce(&spline.mesh, dx, &[by_time], shared);
        self.finish_solution(dx, shared);
        for (end, change) in changes.into_iter().enumerate() {
            let first = spline.end_unknowns(end).start;
            for (i, &change) in change.iter().enumerate().filter(|&(i, change)| given(end, i, *change)) {
                dx[first + i] = change;
            }
        }
    }
}

impl<D: PointDynamics> Interior<D> {
    /// The first part of the step: how the motion changes with the states at its ends. The change of T.
    pub(super) fn respond(&mut self, changes: [&[f64]; 2]) -> f64 {
        let (dx, shared) = (&mut self.steps[0], &mut self.shared_steps[0]);
        self.system.respond(&self.ends, &self.spline, changes, dx, shared);
        self.ends.times.expand(shared, &mut self.time_steps[0]);
        self.time_steps[0][0]
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

    /// Fills the derivatives by the states at both ends, from equations that are factorised at this iterate.
    pub fn fill_feedback(&mut self, feedback: &mut Feedback) {
        let n = self.spline.dof;
        feedback.resize(n, &self.spline.mesh.nodes, self.spline.duration());
        let mut change = std::mem::take(&mut feedback.change);
        change.fill(0.0);
        let none = std::mem::take(&mut feedback.none);
        for end in 0..2 {
            for j in 0..2 * n {
                change[j] = 1.0;
                let changes = if end == 0 { [&change[..], &none[..]] } else { [&none[..], &change[..]] };
                let dt = self.respond(changes);
                change[j] = 0.0;
                feedback.time_by[end][j] = dt;
                self.take_response(end, j, feedback);
                if end == 0 {
                    self.take_costate_response(j, feedback);
                }
            }
        }
        (feedback.change, feedback.none) = (change, none);
        let full = self.ends.given[0].iter().all(|given| *given);
        feedback.has_gain = full;
        if full {
            fill_gains(n, feedback);
        }
    }

    /// Writes column `j` of the derivatives of states and torques at all points.
    fn take_response(&mut self, end: usize, j: usize, feedback: &mut Feedback) {
        let n = self.spline.dof;
        for p in 0..self.points.count() {
            self.change_of_z(p, 0);
            let (dz, tau_z) = (&self.trial.dz, self.points.tau_z(p));
            let states = &mut feedback.states_by[end][4 * n * n * p..][..4 * n * n];
            for (i, row) in states.chunks_exact_mut(2 * n).enumerate() {
                row[j] = dz[i];
            }
            let torques = &mut feedback.torques_by[end][2 * n * n * p..][..2 * n * n];
            for (row, tau_z) in torques.chunks_exact_mut(2 * n).zip(tau_z.chunks_exact(3 * n)) {
                row[j] = dot(tau_z, dz);
            }
        }
    }

    /// Writes column `j` of the second derivatives of the cost by the state at the start.
    fn take_costate_response(&mut self, j: usize, feedback: &mut Feedback) {
        let (n, dt) = (self.spline.dof, self.time_steps[0][0]);
        let at_ends = &self.system.at_ends;
        for i in 0..2 * n {
            feedback.cost_xx[2 * n * i + j] =
                at_ends.product(0, i, &self.steps[0]) + at_ends.border[0][i] * dt;
            feedback.cost_x[i] = at_ends.gradient(0, i);
        }
    }
}

/// `K = tau_x0 X^-1` at all points, with X the derivative of the state there by that at the start.
fn fill_gains(n: usize, feedback: &mut Feedback) {
    let width = 3 * n;
    let Feedback { states_by: [states, _], torques_by: [torques, _], gains, work, exchanges, .. } = feedback;
    let points = states.chunks_exact(4 * n * n).zip(torques.chunks_exact(2 * n * n));
    for ((states, torques), gain) in points.zip(gains.chunks_exact_mut(2 * n * n)) {
        // X'K' = tau_x0'.
        for (i, row) in work.chunks_exact_mut(width).enumerate() {
            let (left, right) = row.split_at_mut(2 * n);
            left.iter_mut().enumerate().for_each(|(l, entry)| *entry = states[2 * n * l + i]);
            right.iter_mut().enumerate().for_each(|(l, entry)| *entry = torques[2 * n * l + i]);
        }
        if !eliminate(work, width, 2 * n, exchanges) {
            gain.fill(f64::NAN);
            continue;
        }
        for l in 0..n {
            for i in (0..2 * n).rev() {
                let row = &work[width * i..width * (i + 1)];
                let known: f64 = (i + 1..2 * n).map(|k| row[k] * gain[2 * n * l + k]).sum();
                gain[2 * n * l + i] = (row[2 * n + l] - known) / row[i];
            }
        }
    }
}
