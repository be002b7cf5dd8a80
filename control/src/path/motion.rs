//! A path as a motion of its own: what is left when no extremal is found near it.

use super::costates::Path;
use super::objective::GAUSS;
use crate::constants::arcs::BEYOND;
use crate::extremal::penalty::Penalties;
use crate::extremal::user_terms::UserTerms;
use crate::problem::Problem;
use costate::EvalError;

/// A path with the controls that follow it.
#[derive(Clone, Debug)]
pub(crate) struct PathMotion {
    /// Times (s), rising.
    pub times: Vec<f64>,
    /// Rows of q, v, p, u, y_q and y_p.
    pub rows: [Vec<Vec<f64>>; 6],
    /// Without penalties.
    pub cost: f64,
    pub penalty_cost: f64,
}

impl PathMotion {
    /// Cost and penalties.
    pub fn total(&self) -> f64 {
        self.cost + self.penalty_cost
    }
}

impl Path {
    /// The motion along the path, with the costs of the problem itself: no smoothing, and nothing in place of
    /// bounds. `None` where the controls exceed the bounds at one of its points, which are the knots of the
    /// spline and the points of the quadrature.
    ///
    /// # Errors
    /// Any error from evaluating the dynamics.
    pub(crate) fn motion(&mut self, problem: &Problem) -> Result<Option<PathMotion>, EvalError> {
        let (n, intervals, time) = (problem.robot.dof(), self.objective.basis.intervals, self.time());
        let penalties = Penalties::new(n, problem.penalty.as_ref());
        let terms = UserTerms::<f64>::new(n, &problem.terms);
        let (mut cost, mut penalty_cost) = (problem.cost.time * time, 0.0);
        let (mut times, mut rows): (Vec<f64>, [Vec<Vec<f64>>; 6]) = Default::default();
        let (mut z, mut u) = (vec![0.0; 4 * n], vec![0.0; n]);
        let knot = [(0.0, 0.0)];
        for interval in 0..intervals {
            let last = if interval + 1 == intervals { &[(1.0, 0.0)][..] } else { &[] };
            for &(at, weight) in knot.iter().chain(&GAUSS).chain(last) {
                let s = (interval as f64 + at) / intervals as f64;
                // The spline has continuous accelerations, so a knot has one control.
                self.sample(s, &mut z)?;
                self.set_point(interval, s)?;
                u.iter_mut().zip(&self.force).zip(&problem.gain).for_each(|((u, tau), gain)| *u = tau / gain);
                let within = u.iter().zip(&self.objective.controls);
                if within.clone().any(|(&u, control)| control.bounds.factor(u) > 1.0 + BEYOND) {
                    return Ok(None);
                }
                let (q, v, _) = self.objective.state();
                let weight = weight * time / intervals as f64;
                let efforts = u.iter().zip(&problem.cost.effort).map(|(u, r)| 0.5 * r * u * u);
                cost += weight * (efforts.sum::<f64>() + terms.at(q, v));
                let beyond = |i: usize| penalties.position(i, q[i]).value + penalties.rate(i, v[i]).value;
                penalty_cost += weight * (0..n).map(beyond).sum::<f64>();
                times.push(s * time);
                let row = [q, v, &z[n..2 * n], &u, &z[2 * n..3 * n], &z[3 * n..]];
                rows.iter_mut().zip(row).for_each(|(rows, row)| rows.push(row.to_vec()));
            }
        }
        Ok(Some(PathMotion { times, rows, cost, penalty_cost }))
    }
}
