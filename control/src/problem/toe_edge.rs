//! A sole in space that stands on the edge of its toe.
//!
//! The foot behind rolls about the edge: both of its corners keep x and z, and its middle keeps y. These are
//! five rows, linear in places of points, and pitch is what they leave free. So their multipliers are forces
//! of the ground, at both corners along x and z and across the edge as a whole, whatever the pitch is. Forces
//! in the friction pyramids of both corners, f_y of which only the sum matters, add up to all that satisfy
//!
//! ```text
//! |f_x| <= mu f_z at each corner        |f_y| <= mu (f_z + f_z of the other corner)
//! ```
//!
//! and to no others.

use super::gait::{Gait, SoleContact};
use super::wrench_cone::ConeSide;
use costate::robot::{ConstraintRow, ConstraintSpec, Placement};

/// Number of rows.
const ROWS: usize = 5;

/// Rows of the corners along x and z, and of the middle along y.
const X: [usize; 2] = [0, 2];
const Z: [usize; 2] = [1, 3];
const Y: usize = 4;

/// The corners, and on which side they are.
const CORNERS: [(&str, f64); 2] = [("left", 1.0), ("right", -1.0)];

impl Gait {
    /// Whether a foot that stands so does on the edge of its toe.
    pub(crate) fn is_on_edge(&self, contact: SoleContact) -> bool {
        self.is_in_space() && self.sole.is_some() && contact == SoleContact::Toe
    }

    /// The edge of the toe: x (m), and y of its left corner.
    fn edge(&self) -> [f64; 2] {
        [self.sole.map_or(0.0, |[_, toe]| toe), 0.5 * self.sole_width]
    }

    /// The rows that hold the edge of a foot at x and y.
    pub(super) fn held_edge(&self, foot: &str, [x, y]: [f64; 2]) -> Vec<ConstraintSpec> {
        use ConstraintRow::{X, Y, Z};
        let [toe, half] = self.edge();
        let at = |name: String, rows: &[ConstraintRow], side: f64| {
            let placed = |x: f64, y: f64| Placement::from_xyz_rpy([x, y, 0.0], [0.0; 3]);
            ConstraintSpec::rows(name, foot, "world", rows)
                .placed(placed(toe, side * half))
                .to_placed(placed(x + toe, y + side * half))
        };
        let corners =
            CORNERS.map(|(side, sign)| at(format!("{foot} at the {side} of its toe"), &[X, Z], sign));
        corners.into_iter().chain([at(format!("{foot} across its toe"), &[Y], 0.0)]).collect()
    }

    /// The middle of the edge, in whose rows its force is told.
    pub(super) fn told_edge(&self, foot: &str) -> ConstraintSpec {
        let [toe, _] = self.edge();
        ConstraintSpec::pinned(foot, foot, "world").placed(Placement::from_xyz_rpy([toe, 0.0, 0.0], [0.0; 3]))
    }

    /// The edge of a foot that is flat, and that the ground holds as a whole: force and moments about x and z
    /// at its middle.
    pub(super) fn landing_edge(&self, foot: &str) -> ConstraintSpec {
        use ConstraintRow::{TurnX, TurnZ, X, Y, Z};
        let [toe, _] = self.edge();
        ConstraintSpec::rows(foot, foot, "world", &[X, Y, Z, TurnX, TurnZ])
            .placed(Placement::from_xyz_rpy([toe, 0.0, 0.0], [0.0; 3]))
    }

    /// The force of each row.
    pub(super) fn columns_of_edge(&self) -> Vec<Vec<f64>> {
        let mut columns = vec![vec![0.0; 3]; ROWS];
        X.into_iter().for_each(|row| columns[row][0] = 1.0);
        Z.into_iter().for_each(|row| columns[row][2] = 1.0);
        columns[Y][1] = 1.0;
        columns
    }

    /// The moment of the ground about the middle of the edge, in the axes of the world (N m), by the forces
    /// of its rows.
    pub(crate) fn moment_of_edge(&self, forces: &[f64]) -> [f64; 3] {
        let [_, half] = self.edge();
        [half * (forces[Z[0]] - forces[Z[1]]), 0.0, half * (forces[X[1]] - forces[X[0]])]
    }

    /// How much of this each row takes of a foot that bears it: corners take a half.
    pub(super) fn parts_of_edge(&self) -> [f64; ROWS] {
        let mut parts = [0.5; ROWS];
        parts[Y] = 1.0;
        parts
    }

    /// The forces of the rows where the edge bears a weight (N).
    pub(super) fn load_of_edge(&self, weight: f64) -> [f64; ROWS] {
        let mut loads = [0.0; ROWS];
        Z.into_iter().for_each(|row| loads[row] = 0.5 * weight);
        loads
    }

    /// All sides of the cone.
    pub(super) fn cone_of_edge(&self) -> Vec<ConeSide> {
        let mu = self.friction;
        let side = |axis: usize, sign: f64, loads: &[usize], what| {
            let mut by = vec![0.0; ROWS];
            by[axis] = -sign;
            loads.iter().for_each(|load| by[*load] = mu);
            ConeSide::of_foot(by, what)
        };
        vec![
            side(X[0], 1.0, &Z[..1], "friction ahead, left of the toe"),
            side(X[0], -1.0, &Z[..1], "friction back, left of the toe"),
            side(X[1], 1.0, &Z[1..], "friction ahead, right of the toe"),
            side(X[1], -1.0, &Z[1..], "friction back, right of the toe"),
            side(Y, 1.0, &Z, "friction to the left"),
            side(Y, -1.0, &Z, "friction to the right"),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SOLE: [f64; 2] = [-0.05, 0.2];
    const WIDTH: f64 = 0.08;
    const FRICTION: f64 = 0.7;

    fn gait() -> Gait {
        Gait::new(&["a"], &["b"], "x", 0.3)
            .with_friction(FRICTION)
            .in_space(&["y"], 0.2)
            .with_sole(SOLE[0], SOLE[1])
            .with_sole_width(WIDTH)
    }

    /// Forces at both corners are in the cone where each is in its pyramid, for some split of the force
    /// across; force and moment are their sum.
    #[test]
    fn the_cone_is_that_of_both_corners() {
        let (gait, half) = (gait(), 0.5 * WIDTH);
        let mut both = [0, 0];
        for number in 0..400 {
            let some = |i: usize| (1.0 + f64::from(number) * (1.7 + 0.41 * i as f64) + 2.3 * i as f64).sin();
            let loads = [0.9 + some(0), 0.9 + some(1)];
            let ahead = [some(2), some(3)].map(|part| 0.6 * part);
            let across = 1.2 * some(4);
            let rows = [ahead[0], loads[0], ahead[1], loads[1], across];
            let least = gait
                .cone_of_edge()
                .iter()
                .map(|side| side.by.iter().zip(rows).map(|(by, row)| by * row).sum::<f64>())
                .fold(f64::INFINITY, f64::min);
            // All that the corners can take across, in parts of their loads.
            let corner = |i: usize| loads[i] >= 0.0 && ahead[i].abs() <= FRICTION * loads[i];
            let expected = corner(0) && corner(1) && across.abs() <= FRICTION * (loads[0] + loads[1]);
            assert_eq!(least >= 0.0, expected, "{rows:?}: {least}");
            both[usize::from(expected)] += 1;
            // By the arms of the corners from the middle.
            let expected = [half * loads[0] - half * loads[1], 0.0, -half * ahead[0] + half * ahead[1]];
            let found = gait.moment_of_edge(&rows);
            assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{found:?}");
            let columns = gait.columns_of_edge();
            let force =
                [0, 1, 2].map(|axis| columns.iter().zip(rows).map(|(of, row)| of[axis] * row).sum::<f64>());
            assert_eq!(force, [ahead[0] + ahead[1], across, loads[0] + loads[1]]);
        }
        assert!(both[0] > 50 && both[1] > 50, "{both:?}");
    }

    #[test]
    fn other_feet_do_not_stand_on_edges() {
        let (space, mut plane) = (gait(), gait());
        plane.flipped.clear();
        let mut points = gait();
        points.sole = None;
        assert!(space.is_on_edge(SoleContact::Toe) && !space.is_on_edge(SoleContact::Flat));
        assert!(!plane.is_on_edge(SoleContact::Toe) && !points.is_on_edge(SoleContact::Toe));
    }
}
