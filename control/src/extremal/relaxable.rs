//! The parts of a problem that a relaxation changes.

use crate::extremal::actuation::Actuation;
use crate::extremal::penalty::Penalties;
use crate::extremal::relaxation::{Relaxation, smoothing_price};
use crate::extremal::user_terms::UserTerms;
use crate::problem::Problem;

/// The original values of what a relaxation changes, and the current relaxation.
#[derive(Clone, Debug)]
pub(crate) struct Relaxable {
    original: Actuation,
    penalty_weight: f64,
    /// Whether a relaxation weakens user terms.
    weakens_terms: bool,
    time_cost: f64,
    current: Relaxation,
}

/// The parts of an extremal that a relaxation changes.
pub(crate) struct RelaxedParts<'a> {
    pub actuation: &'a mut Actuation,
    pub penalties: &'a mut Penalties,
    pub terms: &'a mut UserTerms<f64>,
}

impl Relaxable {
    pub fn new(problem: &Problem) -> Self {
        Self {
            original: Actuation::new(problem),
            penalty_weight: problem.penalty.as_ref().map_or(0.0, |penalty| penalty.weight),
            weakens_terms: problem.terms_may_be_weaker(),
            time_cost: problem.cost.time,
            current: Relaxation::NONE,
        }
    }

    /// For a problem with neither penalties nor user terms.
    pub fn of_actuation(original: Actuation, time_cost: f64) -> Self {
        let current = Relaxation::NONE;
        Self { original, penalty_weight: 0.0, weakens_terms: false, time_cost, current }
    }

    pub fn current(&self) -> Relaxation {
        self.current
    }

    /// Actuation of the original problem.
    pub fn original(&self) -> &Actuation {
        &self.original
    }

    /// Smooths controls without effort, and makes the smoothed problem the original one.
    pub fn smooth(&mut self, effort: f64) {
        let sharp = self.original.clone();
        self.original.relax(&sharp, self.time_cost, Relaxation { effort, ..Relaxation::NONE });
    }

    /// Relaxes actuation, penalties and user terms.
    pub fn apply(&mut self, relaxation: Relaxation, parts: RelaxedParts<'_>) {
        let RelaxedParts { actuation, penalties, terms } = parts;
        self.relax_actuation(relaxation, actuation);
        penalties.set_weight(relaxation.penalty * self.penalty_weight);
        penalties.set_rounding(relaxation.effort * smoothing_price(self.time_cost));
        terms.factor = if self.weakens_terms { relaxation.penalty } else { 1.0 };
    }

    /// Relaxes the actuation alone.
    pub fn relax_actuation(&mut self, relaxation: Relaxation, actuation: &mut Actuation) {
        self.current = relaxation;
        actuation.relax(&self.original, self.time_cost, relaxation);
    }

    /// The easiest problem.
    pub fn easiest(&self) -> Relaxation {
        let bounded =
            self.original.bounds.iter().any(|range| range.low.is_finite() || range.high.is_finite());
        Relaxation {
            goal: 0.1,
            penalty: if self.penalty_weight > 0.0 || self.weakens_terms { 0.0 } else { 1.0 },
            effort: if self.original.effort.contains(&0.0) { 1.0 } else { 0.0 },
            bounds: if bounded { f64::INFINITY } else { 1.0 },
        }
    }
}
