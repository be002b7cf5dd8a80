//! The rows that hold the feet of a gait: points, or soles that stand flat.
//!
//! The forces of the ground on heel and toe, each in its friction cone, add up to a force (f_x, f_z) and a
//! torque. All that they can be is a cone with four sides,
//!
//! ```text
//! |f_x| <= mu f_z        0 <= heel's share of f_z        0 <= toe's share of f_z
//! ```
//!
//! A sole has three rows: the toe along both edges d_1, d_2 of its friction cone, as a point foot, and the
//! angle. With the multipliers a_1, a_2, a_3 the force is `a_1 d_1 + a_2 d_2` and a_3 the torque about the
//! toe, which is the heel's share times the length of the sole. So three sides of the cone are limits of
//! single multipliers, and the fourth is linear: the toe's share is f_z less that of the heel.
//!
//! A sole on its toe alone has the first two rows: the toe is pinned as a point foot, and the foot rolls
//! about it.
//!
//! In space the rows of a foot are those of its pose in the axes of the world, three of a point and six of a
//! sole, and all sides of the cone are linear ([`super::wrench_cone`]).

use super::gait::{Gait, SoleContact};
use costate::robot::{ConstraintRow, ConstraintSpec, Placement};
use std::ops::Range;

/// Part of a name: constraints of a foot that stands.
const EDGES: [(&str, f64); 2] = [("ahead", 1.0), ("back", -1.0)];

impl Gait {
    /// Those of the pose of a foot that are held if it is flat.
    fn rows_of_pose(&self) -> &'static [ConstraintRow] {
        use ConstraintRow::{TurnY, X, Y, Z};
        match (self.is_in_space(), self.sole.is_some()) {
            (false, false) => &[X, Z],
            (false, true) => &[X, Z, TurnY],
            (true, false) => &[X, Y, Z],
            (true, true) => &ConstraintRow::ALL,
        }
    }

    /// Whether a row of a foot that stands so is an angle.
    pub(crate) fn is_angle(&self, contact: SoleContact, row: usize) -> bool {
        !self.is_on_edge(contact) && row >= if self.is_in_space() { 3 } else { 2 }
    }

    /// The rows of a flat foot, or a point, whose sum is zero at the start: of the first foot its place, of
    /// others their heights, in space y too, and angles of both.
    pub(crate) fn places_of_foot(&self, foot: usize) -> Vec<Range<usize>> {
        let heights: &[[usize; 2]] = if self.is_in_space() { &[[1, 2], [2, 3]] } else { &[[0, 2]] };
        let all = 0..self.rows_of_pose().len();
        let angles = all.clone().filter(|row| self.is_angle(SoleContact::Flat, *row));
        let angles = angles.map(|row| row..row + 1);
        match foot {
            0 => all.map(|row| row..row + 1).collect(),
            _ => heights.iter().map(|&[from, to]| from..to).chain(angles).collect(),
        }
    }

    /// Force of the ground (N, N s) by the [rows](Self::placed) of a foot.
    pub(crate) fn force_of(&self, foot: &[f64]) -> [f64; 3] {
        if self.is_in_space() { [foot[0], foot[1], foot[2]] } else { [foot[0], 0.0, foot[1]] }
    }

    /// x and y of the points of a foot that touch the ground, in its frame: heel and toe, or its origin; in
    /// space the corners of the sole.
    pub(crate) fn corners(&self) -> Vec<[f64; 2]> {
        let sides = if self.is_in_space() { vec![0.5, -0.5] } else { vec![0.0] };
        let at = |x: f64| sides.iter().map(move |side| [x, side * self.sole_width]);
        self.sole.map_or(vec![[0.0; 2]], |sole| sole.into_iter().flat_map(at).collect())
    }

    /// What a point of a foot is called.
    pub(crate) fn name_of_corner(&self, foot: &str, corner: usize) -> String {
        let names: &[&str] = match (self.sole.is_some(), self.is_in_space()) {
            (true, true) => &["left of the heel", "right of the heel", "left of the toe", "right of the toe"],
            (true, false) => &["heel", "toe"],
            (false, _) => &[],
        };
        names.get(corner).map_or_else(|| format!("'{foot}'"), |name| format!("the {name} of '{foot}'"))
    }

    /// The points of a foot that do not move while it stands so.
    pub(crate) fn resting_corners(&self, contact: SoleContact) -> Vec<bool> {
        let corners = self.corners();
        let toe = corners.iter().map(|[x, _]| *x).fold(f64::NEG_INFINITY, f64::max);
        corners.iter().map(|[x, _]| contact == SoleContact::Flat || *x == toe).collect()
    }

    /// The rows of a foot that stands at x and y. In the plane forces are in their cone where multipliers are
    /// positive, and the [load of the toe](Self::load_of_toe) of a flat sole too; in space all sides are in
    /// [`cone`](Self::cone).
    pub(super) fn held(&self, foot: &str, [x, y]: [f64; 2], contact: SoleContact) -> Vec<ConstraintSpec> {
        if self.is_on_edge(contact) {
            return self.held_edge(foot, [x, y]);
        }
        if self.is_in_space() {
            return vec![self.placed(foot, foot, [x, y, 0.0])];
        }
        let (angle, toe) = (self.friction.atan(), self.sole.map_or(0.0, |[_, toe]| toe));
        let edge = |(name, sign): (&str, f64)| {
            let name = format!("{foot} pushed {name}");
            let edge = ConstraintSpec::rows(name, foot, "world", &[ConstraintRow::Z])
                .to_placed(Placement::from_xyz_rpy([x + toe, 0.0, 0.0], [0.0, sign * angle, 0.0]));
            self.at_corner(edge, [toe, 0.0])
        };
        let turn = ConstraintSpec::rows(format!("{foot} turned"), foot, "world", &[ConstraintRow::TurnY]);
        let flat = self.sole.filter(|_| contact == SoleContact::Flat);
        EDGES.into_iter().map(edge).chain(flat.map(|_| turn)).collect()
    }

    /// The rows of a foot in which its force is told: those of its pose, or x and z of its toe if it stands
    /// on that alone, y too of an edge.
    pub(super) fn told(&self, foot: &str, contact: SoleContact) -> ConstraintSpec {
        match (self.sole, contact) {
            _ if self.is_on_edge(contact) => self.told_edge(foot),
            (Some([_, toe]), SoleContact::Toe) => {
                let rows = [ConstraintRow::X, ConstraintRow::Z];
                self.at_corner(ConstraintSpec::rows(foot, foot, "world", &rows), [toe, 0.0])
            }
            _ => self.placed(foot, foot, [0.0; 3]),
        }
    }

    /// The rows of a foot that the ground holds when others land: all that hold it, so many.
    pub(super) fn at_landing(&self, foot: &str, contact: SoleContact) -> ConstraintSpec {
        match self.is_on_edge(contact) {
            true => self.landing_edge(foot),
            false => self.told(foot, contact),
        }
    }

    /// Of each of the rows of [`held`](Self::held) those of [`told`](Self::told): force (f_x, f_z) and torque
    /// about the origin of the foot, of which a toe has the first two; in space all six, of an edge the
    /// force.
    pub(super) fn columns(&self, contact: SoleContact) -> Vec<Vec<f64>> {
        if self.is_on_edge(contact) {
            return self.columns_of_edge();
        }
        if self.is_in_space() {
            let rows = self.rows_of_pose().len();
            return (0..rows).map(|i| (0..rows).map(|j| f64::from(u8::from(i == j))).collect()).collect();
        }
        let (angle, toe) = (self.friction.atan(), self.sole.map_or(0.0, |[_, toe]| toe));
        let edge = |(_, sign): (&str, f64)| vec![sign * angle.sin(), angle.cos(), -toe * angle.cos()];
        EDGES.into_iter().map(edge).chain(self.sole.map(|_| vec![0.0, 0.0, 1.0])).collect()
    }

    /// The vertical force on the toe in the plane, by the multipliers of these rows; none of a point.
    pub(crate) fn load_of_toe(&self) -> Option<[f64; 3]> {
        let ([heel, toe], cos) = (self.sole?, self.friction.atan().cos());
        Some([cos, cos, -1.0 / (toe - heel)])
    }

    /// A foot on the ground at x and y, or in the air above it: x and z of its frame, y in space, and flat if
    /// it is a sole.
    pub(crate) fn placed(&self, name: &str, foot: &str, place: [f64; 3]) -> ConstraintSpec {
        ConstraintSpec::rows(name, foot, "world", self.rows_of_pose())
            .to_placed(Placement::from_xyz_rpy(place, [0.0; 3]))
    }

    /// x and z of a point of a foot.
    pub(super) fn corner(&self, foot: &str, number: usize, at: [f64; 2]) -> ConstraintSpec {
        let name = format!("{foot} {number}");
        let rows = [ConstraintRow::X, ConstraintRow::Z];
        self.at_corner(ConstraintSpec::rows(name, foot, "world", &rows), at)
    }

    /// A constraint at a point of a foot.
    fn at_corner(&self, constraint: ConstraintSpec, [x, y]: [f64; 2]) -> ConstraintSpec {
        match self.sole {
            Some(_) => constraint.placed(Placement::from_xyz_rpy([x, y, 0.0], [0.0; 3])),
            None => constraint,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Forces on heel and toe within their friction cones have positive multipliers, and no others have.
    #[test]
    fn the_cone_is_that_of_heel_and_toe() {
        let ([heel, toe], friction) = ([-0.1, 0.2], 0.5);
        let gait = Gait::new(&["a"], &["b"], "x", 0.3).with_sole(heel, toe).with_friction(friction);
        let (columns, load) = (gait.columns(SoleContact::Flat), gait.load_of_toe().unwrap());
        let edges = nalgebra::Matrix3::from_fn(|i, j| columns[j][i]);
        let inverse = edges.try_inverse().unwrap();
        // Both vertical forces, and the horizontal one in parts of the friction.
        for [of_heel, of_toe, part] in [
            [2.0, 3.0, 0.9],
            [2.0, 3.0, -0.9],
            [0.1, 5.0, 0.0],
            [5.0, 0.1, 0.0],
            [2.0, 3.0, 1.1],
            [2.0, 3.0, -1.1],
        ] {
            for [heel_sign, toe_sign] in [[1.0, 1.0], [-0.01, 1.0], [1.0, -0.01]] {
                let (on_heel, on_toe): (f64, f64) = (heel_sign * of_heel, toe_sign * of_toe);
                let force = [part * friction * (on_heel + on_toe), on_heel + on_toe];
                let torque = -heel * on_heel - toe * on_toe;
                let a = inverse * nalgebra::Vector3::new(force[0], force[1], torque);
                let found: f64 = load.iter().zip(a.iter()).map(|(load, a)| load * a).sum();
                assert!((found - on_toe).abs() < 1e-12, "{found} {on_toe}");
                let expected = part.abs() <= 1.0 && on_heel >= 0.0 && on_toe >= 0.0;
                assert_eq!(a.iter().all(|a| *a >= 0.0) && found >= 0.0, expected, "{a} {found}");
            }
        }
    }
}
