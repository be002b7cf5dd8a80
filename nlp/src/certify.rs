//! What a solver can say about its last solution: second-order conditions, digits, derivatives.

use crate::active::{Active, Certificate, Changes, Held};
use crate::iterate::KktError;
use crate::outcome::SolveError;
use crate::problem::StagedProblem;
use crate::scaled::Scaled;
use crate::scales::Scales;
use crate::solve::Solver;
use crate::vectors::{largest, worse};

/// Largest error of the conditions of first order that second-order ones are judged at.
const STATIONARY: f64 = 1e-4;

/// Most Newton steps of [`Solver::refine`].
const STEPS: usize = 10;

impl Solver {
    /// What the second-order conditions say about the last solution of this program.
    ///
    /// Convergence of an interior-point method with the right inertia certifies a minimum of the barrier
    /// problem alone. Here the ranges that are held with a multiplier are equations, and neither the barrier
    /// nor a regularisation counts. The program has the bounds and scales that it was solved with.
    ///
    /// # Errors
    /// [`SolveError`].
    pub fn certify<P: StagedProblem>(
        &mut self,
        problem: &mut P,
    ) -> Result<Certificate, SolveError<P::Error>> {
        let mut active = self.take_active(problem)?;
        let error = self.iterate.error(&self.residuals, 0.0);
        let certificate = match error.largest() <= STATIONARY {
            true => active.certify(&self.layout, &self.blocks),
            false => Certificate::NotStationary,
        };
        self.active = Some(active);
        Ok(certificate)
    }

    /// Which ranges the last solution holds, by [`certify`](Self::certify) or [`refine`](Self::refine); empty
    /// before.
    pub fn held(&self) -> &[Held] {
        self.active.as_ref().filter(|active| active.has_held).map_or(&[], |active| &active.held)
    }

    /// Newton steps on the set of ranges that the last solution holds: they lie on their bounds then, and the
    /// error of the conditions of optimality falls below `tolerance` or to rounding. Returns that error; the
    /// point is [`point`](Self::point).
    ///
    /// # Errors
    /// [`SolveError`].
    pub fn refine<P: StagedProblem>(
        &mut self,
        problem: &mut P,
        tolerance: f64,
    ) -> Result<KktError, SolveError<P::Error>> {
        let mut active = self.take_active(problem)?;
        let zeros = || Changes::zeros(&self.layout);
        let mut room = active.newton.take().unwrap_or_else(|| [zeros(), zeros()]);
        let outcome = self.with_scaled(problem, |solver, scaled| {
            solver.refine_with(scaled, (&mut active, &mut room), tolerance)
        });
        active.newton = Some(room);
        self.active = Some(active);
        outcome
    }

    /// The point of the last iterate or solution, refined if [`refine`](Self::refine) was called; in
    /// restoration that of its iterate.
    pub fn point(&self) -> &[f64] {
        match self.restoration.as_ref().filter(|restoration| restoration.is_on) {
            Some(restoration) => restoration.places.original_point(&restoration.solver.iterate.point),
            None => &self.iterate.point,
        }
    }

    /// The changes of the last solution at the rates of its equations:
    ///
    /// $$ K \begin{pmatrix} x' \\\\ y' \\\\ v' \end{pmatrix} = - \begin{pmatrix} \partial_p \nabla_z L \\\\
    /// \partial_p c \\\\ \partial_p (g - b) \end{pmatrix} $$
    ///
    /// for a parameter p of the program, with b the bounds that hold ranges. K is symmetric, so that the same
    /// solves for adjoints: with the gradient of a function of the solution in the place of the rates, the
    /// products of the changes with the rates of each parameter are its derivatives. `None` unless
    /// [`certify`](Self::certify) or [`refine`](Self::refine) has factored K at the last solution, which
    /// `certify` does where it is stationary; and for rates of other lengths.
    pub fn respond<P: StagedProblem>(&mut self, problem: &P, rates: &Changes) -> Option<Changes> {
        let lengths = |changes: &Changes| [&changes.x, &changes.equalities, &changes.ranges].map(Vec::len);
        let expected = [self.layout.steps(), self.layout.equalities(), self.layout.ranges()];
        let is_known = |active: &&mut Box<Active>| active.is_factored && lengths(rates) == expected;
        let active = self.active.as_mut().filter(is_known)?;
        let ones = || Scales::ones(&self.layout);
        let Scales { cost, steps, equalities, ranges, .. } = problem.scales().cloned().unwrap_or_else(ones);
        let (mut scaled, mut changes) = (rates.clone(), Changes::zeros(&self.layout));
        scaled.x.iter_mut().zip(&steps).for_each(|(rate, scale)| *rate *= scale / cost);
        scaled.equalities.iter_mut().zip(&equalities).for_each(|(rate, scale)| *rate /= scale);
        scaled.ranges.iter_mut().zip(&ranges).for_each(|(rate, scale)| *rate /= scale);
        active.respond(&self.layout, &scaled, &mut changes);
        changes.x.iter_mut().zip(&steps).for_each(|(change, scale)| *change *= scale);
        changes.equalities.iter_mut().zip(&equalities).for_each(|(change, scale)| *change *= cost / scale);
        changes.ranges.iter_mut().zip(&ranges).for_each(|(change, scale)| *change *= cost / scale);
        Some(changes)
    }

    /// Derivatives at the last solution, and which ranges it holds.
    fn take_active<P: StagedProblem>(
        &mut self,
        problem: &mut P,
    ) -> Result<Box<Active>, SolveError<P::Error>> {
        self.forget_active();
        self.next = None;
        self.check(problem)?;
        self.take_sizes(problem);
        self.with_scaled(problem, |solver, scaled| {
            scaled.evaluate(&solver.iterate.point, &mut solver.iterate.values)?;
            solver.linearise(scaled)
        })?;
        let mut active = self.active.take().unwrap_or_else(|| Box::new(Active::new(&self.layout)));
        active.hold(&self.iterate);
        Ok(active)
    }

    /// What is known of the last solution is of another one from here on.
    pub(crate) fn forget_active(&mut self) {
        if let Some(active) = &mut self.active {
            active.forget();
        }
    }

    fn refine_with<P: StagedProblem>(
        &mut self,
        scaled: &mut Scaled<'_, P>,
        (active, [rates, changes]): (&mut Active, &mut [Changes; 2]),
        tolerance: f64,
    ) -> Result<KktError, SolveError<P::Error>> {
        let (mut error, mut best) = (KktError::default(), KktError::default());
        for step in 0..=STEPS {
            // Ranges that are not held have no multiplier, others lie on their bounds.
            for (i, held) in active.held.iter().enumerate() {
                if matches!(held, Held::Free | Held::Weakly) {
                    self.iterate.v[i] = 0.0;
                }
            }
            self.linearise(scaled)?;
            let before = error.largest();
            rates.x.copy_from_slice(&self.residuals.x);
            rates.equalities.copy_from_slice(&self.residuals.equalities);
            for (i, held) in active.held.iter().enumerate() {
                rates.ranges[i] = match held {
                    Held::Free | Held::Weakly => 0.0,
                    Held::Lower => self.iterate.values.ranges[i] - scaled.bound(0, i),
                    Held::Upper => self.iterate.values.ranges[i] - scaled.bound(1, i),
                };
            }
            error = KktError {
                stationarity: largest(&rates.x),
                feasibility: worse(largest(&rates.equalities), largest(&rates.ranges)),
                complementarity: 0.0,
            };
            let is_better = error.largest() < before;
            if step > 0 && !is_better {
                // Back to the better one.
                std::mem::swap(&mut self.iterate.point, &mut self.trial.point);
                self.iterate.y.copy_from_slice(&self.trial.y);
                self.iterate.v.copy_from_slice(&self.trial.v);
                scaled.evaluate(&self.iterate.point, &mut self.iterate.values)?;
                self.linearise(scaled)?;
                error = best;
                break;
            }
            best = error;
            if error.largest() <= tolerance || step == STEPS {
                break;
            }
            active.factorise(&self.layout, &self.blocks, false);
            self.trial.y.copy_from_slice(&self.iterate.y);
            self.trial.v.copy_from_slice(&self.iterate.v);
            active.respond(&self.layout, rates, changes);
            scaled.retract(&self.iterate.point, &changes.x, 1.0, &mut self.trial.point);
            std::mem::swap(&mut self.iterate.point, &mut self.trial.point);
            self.iterate.y.iter_mut().zip(&changes.equalities).for_each(|(y, d)| *y += d);
            self.iterate.v.iter_mut().zip(&changes.ranges).for_each(|(v, d)| *v += d);
            scaled.evaluate(&self.iterate.point, &mut self.iterate.values)?;
        }
        active.factorise(&self.layout, &self.blocks, false);
        Ok(error)
    }
}
