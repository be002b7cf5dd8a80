//! A solved extremal as numbers over time, and how good it is.

use crate::bvp::Solvable;
use crate::bvp::mesh::Span;
use crate::bvp::timed::Timed;
use crate::extremal::{BoundSide, Extremal, Relaxation};
use crate::numerics::dormand_prince::{DormandPrince, Stopped};
use crate::options::Iteration;
use crate::solve::Extremum;
use crate::solve::arcs::side_of;
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

impl Extremum {
    /// The motion, integrated again and checked for conjugate times where it converged.
    pub(crate) fn into_motion<E: Extremal>(mut self, extremal: &mut E, iterations: Vec<Iteration>) -> Motion {
        extremal.set_relaxation(self.ease);
        let values = self.equations.current.clone();
        let mut timed = Timed::new(extremal, self.clock, self.arcs.clone());
        if let Err(error) = self.equations.evaluate(&mut timed, &values)
            && self.status.is_converged()
        {
            self.status = Status::EvaluationFailed(error.to_string());
        }
        let (z_len, m) = (timed.z_len(), self.equations.m);
        let (final_time, (cost, penalty_cost)) = (self.final_time(extremal), self.costs(extremal));
        let converged = self.status.is_converged();
        let whole = converged || self.status == Status::SwitchesNotRefined;
        let end_state = if whole { self.integrated_again(extremal).ok() } else { None };
        let shooting_defect = if whole { self.shooting_defect(extremal).ok() } else { None };
        let (conjugate_time, certificate) = if converged && self.ease == Relaxation::NONE {
            self.second_variation(extremal)
        } else {
            (None, Certificate::NotChecked)
        };
        let (hamiltonian, hamiltonian_drift) = self.drift();
        let durations = self.durations(z_len);
        let (mut t, mut z, mut u) = (Vec::new(), Vec::new(), Vec::new());
        let (mut hamiltonians, mut switches) = (Vec::new(), Vec::new());
        let mut now = 0.0;
        let mut controls = vec![0.0; extremal.controls()];
        for i in 0..self.equations.mesh.nodes() {
            let w = &self.equations.current.nodes[i * m..i * m + z_len];
            let law = self.arcs.law(self.equations.mesh.arc_of_node(i));
            extremal.controls_at(w, law, &mut controls);
            t.push(now);
            z.push(w.to_vec());
            u.push(controls.clone());
            hamiltonians.push(self.equations.rates.0[i].hamiltonian);
            match self.equations.mesh.spans.get(i) {
                Some(&Span::Interval { arc, length }) => now += length * durations[arc],
                Some(Span::Switch { .. }) => switches.push(now),
                None => {}
            }
        }
        if self.arcs.switches.is_empty() {
            switches = self.crossings(extremal).into_iter().map(|crossing| crossing.time).collect();
        }
        let errors = self.estimate.map_or_else(Vec::new, |estimate| estimate.components);
        Motion {
            status: self.status,
            final_time,
            cost,
            penalty_cost,
            smoothing: self.ease.effort,
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
        let inner = self.equations.method.len() - 2;
        let spans = self.equations.mesh.spans.iter().enumerate();
        let of_spans = spans.filter(|(_, span)| matches!(span, Span::Interval { .. }));
        let of_inner = of_spans.flat_map(|(k, _)| &self.equations.rates.1[k * inner..(k + 1) * inner]);
        let all: Vec<_> = self.equations.rates.0.iter().chain(of_inner).collect();
        let mean = all.iter().map(|rate| rate.hamiltonian).sum::<f64>() / all.len() as f64;
        let size = all.iter().map(|rate| rate.magnitude()).fold(0.0, f64::max);
        let far = all.iter().map(|rate| (rate.hamiltonian - mean).abs()).fold(0.0, f64::max);
        (mean, if size > 0.0 { far / size } else { 0.0 })
    }

    /// x(T) by an adaptive integrator from x(0), with the controls that belong to the collocation polynomial of the costates.
    fn integrated_again<E: Extremal>(&self, extremal: &mut E) -> Result<Vec<f64>, Stopped> {
        let (states, m) = (extremal.states(), self.equations.m);
        let durations = self.durations(2 * states);
        let mut x = self.equations.current.nodes[..states].to_vec();
        let (mut w, mut u) = (vec![0.0; m], vec![0.0; extremal.controls()]);
        let mut integrator = DormandPrince::new(states, 1e-12);
        for (k, span) in self.equations.mesh.spans.iter().enumerate() {
            if let Span::Interval { arc, length } = *span {
                let (law, h) = (self.arcs.law(arc), length * durations[arc]);
                integrator.integrate(&mut x, (0.0, h), |t, x, f| {
                    self.equations.polynomial(k, t / h, &mut w);
                    extremal.controls_at(&w[..2 * states], law, &mut u);
                    extremal.state_rate(x, &u, f)
                })?;
            }
        }
        Ok(x)
    }

    /// Where the controls of one arc reach or leave their bounds, in the order of time.
    pub(crate) fn crossings<E: Extremal>(&self, extremal: &mut E) -> Vec<Crossing> {
        let (z_len, m, count) = (2 * extremal.states(), self.equations.m, extremal.controls());
        let durations = self.durations(z_len);
        let mut found: Vec<Crossing> = Vec::new();
        if count == 0 {
            return found;
        }
        let mut sides = |w: &[f64], u: &mut [f64]| -> Vec<BoundSide> {
            extremal.unbounded_controls(&w[..z_len], u);
            let side = |(i, &u): (usize, &f64)| side_of(u, extremal.bounds(i));
            u.iter().enumerate().map(side).collect()
        };
        let (mut w, mut u) = (self.equations.current.nodes[..m].to_vec(), vec![0.0; count]);
        let mut before = sides(&w, &mut u);
        let mut now = 0.0;
        for (k, span) in self.equations.mesh.spans.iter().enumerate() {
            let Span::Interval { arc, length } = *span else { continue };
            let h = length * durations[arc];
            let mut in_interval = Vec::new();
            // Several looks at each interval, for arcs that are short.
            for look in 1..=LOOKS {
                let (from, to) = ((look - 1) as f64 / LOOKS as f64, look as f64 / LOOKS as f64);
                self.equations.polynomial(k, to, &mut w);
                let after = sides(&w, &mut u);
                for control in 0..count {
                    let pair = (before[control], after[control]);
                    if pair.0 != pair.1 {
                        let c = self.bisect(k, (from, to), &mut w, |w| sides(w, &mut u)[control] == pair.0);
                        in_interval.push(Crossing { time: now + c * h, control, sides: pair });
                    }
                }
                before = after;
            }
            in_interval.sort_by(|a, b| a.time.total_cmp(&b.time));
            found.extend(in_interval);
            now += h;
        }
        found
    }

    /// Where in an interval `before` stops to hold.
    fn bisect(
        &self,
        span: usize,
        (mut from, mut to): (f64, f64),
        w: &mut [f64],
        mut before: impl FnMut(&[f64]) -> bool,
    ) -> f64 {
        for _ in 0..50 {
            let middle = 0.5 * (from + to);
            self.equations.polynomial(span, middle, w);
            if before(w) {
                from = middle;
            } else {
                to = middle;
            }
        }
        0.5 * (from + to)
    }
}

/// How often an interval is looked at for a control that reaches or leaves a bound.
const LOOKS: usize = 8;

/// A control reaches or leaves a bound.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Crossing {
    pub time: f64,
    pub control: usize,
    pub sides: (BoundSide, BoundSide),
}
