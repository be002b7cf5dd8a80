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
    let (spline, barrier) = (&interior.spline, &interior.barrier);
    let sides = barrier.sides();
    let mut found: Option<LimitUse> = None;
    let mut worst = VIOLATION_ACCEPTED;
    for (i, side) in sides.iter().enumerate().filter(|(_, side)| side.limited == limited) {
        let usage = found.get_or_insert_default();
        let between = resolution.distances().iter().skip(i).step_by(sides.len());
        usage.between = between.fold(usage.between, |most, d| most.max(-d));
        // The given ends are within the limits; the problem was checked.
        for at in (0..barrier.count()).filter(|&at| barrier.side_index(at) == i) {
            let distance = barrier.distance[at];
            if barrier.slack[at].is_infinite() {
                continue;
            }
            usage.at_points = usage.at_points.max(-distance);
            let part = -distance / side.range;
            if part > worst {
                worst = part;
                usage.worst = Some(LimitViolation {
                    joint: names[side.joint].clone(),
                    time: barrier.place(at, spline) * spline.time,
                    value: side.bound + side.sign * distance,
                    limit: side.bound,
                });
            }
        }
        usage.active.extend(spans(interior, i, side, &names[side.joint]));
    }
    found
}

/// The spans in which a side is active.
fn spans<D>(interior: &Interior<D>, i: usize, side: &Side, joint: &str) -> Vec<ActiveLimit> {
    let (spline, barrier) = (&interior.spline, &interior.barrier);
    let name = if side.sign > 0.0 { "min" } else { "max" };
    let mut spans: Vec<ActiveLimit> = Vec::new();
    let mut open = false;
    for p in 0..spline.mesh.points() {
        let t = spline.mesh.point(p).0 * spline.time;
        let active = barrier.distance[barrier.at_point(p)][i] <= ACTIVE * side.range;
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
