//! Magnitudes of the terms of kinematic quantities, for the tolerances of their properties.

use crate::random_robot::Case;
use crate::rounding::{OPERATIONS, terms};
use costate::robot::{JointKind, Robot};

/// Sums of magnitudes over all joints of a robot at a state; no term of a kinematic quantity is larger than
/// their products, whatever is left of the sum.
#[derive(Clone, Copy, Debug)]
pub struct Reach {
    joints: usize,
    /// No point of a link is farther from the origin of the world (m); at least 1, for directions.
    pub length: f64,
    /// What one derivative by q multiplies by: the sum of all `|dq_joint/dq|`.
    pub turn: f64,
    /// The sum of all rates of joints, and of their accelerations.
    pub rate: f64,
    pub acceleration: f64,
    /// Mass of all links (kg).
    pub mass: f64,
}

impl Reach {
    /// At (q, v, a) of a robot without floating and spherical joints, with frames up to `tool` (m) from the
    /// joints that carry them.
    pub fn new(robot: &Robot, [q, v, a]: [&[f64]; 3], tool: f64) -> Self {
        let ratios: Vec<f64> =
            robot.joints().iter().map(|joint| joint.mimic.map_or(1.0, |mimic| mimic.ratio)).collect();
        let indices = robot.independent_indices();
        let of = |x: &[f64], joint: usize| {
            let master = robot.joints()[joint].mimic.map_or(joint, |mimic| mimic.joint);
            indices.iter().position(|&i| i == master).map_or(0.0, |k| (ratios[joint] * x[k]).abs())
        };
        let sum = |x: &[f64]| (0..ratios.len()).map(|joint| of(x, joint)).sum::<f64>();
        let positions = robot.joint_positions(q).unwrap();
        let links = robot.joints().iter().zip(&positions).map(|(joint, position)| {
            let slide = if joint.kind == JointKind::Prismatic { position.abs() } else { 0.0 };
            joint.placement.translation.norm() + slide
        });
        let com = robot.joints().iter().map(|joint| joint.inertia.com.norm()).fold(0.0, f64::max);
        Self {
            joints: ratios.len(),
            length: 1.0 + links.sum::<f64>() + tool.max(com),
            turn: ratios.iter().map(|ratio| ratio.abs()).sum(),
            rate: sum(v),
            acceleration: sum(a),
            mass: robot.joints().iter().map(|joint| joint.inertia.mass).sum(),
        }
    }

    /// Of a case with a = u and a frame within 1 m of its joint.
    pub fn of_case(robot: &Robot, case: &Case) -> Self {
        Self::new(robot, [&case.q, &case.v, &case.u], 1.0)
    }

    /// Bound of the rounding errors of two results: of a position or direction of a frame and its derivatives
    /// of this order by q.
    pub fn position(&self, order: i32) -> f64 {
        self.terms(self.length * self.turn.max(1.0).powi(order))
    }

    /// The same of a velocity, by q and v.
    pub fn velocity(&self, order: i32) -> f64 {
        self.terms(self.length * self.turn.max(1.0).powi(order + 1) * self.rate.max(1.0))
    }

    /// The same of an acceleration, by q, v and a; a derivative by v takes one of two factors of a
    /// centripetal term.
    pub fn acceleration(&self, order: i32) -> f64 {
        let rates = 2.0 * (self.acceleration + self.rate * self.rate).max(1.0);
        self.terms(self.length * self.turn.max(1.0).powi(order + 2) * rates)
    }

    /// `2 u operations |size|`, the operations of all joints.
    fn terms(&self, size: f64) -> f64 {
        terms(OPERATIONS * self.joints, &[size])
    }
}

/// `sum |w|`, at least 1: what weights multiply by.
pub fn weights(w: &[f64]) -> f64 {
    w.iter().map(|w| w.abs()).sum::<f64>().max(1.0)
}
