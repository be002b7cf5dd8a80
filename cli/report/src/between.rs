//! What a motion does between its points, in words.

use crate::numbers::short;
use crate::text::{is_polished, of_ground, quantity, whose};
use costate_control::{LimitViolation, Solution};

/// Torques that are cut by less than this part of their limit are not worth a remark.
const SEEN: f64 = 0.01;

/// Which limits are kept at the points of a motion and exceeded between them, where most, by how much.
pub fn exceeded_between(solution: &Solution) -> Option<String> {
    let at_points = solution.limits.violations().next().is_none();
    let all: Vec<String> = solution
        .limits
        .violations_between()
        .map(|(kind, worst)| {
            let (by, unit, time) = (short(worst.excess, 2), &worst.unit, short(worst.time, 4));
            match (kind, of_ground(kind)) {
                ("task", _) => format!("the {} is off by {by} {unit} at t = {time} s", worst.name),
                (_, Some(what)) => {
                    let name = &worst.name;
                    format!("{what} is {by} {unit} beyond its friction cone, as '{name}', at t = {time} s")
                }
                (kind, None) => format!(
                    "the {} of {} is beyond its limit by {by} {unit} at t = {time} s",
                    quantity(kind),
                    whose(&worst.name)
                ),
            }
        })
        .collect();
    (at_points && !all.is_empty()).then(|| {
        format!("between its points the motion does not keep all limits: {}; set these limits lower by that where it matters", all.join("; "))
    })
}

/// Which torque is cut to its limit between the points of a motion, where most, by how much, and what that
/// means; only where it is a part of the limit that one sees.
pub fn cut_between(solution: &Solution) -> Option<String> {
    let exceeds = solution.motion.status.exceeds_limits();
    let worst = solution.limits.worst_cut().filter(|_| !is_polished(solution) && !exceeds)?;
    let LimitViolation { name, time, excess, unit, limit, .. } = worst;
    (*excess > SEEN * limit.abs()).then(|| {
        format!(
            "between its points the torque of joint '{name}' jumps at t = {} s, where the polynomial is beyond \
             the limit by {} {unit}: torques are cut to their limits there, in --sample too; a smaller tolerance \
             makes that less, and so does --polish, where nothing but torques is at a limit",
            short(*time, 4),
            short(*excess, 2)
        )
    })
}
