//! How the motion that was found uses its limits.

use crate::constants::direct::{ACTIVE, VIOLATION_ACCEPTED, VIOLATION_BETWEEN};
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::POINTS;
use crate::direct::refine::at_ends::AtEnds;
use crate::direct::refine::peak::{self, WITH_ENDS};
use crate::direct::refine::resolution::Resolution;
use crate::problem::Problem;
use crate::result::infeasibility::Infeasibility;
use crate::result::limit_use::{ALL_JOINTS, ActiveLimit, LimitReport, LimitUse, LimitViolation};
use costate::robot::JointKind;

/// The use of all limits, from distances at the points, between them and at the ends of the intervals.
pub(crate) fn report<D>(
    problem: &Problem,
    interior: &Interior<D>,
    resolution: &Resolution,
    ends: &AtEnds,
    infeasible: Option<Infeasibility>,
) -> LimitReport {
    let coordinates = Coordinates::of(problem);
    let of = |what: What| usage(what, &coordinates, interior, (resolution, ends));
    let usage = |limited: Limited| of(What { limited, is_of_ground: false });
    let of_ground = |limited: Limited| of(What { limited, is_of_ground: true });
    LimitReport {
        position: usage(Limited::Position),
        rate: usage(Limited::Rate),
        acceleration: usage(Limited::Acceleration),
        torque: usage(Limited::Torque),
        jerk: usage(Limited::Jerk),
        torque_rate: usage(Limited::TorqueRate),
        power: usage(Limited::Power),
        torque_speed: usage(Limited::TorqueSpeed),
        ground_force: of_ground(Limited::Acceleration),
        landing_impulse: of_ground(Limited::Rate),
        task: usage(Limited::Task),
        infeasible,
    }
}

/// A kind of limits.
#[derive(Clone, Copy)]
struct What {
    limited: Limited,
    is_of_ground: bool,
}

/// Names and kinds of all coordinates, of which the first ones are joints, and the others multipliers.
pub(super) struct Coordinates {
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
    fn factor(&self, side: &Side) -> f64 {
        let own = side.joint.checked_sub(self.joints).filter(|_| self.is_of_ground(side));
        own.and_then(|row| self.masses.get(row)).copied().unwrap_or(1.0)
    }

    /// Whether a multiplier is a torque about a foot.
    fn is_torque(&self, side: &Side) -> bool {
        side.joint.checked_sub(self.joints).is_some_and(|row| self.turns.get(row) == Some(&true))
    }

    /// Whether a side limits a force of the ground or its impulse, which are the acceleration and the rate of
    /// a coordinate that is no joint.
    pub fn is_of_ground(&self, side: &Side) -> bool {
        matches!(side.limited, Limited::Acceleration | Limited::Rate) && side.joint >= self.joints
    }

    fn includes(&self, what: What, side: &Side) -> bool {
        match what.limited {
            Limited::Task => side.limited.is_task(),
            limited => side.limited == limited && self.is_of_ground(side) == what.is_of_ground,
        }
    }

    /// What a side limits, as in reports.
    pub fn kind(&self, side: &Side) -> &'static str {
        match side.limited {
            Limited::Acceleration if self.is_of_ground(side) => "ground_force",
            Limited::Rate if self.is_of_ground(side) => "landing_impulse",
            limited => limited.name(),
        }
    }
}

fn usage<D>(
    what: What,
    coordinates: &Coordinates,
    interior: &Interior<D>,
    (resolution, ends): (&Resolution, &AtEnds),
) -> Option<LimitUse> {
    let (spline, barrier, limited) = (&interior.spline, &interior.barrier, what.limited);
    let is_rate = limited >= Limited::Jerk;
    let (sides, distances) = match is_rate {
        true => (barrier.rate_sides(), [resolution.rate_distances(), ends.rate_distance()]),
        false => (barrier.sides(), [resolution.distances(), &ends.distance]),
    };
    let mut found: Option<LimitUse> = None;
    let (mut worst_between, mut z) = (VIOLATION_BETWEEN, vec![0.0; 3 * spline.dof]);
    let is_this = |side: &Side| coordinates.includes(what, side);
    for (i, side) in sides.iter().enumerate().filter(|(_, side)| is_this(side)) {
        let usage = found.get_or_insert_default();
        for k in 0..spline.mesh.intervals() {
            let (place, distance) = least(side, sides.len(), i, k, distances);
            usage.between = usage.between.max(excess(interior, side, None, distance, coordinates));
            let part = side.violation(distance);
            // Equations that may jump cannot be kept around a jump.
            let counts = !(side.is_equation && side.limited.jumps(spline.mesh.shape));
            if part > worst_between && counts {
                worst_between = part;
                spline.in_interval(k, place, &mut z);
                let s = spline.mesh.nodes[k] + place * spline.mesh.width(k);
                let rate = rate(interior, side, &z);
                let named =
                    (name(interior, side, None, coordinates), unit(interior, side, None, coordinates));
                let excess = excess(interior, side, None, distance, coordinates);
                let factor = coordinates.factor(side);
                usage.worst_between =
                    Some(violation(side, (distance, factor), named, (spline.time_at(s), excess), rate));
            }
        }
        if matches!(limited, Limited::Position | Limited::Rate) {
            usage.between =
                usage.between.max(resolution.exceeded_by(i) * side.range * coordinates.factor(side));
        }
        if !side.is_equation {
            usage.active.extend(spans(interior, i, side, name(interior, side, None, coordinates)));
        }
    }
    let mut worst = VIOLATION_ACCEPTED;
    let on = |is_law: bool| {
        let of_it = move |side: &Side| is_this(side) && side.is_law() == is_law;
        let along = barrier.all_sides().enumerate().filter(move |(_, side)| of_it(side));
        let along = along.flat_map(|(i, _)| barrier.entries_of(i));
        let at_ends = barrier.at_ends().filter(move |&at| of_it(barrier.side(at)));
        along.chain(at_ends).filter(|&at| barrier.is_on(at))
    };
    let part = |at: usize| barrier.side(at).violation(barrier.true_distance(at));
    // What a law of physics is off by is told where no limit is exceeded.
    let exceeds = on(false).any(|at| part(at) > VIOLATION_ACCEPTED);
    // The given ends are within the limits; the problem was checked.
    for at in on(false).chain(on(true).filter(|_| !exceeds)) {
        let (side, distance) = (barrier.side(at), barrier.true_distance(at));
        let end = barrier.side_index(at).is_none().then(|| barrier.end_of(at));
        let usage = found.get_or_insert_default();
        usage.at_points = usage.at_points.max(excess(interior, side, end, distance, coordinates));
        let part = side.violation(distance);
        if part > worst {
            worst = part;
            let rate = barrier.point_of(at).and_then(|p| rate(interior, side, interior.points.z(p)));
            let named = (name(interior, side, end, coordinates), unit(interior, side, end, coordinates));
            let time = spline.time_at(barrier.place(at, spline));
            let (excess, factor) =
                (excess(interior, side, end, distance, coordinates), coordinates.factor(side));
            usage.worst = Some(violation(side, (distance, factor), named, (time, excess), rate));
        }
    }
    found
}

/// Where a side is nearest to its limit in interval `k`, or beyond it, and its distance there: from those
/// between the points and at the ends, of `count` sides.
fn least(side: &Side, count: usize, i: usize, k: usize, [between, ends]: [&[f64]; 2]) -> (f64, f64) {
    let last = WITH_ENDS.len() - 1;
    let at = |at: usize| match at {
        0 => ends[count * 2 * k + i],
        at if at == last => ends[count * (2 * k + 1) + i],
        at => between[count * ((last - 1) * k + at - 1) + i],
    };
    // Distances of bodies have corners; peaks of positions and rates are those of `Excess`.
    if !side.limited.is_largest_at_ends() && side.limited < Limited::Jerk {
        let part = |p: &usize| side.violation(at(*p));
        let worst = (0..=last).max_by(|a, b| part(a).total_cmp(&part(b))).unwrap_or(0);
        return (WITH_ENDS[worst], at(worst));
    }
    let below = peak::least(std::array::from_fn(at));
    if !side.is_equation {
        return below;
    }
    let above = peak::least(std::array::from_fn(|p| -at(p)));
    if above.1 < below.1 { (above.0, -above.1) } else { below }
}

/// Where a limit is exceeded: name and unit, time and excess, and the rate of a motor.
fn violation(
    side: &Side,
    (distance, factor): (f64, f64),
    (name, unit): (&str, &str),
    (time, excess): (f64, f64),
    rate: Option<(f64, f64)>,
) -> LimitViolation {
    LimitViolation {
        name: name.into(),
        time,
        excess,
        unit: unit.into(),
        value: (side.bound + side.sign * distance) * factor - rate.map_or(0.0, |(_, line)| line),
        limit: torque_limit(side, rate).unwrap_or(side.bound),
        rate: rate.map(|(rate, _)| rate),
    }
}

/// The name of a joint, of all, or of a row at an end or along the motion.
pub(super) fn name<'a, D>(
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
pub(super) fn joint<D>(interior: &Interior<D>, side: &Side) -> Option<usize> {
    match side.limited {
        Limited::Power | Limited::TorqueSpeed => interior.model.powers.joint(side.joint),
        _ => Some(side.joint),
    }
}

/// Where the torque of a motor is limited by its rate: the rate at z = (q, v, a), and what is to be taken
/// from value and bound to get a torque and its limit at this rate.
pub(super) fn rate<D>(interior: &Interior<D>, side: &Side, z: &[f64]) -> Option<(f64, f64)> {
    let n = interior.points.dof;
    let joint = joint(interior, side).filter(|_| side.limited == Limited::TorqueSpeed)?;
    Some((z[n + joint], interior.model.powers.line(side.joint, &z[n..2 * n])))
}

/// The limit of a torque at a [`rate`]; 0 beyond the no-load speed, where the motor has none.
pub(super) fn torque_limit(side: &Side, rate: Option<(f64, f64)>) -> Option<f64> {
    let limit = side.bound - rate?.1;
    Some(if side.sign * limit < 0.0 { limit } else { 0.0 })
}

/// The unit of a limit.
pub(super) fn unit<D>(
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
        Limited::Rate if coordinates.is_of_ground(side) => ["N s", "N m s"][turns],
        Limited::Acceleration if coordinates.is_of_ground(side) => ["N", "N m"][turns],
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
pub(super) fn excess<D>(
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

/// The spans in which a side is active.
fn spans<D>(interior: &Interior<D>, i: usize, side: &Side, name: &str) -> Vec<ActiveLimit> {
    let (spline, barrier) = (&interior.spline, &interior.barrier);
    let is_rate = side.limited >= Limited::Jerk;
    // Not where feet do not do what this limits.
    let counts = |interval: usize| !interior.ends.is_absent(spline.mesh.phase(interval), side);
    let places = if is_rate { spline.mesh.gauss_points() } else { spline.mesh.points() };
    let times = (0..places).map(|p| {
        let (entries, s, interval) = match is_rate {
            true => (barrier.at_gauss_point(p), spline.mesh.gauss_point(p).0, p / POINTS),
            false => (barrier.at_point(p), spline.mesh.point(p).0, spline.mesh.interval_of(p).0),
        };
        (spline.time_at(s), counts(interval) && barrier.distance[entries][i] <= ACTIVE * side.range)
    });
    ActiveLimit::spans(name, if side.sign > 0.0 { "min" } else { "max" }, times)
}
