//! Units of quantities of joints.

use costate::robot::{Joint, JointKind, Robot};

/// The unit of a quantity for a revolute and for a prismatic joint.
pub type Units = [&'static str; 2];

pub const POSITION: Units = ["rad", "m"];
pub const RATE: Units = ["rad/s", "m/s"];
pub const ACCELERATION: Units = ["rad/s\u{b2}", "m/s\u{b2}"];
pub const MOMENTUM: Units = ["N m s", "N s"];
pub const EFFORT: Units = ["N m", "N"];
pub const FORCE: Units = ["N", "N"];
pub const IMPULSE: Units = ["N s", "N s"];
pub const EFFORT_RATE: Units = ["N m/s", "N/s"];
pub const JERK: Units = ["rad/s\u{b3}", "m/s\u{b3}"];
pub const POWER: Units = ["W", "W"];
pub const POSITION_COSTATE: Units = ["cost/rad", "cost/m"];
pub const MOMENTUM_COSTATE: Units = ["cost/(N m s)", "cost/(N s)"];

/// The unit; both units if the robot has joints of both kinds.
pub fn of_robot(robot: &Robot, [revolute, prismatic]: Units) -> String {
    let has = |kind| robot.independent_joints().any(|joint| joint.kind == kind);
    match (has(JointKind::Revolute), has(JointKind::Prismatic)) {
        (true, true) if revolute != prismatic => format!("{revolute}, {prismatic}"),
        (false, _) => prismatic.into(),
        _ => revolute.into(),
    }
}

/// The unit of the positions: as [`of_robot`], but quaternions have none.
pub fn of_positions(robot: &Robot) -> String {
    let [revolute, prismatic] = POSITION;
    let is_quaternion = |joint: &Joint| joint.free.is_some() && joint.kind == JointKind::Revolute;
    let has = |kind| robot.independent_joints().any(|joint| joint.kind == kind && !is_quaternion(joint));
    let found = [(JointKind::Revolute, revolute), (JointKind::Prismatic, prismatic)];
    let found: Vec<&str> = found.into_iter().filter(|(kind, _)| has(*kind)).map(|(_, unit)| unit).collect();
    found.join(", ")
}

/// The unit of one joint.
pub fn of_joint(kind: JointKind, [revolute, prismatic]: Units) -> &'static str {
    match kind {
        JointKind::Revolute => revolute,
        JointKind::Prismatic => prismatic,
    }
}
