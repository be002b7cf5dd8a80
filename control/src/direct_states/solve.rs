//! From a problem to a motion.

#[cfg(doc)]
use super::independent::StateVerification;
use super::interior::Interior;
use super::points::Layout;
use super::problem::{DirectDynamics, DirectDynamicsError};
use super::solution::StateMotion;
use crate::bvp::collocation::error::defined;
use crate::constants::{direct as shared, states as constants};
use crate::options::SolverOptions;
use crate::result::motion::Certificate;
use crate::solve::Recorder;
use crate::solve::recorder::Stop;
use crate::status::Status;
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};

impl<D: Dynamics<f64>, C: Cost<f64>> DirectDynamics<D, C> {
    /// Solves the problem from a straight line between its ends, or from the guess that was given.
    ///
    /// Of the options `tolerance`, `max_nodes`, `max_iterations` and `time_limit` are used. Errors of the
    /// cost are relative to |J|, but to no less than 1e-4 of its size along the guess: what c_t, l and
    /// controls of size 1 (or half of their range, where that is less) cost there. A motion is
    /// [`Converged`](Status::Converged) where all of these hold:
    ///
    /// - the conditions of first order hold on the mesh to a twentieth of the tolerance, or, where rounding
    ///   hides progress, to five times the tolerance: [`StateMotion::residual`];
    /// - the logarithms of the barrier cost less than a twentieth of the tolerance;
    /// - on a mesh of twice the widths the cost differs by less than the tolerance;
    /// - errors of x, estimated between the points, are less than 0.3 times the root of the tolerance,
    ///   relative to the largest values along the motion: the cost is stationary. So is what the end is
    ///   missed by when u is integrated independently, or else the sum of what 20 parts of the motion miss,
    ///   each integrated from its own start: errors of unstable motions grow exponentially;
    /// - limits of x are exceeded halfway between the points, and at random times, by less than 1e-4 of the
    ///   largest value;
    /// - the cost by adaptive quadrature differs by less than the tolerance, and the gap of the maximum
    ///   principle, with the costates integrated along the motion, is less than eight times the tolerance:
    ///   [`StateVerification`].
    ///
    /// With any other status the motion is the last iterate; [`StateMotion::defect`] and
    /// [`StateMotion::end_missed`] tell what it does not meet.
    ///
    /// # Errors
    /// Options that are out of range.
    pub fn solve(&mut self, options: &SolverOptions) -> Result<StateMotion, DirectDynamicsError> {
        let mut recorder = Recorder::new(None, Stop::new(None, options.time_limit));
        self.solve_recorded(options, &mut recorder)
    }

    /// The same, its steps in a log, until the search is stopped.
    ///
    /// # Errors
    /// As [`solve`](Self::solve).
    pub(crate) fn solve_recorded(
        &mut self,
        options: &SolverOptions,
        recorder: &mut Recorder<'_>,
    ) -> Result<StateMotion, DirectDynamicsError> {
        options.check()?;
        let intervals = constants::INTERVALS.min(options.max_nodes - 1);
        let layout = Layout { n: self.model.states(), m: self.model.controls(), intervals };
        let guess = self.unknowns(&layout);
        self.reference = 1.0;
        self.reference = self.size_of_cost(&layout, &guess);
        let widths = vec![1.0 / intervals as f64; intervals];
        let mut mesh = Interior::new(self, widths, guess, false);
        let mut motion = StateMotion::new();
        motion.status =
            self.refine(&mut mesh, &mut motion, options, recorder).err().unwrap_or(Status::Converged);
        if motion.status.is_converged() {
            self.look_and_divide(&mut mesh, &mut motion, options, recorder);
        }
        motion.end_error = self.verify(&mesh, accuracy(options), recorder);
        // Not true for NaN.
        let is_verified = motion.end_error <= accuracy(options) && motion.verified.passes(options.tolerance);
        if motion.status.is_converged() && !is_verified {
            motion.status = recorder.interruption().map_or(Status::NotVerified, Status::from);
        }
        if motion.status.is_converged() && mesh.definite {
            motion.certificate = Certificate::LocalMinimumOnMesh;
        }
        Ok(self.report(&mut mesh, motion))
    }

    /// Looks at a motion that converged between its points. Where that fails, the intervals that make it fail
    /// are divided and the problem is solved again, a few times; the last motion that was solved stays.
    fn look_and_divide(
        &mut self,
        mesh: &mut Interior,
        motion: &mut StateMotion,
        options: &SolverOptions,
        recorder: &mut Recorder<'_>,
    ) {
        for round in 0..=constants::ROUNDS {
            motion.verified = self.look_between(mesh, options.tolerance, recorder);
            if motion.verified.passes(options.tolerance) || round == constants::ROUNDS {
                break;
            }
            let parts = motion.verified.parts(&mesh.widths);
            let Some(parts) = parts.filter(|parts| parts.iter().sum::<usize>() < options.max_nodes) else {
                break;
            };
            let finer = mesh.divided(self, &parts);
            let solved = std::mem::replace(mesh, finer);
            let precision = constants::PART_OF_TOLERANCE * options.tolerance;
            let between = mesh
                .solve(self, precision, options, recorder, &mut motion.steps)
                .ok()
                .and_then(|()| mesh.between(self).ok());
            let Some(between) = between else {
                *mesh = solved;
                break;
            };
            (motion.error, motion.largest_violation) = (largest(&between.errors), largest(&between.excess));
        }
    }

    /// Solves on finer and finer meshes. An error if the tolerance is not met.
    fn refine(
        &mut self,
        mesh: &mut Interior,
        motion: &mut StateMotion,
        options: &SolverOptions,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), Status> {
        let accuracy = accuracy(options);
        let failed = |error: EvalError| Status::EvaluationFailed(error.into());
        let (mut is_halved, mut last, mut parts) = (false, f64::INFINITY, Vec::new());
        for number in 0..constants::MESHES {
            if number > 0 {
                last = mesh.cost;
                *mesh = mesh.divided(self, &parts);
            }
            let tolerance = constants::PART_OF_TOLERANCE * options.tolerance;
            mesh.solve(self, tolerance, options, recorder, &mut motion.steps)?;
            let between = mesh.between(self).map_err(failed)?;
            (motion.error, motion.largest_violation) = (largest(&between.errors), largest(&between.excess));
            let cost = mesh.cost_size();
            motion.cost_change = (mesh.cost - last).abs() / cost;
            let is_met = motion.cost_change <= options.tolerance
                && motion.error <= accuracy
                && motion.largest_violation <= constants::EXCESS;
            if is_halved && is_met {
                return Ok(());
            }
            parts = mesh.parts(&between, accuracy, constants::ENOUGH * options.tolerance * cost);
            is_halved = parts.iter().all(|&parts| parts == 1);
            if is_halved {
                parts.fill(2);
            }
            if parts.iter().sum::<usize>() >= options.max_nodes {
                break;
            }
        }
        Err(Status::MeshLimit)
    }
}

/// Largest relative error of x.
fn accuracy(options: &SolverOptions) -> f64 {
    shared::VERIFIED * options.tolerance.sqrt()
}

/// Infinite if a value is not a number.
fn largest(errors: &[f64]) -> f64 {
    errors.iter().fold(0.0, |most: f64, error| most.max(defined(*error)))
}
