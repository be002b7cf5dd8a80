//! On which arc each bounded control is.

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

/// How the controls follow from z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ControlLaw<'a> {
    /// Each control maximises the Hamiltonian within its bounds.
    Maximal,
    /// The arc of each control is given: at a bound, or inside, where it is not clipped.
    Given(&'a [BoundSide]),
}
