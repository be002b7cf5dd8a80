//! Directions: from the factorised equations to steps of unknowns, slacks and multipliers.

use super::iterate::{Interior, Trial};
use crate::constants::direct as constants;
use crate::direct::limits::at_node::AtNode;
use crate::direct::limits::entries::{complementarity, steps};
use crate::direct::limits::side::Limited;
use crate::direct::motion::shape::{MOST_POINTS, POINTS};
use crate::direct::motion::spline::TimeDerivative;
use crate::direct::points::rates::{SLOPES, combine};
use crate::direct::points::values::PointDynamics;
use crate::numerics::chain::dot;
use crate::result::stage_times::Stage;
use costate_numerics::widest_fused;

impl<D: PointDynamics> Interior<D> {
    /// Both parts of the step, and of the change of distances; without corrections.
    pub(super) fn solve(&mut self) {
        for part in 0..2 {
            let (dx, shared) = (&mut self.steps[part], &mut self.shared_steps[part]);
            self.system.solve(part, dx, shared);
            self.relaxation.correct(part, dx, shared);
            self.clock.lap(Stage::Equations);
            self.finish_part(part);
            self.relaxation.add_change(part, &self.barrier, &mut self.changes[part]);
            self.clock.lap(Stage::Limits);
        }
        let (unknowns, count) = (self.spline.unknowns.len(), self.barrier.count());
        let of_barrier = self.changes[2..].iter_mut().chain(&mut self.corrections);
        let vectors = self.steps[2..].iter_mut().map(|vector| (vector, unknowns));
        for (vector, count) in vectors.chain(of_barrier.map(|vector| (vector, count))) {
            vector.clear();
            vector.resize(count, 0.0);
        }
        self.system.correction.resize(unknowns, 0.0);
        let (shared, phases) = (self.ends.shared(), self.spline.times.len());
        for (steps, count) in [(&mut self.shared_steps, shared), (&mut self.time_steps, phases)] {
            for vector in &mut steps[2..] {
                vector.clear();
                vector.resize(count, 0.0);
            }
        }
    }

    /// The steps of the times and of tied ends, and the change of distances, of a part of the step.
    pub(super) fn finish_part(&mut self, part: usize) {
        let count = self.barrier.count();
        let (unknowns, times) = (&mut self.steps[part], &mut self.time_steps[part]);
        self.ends.expand(&self.spline.mesh, &self.shared_steps[part], unknowns, times);
        self.changes[part].resize(count, 0.0);
        if count > 0 {
            self.change_distances(part);
        }
    }

    /// The step of an unknown, all parts together.
    #[inline(always)]
    pub(super) fn step(&self, i: usize) -> f64 {
        self.steps[0][i] + self.mu * self.steps[1][i] + self.steps[2][i]
    }

    /// The step of the time of a phase.
    pub(super) fn time_step(&self, phase: usize) -> f64 {
        let [at_zero, of_mu, correction, _] = &self.time_steps;
        at_zero[phase] + self.mu * of_mu[phase] + correction[phase]
    }

    /// The step of a shared unknown.
    pub(super) fn shared_step(&self, i: usize) -> f64 {
        let [at_zero, of_mu, correction, _] = &self.shared_steps;
        at_zero[i] + self.mu * of_mu[i] + correction[i]
    }

    /// Change of all distances by a part of the step.
    pub(crate) fn change_distances(&mut self, part: usize) {
        widest_fused(
            #[inline(always)]
            |_| self.change_at_points(part),
        );
        self.change_at_nodes(part);
        self.change_of_rates(part);
        self.change_at_ends(part);
        self.barrier.take_coefficients(&mut self.changes[part]);
    }

    /// Change of the distances at the points by a part of the step.
    #[inline(always)]
    fn change_at_points(&mut self, part: usize) {
        let n = self.spline.dof;
        for p in 0..self.points.count() {
            self.change_of_z(p, part);
            let dz = &self.trial.dz;
            let (tau_z, g_x, h_z) = (self.points.tau_z(p), self.points.g_x(p), self.points.h_z(p));
            let changes = &mut self.changes[part][self.barrier.at_point(p)];
            // Both sides of a limit change alike, and one follows the other.
            let (mut last, mut value) = (None, 0.0);
            for (change, side) in changes.iter_mut().zip(self.barrier.sides()) {
                let this = Some((side.limited, side.joint));
                if last != this {
                    last = this;
                    value = match side.limited {
                        Limited::Torque => dot(&tau_z[3 * n * side.joint..][..3 * n], dz),
                        Limited::Power | Limited::TorqueSpeed | Limited::ToolAcceleration => {
                            dot(&h_z[3 * n * side.joint..][..3 * n], dz)
                        }
                        Limited::Task => dot(&g_x[2 * n * side.joint..][..2 * n], &dz[..2 * n]),
                        _ => dz[side.index(n)],
                    };
                }
                *change = side.sign * value;
            }
        }
    }

    /// Change of z at a point by a part of the step, to the trial.
    #[inline(never)]
    pub(crate) fn change_of_z(&mut self, p: usize, part: usize) {
        let (k, j) = self.spline.mesh.interval_of(p);
        let dt = self.time_steps[part][self.spline.mesh.phase(k)];
        let (inner, ends) = self.spline.of_interval(&self.steps[part], k);
        let basis = self.spline.basis(k, j);
        self.spline.change((k, &basis), (inner, ends), dt, self.points.z(p), &mut self.trial.dz);
    }

    /// Change of the distances at the nodes by a part of the step.
    fn change_at_nodes(&mut self, part: usize) {
        for k in 0..self.spline.mesh.nodes.len() {
            let node = AtNode::new(&self.spline, k);
            for at in self.barrier.at_node(k) {
                let side = self.barrier.side(at);
                let value = node.of(side);
                let change = value.change(self.steps[part][value.unknown], &self.time_steps[part]);
                self.changes[part][at] = side.sign * change;
            }
        }
    }

    /// Change of jerks and rates of torques by a part of the step.
    fn change_of_rates(&mut self, part: usize) {
        if self.barrier.rate_sides().is_empty() {
            return;
        }
        let n = self.spline.dof;
        let mut torques = std::mem::take(&mut self.trial.torques);
        torques.resize(MOST_POINTS * n, 0.0);
        let [mut jerk, mut torque] = std::mem::take(&mut self.trial.rates);
        jerk.resize(n, 0.0);
        torque.resize(n, 0.0);
        for k in 0..self.spline.mesh.intervals() {
            let rate = 1.0 / self.spline.clock(k);
            let dt = self.time_steps[part][self.spline.mesh.phase(k)];
            for (m, torques) in torques.chunks_exact_mut(n).enumerate() {
                let p = self.spline.mesh.first_point(k) + m;
                self.change_of_z(p, part);
                let rows = self.points.tau_z(p).chunks_exact(3 * n);
                torques.iter_mut().zip(rows).for_each(|(to, row)| *to = dot(row, &self.trial.dz));
            }
            let scale = rate / self.spline.mesh.width(k);
            let (inner, ends) = self.spline.of_interval(&self.steps[part], k);
            for (j, slopes) in SLOPES.iter().enumerate() {
                let p = POINTS * k + j;
                combine(slopes, &torques, &mut torque);
                let basis = self.spline.gauss_basis(k, j);
                basis.jerk(n, inner, ends, &mut jerk);
                for TimeDerivative { column, order, first } in self.spline.time_derivatives(k) {
                    let factor = order * rate * basis.rows[3][column] * dt;
                    let unknowns = &self.spline.unknowns[first..first + n];
                    jerk.iter_mut().zip(unknowns).for_each(|(jerk, x)| *jerk += factor * x);
                }
                let values = &self.points.rates;
                for i in 0..n {
                    torque[i] = scale * torque[i] - rate * values.torque[n * p + i] * dt;
                    jerk[i] = rate * rate * rate * jerk[i] - 3.0 * rate * values.jerk[n * p + i] * dt;
                }
                let changes = &mut self.changes[part][self.barrier.at_gauss_point(p)];
                for (change, side) in changes.iter_mut().zip(self.barrier.rate_sides()) {
                    let of = if side.limited == Limited::Jerk { &jerk } else { &torque };
                    *change = side.sign * of[side.joint];
                }
            }
        }
        (self.trial.torques, self.trial.rates) = (torques, [jerk, torque]);
    }

    /// Change of the rows at the ends by a part of the step.
    fn change_at_ends(&mut self, part: usize) {
        let n = self.spline.dof;
        let rows = self.points.ends.g_x.chunks_exact(2 * n);
        let mut far = self.points.ends.far.chunks_exact(2 * n);
        let last = self.spline.end_unknowns(self.spline.mesh.phases()).start;
        for (at, row) in self.barrier.at_ends().zip(rows) {
            let first = self.spline.end_unknowns(self.barrier.end_of(at)).start;
            let steps = &self.steps[part];
            let change = match far.next() {
                Some(far) => dot(row, &steps[first..first + 2 * n]) + dot(far, &steps[last..last + 2 * n]),
                // Rows of one end depend on positions.
                None => dot(&row[..n], &steps[first..first + n]),
            };
            self.changes[part][at] = self.barrier.side(at).sign * change;
        }
    }

    /// Steps of slacks and multipliers for a barrier, and how far they may go.
    pub(crate) fn steps_of(&mut self, mu: f64) -> (f64, f64) {
        let Self { barrier, changes: [zero, of_mu, more, _], corrections, trial, .. } = self;
        trial.slack_step.resize(barrier.count(), 0.0);
        trial.multiplier_step.resize(barrier.count(), 0.0);
        let [slack, multiplier] = [&mut trial.slack_step, &mut trial.multiplier_step];
        let most = steps(barrier, mu, [zero, of_mu, more], &corrections[0], slack, multiplier);
        let [primal, dual] = most.map(|most| ((1.0 - constants::BOUNDARY) / most).min(1.0));
        (primal, dual)
    }

    /// Mehrotra's choice: from the complementarity that the step at mu = 0 would leave.
    pub(super) fn choose_barrier(&mut self, tolerance: f64) {
        let gap = self.figures.gap;
        if gap == 0.0 {
            self.mu = 0.0;
            return;
        }
        let active = self.barrier.total_weight();
        let now = gap / active;
        let (primal, dual) = self.steps_of(0.0);
        let Trial { slack_step, multiplier_step, .. } = &self.trial;
        let after = [(primal, &slack_step[..]), (dual, &multiplier_step[..])];
        let left = complementarity(&self.barrier, Some(after));
        self.mu = now;
        // A damped step is short, so what it would leave says nothing about the distance to a solution. But
        // where the motion is optimal for this barrier already, only a smaller one leads on.
        let part = if self.damping == 0.0 {
            (left / gap).clamp(0.0, 1.0)
        } else if self.decrement_without_equations().abs() < constants::CENTRED * gap {
            constants::CENTRED_PART
        } else {
            1.0
        };
        // No smaller than the tolerance needs, nor than the distance from stationary points allows.
        let floor = constants::LEAST_GAP * tolerance * self.figures.size / active;
        let centre = constants::CENTRING * self.decrement_without_equations().abs() / active;
        let most = constants::FIRST_GAP * self.figures.size / active;
        self.mu = (now * (part * part * part).max(constants::MOST_DECREASE))
            .max(floor)
            .max(centre.min(now * constants::MOST_INCREASE))
            .min(most);
    }

    /// -(g dx) for the step, without the squares of equations: where they are off these are large, and say
    /// nothing about limits.
    fn decrement_without_equations(&self) -> f64 {
        let squares = self.barrier.equations().map(|at| {
            let change = self.changes[0][at] + self.mu * self.changes[1][at];
            self.barrier.curvature(at) * self.barrier.distance[at] * change
        });
        self.decrement() + squares.sum::<f64>()
    }

    /// -(g dx) for the step.
    pub(super) fn decrement(&self) -> f64 {
        let mu = self.mu;
        let gradient = |i: usize| self.system.gradient[0][i] + mu * self.system.gradient[1][i];
        let step = |i: usize| self.steps[0][i] + mu * self.steps[1][i];
        let sum: f64 = (0..self.steps[0].len()).map(|i| gradient(i) * step(i)).sum();
        let shared = self.system.shared_gradient[0].iter().zip(&self.system.shared_gradient[1]);
        let steps = self.shared_steps[0].iter().zip(&self.shared_steps[1]);
        let shared = shared.zip(steps).map(|((g, of_mu), (y, y_mu))| (g + mu * of_mu) * (y + mu * y_mu));
        -(sum + shared.sum::<f64>() + self.relaxation.slope(mu, true))
    }
}
