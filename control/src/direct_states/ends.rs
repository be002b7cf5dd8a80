//! What is given at the end, as linear equations.

use super::points::Layout;
use crate::extremal::dynamics::problem::EndState;

/// `c'x(T) = value`.
pub(super) struct EndRow {
    /// Components of c that are not zero.
    entries: Vec<(usize, f64)>,
    value: f64,
}

impl EndRow {
    /// The components that are fixed, then the functions that are given.
    pub fn of(end: &EndState) -> Vec<Self> {
        let fixed = (0..end.x.len()).filter(|i| !end.free.contains(i));
        let fixed = fixed.map(|i| Self { entries: vec![(i, 1.0)], value: end.x[i] });
        let given = end.given.iter().map(|row| {
            let entries = row.iter().copied().enumerate().filter(|(_, c)| *c != 0.0).collect();
            Self { entries, value: row.iter().zip(&end.x).map(|(c, x)| c * x).sum() }
        });
        fixed.chain(given).collect()
    }

    /// c, one component after the other.
    pub fn entries(&self) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        self.entries.iter().copied()
    }

    /// `c'x`.
    pub fn of_state(&self, x: &[f64]) -> f64 {
        self.entries().map(|(i, c)| c * x[i]).sum()
    }

    /// What is missed at the end of a motion.
    pub fn missed(&self, layout: &Layout, w: &[f64]) -> f64 {
        self.of_state(&w[layout.node(layout.intervals)..]) - self.value
    }

    /// The component that c is nearest to.
    pub fn component(&self) -> Option<usize> {
        self.entries().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs())).map(|(i, _)| i)
    }

    /// The size of c'x where components have these.
    pub fn size(&self, of_component: impl Fn(usize) -> f64) -> f64 {
        self.entries().map(|(i, c)| c.abs() * of_component(i)).fold(0.0, f64::max)
    }
}
