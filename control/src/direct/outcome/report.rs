//! How the motion that was found uses its limits.

use super::named::{Coordinates, excess, name, rate, subject, torque_limit, unit};
use crate::constants::direct::{ACTIVE, VIOLATION_ACCEPTED, VIOLATION_BETWEEN};
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::motion::shape::{POINTS, Shape};
use crate::direct::refine::at_ends::AtEnds;
use crate::direct::refine::peak::{self, WITH_ENDS};
use crate::direct::refine::resolution::Resolution;
use crate::problem::Problem;
use crate::result::infeasibility::Infeasibility;
use crate::result::limit_use::{ActiveLimit, LimitReport, LimitUse, LimitViolation};
use crate::task::row::Subject;

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
    let usage = |limited: Limited| of(What { limited, subject: Subject::Task });
    let of_ground = |limited: Limited, subject: Subject| of(What { limited, subject });
    LimitReport {
        position: usage(Limited::Position),
        rate: usage(Limited::Rate),
        acceleration: usage(Limited::Acceleration),
        torque: usage(Limited::Torque),
        jerk: usage(Limited::Jerk),
        torque_rate: usage(Limited::TorqueRate),
        power: usage(Limited::Power),
        torque_speed: usage(Limited::TorqueSpeed),
        ground_force: of_ground(Limited::Acceleration, Subject::GroundForce),
        landing_impulse: of_ground(Limited::Rate, Subject::LandingImpulse),
        task: usage(Limited::Task),
        infeasible,
    }
}

/// A kind of limits. What the ground gives is limited as a multiplier or its rate, or in a row of a task.
#[derive(Clone, Copy)]
struct What {
    limited: Limited,
    subject: Subject,
}

fn usage<D>(
    what: What,
    coordinates: &Coordinates,
    interior: &Interior<D>,
    (resolution, ends): (&Resolution, &AtEnds),
) -> Option<LimitUse> {
    let (spline, barrier, limited) = (&interior.spline, &interior.barrier, what.limited);
    let (is_rate, shape) = (limited >= Limited::Jerk, spline.mesh.shape);
    let (sides, distances) = match is_rate {
        true => (barrier.rate_sides(), [resolution.rate_distances(), ends.rate_distance()]),
        false => (barrier.sides(), [resolution.distances(), &ends.distance]),
    };
    let mut found: Option<LimitUse> = None;
    let (mut worst_between, mut z) = (VIOLATION_BETWEEN, vec![0.0; 3 * spline.dof]);
    let is_this = |side: &Side, end: Option<usize>| {
        let subject = subject(interior, side, end, coordinates);
        let is_same = match limited {
            Limited::Task => side.limited.is_task(),
            limited => side.limited == limited,
        };
        subject == what.subject && (subject != Subject::Task || is_same)
    };
    for (i, side) in sides.iter().enumerate().filter(|(_, side)| is_this(side, None)) {
        let usage = found.get_or_insert_default();
        for k in 0..spline.mesh.intervals() {
            let (mut place, mut distance) = least(side, sides.len(), i, k, distances);
            // What is thin lies between these places too.
            let swept = resolution.swept(k);
            if limited == Limited::Task
                && side.limited == limited
                && side.joint == swept.row
                && swept.part > side.violation(distance)
            {
                (place, distance) = (swept.place, -swept.part * side.range);
            }
            usage.between = usage.between.max(excess(interior, side, None, distance, coordinates));
            let part = side.violation(distance);
            // Equations that may jump cannot be kept around a jump.
            let counts = !(side.is_equation && side.limited.jumps(shape));
            if part > worst_between && counts {
                worst_between = part;
                spline.in_interval(k, place, &mut z);
                let s = spline.mesh.nodes[k] + place * spline.mesh.width(k);
                let rate = rate(interior, side, &z);
                let named =
                    (name(interior, side, None, coordinates), unit(interior, side, None, coordinates));
                let excess = excess(interior, side, None, distance, coordinates);
                let factor = coordinates.factor(side);
                usage.worst_between = Some(violation(
                    side,
                    shape,
                    (distance, factor),
                    named,
                    (spline.time_at(s), excess),
                    rate,
                ));
            }
        }
        if matches!(side.limited, Limited::Position | Limited::Rate) {
            usage.between =
                usage.between.max(resolution.exceeded_by(i) * side.range * coordinates.factor(side));
        }
        if !side.is_equation {
            usage.active.extend(spans(interior, i, side, name(interior, side, None, coordinates)));
        }
    }
    let mut worst = VIOLATION_ACCEPTED;
    let end_of = |at: usize| barrier.side_index(at).is_none().then(|| barrier.end_of(at));
    let on = |is_law: bool| {
        let of_it = move |side: &Side, end| is_this(side, end) && side.is_law() == is_law;
        let along = barrier.all_sides().enumerate().filter(move |(_, side)| of_it(side, None));
        let along = along.flat_map(|(i, _)| barrier.entries_of(i));
        let at_ends = barrier.at_ends().filter(move |&at| of_it(barrier.side(at), end_of(at)));
        along.chain(at_ends).filter(|&at| barrier.is_on(at))
    };
    let part = |at: usize| barrier.side(at).violation(barrier.true_distance(at));
    // What a law of physics is off by is told where no limit is exceeded.
    let exceeds = on(false).any(|at| part(at) > VIOLATION_ACCEPTED);
    // The given ends are within the limits; the problem was checked.
    for at in on(false).chain(on(true).filter(|_| !exceeds)) {
        let (side, distance) = (barrier.side(at), barrier.true_distance(at));
        let end = end_of(at);
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
            usage.worst = Some(violation(side, shape, (distance, factor), named, (time, excess), rate));
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
    shape: Shape,
    (distance, factor): (f64, f64),
    (name, unit): (&str, &str),
    (time, excess): (f64, f64),
    rate: Option<(f64, f64)>,
) -> LimitViolation {
    LimitViolation {
        name: name.into(),
        time,
        excess,
        part: side.violation(distance),
        jumps: side.limited.jumps(shape),
        unit: unit.into(),
        value: (side.bound + side.sign * distance) * factor - rate.map_or(0.0, |(_, line)| line),
        limit: torque_limit(side, rate).unwrap_or(side.bound),
        rate: rate.map(|(rate, _)| rate),
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
