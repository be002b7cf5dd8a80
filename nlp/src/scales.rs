//! Typical sizes of what a program consists of.

use crate::layout::Layout;

/// Typical sizes, all positive.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// Of the cost.
    pub cost: f64,
    /// Of displacements of the unknowns.
    pub steps: Vec<f64>,
    /// Of the equations.
    pub equalities: Vec<f64>,
    /// Of the functions with ranges.
    pub ranges: Vec<f64>,
}

impl Scales {
    /// All of them 1.
    pub fn ones(layout: &Layout) -> Self {
        let ones = |count| vec![1.0; count];
        Self {
            cost: 1.0,
            steps: ones(layout.steps()),
            equalities: ones(layout.equalities()),
            ranges: ones(layout.ranges()),
        }
    }
}
