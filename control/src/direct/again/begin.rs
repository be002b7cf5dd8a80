//! Where a solve begins: at the last iterate; after failures at the last motion that was solved, or at the
//! first guess.

use super::recovery::Recovery;
use super::resolve::Resolve;
use crate::constants::direct as constants;
use crate::direct::interior::figures::Figures;
use costate::EvalError;

impl Resolve {
    /// Begins anew: the next solve starts at the first guess, moved to the ends that are set now, as if
    /// nothing had been solved before. What was set stays, and so does the time by which the motion was
    /// [advanced](Self::advance) where a time is given.
    ///
    /// A motion is a local minimum, and the next one is near it. After a jump of the start a motion that is
    /// solved may cost more than the one that a new search finds.
    ///
    /// ```
    /// # use costate::robot::Robot;
    /// # use costate_control::{Problem, Resolve, SolverOptions};
    /// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    /// # let robot = Robot::from_file("robots/two_link.toml")?;
    /// let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.0, 0.5], 1.0);
    /// let mut motion = Resolve::new(&problem, SolverOptions::default())?;
    /// let first = motion.solve()?;
    /// motion.reset();
    /// assert_eq!(motion.solve()?.iterations, first.iterations);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn reset(&mut self) {
        self.recovery.put_guess(&mut self.interior, &self.states);
        (self.started, self.factorised) = (false, false);
        (self.recovery.is_solved, self.recovery.failures, self.recovery.unfinished) = (false, 0, false);
        self.recovery.late = 0.0;
        (self.damping, self.shown.spline.dof) = (0.0, 0);
    }

    /// Makes the iterate the one where the next solve begins. After a failure that is the last motion that
    /// was solved; after two the first guess, after three that motion again, and so on. Where none was solved
    /// it is the first guess, unless the solve that failed began there.
    pub(super) fn begin_solve(&mut self) -> Result<(), EvalError> {
        let Recovery { failures, is_solved, was_guess, .. } = self.recovery;
        self.recovery.was_guess = false;
        if failures > 0 && (if is_solved { failures % 2 == 0 } else { !was_guess }) {
            self.recovery.put_guess(&mut self.interior, &self.states);
            self.recovery.was_guess = true;
            self.damping = 0.0;
            return self.begin_anew();
        }
        if failures > 0 && is_solved {
            return self.begin_at_solved();
        }
        if !self.started {
            return self.begin_anew();
        }
        self.interior.follow(&self.states, self.factorised, &mut self.again)?;
        // A start that was wrong for one solve leaves an iterate that is far from all motions.
        let solved = &self.recovery.solved.figures;
        let is_far = merit(&self.interior.figures) > constants::FAR_FROM_SOLVED * merit(solved);
        if self.recovery.unfinished && self.recovery.is_solved && is_far {
            return self.begin_at_better();
        }
        Ok(())
    }

    fn begin_anew(&mut self) -> Result<(), EvalError> {
        self.interior.put_ends(&self.states);
        if self.recovery.has_room {
            return self.interior.begin(None);
        }
        self.interior.start(None)?;
        self.interior.reserve(&mut self.again);
        self.recovery.solved.take(&self.interior);
        self.recovery.other.take(&self.interior);
        self.recovery.has_room = true;
        Ok(())
    }

    /// Begins at the last motion that was solved, as it goes on now, along the optimal motions near it.
    fn begin_at_solved(&mut self) -> Result<(), EvalError> {
        let recovery = &mut self.recovery;
        recovery.other.spline.times.clone_from(&self.interior.spline.times);
        recovery.solved.put(&mut self.interior);
        if recovery.late > 0.0 {
            self.interior.shift(recovery.late, &mut self.again);
        }
        if self.interior.ends.times.is_given_after(0) {
            self.interior.spline.times.clone_from(&recovery.other.spline.times);
        }
        self.damping = 0.0;
        self.interior.evaluate()?;
        self.interior.measure_figures();
        let predict = self.interior.linearise()?;
        self.interior.follow(&self.states, predict, &mut self.again)
    }

    /// Begins at the last motion that was solved if that is better than the iterate for the new ends.
    fn begin_at_better(&mut self) -> Result<(), EvalError> {
        let damping = self.damping;
        self.recovery.other.take(&self.interior);
        let there = self.begin_at_solved();
        let other = &self.recovery.other;
        if there.is_ok() && merit(&self.interior.figures) < merit(&other.figures) {
            return Ok(());
        }
        other.put(&mut self.interior);
        self.damping = damping;
        self.interior.evaluate()?;
        self.interior.measure_figures();
        Ok(())
    }
}

/// What an iterate costs, more where it exceeds limits.
fn merit(figures: &Figures) -> f64 {
    let merit = figures.size * (1.0 + constants::PRICE_OF_VIOLATION * figures.violation);
    if merit.is_nan() { f64::INFINITY } else { merit }
}
