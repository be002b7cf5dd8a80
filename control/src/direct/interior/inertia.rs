//! Whether a stationary motion is a minimum or a saddle, and the way down from a saddle.

use super::iterate::Interior;
use crate::constants::{direct as constants, saddle};
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::PointDynamics;
use costate::EvalError;

/// The signs of the eigenvalues of the exact Hessian of cost and barrier along all changes that keep the
/// equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Inertia {
    Positive,
    /// One of them at least is negative, with every stiffness of the equations that was tried.
    Negative,
    /// The smallest one is about zero.
    Unknown,
}

impl<D: PointDynamics> Interior<D> {
    /// Those at a motion that is solved. Squares of the equations are in the matrix, as stiff as it takes:
    /// the Hessian is positive along what keeps the equations where the matrix is so for some stiffness
    /// (G. Debreu, Definite and semidefinite quadratic forms, Econometrica 20, 1952). Rounding grows with the
    /// stiffness and may be larger than all else, so softer squares are tried too. Squares of active limits
    /// are in it as stiff as the barrier makes them, and rounded likewise. With softer ones the matrix is
    /// smaller along all changes, so it is enough that this one is positive.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn inertia(&mut self) -> Result<Inertia, EvalError> {
        if self.figures.is_minimum {
            return Ok(Inertia::Positive);
        }
        self.refresh()?;
        self.system.exact = true;
        let mut found = self.inertia_with(constants::ROUNDED_INERTIA);
        if found != Inertia::Positive && self.barrier.total_weight() > 0.0 {
            let slacks = self.barrier.slack.clone();
            for softness in saddle::SOFTNESSES {
                self.barrier.soften(softness * self.figures.size);
                if self.inertia_with(0.0) == Inertia::Positive {
                    found = Inertia::Positive;
                    break;
                }
            }
            self.barrier.slack = slacks;
            self.inertia_with(0.0);
        }
        Ok(found)
    }

    /// The same from the matrix with these slacks, which stays assembled; negative eigenvalues are those that
    /// this damping leaves negative.
    fn inertia_with(&mut self, rounded: f64) -> Inertia {
        let stiffness = self.barrier.stiffness;
        let has_equations = self.barrier.equations().next().is_some();
        let mut found = Inertia::Negative;
        for factor in if has_equations { &constants::STIFFNESSES[..] } else { &constants::STIFFNESSES[..1] } {
            self.barrier.stiffness = factor * stiffness;
            self.assemble();
            if self.factorise(0.0) {
                found = Inertia::Positive;
                break;
            }
            if rounded > 0.0 && self.factorise(rounded) {
                found = Inertia::Unknown;
            }
        }
        self.barrier.stiffness = stiffness;
        found
    }

    /// A motion near a saddle that costs less, with the limits as their multipliers price them: along a
    /// direction in which the matrix of [`inertia`](Self::inertia) is negative; and by about how much. Limits
    /// are exceeded there by the part `off` of their ranges at most. The iterate stays; `None` where no such
    /// motion was found.
    pub fn below_saddle(&mut self, off: f64) -> Option<(Spline, f64)> {
        self.find_negative_direction()?;
        let n = self.spline.dof;
        let (mut moved, mut extent) = (0.0_f64, constants::SMALL_MOTION);
        for i in 0..n {
            let values = || (0..self.points.count()).map(|p| self.points.z(p)[i]);
            let [low, high] =
                [values().fold(f64::INFINITY, f64::min), values().fold(-f64::INFINITY, f64::max)];
            extent = extent.max(high - low);
        }
        for p in 0..self.points.count() {
            self.change_of_z(p, 0);
            moved = self.trial.dz[..n].iter().fold(moved, |most, dq| most.max(dq.abs()));
        }
        let first = saddle::FIRST_PART * extent / moved;
        let now = self.lagrangian(self.figures.cost, &self.barrier.distance);
        let rounding = constants::ROUNDING * self.figures.size;
        let mut part = if first.is_finite() { first } else { return None };
        let mut best: Option<(f64, Spline)> = None;
        for _ in 0..saddle::TRIALS {
            let least = best.as_ref().map_or(now - rounding, |(value, _)| *value);
            let mut closer = None;
            for sign in [1.0, -1.0] {
                let least = closer.as_ref().map_or(least, |(value, _)| *value);
                if let Some(value) = self.value_along(sign * part, off).filter(|value| *value < least) {
                    closer = Some((value, self.trial.spline.clone()));
                }
            }
            if closer.is_none() && best.is_some() {
                break;
            }
            best = closer.or(best);
            part *= 0.5;
        }
        best.map(|(value, spline)| (spline, now - value))
    }

    /// A direction of negative curvature as the first part of the step, by inverse iteration with the matrix
    /// and just so much of the metric of damping that it is positive definite; `None` where it is so without.
    fn find_negative_direction(&mut self) -> Option<()> {
        let (mut low, mut high) = (constants::ROUNDED_INERTIA, constants::ROUNDED_INERTIA);
        while !self.factorise(high) {
            (low, high) = (high, high * constants::DAMPING_UP);
            if high > constants::MOST_DAMPING {
                return None;
            }
        }
        if low == high {
            return None;
        }
        for _ in 0..saddle::BISECTIONS {
            let middle = (low * high).sqrt();
            (low, high) = if self.factorise(middle) { (low, middle) } else { (middle, high) };
        }
        if !self.factorise(high) {
            return None;
        }
        // No symmetry of a problem has this start.
        let places = |count: usize| (0..count).map(|i| (1.0 + i as f64).sqrt().sin());
        let mut unknowns: Vec<f64> = places(self.spline.unknowns.len()).collect();
        let by_times: Vec<f64> = places(self.spline.times.len()).collect();
        let mut shared = vec![0.0; self.ends.shared()];
        self.ends.reduce(&self.spline.mesh, &mut unknowns, &by_times, &mut shared);
        for _ in 0..saddle::INVERSE_ITERATIONS {
            self.system.finish_solution(&mut unknowns, &mut shared);
            let size = unknowns.iter().chain(&shared).fold(0.0_f64, |most, x| most.max(x.abs()));
            if !(size > 0.0 && size.is_finite()) {
                return None;
            }
            unknowns.iter_mut().chain(&mut shared).for_each(|x| *x /= size);
        }
        (self.steps[0], self.shared_steps[0]) = (unknowns, shared);
        self.finish_part(0);
        Some(())
    }

    /// The Lagrange function of the motion that is so far along the first part of the step, which the trial
    /// has then; `None` where it cannot be evaluated, or exceeds limits by more than a small part of their
    /// ranges.
    fn value_along(&mut self, part: f64, off: f64) -> Option<f64> {
        let trial = &mut self.trial;
        trial.spline.copy_from(&self.spline);
        let steps =
            [(&mut trial.spline.unknowns, &self.steps[0]), (&mut trial.spline.times, &self.time_steps[0])];
        for (values, steps) in steps {
            values.iter_mut().zip(steps).for_each(|(value, step)| *value += part * step);
        }
        if !trial.spline.times.iter().all(|time| *time > 0.0) {
            return None;
        }
        self.model.resize_values(&trial.spline, &mut trial.points);
        self.model.evaluate(&trial.spline, &mut trial.points).ok()?;
        trial.distance.resize(self.barrier.count(), 0.0);
        self.barrier.measure(&trial.spline, &trial.points, &mut trial.distance);
        let is_near = (0..self.barrier.count()).filter(|&at| self.barrier.is_on(at)).all(|at| {
            let distance = trial.distance[at];
            let own = if self.barrier.is_limit(at) { -distance } else { distance.abs() };
            self.barrier.unit[at] * own <= off
        });
        let cost = is_near.then(|| self.running.cost(&self.trial.spline, &self.trial.points))?;
        let value = self.lagrangian(cost, &self.trial.distance);
        value.is_finite().then_some(value)
    }

    /// The cost less all distances times their multipliers.
    fn lagrangian(&self, cost: f64, distance: &[f64]) -> f64 {
        let on = (0..self.barrier.count()).filter(|&at| self.barrier.is_on(at));
        cost - on.map(|at| self.barrier.multiplier[at] * distance[at]).sum::<f64>()
    }
}
