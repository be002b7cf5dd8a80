//! The rows of constraints whose multipliers are coordinates.

use super::gait::{Gait, SoleContact};
use costate::robot::Robot;
use std::ops::Range;

/// The rows that hold along a motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Loops {
    /// With its constraints, those of all phases.
    pub robot: Robot,
    pub rows: Vec<LoopRow>,
    /// What holds in each phase.
    pub phases: Vec<LoopPhase>,
    /// Of a gait.
    pub walk: Option<Walk>,
}

/// The constraints that hold in a phase.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LoopPhase {
    /// With these constraints, the first ones of all.
    pub robot: Robot,
    /// Number of their rows, which are the first ones among the [rows](Loops::rows) too. The multipliers of
    /// the others have no force.
    pub rows: usize,
}

impl Loops {
    /// These rows in one phase.
    pub fn new(robot: Robot, rows: Vec<LoopRow>) -> Self {
        let phases = vec![LoopPhase { robot: robot.clone(), rows: rows.len() }];
        Self { robot, rows, phases, walk: None }
    }
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

/// A gait, prepared.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Walk {
    pub gait: Gait,
    /// The robot with a constraint for each of the [feet](Self::feet), whose rows are x and z of it, and its
    /// angle if it is a sole that is flat; in space three of a point and of the edge of a toe, and six of a
    /// sole that is flat.
    pub foot: Robot,
    /// Likewise the feet that land, then those that stay on the ground meanwhile, with all rows of both.
    pub landing: Robot,
    /// The feet that stand during the step, then those that stand in the phase of double support alone.
    pub feet: Vec<Foot>,
    /// With x and z of the points that touch the ground: of the feet that swing, and that stand.
    pub corners: [Robot; 2],
    /// x and y of the feet that stand, in a guess.
    pub places: Vec<[f64; 2]>,
    /// For each joint the one whose place it takes when the legs change their roles, and 1, or -1 if it
    /// changes its sign too.
    pub exchange: Vec<(usize, f64)>,
    /// q(0) less the exchanged q(T) (rad, m).
    pub shift: Vec<f64>,
    /// Units of momenta, the diagonal of M at the start (kg m^2/s, kg m/s).
    pub scales: Vec<f64>,
    /// The force of each row in the rows of a foot in the axes of the world: (x, z) and torque about y, in
    /// space all six, or the force on the edge of a toe.
    pub columns: Vec<Vec<f64>>,
    /// Accelerations of multipliers that carry the weight, for guesses.
    pub lift: Vec<f64>,
}

/// A foot on the ground, and the rows that hold it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Foot {
    pub name: String,
    pub rows: Range<usize>,
    /// Those of [`Walk::foot`] in which its force is told.
    pub told: Range<usize>,
    /// Of its sole; points are none.
    pub contact: SoleContact,
}

/// A list with an entry for each joint, with the legs exchanged.
pub(crate) fn exchanged(exchange: &[(usize, f64)], list: &[f64]) -> Vec<f64> {
    exchange.iter().map(|&(from, sign)| sign * list[from]).collect()
}

impl Walk {
    /// The foot that is held by a row.
    pub fn foot_of(&self, row: usize) -> Option<&Foot> {
        self.feet.iter().find(|foot| foot.rows.contains(&row))
    }

    /// Whether a row holds an angle of its foot.
    pub fn is_angle(&self, row: usize) -> bool {
        self.foot_of(row).is_some_and(|foot| self.gait.is_angle(foot.contact, row - foot.rows.start))
    }

    /// The feet that stand during the whole step.
    pub fn stance(&self) -> &[Foot] {
        &self.feet[..self.gait.stance.len()]
    }

    /// Number of the rows that hold them, the first ones.
    pub fn stance_rows(&self) -> usize {
        self.stance().last().map_or(0, |foot| foot.rows.end)
    }

    /// Whether there is a phase of double support.
    pub fn has_double_support(&self) -> bool {
        self.gait.double_support.is_some()
    }

    /// Weight of the robot (N).
    pub fn weight(&self) -> f64 {
        let along = self.shift.iter().position(|&shift| shift != 0.0);
        along.map_or(0.0, |i| self.scales[i] * self.foot.gravity().norm())
    }

    /// The position at the end that the exchange makes the start.
    pub fn mirrored_back(&self, start: &[f64]) -> Vec<f64> {
        let mut end = vec![0.0; start.len()];
        for (i, &(from, sign)) in self.exchange.iter().enumerate() {
            end[from] = sign * (start[i] - self.shift[i]);
        }
        end
    }
}
