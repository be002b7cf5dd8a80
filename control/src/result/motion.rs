//! Figures of a solved extremal, and its values at the nodes.

use crate::bvp::Solvable;
use crate::bvp::mesh::Span;
use crate::extremal::{Extremal, Relaxation};
use crate::options::{SolverOptions, Verify};
use crate::progress::Iteration;
use crate::result::nodes::{Interpolant, Nodes};
use crate::result::verify::{integration_tolerance, verification_bound};
use crate::solve::{Recorder, Solved};
use crate::status::{BoundViolation, Status};
use serde::{Deserialize, Serialize};

/// What is known about the second variation, for ends that are fixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Certificate {
    /// No conjugate time up to T, of any multiplicity: a strict local minimum among all motions between these
    /// ends in this time.
    ///
    /// Conjugate times are counted over pieces of the motion. A bound on the second variation shows that no
    /// piece holds two of them. The bound uses the Jacobian where the integration of the Jacobi fields
    /// evaluates it, several times in each mesh interval. Two assumptions remain: that y'F_xx - l_xx has no
    /// peak between these points, and `H_yy >= 0`, which [`ends_are_fixed`] promises.
    ///
    /// [`ends_are_fixed`]: crate::BoundaryValueProblem::ends_are_fixed
    LocalMinimum,
    /// A conjugate time lies before T: motions nearby cost less.
    NotMinimal,
    /// Not checked: free ends, controls that reach a bound, a smoothed control, a motion that is not
    /// converged or not verified, or rounding that hides the answer.
    NotChecked,
}

/// Figures of a solved extremal.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Motion {
    /// How the solve ended.
    pub status: Status,
    /// Integral of the running cost without penalties; `c_t T + integral of 1/2 sum r_i u_i^2` for a robot.
    pub cost: f64,
    /// Integral of the penalties.
    pub penalty_cost: f64,
    /// Weight of the smoothing that is left, relative to one that matters; 0 for the problem itself.
    pub smoothing: f64,
    /// T (s); NaN without a motion.
    pub final_time: f64,
    /// Mean of H* over the nodes and inner points; `dJ/dT = -H*`. With [references](crate::Reference) over
    /// time H* is not constant: then that at the end, the mean of $H^\\ast(t) - \int\_t^T l\_t \\, dt$.
    pub hamiltonian: f64,
    /// Mean of H* in each phase of a motion of the direct method. Phases between which a via has a free time
    /// have the same: a later via would gain in one what it costs in the other.
    pub phase_hamiltonians: Vec<f64>,
    /// `max |H* - mean| / max (|y'f| + |l|)`, the mean that of the phase: zero for an exact solution.
    pub hamiltonian_drift: f64,
    /// x at the end when the motion is integrated again from its start with the control that was found;
    /// `None` where the integration stopped, or for a motion that is not converged.
    pub end_state: Option<Vec<f64>>,
    /// What was done to verify the motion: the level of the options, or [`Verify::None`] where there was no
    /// solution to verify.
    pub verification: Verify,
    /// How much the equations amplify rounding errors: the largest change of a component at a node, in parts
    /// of its largest value, when the equations of all intervals change by independent errors of size 1;
    /// NaN unless verified by [`Verify::Factors`].
    pub conditioning: f64,
    /// Largest relative mismatch when segments of the motion, costates included, are integrated again from
    /// their starts; infinite where the integration stopped, or for a motion that is not converged.
    pub shooting_defect: f64,
    /// First conjugate time (s), if there is one up to T.
    pub conjugate_time: Option<f64>,
    /// Number of independent Jacobi fields that vanish at the conjugate time; 0 without one.
    pub conjugate_multiplicity: usize,
    /// What the second variation shows.
    pub certificate: Certificate,
    /// Estimated error of each component of z in the coordinates of the search, relative to its largest
    /// value.
    pub errors: Vec<f64>,
    /// Newton steps, those of the direct method included.
    pub iterations: Vec<Iteration>,
    /// Times (s) at which a control reaches or leaves a bound.
    pub switches: Vec<f64>,
    /// With [`Status::BoundsNotReached`]: where the motion with the narrowest bounds that could be solved
    /// exceeds the bounds of the problem most.
    pub bound_violation: Option<BoundViolation>,
}

impl Motion {
    /// Figures of a motion that does not exist.
    pub(crate) fn missing(status: Status, final_time: f64) -> Self {
        Self {
            status,
            cost: f64::INFINITY,
            penalty_cost: 0.0,
            smoothing: 0.0,
            final_time,
            hamiltonian: f64::NAN,
            phase_hamiltonians: Vec::new(),
            hamiltonian_drift: f64::INFINITY,
            end_state: None,
            verification: Verify::None,
            conditioning: f64::NAN,
            shooting_defect: f64::INFINITY,
            conjugate_time: None,
            conjugate_multiplicity: 0,
            certificate: Certificate::NotChecked,
            errors: Vec::new(),
            iterations: Vec::new(),
            switches: Vec::new(),
            bound_violation: None,
        }
    }

    /// Cost and penalties together: what was minimised.
    pub fn total(&self) -> f64 {
        self.cost + self.penalty_cost
    }

    /// Largest end defect, relative to the size of each component of x, with which a motion that was solved
    /// to this tolerance counts as verified: `max(100 tolerance, 1e-6)`.
    pub fn verification_bound(tolerance: f64) -> f64 {
        verification_bound(tolerance)
    }
}

/// A solved extremal: its figures, and its values at the nodes.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ExtremalSolution {
    /// The figures.
    pub motion: Motion,
    /// The values at the nodes.
    pub nodes: Nodes,
}

/// The status of a converged motion with this defect; undefined defects are not verified.
pub(crate) fn verified(defect: f64, smoothed: bool, tolerance: f64) -> Status {
    solved_if(defect <= Motion::verification_bound(tolerance), smoothed)
}

fn solved_if(verified: bool, smoothed: bool) -> Status {
    match (verified, smoothed) {
        (true, false) => Status::Converged,
        (true, true) => Status::ConvergedSmoothed,
        (false, _) => Status::NotVerified,
    }
}

impl ExtremalSolution {
    /// Changes the coordinates of all values of z and of the end state; what cannot be mapped becomes
    /// undefined. The polynomial between the nodes belongs to the old coordinates and is dropped when values
    /// change.
    pub(crate) fn map<F: FnMut(&mut [f64]) -> Result<(), costate::EvalError>>(&mut self, mut map: F) {
        let before = self.nodes.z.clone();
        for z in self.nodes.z.iter_mut().chain(&mut self.motion.end_state) {
            if map(z).is_err() {
                z.fill(f64::NAN);
            }
        }
        if self.nodes.z != before {
            self.nodes.interpolant = None;
        }
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
            return ExtremalSolution { motion, nodes: Nodes::default() };
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
        let verification = if verifiable { options.verify } else { Verify::None };
        let smoothed = self.relaxation != Relaxation::NONE;
        let (mut end_state, mut shooting_defect, mut conditioning) = (None, f64::INFINITY, f64::NAN);
        match verification {
            Verify::Full => {
                end_state = self.integrated_or_sharper(extremal, recorder, options);
                let tolerance = integration_tolerance(options.tolerance);
                shooting_defect = self.shooting_defect(extremal, tolerance).unwrap_or(f64::INFINITY);
                if converged {
                    let end = self.end_defect(extremal, end_state.as_deref());
                    self.status = verified(end, smoothed, options.tolerance);
                }
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
            self.second_variation(extremal)
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
            final_time,
            hamiltonian,
            phase_hamiltonians: Vec::new(),
            hamiltonian_drift,
            end_state,
            verification,
            conditioning,
            shooting_defect,
            conjugate_time: conjugate.map(|conjugate| conjugate.time),
            conjugate_multiplicity: conjugate.map_or(0, |conjugate| conjugate.multiplicity),
            certificate,
            errors: self.estimate.map_or_else(Vec::new, |estimate| estimate.components),
            iterations: std::mem::take(&mut recorder.iterations),
            switches,
            bound_violation: None,
        };
        ExtremalSolution { motion, nodes }
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
