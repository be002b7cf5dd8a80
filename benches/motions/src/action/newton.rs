//! Newton's method on the action of an extremal.
//!
//! An extremal without active bounds, between fixed ends at rest, in a fixed time, makes stationary
//!
//! S = integral of L_q.y + L_v.y' + y.D + sum b^2 y^2 / (2 r),   y the costate y_p of the momenta
//!
//! With q and y polynomials of degree 3 on each interval and Lobatto's four points, the equations are the
//! derivatives of one number: their matrix is symmetric, and consists of kernels one and two.

use super::fronts::{Front, Given, Rest};
use super::interval::{Interval, Work};
use super::points::{Points, Values, WEIGHTS};
use crate::numerics::WrongSign;
use costate::EvalError;
use costate::robot::Tree;
use costate_control::Problem;

/// The unknowns of all points, three for each interval and the last one, n each.
#[derive(Clone)]
pub struct Unknowns {
    pub q: Vec<f64>,
    pub y: Vec<f64>,
}

/// The equations on one mesh.
pub struct Action {
    n: usize,
    /// Lengths of intervals (s).
    h: Vec<f64>,
    /// b^2 / r of each control.
    price: Vec<f64>,
    points: Points,
    intervals: Vec<Interval>,
    fronts: Vec<Front>,
    rest: Rest,
    work: Work,
    pub at: Unknowns,
    gradient: Unknowns,
    pub step: Unknowns,
}

/// What a step may end with.
#[derive(Debug)]
pub enum Stopped {
    Dynamics(EvalError),
    /// The motion is no local minimum on its mesh.
    NotMinimal,
}

impl Action {
    pub fn new(problem: &Problem, h: Vec<f64>, at: Unknowns) -> Self {
        let n = problem.robot.dof();
        let zeros = Unknowns { q: vec![0.0; at.q.len()], y: vec![0.0; at.y.len()] };
        let price = problem.gain.iter().zip(&problem.cost.effort).map(|(b, r)| b * b / r);
        Self {
            n,
            price: price.collect(),
            points: Points::new(Tree::from(&problem.robot)),
            intervals: vec![Interval::new(n); h.len()],
            fronts: vec![Front::new(n); h.len() + 1],
            rest: Rest::new(n),
            work: Work::new(n),
            h,
            at,
            gradient: zeros.clone(),
            step: zeros,
        }
    }

    /// Gradient of the whole action, without second derivatives.
    pub fn evaluate(&mut self) -> Result<(), EvalError> {
        self.clear_gradient();
        (0..self.h.len()).try_for_each(|k| self.evaluate_interval(k, false))
    }

    fn clear_gradient(&mut self) {
        self.gradient.q.fill(0.0);
        self.gradient.y.fill(0.0);
    }

    fn evaluate_interval(&mut self, k: usize, second: bool) -> Result<(), EvalError> {
        let (n, h) = (self.n, self.h[k]);
        let range = 3 * k * n..(3 * k + 4) * n;
        let values = Values { h, q: &self.at.q[range.clone()], y: &self.at.y[range.clone()] };
        let Unknowns { q, y } = &mut self.gradient;
        for (i, (g, y)) in y[range.clone()].iter_mut().zip(values.y).enumerate() {
            *g += h * WEIGHTS[i / n] * self.price[i % n] * y;
        }
        self.points.evaluate(values, [&mut q[range.clone()], &mut y[range]], second)
    }

    /// Gradient, and the factors of minus the second derivatives.
    pub fn linearise(&mut self) -> Result<(), Stopped> {
        let not_minimal = |WrongSign| Stopped::NotMinimal;
        self.clear_gradient();
        self.rest.clear();
        for k in 0..self.fronts.len() {
            self.fronts[k].take(&mut self.rest, k == 0);
            if k < self.h.len() {
                self.evaluate_interval(k, true).map_err(Stopped::Dynamics)?;
                let blocks = &self.points.blocks;
                let interval = &mut self.intervals[k];
                interval.condense(self.h[k], &self.price, blocks, &mut self.work).map_err(not_minimal)?;
                self.fronts[k].add(&self.work.nodes, &mut self.rest);
            }
            if k == 0 {
                self.fronts[k].give(&mut self.rest, Given::Left);
            }
            if k + 1 == self.h.len() {
                self.fronts[k].give(&mut self.rest, Given::Right);
            }
            self.fronts[k].eliminate(&mut self.rest).map_err(not_minimal)?;
        }
        Ok(())
    }

    /// The correction for the gradient of the last evaluation.
    pub fn correct(&mut self) {
        let (n, last) = (self.n, self.h.len());
        self.step.clone_from(&self.gradient);
        self.keep_ends();
        for k in 0..=last {
            if k < last {
                let (inner, part) = (3 * k * n + n..3 * (k + 1) * n, &mut self.work.part);
                let Unknowns { q, y } = &mut self.step;
                self.intervals[k].reduce(&mut q[inner.clone()], &mut y[inner], part);
                for a in 0..n {
                    for (s, at) in [3 * k * n + a, 3 * (k + 1) * n + a].into_iter().enumerate() {
                        q[at] += part[(2 + s) * n + a];
                        y[at] += part[(4 + s) * n + a];
                    }
                }
                self.keep_ends();
            }
            self.gather(k);
            self.fronts[k].forward(&mut self.work.part[..5 * n]);
            self.scatter(k);
        }
        for k in (0..=last).rev() {
            self.gather(k);
            self.fronts[k].backward(&mut self.work.part[..5 * n]);
            self.scatter(k);
        }
        for k in 0..last {
            let (left, right) = (3 * k * n, 3 * (k + 1) * n);
            let (Unknowns { q, y }, part) = (&mut self.step, &mut self.work.part);
            for (to, from) in [(2, &q[left..]), (3, &q[right..]), (4, &y[left..]), (5, &y[right..])] {
                part[to * n..][..n].copy_from_slice(&from[..n]);
            }
            let inner = left + n..right;
            self.intervals[k].expand(&mut q[inner.clone()], &mut y[inner], part);
        }
    }

    /// Positions at the ends do not change.
    fn keep_ends(&mut self) {
        let (n, last) = (self.n, self.step.q.len() - self.n);
        self.step.q[..n].fill(0.0);
        self.step.q[last..].fill(0.0);
    }

    /// The unknowns of a front, each with its place: y_k, q_k-1, y_k+1, q_k, q_k+1.
    fn places(&self, k: usize) -> [(bool, Option<usize>); 5] {
        let node = |k: usize| (k <= self.h.len()).then_some(3 * k * self.n);
        let before = k.checked_sub(1).map(|k| 3 * k * self.n);
        [(false, node(k)), (true, before), (false, node(k + 1)), (true, node(k)), (true, node(k + 1))]
    }

    fn gather(&mut self, k: usize) {
        let (n, places) = (self.n, self.places(k));
        let parts = self.work.part.chunks_exact_mut(n);
        for (to, (is_q, at)) in parts.zip(places) {
            let from = if is_q { &self.step.q } else { &self.step.y };
            match at {
                Some(at) => to.copy_from_slice(&from[at..at + n]),
                None => to.fill(0.0),
            }
        }
    }

    fn scatter(&mut self, k: usize) {
        let n = self.n;
        for (i, (is_q, at)) in self.places(k).into_iter().enumerate() {
            let to = if is_q { &mut self.step.q } else { &mut self.step.y };
            if let Some(at) = at {
                to[at..at + n].copy_from_slice(&self.work.part[i * n..][..n]);
            }
        }
    }

    /// Takes the step; its size, relative to the largest q and y.
    pub fn take(&mut self) -> f64 {
        let pairs = [(&mut self.at.q, &self.step.q), (&mut self.at.y, &self.step.y)];
        let most = |x: &[f64]| x.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        let size = |(x, step): (&mut Vec<f64>, &Vec<f64>)| {
            x.iter_mut().zip(step).for_each(|(x, step)| *x += step);
            most(step) / most(x)
        };
        pairs.map(size).into_iter().fold(0.0, f64::max)
    }

    /// The cost of the controls, by the quadrature of the action.
    pub fn cost(&self) -> f64 {
        let n = self.n;
        let of = |k: usize, i: usize| {
            let y = &self.at.y[(3 * k + i) * n..][..n];
            let squares: f64 = y.iter().zip(&self.price).map(|(y, price)| 0.5 * price * y * y).sum();
            self.h[k] * WEIGHTS[i] * squares
        };
        (0..self.h.len()).map(|k| (0..4).map(|i| of(k, i)).sum::<f64>()).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::{Action, Unknowns};
    use crate::problems::ROOT;
    use costate::robot::Robot;
    use costate_control::Problem;

    /// A robot with gravity and friction; q and y are waves.
    fn waves(intervals: usize) -> Action {
        let robot = Robot::from_file(format!("{ROOT}/robots/puma560_corke.toml")).unwrap();
        let n = robot.dof();
        let problem = Problem::rest_to_rest(robot, &vec![0.0; n], &vec![0.5; n], 1.0);
        let wave = |size: f64| (0..n * (3 * intervals + 1)).map(|i| size * (0.13 * i as f64).sin()).collect();
        let at = Unknowns { q: wave(1.0), y: wave(1e-4) };
        Action::new(&problem, vec![1.0 / intervals as f64; intervals], at)
    }

    /// G(x + e d) = (1 - e) G(x) + O(e^2) for d = -H^-1 G: ten times smaller steps, a hundred times less.
    #[test]
    fn a_step_solves_the_linearised_equations() {
        let off = |change: f64| {
            let mut action = waves(5);
            action.linearise().unwrap();
            action.correct();
            let before = action.gradient.clone();
            action.step.q.iter_mut().chain(&mut action.step.y).for_each(|step| *step *= change);
            action.take();
            action.evaluate().unwrap();
            let inside = action.n..action.at.q.len() - action.n;
            let of_q = before.q[inside.clone()].iter().zip(&action.gradient.q[inside]);
            let pairs = of_q.chain(before.y.iter().zip(&action.gradient.y));
            pairs.fold(0.0_f64, |most, (before, after)| most.max((after - (1.0 - change) * before).abs()))
        };
        let [large, small] = [1e-5, 1e-6].map(off);
        assert!((0.005..0.02).contains(&(small / large)), "{large} {small}");
    }

    /// y beyond what a minimum can have: some pivot has the wrong sign.
    #[test]
    fn no_minimum_is_found_where_there_is_none() {
        let mut action = waves(5);
        action.at.y.iter_mut().for_each(|y| *y *= 1e7);
        assert!(action.linearise().is_err());
    }
}
