//! How the motion that was found uses its limits.

use super::interior::Interior;
use super::limits::{Limited, Side};
use super::refine::Resolution;
use crate::constants::direct::{ACTIVE, VIOLATION_ACCEPTED};
use crate::problem::Problem;
use crate::result::limit_use::{ActiveLimit, LimitReport, LimitUse, LimitViolation};
use crate::result::solution::RobotNames;

/// The use of all limits, from distances at and between the points.
pub(super) fn report<D>(problem: &Problem, interior: &Interior<D>, resolution: &Resolution) -> LimitReport {
    let names = RobotNames::of(&problem.robot).joints;
    let usage = |limited: Limited| usage(limited, &names, interior, resolution);
    LimitReport {
        position: usage(Limited::Position),
        rate: usage(Limited::Rate),
        acceleration: usage(Limited::Acceleration),
        torque: usage(Limited::Torque),
    }
}

fn usage<D>(
    limited: Limited,
    names: &[String],
    interior: &Interior<D>,
    resolution: &Resolution,
) -> Option<LimitUse> {
    let sides = &interior.barrier.sides;
    let mut found: Option<LimitUse> = None;
    for (i, side) in sides.iter().enumerate().filter(|(_, side)| side.limited == limited) {
        let usage = found.get_or_insert_default();
        let largest = |distances: &[f64]| {
            distances.iter().skip(i).step_by(sides.len()).fold(0.0_f64, |most, d| most.max(-d))
        };
        // The given ends are within the limits; the problem was checked.
        for p in 0..interior.spline.points() {
            let at = sides.len() * p + i;
            let distance = interior.barrier.distance[at];
            if interior.barrier.slack[at].is_infinite() || -distance <= usage.at_points {
                continue;
            }
            usage.at_points = -distance;
            if -distance > VIOLATION_ACCEPTED * side.range {
                usage.worst = Some(LimitViolation {
                    joint: names[side.joint].clone(),
                    time: interior.spline.point(p).0 * interior.spline.time,
                    value: side.bound + side.sign * distance,
                    limit: side.bound,
                });
            }
        }
        usage.between = usage.between.max(largest(resolution.distances()));
        usage.active.extend(spans(interior, i, side, &names[side.joint]));
    }
    found
}

/// The spans in which a side is active.
fn spans<D>(interior: &Interior<D>, i: usize, side: &Side, joint: &str) -> Vec<ActiveLimit> {
    let sides = interior.barrier.sides.len();
    let name = if side.sign > 0.0 { "min" } else { "max" };
    let mut spans: Vec<ActiveLimit> = Vec::new();
    let mut open = false;
    for p in 0..interior.spline.points() {
        let t = interior.spline.point(p).0 * interior.spline.time;
        let at = sides * p + i;
        let active =
            interior.barrier.slack[at].is_finite() && interior.barrier.distance[at] <= ACTIVE * side.range;
        match spans.last_mut().filter(|_| open && active) {
            Some(span) => span.to = t,
            None if active => {
                spans.push(ActiveLimit { joint: joint.into(), side: name.into(), from: t, to: t })
            }
            None => {}
        }
        open = active;
    }
    spans
}
