//! The cone of what the ground can give to a foot, as linear rows.
//!
//! The friction cone of a point is taken as a pyramid with sides across x and y, `|f_x| <= mu f_z` and
//! `|f_y| <= mu f_z`. Forces in the pyramids of all four corners of a rectangle with the half lengths X and Y
//! add up to the wrenches whose force and moment (about the middle of the rectangle) satisfy
//!
//! ```text
//! |f_x| <= mu f_z    |f_y| <= mu f_z    |m_x| <= Y f_z    |m_y| <= X f_z
//! m_z >= -mu (X + Y) f_z + |Y f_x - mu m_x| + |X f_y - mu m_y|
//! m_z <=  mu (X + Y) f_z - |Y f_x + mu m_x| - |X f_y + mu m_y|
//! ```
//!
//! and to no others: S. Caron, Q.-C. Pham, Y. Nakamura, "Stability of surface contacts for humanoid robots:
//! closed-form formulae of the contact wrench cone for rectangular support areas", IEEE International
//! Conference on Robotics and Automation (2015) 5107-5112. The second pair of the first line is that the
//! centre of pressure is in the rectangle, the last ones are that the foot does not turn.

use super::gait::{Gait, SoleContact};

/// Both signs.
const SIGNS: [f64; 2] = [1.0, -1.0];

/// A linear row of the multipliers of a foot that is not negative in its cone.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ConeSide {
    /// By each of them, times a force or a moment.
    pub by: Vec<f64>,
    /// Of a moment, that which weight gives with this arm (m).
    pub length: Option<f64>,
    what: What,
}

/// What a side limits.
#[derive(Clone, Copy, Debug, PartialEq)]
enum What {
    /// The load of a corner.
    Corner(&'static str),
    /// Anything else of the whole foot.
    Foot(&'static str),
}

impl ConeSide {
    /// A force on a foot that is limited so.
    pub(super) fn of_foot(by: Vec<f64>, what: &'static str) -> Self {
        Self { by, length: None, what: What::Foot(what) }
    }

    /// The foot, and what about it, as a force or an impulse of the ground.
    pub fn name_on(&self, foot: &str) -> String {
        match self.what {
            What::Corner(corner) => format!("{foot} on its {corner}"),
            What::Foot(what) => format!("{foot} ({what})"),
        }
    }
}

impl Gait {
    /// The sides of the cone of a foot that stands so which are not limits of single multipliers: the load of
    /// the toe of a flat sole in the plane, and in space all of them.
    pub(crate) fn cone(&self, contact: SoleContact) -> Vec<ConeSide> {
        if self.is_on_edge(contact) {
            return self.cone_of_edge();
        }
        if self.is_in_space() {
            return self.sole.map_or_else(|| self.friction_pyramid(3), |sole| self.wrench_cone(sole));
        }
        let of_toe = |load: [f64; 3]| ConeSide { by: load.to_vec(), length: None, what: What::Corner("toe") };
        let load = self.load_of_toe().filter(|_| contact == SoleContact::Flat);
        load.map(of_toe).into_iter().collect()
    }

    /// `mu f_z - |f_x|` and `mu f_z - |f_y|` of so many multipliers, of which the first three are the force.
    fn friction_pyramid(&self, count: usize) -> Vec<ConeSide> {
        let names = [["friction ahead", "friction back"], ["friction to the left", "friction to the right"]];
        let side = |axis: usize, at: usize| {
            let mut by = vec![0.0; count];
            (by[axis], by[2]) = (-SIGNS[at], self.friction);
            ConeSide::of_foot(by, names[axis][at])
        };
        (0..2).flat_map(|axis| (0..2).map(move |at| side(axis, at))).collect()
    }

    /// All sides of the cone of a sole from heel to toe, by force and moment about the origin of the foot.
    fn wrench_cone(&self, [heel, toe]: [f64; 2]) -> Vec<ConeSide> {
        let (mu, middle) = (self.friction, 0.5 * (heel + toe));
        let [x, y] = [0.5 * (toe - heel), 0.5 * self.sole_width];
        // About the middle m_y is larger by `middle f_z`, and m_z smaller by `middle f_y`.
        let side = |what, length: f64, [f_x, f_y, f_z, m_x, m_y, m_z]: [f64; 6]| ConeSide {
            by: vec![f_x, f_y - middle * m_z, f_z + middle * m_y, m_x, m_y, m_z],
            length: Some(length),
            what: What::Foot(what),
        };
        let mut sides = self.friction_pyramid(6);
        for (sign, [across, along]) in SIGNS.into_iter().zip([
            ["pressure to the left", "pressure behind"],
            ["pressure to the right", "pressure in front"],
        ]) {
            sides.push(side(across, y, [0.0, 0.0, y, -sign, 0.0, 0.0]));
            sides.push(side(along, x, [0.0, 0.0, x, 0.0, -sign, 0.0]));
        }
        for (turn, what) in SIGNS.into_iter().zip(["turning to the left", "turning to the right"]) {
            for a in SIGNS {
                for b in SIGNS {
                    let row = [-a * y, -b * x, mu * (x + y), -a * turn * mu, -b * turn * mu, -turn];
                    sides.push(side(what, mu * (x + y), row));
                }
            }
        }
        sides
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::SMatrix;

    const SOLE: [f64; 2] = [-0.05, 0.2];
    const WIDTH: f64 = 0.08;
    const FRICTION: f64 = 0.7;

    fn gait() -> Gait {
        let gait = Gait::new(&["a"], &["b"], "x", 0.3).with_friction(FRICTION).in_space(&["y"], 0.2);
        Gait { sole: Some(SOLE), ..gait }.with_sole_width(WIDTH)
    }

    /// Wrenches about the origin of the foot: the edges of the pyramids at all corners.
    fn generators() -> SMatrix<f64, 6, 16> {
        let corners = SOLE.into_iter().flat_map(|x| SIGNS.map(|side| [x, 0.5 * WIDTH * side]));
        let edges = |[x, y]: [f64; 2]| {
            SIGNS.into_iter().flat_map(move |a| {
                SIGNS.map(|b| {
                    let [f_x, f_y, f_z] = [a * FRICTION, b * FRICTION, 1.0];
                    [f_x, f_y, f_z, y * f_z, -x * f_z, x * f_y - y * f_x]
                })
            })
        };
        let all: Vec<[f64; 6]> = corners.flat_map(edges).collect();
        SMatrix::from_fn(|row, column| all[column][row])
    }

    fn least(wrench: &[f64]) -> f64 {
        let cone = gait().cone(SoleContact::Flat);
        let values = cone.iter().map(|side| side.by.iter().zip(wrench).map(|(by, f)| by * f).sum::<f64>());
        values.fold(f64::INFINITY, f64::min)
    }

    /// The distance of a wrench from the cone of the corners, by coordinate descent over their forces.
    fn distance(wrench: &[f64; 6]) -> f64 {
        let all = generators();
        let (mut forces, mut left) = ([0.0_f64; 16], -SMatrix::<f64, 6, 1>::from_row_slice(wrench));
        for _ in 0..3000 {
            for (i, force) in forces.iter_mut().enumerate() {
                let column = all.column(i);
                let to = (*force - column.dot(&left) / column.norm_squared()).max(0.0);
                left += column * (to - *force);
                *force = to;
            }
        }
        left.norm()
    }

    #[test]
    fn forces_at_the_corners_are_in_the_cone() {
        let cone = gait().cone(SoleContact::Flat);
        assert_eq!(cone.len(), 16);
        for generator in generators().column_iter() {
            assert!(least(generator.as_slice()) > -1e-15, "{generator}");
        }
        // Each row is used: some corner's edge is on it.
        for side in &cone {
            let on = generators()
                .column_iter()
                .filter(|of| side.by.iter().zip(of.iter()).map(|(by, f)| by * f).sum::<f64>().abs() < 1e-12)
                .count();
            assert!(on >= 5, "{side:?}");
        }
    }

    /// Wrenches that are in the cone by a little are sums of forces at the corners, others are not.
    #[test]
    fn nothing_else_is_in_the_cone() {
        let mut both = [0, 0];
        for number in 0..60 {
            let some = |i: usize| (1.0 + f64::from(number) * 1.7 + 2.3 * i as f64).sin();
            let [f_x, f_y, m_x, m_y, m_z] =
                [0.6 * some(0), 0.6 * some(1), 0.04 * some(2), 0.12 * some(3), some(4)];
            let wrench = [f_x, f_y, 1.0, m_x, m_y - 0.075, 0.06 * m_z];
            let (inside, off) = (least(&wrench), distance(&wrench));
            if inside > 1e-3 {
                assert!(off < 2e-4, "{wrench:?}: {off}");
                both[0] += 1;
            } else if inside < -5e-3 {
                assert!(off > 5e-4, "{wrench:?}: {off}");
                both[1] += 1;
            }
        }
        assert!(both[0] > 10 && both[1] > 10, "{both:?}");
    }

    #[test]
    fn sides_are_named() {
        let names: Vec<String> =
            gait().cone(SoleContact::Flat).iter().map(|side| side.name_on("foot")).collect();
        assert_eq!((&*names[0], &*names[5]), ("foot (friction ahead)", "foot (pressure behind)"));
        let planar = Gait::new(&["a"], &["b"], "x", 0.3).with_sole(-0.1, 0.2);
        assert_eq!(planar.cone(SoleContact::Flat)[0].name_on("foot"), "foot on its toe");
    }
}
