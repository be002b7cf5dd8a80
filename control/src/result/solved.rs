//! The solution of what was solved, verified.

use crate::bvp::Solvable;
use crate::bvp::mesh::Span;
use crate::extremal::{Extremal, Relaxation};
use crate::options::{SolverOptions, Verify};
use crate::result::motion::{Certificate, ExtremalSolution, Motion};
use crate::result::nodes::{Interpolant, Nodes};
use crate::solve::{Recorder, Solved};
use crate::status::Status;

/// The status of a converged motion.
fn solved_if(verified: bool, smoothed: bool) -> Status {
    match (verified, smoothed) {
        (true, false) => Status::Converged,
        (true, true) => Status::ConvergedSmoothed,
        (false, _) => Status::NotVerified,
    }
}

impl Solved {
    /// The solution, verified as the options say where it converged.
    pub(crate) fn into_solution(
        mut self,
        extremal: &mut dyn Extremal,
        recorder: &mut Recorder<'_>,
        options: &SolverOptions,
    ) -> ExtremalSolution {
        if self.status == Status::BoundsNotReached {
            // A motion that exceeds the bounds of the problem is no result.
            let missing = Motion::missing(self.status, f64::NAN);
            let iterations = std::mem::take(&mut recorder.iterations);
            let motion = Motion { iterations, bound_violation: self.violation, ..missing };
            return ExtremalSolution { motion, nodes: Nodes::default(), verified: None };
        }
        extremal.set_relaxation(self.relaxation);
        let values = self.found.equations.current.clone();
        let mut timed = self.found.timed(extremal);
        if let Err(failure) = self.found.equations.evaluate(&mut timed, &values)
            && self.status.is_converged()
        {
            self.status = failure.into();
        }
        let converged = self.status.is_converged();
        let verifiable = converged || self.status == Status::SwitchesNotRefined;
        let mut verification = if verifiable { options.verify } else { Verify::None };
        let mut verified = None;
        let smoothed = self.relaxation != Relaxation::NONE;
        let (mut end_state, mut shooting_defect, mut conditioning) = (None, f64::INFINITY, f64::NAN);
        match verification {
            Verify::Full => {
                let checked = self.checked(extremal, recorder, options);
                (end_state, shooting_defect) = (checked.end_state, checked.shooting_defect);
                if !checked.is_complete {
                    verification = Verify::None;
                }
                if converged {
                    self.status = match recorder.ended().filter(|_| !checked.is_complete) {
                        Some(interruption) => interruption.into(),
                        None => solved_if(checked.verification.failure().is_none(), smoothed),
                    };
                }
                verified = Some(checked.verification);
            }
            Verify::Factors => {
                conditioning = self.conditioning(extremal).unwrap_or(f64::INFINITY);
                if converged {
                    self.status = solved_if(conditioning * f64::EPSILON <= options.tolerance, smoothed);
                }
            }
            Verify::None if converged => self.status = Status::NotVerified,
            Verify::None => {}
        }
        let (final_time, (cost, penalty_cost)) =
            (self.found.final_time(extremal), self.found.costs(extremal));
        // A motion that is not verified, or belongs to a smoothed problem, gets no certificate.
        let (conjugate, certificate) = if verification == Verify::Full && self.status.is_converged() {
            self.second_variation(extremal, &mut || recorder.ended().is_some())
        } else {
            (None, Certificate::NotChecked)
        };
        let (hamiltonian, hamiltonian_drift) = self.drift();
        let (nodes, mut switches) = self.nodes(extremal);
        if self.found.arcs.switches.is_empty() {
            switches = self.found.crossings(extremal).into_iter().map(|crossing| crossing.time).collect();
        }
        let motion = Motion {
            status: self.status,
            cost,
            penalty_cost,
            smoothing: self.relaxation.effort,
            smoothing_bound: 0.0,
            final_time,
            hamiltonian,
            phase_hamiltonians: Vec::new(),
            hamiltonian_drift,
            end_state,
            verification,
            conditioning,
            shooting_defect,
            finer_mesh: f64::NAN,
            duality_gap: f64::NAN,
            newton_decrement: f64::NAN,
            stationarity: f64::NAN,
            conjugate_time: conjugate.map(|conjugate| conjugate.time),
            conjugate_multiplicity: conjugate.map_or(0, |conjugate| conjugate.multiplicity),
            certificate,
            errors: self.estimate.map_or_else(Vec::new, |estimate| estimate.components),
            iterations: std::mem::take(&mut recorder.iterations),
            switches,
            bound_violation: None,
        };
        ExtremalSolution { motion, nodes, verified }
    }

    /// Values at the nodes with the collocation polynomial, and the times of the switches between arcs.
    fn nodes(&self, extremal: &mut dyn Extremal) -> (Nodes, Vec<f64>) {
        let (z_len, m) = (2 * extremal.states(), self.found.equations.m);
        let durations = self.found.durations(z_len);
        let points = self.found.equations.method.len();
        let (mut nodes, mut interpolant) = (Nodes::default(), Interpolant::new(points));
        let (mut switches, mut now) = (Vec::new(), 0.0);
        let mut controls = vec![0.0; extremal.controls()];
        for i in 0..self.found.equations.mesh.nodes() {
            let w = &self.found.equations.current.nodes[i * m..i * m + z_len];
            let arc = self.found.equations.mesh.arc_of_node(i);
            extremal.controls_at(w, self.found.arcs.law(arc), &mut controls);
            nodes.t.push(now);
            nodes.z.push(w.to_vec());
            nodes.u.push(controls.clone());
            nodes.hamiltonian.push(self.found.equations.rates.nodes[i].hamiltonian);
            // Slopes are in the scaled time of an arc.
            let seconds = |slopes: &[f64], arc: usize| -> Vec<f64> {
                slopes[..z_len].iter().map(|slope| slope / durations[arc]).collect()
            };
            interpolant.slopes.push(seconds(&self.found.equations.slopes.nodes[i * m..], arc));
            match self.found.equations.mesh.spans.get(i) {
                Some(&Span::Interval { arc, length }) => {
                    let (mut slopes, mut inner_controls) = (Vec::new(), Vec::new());
                    for k in i * (points - 2)..(i + 1) * (points - 2) {
                        let w = &self.found.equations.current.inner[k * m..k * m + z_len];
                        extremal.controls_at(w, self.found.arcs.law(arc), &mut controls);
                        slopes.push(seconds(&self.found.equations.slopes.inner[k * m..], arc));
                        inner_controls.push(controls.clone());
                    }
                    interpolant.inner.push(slopes);
                    interpolant.controls.push(inner_controls);
                    now += length * durations[arc];
                }
                Some(Span::Switch { .. }) => {
                    interpolant.inner.push(Vec::new());
                    interpolant.controls.push(Vec::new());
                    switches.push(now);
                }
                None => {}
            }
        }
        nodes.interpolant = Some(interpolant);
        (nodes, switches)
    }

    /// Mean of H*, and its largest distance from it in parts of the terms that it is made of.
    fn drift(&self) -> (f64, f64) {
        let inner = self.found.equations.method.len() - 2;
        let spans = self.found.equations.mesh.spans.iter().enumerate();
        let of_spans = spans.filter(|(_, span)| matches!(span, Span::Interval { .. }));
        let of_inner =
            of_spans.flat_map(|(k, _)| &self.found.equations.rates.inner[k * inner..(k + 1) * inner]);
        let all: Vec<_> = self.found.equations.rates.nodes.iter().chain(of_inner).collect();
        let mean = all.iter().map(|rate| rate.hamiltonian).sum::<f64>() / all.len() as f64;
        let size = all.iter().map(|rate| rate.magnitude()).fold(0.0, f64::max);
        let far = all.iter().map(|rate| (rate.hamiltonian - mean).abs()).fold(0.0, f64::max);
        (mean, if size > 0.0 { far / size } else { 0.0 })
    }
}
