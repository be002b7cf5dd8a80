//! From a problem to a motion.

use super::interior::Interior;
use super::points::{Layout, POINTS, Radau};
use super::problem::DirectDynamics;
use super::solution::StateMotion;
use crate::constants::{direct as shared, states as constants};
use crate::options::SolverOptions;
use crate::result::motion::Certificate;
use crate::status::Status;
use costate::EvalError;
use costate::dynamics::{Cost, Dynamics};
use std::time::Instant;

impl<D: Dynamics<f64>, C: Cost<f64>> DirectDynamics<D, C> {
    /// Solves the problem from a straight line between its ends.
    ///
    /// Of the options `tolerance`, `max_nodes`, `max_iterations` and `time_limit` are used. A motion is
    /// [`Converged`](Status::Converged) where all of these hold:
    ///
    /// - the conditions of first order hold on the mesh to a twentieth of the tolerance, or, where rounding
    ///   hides progress, to five times the tolerance: [`StateMotion::residual`];
    /// - on a mesh of twice the widths the cost differs by less than the tolerance, relative;
    /// - errors of x, estimated between the points, and the end that is reached when u is integrated
    ///   independently, differ by less than 0.3 times the root of the tolerance, relative to the largest
    ///   values along the motion: the cost is stationary;
    /// - limits of x are exceeded between the points by less than 1e-4 of the largest value.
    ///
    /// With any other status the motion is the last iterate; [`StateMotion::defect`] and
    /// [`StateMotion::end_missed`] tell what it does not meet.
    pub fn solve(&mut self, options: &SolverOptions) -> StateMotion {
        let deadline = options.time_limit.map(|limit| Instant::now() + limit);
        let layout =
            Layout { n: self.model.states(), m: self.model.controls(), intervals: constants::INTERVALS };
        let widths = vec![1.0 / layout.intervals as f64; layout.intervals];
        let mut mesh = Interior::new(self, widths, self.guess(&layout), false);
        let mut motion = StateMotion::new();
        motion.status =
            self.refine(&mut mesh, &mut motion, options, deadline).err().unwrap_or(Status::Converged);
        motion.end_error = self.verify(&mesh);
        // Not true for NaN.
        let is_verified = motion.end_error <= accuracy(options);
        if motion.status.is_converged() && !is_verified {
            motion.status = Status::NotVerified;
        }
        if motion.status.is_converged() && mesh.definite {
            motion.certificate = Certificate::LocalMinimumOnMesh;
        }
        self.report(&mesh, motion)
    }

    /// Solves on finer and finer meshes. An error if the tolerance is not met.
    fn refine(
        &mut self,
        mesh: &mut Interior,
        motion: &mut StateMotion,
        options: &SolverOptions,
        deadline: Option<Instant>,
    ) -> Result<(), Status> {
        let accuracy = accuracy(options);
        let failed = |error: EvalError| Status::EvaluationFailed(error.into());
        let (mut is_halved, mut last) = (false, f64::NAN);
        for _ in 0..constants::MESHES {
            let tolerance = constants::PART_OF_TOLERANCE * options.tolerance;
            let solved = mesh.solve(self, tolerance, options, deadline, &mut motion.steps);
            motion.residual = mesh.residual;
            solved?;
            let between = mesh.between(self).map_err(failed)?;
            motion.error = between.errors.iter().fold(0.0, |most: f64, error| most.max(*error));
            motion.largest_violation = between.excess.iter().fold(0.0, |most: f64, excess| most.max(*excess));
            let cost = mesh.cost.abs().max(constants::LEAST_COST);
            motion.cost_change = (mesh.cost - last).abs() / cost;
            if is_halved && motion.cost_change <= options.tolerance {
                return Ok(());
            }
            let parts = mesh.parts(&between, accuracy, constants::ENOUGH * options.tolerance * cost);
            is_halved = parts.iter().all(|&parts| parts == 1);
            let parts = if is_halved { vec![2; parts.len()] } else { parts };
            if parts.iter().sum::<usize>() >= options.max_nodes {
                break;
            }
            last = mesh.cost;
            *mesh = mesh.divided(self, &parts);
        }
        Err(Status::MeshLimit)
    }

    /// Straight line between the ends, controls at zero.
    fn guess(&self, layout: &Layout) -> Vec<f64> {
        let mut w = vec![0.0; layout.count()];
        let radau = Radau::new();
        let (start, end) = (&self.problem.start.x, &self.problem.end.x);
        w[..layout.n].copy_from_slice(start);
        for k in 0..layout.intervals {
            for j in 0..POINTS {
                let s = (k as f64 + radau.places[j + 1]) / layout.intervals as f64;
                for i in 0..layout.n {
                    w[layout.point(k, j) + i] = start[i] + s * (end[i] - start[i]);
                }
            }
        }
        w[layout.time()] = self.problem.time.value();
        w
    }
}

/// Largest relative error of x.
fn accuracy(options: &SolverOptions) -> f64 {
    shared::VERIFIED * options.tolerance.sqrt()
}
