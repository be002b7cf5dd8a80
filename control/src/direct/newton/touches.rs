//! Limits that a motion touches for an instant, in Newton's equations.
//!
//! Where the distance $d(t) \ge 0$ of a limit of positions is zero at one time $t_c$ alone its multiplier is
//! an impulse M there: the Lagrangian has the term $-M \min_t d$. The instant moves with the motion,
//!
//! $$ \min_t (d + \epsilon\, \delta d) = d(t_c) + \epsilon\, \delta d(t_c) -
//!    \frac{\epsilon^2}{2} \frac{\delta\dot d(t_c)^2}{\ddot d(t_c)} + O(\epsilon^3) $$
//!
//! so the second derivative by $\delta\dot d$ is $M / \ddot d$. The points of a mesh are at given times: it
//! is missing where the limit is active at one point, and infinite where it is at two.

use super::system::{Place, System};
use crate::direct::motion::spline::Spline;

impl System {
    /// Adds the touches of an interval.
    pub(super) fn add_touches(&mut self, k: usize, spline: &Spline) {
        let touches = std::mem::take(&mut self.touches);
        let mut z = std::mem::take(&mut self.of_place);
        for touch in touches.iter().filter(|touch| touch.k == k) {
            let s = spline.mesh.nodes[k] + touch.x * spline.mesh.width(k);
            spline.in_interval(k, touch.x, &mut z);
            self.work.collect_squares(&touch.rows, touch.curvatures);
            let factors = spline.factors_at(k, touch.x);
            self.add_gradients(&Place { k, s, z: &z, has_clock: false }, spline, &factors, 0.0);
            self.interval.take(0, spline.dof, factors, &self.work.hessian);
            self.interval.add_to(&mut self.matrix, k, spline.dof, 1);
        }
        (self.touches, self.of_place) = (touches, z);
    }
}
