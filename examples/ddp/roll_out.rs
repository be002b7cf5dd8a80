//! Roll-outs: a trajectory from controls or policies.

use super::problem::{Failure, Problem};
use super::sweep::Policy;
use super::trajectory::Trajectory;
use costate::dynamics::Cost;
use costate::step::Step;

/// The policies of all stages and the step length.
#[derive(Clone, Copy)]
pub struct Following<'a> {
    pub policies: &'a [Policy],
    pub alpha: f64,
}

impl<P: Step<f64>, L: Cost<f64>, T: Cost<f64>> Problem<P, L, T> {
    /// Rolls out `old` into `new` with the policies, if given, projected to the box.
    ///
    /// # Errors
    /// A stage that could not be evaluated, or whose cost is not finite. `new` is invalid then.
    pub fn roll_out(
        &mut self,
        old: &Trajectory,
        follow: Option<Following<'_>>,
        new: &mut Trajectory,
    ) -> Result<(), Failure> {
        let stages = old.u.len();
        (new.cost, new.terms) = (0.0, 0.0);
        new.x[0].copy_from(&old.x[0]);
        for k in 0..stages {
            let u = &mut new.u[k];
            u.copy_from(&old.u[k]);
            if let Some(Following { policies, alpha }) = follow {
                u.axpy(alpha, &policies[k].d, 1.0);
                u.gemv(1.0, &policies[k].gain, &(&new.x[k] - &old.x[k]), 1.0);
            }
            (0..u.len()).for_each(|i| u[i] = u[i].clamp(self.lower[i], self.upper[i]));
            let (x, u) = (new.x[k].as_slice(), new.u[k].as_slice());
            let cost = self.running.evaluate(x, u).map_err(|source| Failure::at(k, source))?;
            let next = self.step.evaluate(x, u, self.h).map_err(|source| Failure::at(k, source))?;
            self.count.advances += 1;
            new.x[k + 1].copy_from_slice(next);
            new.add_cost(self.h * cost);
            if !new.cost.is_finite() {
                return Err(Failure::NotFinite { stage: k });
            }
        }
        let end = self.terminal.evaluate(new.x[stages].as_slice(), &[]);
        new.add_cost(end.map_err(|source| Failure::at(stages, source))?);
        if new.cost.is_finite() { Ok(()) } else { Err(Failure::NotFinite { stage: stages }) }
    }
}
