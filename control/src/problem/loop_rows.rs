//! The rows of constraints whose multipliers are coordinates.

use super::gait::Gait;
use costate::robot::Robot;

/// The rows that hold along a motion.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Loops {
    /// With its constraints.
    pub robot: Robot,
    pub rows: Vec<LoopRow>,
    /// Of a gait.
    pub walk: Option<Walk>,
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
    /// The robot with a constraint for each foot that stands, whose rows are x and z of it, and its angle if
    /// it is a sole.
    pub foot: Robot,
    /// The same of the feet that swing.
    pub swing: Robot,
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
    /// The force of each row in the rows of a foot in the axes of the world, the same number for each foot:
    /// (x, z) and torque about y, or in space all six.
    pub columns: Vec<Vec<f64>>,
    /// Accelerations of multipliers that carry the weight, for guesses.
    pub lift: Vec<f64>,
}

/// A list with an entry for each joint, with the legs exchanged.
pub(crate) fn exchanged(exchange: &[(usize, f64)], list: &[f64]) -> Vec<f64> {
    exchange.iter().map(|&(from, sign)| sign * list[from]).collect()
}

impl Walk {
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
