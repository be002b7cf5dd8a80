//! The gains of jerks: each interval is the start of the rest of the motion.
//!
//! What corrects an acceleration that is off may be over long before the motion is. The derivatives X by the
//! start of a phase have forgotten it then, and X^-1 is lost in rounding. So the unknowns of each node are
//! given in turn, and what follows is factorised: the columns of X and of the jerks at the points of the next
//! interval are those by its left node. Times are given.

use super::feedback::Feedback;
use crate::direct::interior::iterate::Interior;
use crate::direct::motion::shape::POINTS;
use crate::direct::points::values::PointDynamics;

impl<D: PointDynamics> Interior<D> {
    /// States and jerks at Gauss's points of a phase, each by the unknowns at the left node of its interval,
    /// from assembled equations whose times are all given. Whether all of them are positive definite.
    pub(super) fn take_rests(&mut self, phase: usize, feedback: &mut Feedback) -> bool {
        let (n, m, mesh) = (self.spline.dof, self.spline.node(), self.spline.mesh.clone());
        let (nodes, inner) = (m * mesh.nodes.len(), n * mesh.shape.inner());
        let Feedback { rest: Some(rest), tail, own_states, own_controls, .. } = feedback else {
            return false;
        };
        for k in mesh.ends()[phase]..mesh.ends()[phase + 1] {
            if self.system.factorise_behind(k, rest).is_err() {
                return false;
            }
            for j in 0..m {
                let dx = &mut self.steps[0];
                dx.clear();
                dx.resize(self.spline.unknowns.len(), 0.0);
                match mesh.end_at(k) {
                    // Its columns are removed.
                    Some(end) => self.system.at_ends.add_column(end, j, -1.0, dx),
                    None => self.system.add_node_column(k, j, -1.0, dx),
                }
                self.ends.removed(&mesh).for_each(|(node, i)| dx[m * node + i] = 0.0);
                dx[m * k..m * (k + 1)].fill(0.0);
                tail.clear();
                tail.extend_from_slice(&dx[m * k..nodes]);
                tail.extend_from_slice(&dx[nodes + inner * k..]);
                rest.solve(tail);
                dx[m * k..nodes].copy_from_slice(&tail[..nodes - m * k]);
                dx[nodes + inner * k..].copy_from_slice(&tail[nodes - m * k..]);
                dx[m * k + j] = 1.0;
                for p in POINTS * k..POINTS * (k + 1) {
                    self.change_at_gauss_point(p);
                    let states = own_states[m * m * p..][..m * m].chunks_exact_mut(m);
                    states.zip(&self.trial.dz).for_each(|(row, dx)| row[j] = *dx);
                    let jerks = own_controls[n * m * p..][..n * m].chunks_exact_mut(m);
                    jerks.zip(&self.trial.rates[0]).for_each(|(row, jerk)| row[j] = *jerk);
                }
            }
        }
        true
    }

    /// Changes of z and of the jerk at one of Gauss's points by the first part of the step at constant times,
    /// to the trial.
    fn change_at_gauss_point(&mut self, p: usize) {
        let (n, k) = (self.spline.dof, p / POINTS);
        let (rate, basis) = (1.0 / self.spline.clock(k), self.spline.gauss_basis(k, p % POINTS));
        let (inner, ends) = self.spline.of_interval(&self.steps[0], k);
        let [jerks, _] = &mut self.trial.rates;
        jerks.resize(n, 0.0);
        let mut scale = 1.0;
        let width = self.spline.mesh.shape.coefficients();
        for (order, row) in basis.rows.iter().enumerate() {
            let to = if order < 3 { &mut self.trial.dz[n * order..n * (order + 1)] } else { &mut jerks[..] };
            to.fill(0.0);
            for (factor, step) in row[..width].iter().zip(inner.chunks_exact(n).chain(ends.chunks_exact(n))) {
                to.iter_mut().zip(step).for_each(|(to, step)| *to += scale * factor * step);
            }
            scale *= rate;
        }
    }
}
