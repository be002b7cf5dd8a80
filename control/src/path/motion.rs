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

#[cfg(test)]
mod tests {
    use crate::constants::attempts::PathAttempt;
    use crate::path::cubics::Disturbance;
    use crate::path::lowest_path;
    use crate::solve::Recorder;
    use crate::{Bounds, Penalty, Problem};
    use costate::robot::Robot;
    use std::f64::consts::FRAC_PI_2;

    fn motion(problem: &Problem) -> Option<super::PathMotion> {
        let attempt = PathAttempt { smoothing: 0.0, penalty: 0.01, halvings: 1 };
        let mut path =
            lowest_path(problem, &Disturbance::default(), attempt, &mut Recorder::default()).unwrap();
        path.motion(problem).unwrap()
    }

    #[test]
    fn costs_are_those_of_the_problem_and_bounds_are_kept() {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[FRAC_PI_2; 2], 1.0);
        let free = motion(&problem).unwrap();
        let best = 145.13113754;
        assert!(free.cost > best && free.cost < 1.0005 * best && free.penalty_cost == 0.0, "{}", free.cost);
        // The penalty of the problem, not the weaker one of the path.
        let limited = problem.clone().with_penalty(Penalty::new(1.0).with_v_max(vec![2.0; 2]));
        let limited = motion(&limited).unwrap();
        assert!(limited.penalty_cost > 1.0 && limited.cost >= free.cost, "{limited:?}");
        let most = free.rows[3].iter().flatten().fold(0.0_f64, |most, u| most.max(u.abs()));
        let bounded = |part: f64| problem.clone().with_bounds(Bounds::symmetric(vec![part * most; 2]));
        assert!(motion(&bounded(1.1)).is_some() && motion(&bounded(0.5)).is_none());
    }
}
