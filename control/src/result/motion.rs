//! A solved extremal as numbers over time, and how good it is.

use crate::bvp::Solvable;
use crate::bvp::mesh::Span;
use crate::extremal::{Ease, Extremal};
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::progress::Iteration;
use crate::solve::Solved;
use crate::status::Status;
use serde::{Deserialize, Serialize};

/// What is known about the second variation, for ends that are fixed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Certificate {
    /// No conjugate time: a strict local minimum among all motions between these ends in this time.
    LocalMinimum,
    /// Past a conjugate time: motions nearby cost less.
    NotMinimal,
    /// Not checked: free ends, controls that reach a bound, or not converged.
    NotChecked,
}

/// An extremal that was found, on the nodes of its mesh.
#[derive(Clone, Debug)]
pub struct Motion {
    /// How it ended.
    pub status: Status,
    /// T (s).
    pub final_time: f64,
    /// Integral of the running cost without penalties.
    pub cost: f64,
    /// Integral of the penalties.
    pub penalty_cost: f64,
    /// Weight of the smoothing that is left: 0 for the problem itself.
    pub smoothing: f64,
    /// Mean of H* over the nodes and inner points.
    pub hamiltonian: f64,
    /// `max |H* - mean| / max (|y'f| + |l|)`.
    pub hamiltonian_drift: f64,
    /// x at the end of a motion integrated again with the control that was found.
    pub end_state: Option<Vec<f64>>,
    /// Largest mismatch when segments of the motion, costates included, are integrated again from their found starts, in
    /// parts of the size of each component.
    pub shooting_defect: Option<f64>,
    /// First conjugate time (s), if there is one before T.
    pub conjugate_time: Option<f64>,
    /// What follows from it.
    pub certificate: Certificate,
    /// Estimated error of each component of z, in parts of its largest value.
    pub errors: Vec<f64>,
    /// Newton steps on the way.
    pub iterations: Vec<Iteration>,
    /// Times (s) at which a control reaches or leaves a bound.
    pub switches: Vec<f64>,
    /// Times of the nodes (s).
    pub t: Vec<f64>,
    /// z at the nodes.
    pub z: Vec<Vec<f64>>,
    /// Controls at the nodes.
    pub u: Vec<Vec<f64>>,
    /// H* at the nodes.
    pub hamiltonians: Vec<f64>,
}

impl Solved {
    /// The motion, integrated again and checked for conjugate times where it converged.
    pub(crate) fn into_motion<E: Extremal>(mut self, extremal: &mut E, iterations: Vec<Iteration>) -> Motion {
        extremal.set_ease(self.relaxation);
        let values = self.found.equations.current.clone();
        let mut timed = self.found.timed(extremal);
        if let Err(error) = self.found.equations.evaluate(&mut timed, &values)
            && self.status.is_converged()
        {
            self.status = error.into();
        }
        let (z_len, m) = (timed.z_len(), self.found.equations.m);
        let (final_time, (cost, penalty_cost)) =
            (self.found.final_time(extremal), self.found.costs(extremal));
        let converged = self.status.is_converged();
        let whole = converged || self.status == Status::SwitchesNotRefined;
        let end_state = if whole { self.integrated_again(extremal).ok() } else { None };
        let shooting_defect = if whole { self.shooting_defect(extremal).ok() } else { None };
        let (conjugate_time, certificate) = if converged && self.relaxation == Ease::NONE {
            self.second_variation(extremal)
        } else {
            (None, Certificate::NotChecked)
        };
        let (hamiltonian, hamiltonian_drift) = self.drift();
        let durations = self.found.durations(z_len);
        let (mut t, mut z, mut u) = (Vec::new(), Vec::new(), Vec::new());
        let (mut hamiltonians, mut switches) = (Vec::new(), Vec::new());
        let mut now = 0.0;
        let mut controls = vec![0.0; extremal.controls()];
        for i in 0..self.found.equations.mesh.nodes() {
            let w = &self.found.equations.current.nodes[i * m..i * m + z_len];
            let law = self.found.arcs.law(self.found.equations.mesh.arc_of_node(i));
            extremal.controls_at(w, law, &mut controls);
            t.push(now);
            z.push(w.to_vec());
            u.push(controls.clone());
            hamiltonians.push(self.found.equations.rates.nodes[i].hamiltonian);
            match self.found.equations.mesh.spans.get(i) {
                Some(&Span::Interval { arc, length }) => now += length * durations[arc],
                Some(Span::Switch { .. }) => switches.push(now),
                None => {}
            }
        }
        if self.found.arcs.switches.is_empty() {
            switches = self.found.crossings(extremal).into_iter().map(|crossing| crossing.time).collect();
        }
        let errors = self.estimate.map_or_else(Vec::new, |estimate| estimate.components);
        Motion {
            status: self.status,
            final_time,
            cost,
            penalty_cost,
            smoothing: self.relaxation.effort,
            hamiltonian,
            hamiltonian_drift,
            end_state,
            shooting_defect,
            conjugate_time,
            certificate,
            errors,
            iterations,
            switches,
            t,
            z,
            u,
            hamiltonians,
        }
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

    /// x(T) by an adaptive integrator from x(0), with the controls that belong to the collocation polynomial of the costates.
    fn integrated_again<E: Extremal>(&self, extremal: &mut E) -> Result<Vec<f64>, Stopped> {
        let (states, m) = (extremal.states(), self.found.equations.m);
        let durations = self.found.durations(2 * states);
        let mut x = self.found.equations.current.nodes[..states].to_vec();
        let (mut w, mut u) = (vec![0.0; m], vec![0.0; extremal.controls()]);
        let mut integrator = DormandPrince::new(states, 1e-12);
        for (k, span) in self.found.equations.mesh.spans.iter().enumerate() {
            if let Span::Interval { arc, length } = *span {
                let (law, h) = (self.found.arcs.law(arc), length * durations[arc]);
                integrator.integrate(&mut x, (0.0, h), |t, x, f| {
                    self.found.equations.polynomial(k, t / h, &mut w);
                    extremal.controls_at(&w[..2 * states], law, &mut u);
                    extremal.state_rate(x, &u, f)
                })?;
            }
        }
        Ok(x)
    }
}
