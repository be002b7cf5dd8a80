//! Solutions verified: integrated again by an adaptive integrator, or by the factors of their equations.

use crate::bvp::collocation::error::defined;
use crate::bvp::mesh::Span;
use crate::bvp::timed::Clock;
use crate::bvp::{Discretised, Failure, Solvable};
use crate::constants::checks::verify::{DRAWS, SHARP, SHARPER, SHARPEST};
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::options::SolverOptions;
use crate::progress::Phase;
use crate::solve::{Attempt, Recorder, Solved};

/// Largest end defect of a verified motion, relative to the size of each component.
pub(crate) fn verification_bound(tolerance: f64) -> f64 {
    (100.0 * tolerance).max(1e-6)
}

/// Relative tolerance of one step when a motion of this tolerance is integrated again.
pub(crate) fn integration_tolerance(tolerance: f64) -> f64 {
    (SHARPER * tolerance).max(SHARPEST)
}

impl Solved {
    /// x(T) of the motion integrated again.
    ///
    /// The integration amplifies errors along the motion. If it misses the end of a motion with a loose
    /// tolerance, the motion is solved once more to a sharp one.
    pub(crate) fn integrated_or_sharper(
        &mut self,
        extremal: &mut dyn Extremal,
        recorder: &mut Recorder<'_>,
        options: &SolverOptions,
    ) -> Result<Vec<f64>, Stopped> {
        let tolerance = integration_tolerance(options.tolerance);
        let end = self.integrated_again(extremal, tolerance, &mut || recorder.ended().is_some());
        let misses = |solved: &Self, end: Option<&[f64]>, extremal: &dyn Extremal| {
            solved.end_defect(extremal, end) > verification_bound(options.tolerance)
        };
        let sharper = self.status.is_converged() && options.tolerance > 10.0 * SHARP;
        let was_stopped = end == Err(Stopped::Interrupted);
        if !sharper || was_stopped || !misses(self, end.as_deref().ok(), extremal) {
            return end;
        }
        let phase = if let Clock::Free = self.found.clock { Phase::FreeTime } else { Phase::FixedTime };
        let attempt = Attempt { tolerance: SHARP, ..Attempt::new(options, phase) };
        let sharp = self.found.predicted(extremal, None).solve(extremal, &attempt, recorder);
        if !sharp.is_converged() {
            return end;
        }
        *self = sharp;
        let tolerance = integration_tolerance(SHARP);
        self.integrated_again(extremal, tolerance, &mut || recorder.ended().is_some())
    }

    /// x(T) integrated from x(0), with the controls that belong to the collocation polynomial of the
    /// costates.
    pub(crate) fn integrated_again(
        &self,
        extremal: &mut dyn Extremal,
        tolerance: f64,
        stops: &mut dyn FnMut() -> bool,
    ) -> Result<Vec<f64>, Stopped> {
        let (states, m) = (extremal.states(), self.found.equations.m);
        let durations = self.found.durations(2 * states);
        let mut x = self.found.equations.current.nodes[..states].to_vec();
        let (mut w, mut u) = (vec![0.0; m], vec![0.0; extremal.controls()]);
        let mut rate = vec![0.0; 2 * states];
        let mut integrator = DormandPrince::new(states, tolerance);
        for (k, span) in self.found.equations.mesh.spans.iter().enumerate() {
            if let Span::Interval { arc, length } = *span {
                let (law, h) = (self.found.arcs.law(arc), length * durations[arc]);
                integrator.integrate_until(&mut x, 0.0..h, |t, x, f| {
                    if stops() {
                        return Err(Stopped::Interrupted);
                    }
                    self.found.equations.polynomial(k, t / h, &mut w);
                    if u.is_empty() {
                        // Without controls the first half of z' = g(z), with these costates, is the state
                        // equation.
                        w[..states].copy_from_slice(x);
                        extremal.evaluate(&w[..2 * states], law, &mut rate)?;
                        f.copy_from_slice(&rate[..states]);
                        return Ok(());
                    }
                    extremal.controls_at(&w[..2 * states], law, &mut u);
                    Ok(extremal.state_rate(x, &u, f)?)
                })?;
            }
        }
        Ok(x)
    }

    /// How much the equations amplify errors:
    ///
    /// $$ \kappa = \max_{draws} \lVert A^{-1} e \rVert_\infty, \qquad e_i = \pm 1 $$
    ///
    /// with the matrix A of the equations in scaled variables, factored for the last step of Newton's method,
    /// and random signs for the equations of all intervals. Rounding errors of the size eps then change a
    /// component by about kappa eps.
    pub(crate) fn conditioning(&mut self, extremal: &mut dyn Extremal) -> Result<f64, Failure> {
        let mut timed = self.found.timed(extremal);
        let equations = &mut self.found.equations;
        if !equations.factored {
            equations.linearise(&mut timed)?;
        }
        let mut errors = vec![0.0; equations.mesh.spans.len() * equations.m];
        let (mut response, mut random, mut largest) = (equations.zeros(), 1_u64, 0.0_f64);
        for _ in 0..DRAWS {
            for error in &mut errors {
                // Marsaglia's generator.
                random ^= random << 13;
                random ^= random >> 7;
                random ^= random << 17;
                *error = if random >> 63 == 0 { 1.0 } else { -1.0 };
            }
            equations.response(&errors, &mut response);
            largest = response.nodes.iter().fold(largest, |most, &change| most.max(defined(change)));
        }
        Ok(largest)
    }

    /// Largest difference between x(T) of the mesh and `end`, relative to the size of each component;
    /// infinite without an end.
    pub(crate) fn end_defect(&self, extremal: &dyn Extremal, end: Option<&[f64]>) -> f64 {
        let (states, m, scale) = (extremal.states(), self.found.equations.m, &self.found.equations.scale);
        let last = (self.found.equations.mesh.nodes() - 1) * m;
        let found = &self.found.equations.current.nodes[last..last + states];
        end.map_or(f64::INFINITY, |end| {
            let defects = found.iter().zip(end).zip(scale).map(|((a, b), scale)| defined((a - b) / scale));
            defects.fold(0.0, f64::max)
        })
    }
}
