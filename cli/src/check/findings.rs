//! What a check finds.

use costate::derivative::{Figure, StateReport, Verdict, worse};

/// What was found.
pub(super) struct Findings {
    /// At q = 0, if M is regular there.
    pub zero: Option<StateReport>,
    /// The worst of each figure over all random states.
    pub random: Option<StateReport>,
    /// Why states were left out, one message for each.
    pub singular: Vec<String>,
    /// States in which rounding leaves too few digits for some comparison.
    pub nearly_singular: usize,
    /// States in which an implicit step was not solved to rounding.
    pub steps_unsolved: usize,
}

/// One row of the report: a quantity by one method.
pub(super) struct Row<'a> {
    pub named: &'a Figure,
    pub zero: Option<&'a Figure>,
    pub random: Option<&'a Figure>,
}

impl Findings {
    /// Every quantity by every method.
    pub fn rows(&self) -> Vec<Row<'_>> {
        let reports = self.zero.iter().chain(&self.random);
        let fullest = reports.max_by_key(|report| report.figures.len());
        let figures = fullest.into_iter().flat_map(|report| report.figures.iter().enumerate());
        figures
            .map(|(k, named)| Row {
                named,
                zero: self.zero.as_ref().and_then(|report| report.figures.get(k)),
                random: self.random.as_ref().and_then(|report| report.figures.get(k)),
            })
            .collect()
    }

    /// Why no figure says anything, if so.
    pub fn nothing_compared(&self) -> Option<&'static str> {
        if self.zero.is_none() && self.random.is_none() {
            return Some("no state could be evaluated");
        }
        let silent = self.rows().iter().all(Row::says_nothing);
        silent.then_some("no row is comparable in any state: rounding leaves too few digits")
    }

    /// The figures that do not agree.
    pub fn failures(&self, tolerance: f64) -> Vec<Figure> {
        let worst = self.rows().iter().filter_map(Row::worst).collect::<Vec<_>>();
        worst.into_iter().filter(|figure| figure.verdict(tolerance) == Verdict::Differs).collect()
    }

    /// The largest condition number of M.
    pub fn condition(&self) -> f64 {
        self.zero.iter().chain(&self.random).map(|report| report.condition).fold(0.0, worse)
    }
}

impl Row<'_> {
    /// Whether rounding leaves too few digits in every state.
    pub fn says_nothing(&self) -> bool {
        self.worst().is_none_or(|figure| figure.verdict(1.0) == Verdict::NotComparable)
    }

    /// The worse of both columns.
    pub fn worst(&self) -> Option<Figure> {
        match (self.zero, self.random) {
            (Some(zero), Some(random)) => Some(zero.or_worse(random)),
            (one, other) => one.or(other).copied(),
        }
    }
}
