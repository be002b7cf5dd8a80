//! Derivatives by the times of phases.

/// Derivatives by the time of each phase.
#[derive(Clone, Debug, Default)]
pub(super) struct ByTimes {
    /// Gradients, as those in x.
    pub gradient: [Vec<f64>; 2],
    /// Of the gradient in x.
    pub columns: Vec<Vec<f64>>,
    /// Second ones. No two phases have any together.
    pub second: Vec<f64>,
}

impl ByTimes {
    /// Zero, for so many phases and unknowns.
    pub fn reset(&mut self, phases: usize, size: usize) {
        for list in self.gradient.iter_mut().chain([&mut self.second]) {
            list.clear();
            list.resize(phases, 0.0);
        }
        self.columns.resize_with(phases, Vec::new);
        for column in &mut self.columns {
            column.clear();
            column.resize(size, 0.0);
        }
    }
}
