//! A warning about angles that look like degrees.

use crate::terminal;
use costate::robot::{JointKind, Robot, printable, printable_number};

/// Largest |q| of a revolute joint that passes without a warning (rad): two turns.
const LARGEST_ANGLE: f64 = 4.0 * std::f64::consts::PI;

/// Warns once about a revolute joint far beyond its range.
pub struct UnitCheck<'a> {
    robot: &'a Robot,
    warned: bool,
}

impl<'a> UnitCheck<'a> {
    pub fn new(robot: &'a Robot) -> Self {
        Self { robot, warned: false }
    }

    /// Checks the positions of a line.
    pub fn check(&mut self, line: usize, q: &[f64]) {
        if self.warned {
            return;
        }
        let (free, q) = (self.robot.free_joints(), q.iter().enumerate());
        // Entries of free joints are no angles.
        let is_own =
            |k: usize| free.iter().any(|f| (f.position..f.position + f.kind.positions()).contains(&k));
        let q = q.filter(|(k, _)| !is_own(*k)).map(|(_, q)| q);
        let joints = self.robot.independent_joints().filter(|joint| joint.free.is_none()).zip(q);
        let is_suspicious = |kind, q: f64| kind == JointKind::Revolute && q.abs() > LARGEST_ANGLE;
        if let Some((joint, q)) = { joints }.find(|(joint, q)| is_suspicious(joint.kind, **q)) {
            self.warned = true;
            terminal::warning(format!(
                "line {line}: revolute joint '{}' is at q = {} rad, more than two turns; angles are in radians, not \
                 degrees (said once)",
                printable(&joint.name),
                printable_number(*q)
            ));
        }
    }
}
