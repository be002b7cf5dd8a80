//! What limits give, in the words of the user.

use super::named::{Coordinates, excess, joint, kind, name, rate, torque_limit, unit};
use crate::constants::elastic;
use crate::direct::interior::elastic::Given;
use crate::direct::interior::iterate::Interior;
use crate::direct::points::values::PointDynamics;
use crate::problem::Problem;
use crate::result::infeasibility::{Infeasibility, RelaxedLimit};

/// What the limits of an elastic iterate give, or at least what a proof says: the limit that it is about
/// comes first.
pub(crate) fn with_proof(problem: &Problem, found: Option<Infeasibility>) -> Option<Infeasibility> {
    let Some(short) = problem.too_short() else { return found };
    let limit = || {
        let joint = problem.robot.independent_joints().nth(short.joint)?;
        let (kind, unit) = short.kind(joint.kind);
        let ends = problem.ends();
        let forward = ends.last()?.q[short.joint] >= ends.first()?.q[short.joint];
        Some(RelaxedLimit {
            kind: kind.into(),
            name: joint.name.clone(),
            side: if forward { "max" } else { "min" }.into(),
            time: 0.0,
            amount: short.amount,
            part: 0.5 * short.amount / short.limit,
            unit: unit.into(),
            limit: Some(if forward { short.limit } else { -short.limit }),
            rate: None,
            no_load_speed: None,
        })
    };
    let mut found = found.unwrap_or_default();
    if let Some(own) = limit() {
        let is_own = |limit: &RelaxedLimit| limit.name == own.name && limit.kind == own.kind;
        match found.limits.iter().position(is_own) {
            Some(at) => found.limits[..=at].rotate_right(1),
            None => found.limits.insert(0, own),
        }
    }
    found.is_global = true;
    found.proof = Some(short.proof(problem));
    found.least_time = Some(short.needed);
    Some(found)
}

/// What the limits of an elastic iterate give.
pub(crate) fn relaxed<D: PointDynamics>(problem: &Problem, interior: &Interior<D>) -> Infeasibility {
    let mut given = interior.given();
    given.sort_by(|a, b| b.part.total_cmp(&a.part));
    let least = given.first().map_or(0.0, |first| elastic::NOTICED_RELIEF * first.part.max(0.0));
    given.retain(|given| given.part > least);
    let coordinates = Coordinates::of(problem);
    let limits = given.iter().map(|given| limit(problem, interior, given, &coordinates)).collect();
    // No proof, linear limits or not: between the points of a mesh other motions keep more.
    Infeasibility { limits, ..Infeasibility::default() }
}

fn limit<D: PointDynamics>(
    problem: &Problem,
    interior: &Interior<D>,
    given: &Given,
    coordinates: &Coordinates,
) -> RelaxedLimit {
    let side = interior.barrier.numbered(given.side);
    let rate = interior.barrier.point_of(given.at).and_then(|p| rate(interior, side, interior.points.z(p)));
    RelaxedLimit {
        kind: kind(interior, side, None, coordinates).into(),
        name: name(interior, side, None, coordinates).into(),
        side: match (side.is_half, side.sign > 0.0) {
            (true, _) => "equal",
            (_, true) => "min",
            (_, false) => "max",
        }
        .into(),
        time: interior.spline.time_at(interior.barrier.place(given.at, &interior.spline)),
        amount: excess(interior, side, None, -given.amount, coordinates),
        part: given.part,
        unit: unit(interior, side, None, coordinates).into(),
        limit: (!side.limited.is_task()).then_some(torque_limit(side, rate).unwrap_or(side.bound)),
        rate: rate.map(|(rate, _)| rate),
        no_load_speed: rate.and(joint(interior, side)).map(|joint| problem.joint_limits()[joint].speeds[1]),
    }
}
