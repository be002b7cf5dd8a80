//! Bounds of a control, and on which side of them it is.

/// Position of a bounded control relative to its bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum BoundSide {
    /// At the lower bound.
    Low,
    /// Between the bounds.
    Inside,
    /// At the upper bound.
    High,
}

/// The sides of a control before and after a switch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SideChange {
    /// Before the switch.
    pub before: BoundSide,
    /// After it.
    pub after: BoundSide,
}

impl SideChange {
    /// From one side to another.
    pub fn new(before: BoundSide, after: BoundSide) -> Self {
        Self { before, after }
    }
}

/// The values that a control may take, `low <= u <= high`; infinite where there is no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ControlRange {
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

impl ControlRange {
    /// No bounds.
    pub const UNBOUNDED: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// From the lower to the upper bound.
    pub fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Half the distance between the bounds. With one bound only, its absolute value, or 1 where that is
    /// zero.
    pub(crate) fn half_width(self) -> f64 {
        let Self { low, high } = self;
        match (low.is_finite(), high.is_finite()) {
            (true, true) => 0.5 * (high - low),
            (true, false) if low != 0.0 => low.abs(),
            (false, true) if high != 0.0 => high.abs(),
            _ => 1.0,
        }
    }

    /// Distance of a control from the middle, in half distances between the bounds: 1 at a bound, more
    /// beyond. A bound on one side alone counts from zero, as where bounds are relaxed.
    pub(crate) fn factor(self, u: f64) -> f64 {
        1.0 + (self.low - u).max(u - self.high) / self.half_width()
    }

    /// Where an unclipped control is.
    pub(crate) fn side_of(self, u: f64) -> BoundSide {
        if u <= self.low {
            BoundSide::Low
        } else if u >= self.high {
            BoundSide::High
        } else {
            BoundSide::Inside
        }
    }
}

/// How the controls follow from z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ControlLaw<'a> {
    /// Each control maximises the Hamiltonian within its bounds.
    Maximal,
    /// The arc of each control is given: at a bound, or inside, where it is not clipped.
    Given(&'a [BoundSide]),
}
