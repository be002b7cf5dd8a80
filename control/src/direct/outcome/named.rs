//! What sides of limits are called, and their units.

use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::problem::Problem;
use crate::result::limit_use::ALL_JOINTS;
use crate::task::row::Subject;
use costate::robot::JointKind;

/// Names and kinds of all coordinates, of which the first ones are joints, and the others multipliers.
pub(in crate::direct) struct Coordinates {
    names: Vec<String>,
    kinds: Vec<JointKind>,
    joints: usize,
    /// Forces are the accelerations of multipliers times these.
    masses: Vec<f64>,
    /// Which of them are torques.
    turns: Vec<bool>,
}

impl Coordinates {
    pub fn of(problem: &Problem) -> Self {
        let (names, kinds) = problem.named_coordinates();
        let rows = problem.loops.iter().flat_map(|loops| &loops.rows);
        let walk = problem.loops.iter().find_map(|loops| loops.walk.as_ref());
        let turns =
            walk.map_or(Vec::new(), |walk| (0..rows.clone().count()).map(|row| walk.is_angle(row)).collect());
        Self { names, kinds, joints: problem.robot.dof(), masses: rows.map(|row| row.mass).collect(), turns }
    }

    /// What the value of a side is multiplied with: the mass of a multiplier gives a force in N.
    pub fn factor(&self, side: &Side) -> f64 {
        let own = side.joint.checked_sub(self.joints).filter(|_| self.subject(side) != Subject::Task);
        own.and_then(|row| self.masses.get(row)).copied().unwrap_or(1.0)
    }

    /// Whether a multiplier is a torque about a foot.
    fn is_torque(&self, side: &Side) -> bool {
        side.joint.checked_sub(self.joints).is_some_and(|row| self.turns.get(row) == Some(&true))
    }

    /// Forces of the ground and their impulses are accelerations and rates of coordinates that are no joints;
    /// of all else, rows of tasks too, `Task`.
    fn subject(&self, side: &Side) -> Subject {
        match side.limited {
            Limited::Acceleration if side.joint >= self.joints => Subject::GroundForce,
            Limited::Rate if side.joint >= self.joints => Subject::LandingImpulse,
            _ => Subject::Task,
        }
    }
}

/// What a side is about, those of rows of tasks too.
pub(in crate::direct) fn subject<D>(
    interior: &Interior<D>,
    side: &Side,
    end: Option<usize>,
    coordinates: &Coordinates,
) -> Subject {
    match side.limited.is_task() {
        true => interior.model.tasks.row(end, side).subject,
        false => coordinates.subject(side),
    }
}

/// What a side limits, as in reports.
pub(in crate::direct) fn kind<D>(
    interior: &Interior<D>,
    side: &Side,
    end: Option<usize>,
    coordinates: &Coordinates,
) -> &'static str {
    match subject(interior, side, end, coordinates) {
        Subject::GroundForce => "ground_force",
        Subject::LandingImpulse => "landing_impulse",
        Subject::Task => side.limited.name(),
    }
}

/// The name of a joint, of all, or of a row at an end or along the motion.
pub(in crate::direct) fn name<'a, D>(
    interior: &'a Interior<D>,
    side: &Side,
    end: Option<usize>,
    coordinates: &'a Coordinates,
) -> &'a str {
    if side.limited.is_task() {
        return &interior.model.tasks.row(end, side).name;
    }
    joint(interior, side).map_or(ALL_JOINTS, |joint| &coordinates.names[joint])
}

/// The joint of a side that is not a row of a task; `None` for all.
pub(in crate::direct) fn joint<D>(interior: &Interior<D>, side: &Side) -> Option<usize> {
    match side.limited {
        Limited::Power | Limited::TorqueSpeed => interior.model.powers.joint(side.joint),
        _ => Some(side.joint),
    }
}

/// Where the torque of a motor is limited by its rate: the rate at z = (q, v, a), and what is to be taken
/// from value and bound to get a torque and its limit at this rate.
pub(in crate::direct) fn rate<D>(interior: &Interior<D>, side: &Side, z: &[f64]) -> Option<(f64, f64)> {
    let n = interior.points.dof;
    let joint = joint(interior, side).filter(|_| side.limited == Limited::TorqueSpeed)?;
    Some((z[n + joint], interior.model.powers.line(side.joint, &z[n..2 * n])))
}

/// The limit of a torque at a [`rate`]; 0 beyond the no-load speed, where the motor has none.
pub(in crate::direct) fn torque_limit(side: &Side, rate: Option<(f64, f64)>) -> Option<f64> {
    let limit = side.bound - rate?.1;
    Some(if side.sign * limit < 0.0 { limit } else { 0.0 })
}

/// The unit of a limit.
pub(in crate::direct) fn unit<D>(
    interior: &Interior<D>,
    side: &Side,
    end: Option<usize>,
    coordinates: &Coordinates,
) -> &'static str {
    let turns = usize::from(coordinates.is_torque(side));
    // Rows of tasks are no coordinates.
    let kind = || joint(interior, side).map(|i| coordinates.kinds[i]);
    let of = |[rotation, translation]: [&'static str; 2]| match kind() {
        Some(JointKind::Prismatic) => translation,
        _ => rotation,
    };
    match side.limited {
        Limited::Rate if coordinates.subject(side) != Subject::Task => ["N s", "N m s"][turns],
        Limited::Acceleration if coordinates.subject(side) != Subject::Task => ["N", "N m"][turns],
        Limited::Position => of(["rad", "m"]),
        Limited::Rate => of(["rad/s", "m/s"]),
        Limited::Acceleration => of(["rad/s^2", "m/s^2"]),
        Limited::Torque | Limited::TorqueSpeed => of(["N m", "N"]),
        Limited::Jerk => of(["rad/s^3", "m/s^3"]),
        Limited::TorqueRate => of(["N m/s", "N/s"]),
        Limited::Power => "W",
        Limited::Task | Limited::ToolAcceleration => interior.model.tasks.row(end, side).unit,
    }
}

/// By how much a limit is exceeded at a distance, in its unit.
pub(in crate::direct) fn excess<D>(
    interior: &Interior<D>,
    side: &Side,
    end: Option<usize>,
    distance: f64,
    coordinates: &Coordinates,
) -> f64 {
    if side.limited.is_task() {
        interior.model.tasks.row(end, side).excess(side.bound + side.sign * distance)
    } else {
        (-distance).max(0.0) * coordinates.factor(side)
    }
}
