//! How the motion that was found uses its limits.

use crate::constants::direct::{ACTIVE, VIOLATION_ACCEPTED};
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::refine::at_ends::AtEnds;
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
    let (names, kinds) = problem.named_coordinates();
    let usage = |limited: Limited| usage(limited, &names, &kinds, interior, (resolution, ends));
    LimitReport {
        position: usage(Limited::Position),
        rate: usage(Limited::Rate),
        acceleration: usage(Limited::Acceleration),
        torque: usage(Limited::Torque),
        jerk: usage(Limited::Jerk),
        torque_rate: usage(Limited::TorqueRate),
        power: usage(Limited::Power),
        torque_speed: usage(Limited::TorqueSpeed),
        task: usage(Limited::Task),
        infeasible,
    }
}

fn usage<D>(
    limited: Limited,
    names: &[String],
    kinds: &[JointKind],
    interior: &Interior<D>,
    (resolution, ends): (&Resolution, &AtEnds),
) -> Option<LimitUse> {
    let (spline, barrier) = (&interior.spline, &interior.barrier);
    let is_rate = limited >= Limited::Jerk;
    let (sides, distances) = match is_rate {
        true => (barrier.rate_sides(), [resolution.rate_distances(), ends.rate_distance()]),
        false => (barrier.sides(), [resolution.distances(), &ends.distance]),
    };
    let mut found: Option<LimitUse> = None;
    let is_this = |side: &Side| match limited {
        Limited::Task => side.limited.is_task(),
        _ => side.limited == limited,
    };
    for (i, side) in sides.iter().enumerate().filter(|(_, side)| is_this(side)) {
        let usage = found.get_or_insert_default();
        let between = distances.iter().flat_map(|all| all.iter().skip(i).step_by(sides.len()));
        usage.between = between.fold(usage.between, |most, &d| most.max(excess(interior, side, None, d)));
        if matches!(limited, Limited::Position | Limited::Rate) {
            usage.between = usage.between.max(resolution.exceeded_by(i) * side.range);
        }
        if !side.is_equation {
            usage.active.extend(spans(interior, i, side, name(interior, side, None, names)));
        }
    }
    let mut worst = VIOLATION_ACCEPTED;
    // The given ends are within the limits; the problem was checked.
    for at in (0..barrier.count()).filter(|&at| barrier.is_on(at) && is_this(barrier.side(at))) {
        let (side, distance) = (barrier.side(at), barrier.true_distance(at));
        let end = barrier.side_index(at).is_none().then(|| barrier.end_of(at));
        let usage = found.get_or_insert_default();
        usage.at_points = usage.at_points.max(excess(interior, side, end, distance));
        let part = side.violation(distance);
        if part > worst {
            worst = part;
            usage.worst = Some(LimitViolation {
                name: name(interior, side, end, names).into(),
                time: spline.time_at(barrier.place(at, spline)),
                excess: excess(interior, side, end, distance),
                unit: unit(interior, side, end, kinds).into(),
                value: side.bound + side.sign * distance - of_rate(interior, at),
                limit: side.bound - of_rate(interior, at),
            });
        }
    }
    found
}

/// The name of a joint, of all, or of a row at an end or along the motion.
pub(super) fn name<'a, D>(
    interior: &'a Interior<D>,
    side: &Side,
    end: Option<usize>,
    names: &'a [String],
) -> &'a str {
    if side.limited.is_task() {
        return &interior.model.tasks.row(end, side).name;
    }
    joint(interior, side).map_or(ALL_JOINTS, |joint| &names[joint])
}

/// The joint of a side that is not a row of a task; `None` for all.
fn joint<D>(interior: &Interior<D>, side: &Side) -> Option<usize> {
    match side.limited {
        Limited::Power | Limited::TorqueSpeed => interior.model.powers.joint(side.joint),
        _ => Some(side.joint),
    }
}

/// What is to be taken from value and bound of an entry to get a torque and its limit at this rate; zero
/// where the limit does not depend on the rate.
pub(super) fn of_rate<D>(interior: &Interior<D>, at: usize) -> f64 {
    let (side, n) = (interior.barrier.side(at), interior.points.dof);
    match interior.barrier.point_of(at) {
        Some(p) if side.limited == Limited::TorqueSpeed => {
            interior.model.powers.line(side.joint, &interior.points.z(p)[n..2 * n])
        }
        _ => 0.0,
    }
}

/// The unit of a limit.
pub(super) fn unit<D>(
    interior: &Interior<D>,
    side: &Side,
    end: Option<usize>,
    kinds: &[JointKind],
) -> &'static str {
    let of = |[rotation, translation]: [&'static str; 2]| match joint(interior, side).map(|i| kinds[i]) {
        Some(JointKind::Prismatic) => translation,
        _ => rotation,
    };
    match side.limited {
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
pub(super) fn excess<D>(interior: &Interior<D>, side: &Side, end: Option<usize>, distance: f64) -> f64 {
    if side.limited.is_task() {
        interior.model.tasks.row(end, side).excess(side.bound + side.sign * distance)
    } else {
        (-distance).max(0.0)
    }
}

/// The spans in which a side is active.
fn spans<D>(interior: &Interior<D>, i: usize, side: &Side, name: &str) -> Vec<ActiveLimit> {
    let (spline, barrier) = (&interior.spline, &interior.barrier);
    let is_rate = side.limited >= Limited::Jerk;
    let places = if is_rate { spline.mesh.gauss_points() } else { spline.mesh.points() };
    let times = (0..places).map(|p| {
        let (entries, s) = match is_rate {
            true => (barrier.at_gauss_point(p), spline.mesh.gauss_point(p).0),
            false => (barrier.at_point(p), spline.mesh.point(p).0),
        };
        (spline.time_at(s), barrier.distance[entries][i] <= ACTIVE * side.range)
    });
    ActiveLimit::spans(name, if side.sign > 0.0 { "min" } else { "max" }, times)
}
