//! The rows of constraints whose multipliers are coordinates.

use costate::robot::Robot;

/// The rows that hold along a motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Loops {
    /// With its constraints.
    pub robot: Robot,
    pub rows: Vec<LoopRow>,
}

/// A row of g that does not depend on those before it at the start.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LoopRow {
    /// Its number among all rows.
    pub row: usize,
    /// The mass that resists it at the start, `1/(J M^-1 J')` of the row (kg; kg m^2 of an angle): g is
    /// measured in it, so that all equations are forces and torques.
    pub mass: f64,
    /// The constraint that it belongs to.
    pub name: String,
}
