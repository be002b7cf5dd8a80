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

use super::gait::Gait;
use costate::robot::{ConstraintRow, ConstraintSpec, Placement};

/// Part of a name: constraints of a foot that stands.
const EDGES: [(&str, f64); 2] = [("ahead", 1.0), ("back", -1.0)];

impl Gait {
    /// Number of rows that hold a foot.
    pub(crate) fn rows_of_foot(&self) -> usize {
        if self.sole.is_some() { 3 } else { 2 }
    }

    /// x of the points of a foot that touch the ground, in its frame: heel and toe, or its origin.
    pub(crate) fn corners(&self) -> Vec<f64> {
        self.sole.map_or(vec![0.0], |sole| sole.to_vec())
    }

    /// What a point of a foot is called.
    pub(crate) fn name_of_corner(&self, foot: &str, corner: usize) -> String {
        match self.sole {
            Some(_) => format!("the {} of '{foot}'", if corner == 0 { "heel" } else { "toe" }),
            None => format!("'{foot}'"),
        }
    }

    /// The rows of a foot that stands at x: multipliers are in the cone where they are positive, and the
    /// [load of the toe](Self::load_of_toe) too.
    pub(super) fn held(&self, foot: &str, x: f64) -> Vec<ConstraintSpec> {
        let (angle, toe) = (self.friction.atan(), self.sole.map_or(0.0, |[_, toe]| toe));
        let edge = |(name, sign): (&str, f64)| {
            let name = format!("{foot} pushed {name}");
            let edge = ConstraintSpec::rows(name, foot, "world", &[ConstraintRow::Z])
                .to_placed(Placement::from_xyz_rpy([x + toe, 0.0, 0.0], [0.0, sign * angle, 0.0]));
            self.at_corner(edge, toe)
        };
        let turn = ConstraintSpec::rows(format!("{foot} turned"), foot, "world", &[ConstraintRow::TurnY]);
        EDGES.into_iter().map(edge).chain(self.sole.map(|_| turn)).collect()
    }

    /// The rows of a foot that stands at x on a point, its toe if it has a sole: the first ones of
    /// [`held`](Self::held).
    pub(super) fn held_at_toe(&self, foot: &str, x: f64) -> Vec<ConstraintSpec> {
        self.held(foot, x).into_iter().take(EDGES.len()).collect()
    }

    /// Force (f_x, f_z) and torque about the origin of the foot of each of the rows of [`held`](Self::held).
    pub(super) fn columns(&self) -> Vec<[f64; 3]> {
        let (angle, toe) = (self.friction.atan(), self.sole.map_or(0.0, |[_, toe]| toe));
        let edge = |(_, sign): (&str, f64)| [sign * angle.sin(), angle.cos(), -toe * angle.cos()];
        EDGES.into_iter().map(edge).chain(self.sole.map(|_| [0.0, 0.0, 1.0])).collect()
    }

    /// The vertical force on the toe, by the multipliers of these rows; none of a point.
    pub(crate) fn load_of_toe(&self) -> Option<[f64; 3]> {
        let ([heel, toe], cos) = (self.sole?, self.friction.atan().cos());
        Some([cos, cos, -1.0 / (toe - heel)])
    }

    /// A foot on the ground at x, or in the air above it: x and z of its frame, and flat if it is a sole.
    pub(crate) fn placed(&self, name: &str, foot: &str, [x, z]: [f64; 2]) -> ConstraintSpec {
        let rows = [ConstraintRow::X, ConstraintRow::Z, ConstraintRow::TurnY];
        ConstraintSpec::rows(name, foot, "world", &rows[..self.rows_of_foot()])
            .to_placed(Placement::from_xyz_rpy([x, 0.0, z], [0.0; 3]))
    }

    /// A foot on the ground at x by its toe, or by its origin if it is a point: x and z of it.
    pub(super) fn placed_at_toe(&self, foot: &str, x: f64) -> ConstraintSpec {
        let (toe, rows) = (self.sole.map_or(0.0, |[_, toe]| toe), [ConstraintRow::X, ConstraintRow::Z]);
        let toes = ConstraintSpec::rows(foot, foot, "world", &rows)
            .to_placed(Placement::from_xyz_rpy([x + toe, 0.0, 0.0], [0.0; 3]));
        self.at_corner(toes, toe)
    }

    /// x and z of a point of a foot.
    pub(super) fn corner(&self, foot: &str, number: usize, x: f64) -> ConstraintSpec {
        let name = format!("{foot} {number}");
        let rows = [ConstraintRow::X, ConstraintRow::Z];
        self.at_corner(ConstraintSpec::rows(name, foot, "world", &rows), x)
    }

    /// A constraint at a point of a foot.
    fn at_corner(&self, constraint: ConstraintSpec, x: f64) -> ConstraintSpec {
        match self.sole {
            Some(_) => constraint.placed(Placement::from_xyz_rpy([x, 0.0, 0.0], [0.0; 3])),
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
        let (columns, load) = (gait.columns(), gait.load_of_toe().unwrap());
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
