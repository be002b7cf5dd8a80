//! How far a problem is relaxed.

/// How far a problem is relaxed. A homotopy begins with an easier problem and ends at [`NONE`](Self::NONE).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Relaxation {
    /// Fraction of the distance from the start to the end state.
    pub goal: f64,
    /// Factor of the penalties and of user terms.
    pub penalty: f64,
    /// Weight of the effort of controls that cost nothing, relative to a weight that matters; 0 for none.
    pub effort: f64,
    /// Factor of the distance between bounds; infinite for no bounds.
    pub bounds: f64,
}

impl Relaxation {
    /// The original problem.
    pub const NONE: Self = Self { goal: 1.0, penalty: 1.0, effort: 0.0, bounds: 1.0 };
}

/// Cost of one unit of smoothing per unit of time: c_t, or 1 where time costs nothing.
pub(crate) fn smoothing_price(time_cost: f64) -> f64 {
    if time_cost > 0.0 { time_cost } else { 1.0 }
}
