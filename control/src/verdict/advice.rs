//! What helps where the direct method did not get there: it depends on what costs, and on the robot.

use super::light_joints::{too_fast, with_narrow_friction, with_rotor, without_rotors};
use super::numbers::{scientific, short};
use crate::options::{Method, Verify};
use crate::problem::Problem;
use crate::result::solution::Solution;
use crate::result::verification::Verification;
use crate::status::Status;

/// Errors of the cost below this, and below so many times the tolerance, miss a tolerance that is finer than
/// the last one by little.
const NEARLY: f64 = 1e-5;
const NEARER: f64 = 1e3;
const FINE: f64 = 1e-6;
/// Meshes with an error of the cost above this do not resolve the motion.
const UNRESOLVED: f64 = 0.1;
/// A larger tolerance helps where the error is below so many times the tolerance.
const NEAR_TOLERANCE: f64 = 100.0;
/// A cost of torques that may cost more than this, relative to the cost, does not solve least time.
const SMOOTHED: f64 = 1e-2;

/// The reason of a status with what helps this problem; `None` where what the status says is all.
pub(super) fn advice(problem: &Problem, solution: &Solution) -> Option<String> {
    let status = &solution.motion.status;
    let hard = matches!(
        status,
        Status::NotVerified | Status::MeshLimit | Status::IterationLimit | Status::NewtonFailed
    );
    if !hard {
        return None;
    }
    if solution.options.method != Method::Direct {
        return amplified(solution).or_else(|| unverified_extremal(solution));
    }
    if let Some(reason) = empty_phase(problem, solution).or_else(|| nearly(solution)) {
        return Some(reason);
    }
    let verified = solution.verified.as_ref().filter(|verified| verified.failure().is_some());
    let failed = verified.filter(|_| *status == Status::NotVerified);
    if let Some(verified) = failed.filter(|verified| !verified.dynamics.fails()) {
        return Some(unverified(verified));
    }
    let energy = problem.cost.has_energy();
    let jumps = jumps(problem);
    let mut remedies = Vec::new();
    if jumps {
        let beside = if energy { "cost.energy" } else { "cost.time" };
        remedies.push(format!("a little cost.effort beside {beside}"));
    }
    if energy {
        remedies.push("a larger cost.energy_smoothing".into());
    }
    let is_coarse = *status == Status::MeshLimit && error(solution) > UNRESOLVED;
    // Fast motions of what is nearly without inertia are behind the others too.
    let fast = solution.fastest_joint(problem).ok().flatten();
    let others = !(is_coarse || *status == Status::NewtonFailed);
    // Rotors do not help robots that fly or turn freely: their method has no trouble with light joints.
    let is_free = !problem.robot.free_joints().is_empty();
    let light = match &fast {
        Some(fast) => with_rotor(problem, fast),
        None if is_free => None,
        None if passes_through(problem, solution) => Some(
            "a [[via]] beside the obstacle that bodies pass through between points: it is thin for the intervals of the mesh"
                .into(),
        ),
        None if with_narrow_friction(problem, solution).is_some() => with_narrow_friction(problem, solution),
        None => without_rotors(problem)
            .filter(|_| jumps || energy || others)
            .map(|joints| format!("robot.armature (rotor inertia; {joints} without)")),
    };
    remedies.extend(light);
    match status {
        Status::NotVerified => remedies.push("a smaller solver.tolerance".into()),
        _ if is_free && (is_coarse || *status != Status::MeshLimit) => {
            remedies.push("another start (solver.starts), another time (time.final)".into())
        }
        Status::MeshLimit if is_coarse => {
            remedies.push("another start (solver.starts), more solver.nodes, another time".into());
        }
        Status::MeshLimit if jumps || energy => {}
        // What the mesh does not see is no part of the error.
        Status::MeshLimit if with_narrow_friction(problem, solution).is_some() => {}
        Status::MeshLimit if error(solution) < NEAR_TOLERANCE * solution.options.tolerance => {
            remedies.push("a larger solver.tolerance".into());
        }
        Status::MeshLimit => remedies.push("another start (solver.starts)".into()),
        _ if remedies.is_empty() => return None,
        _ => {}
    }
    let reason = match status {
        Status::MeshLimit => unresolved(solution),
        Status::NotVerified if solution.motion.verification == Verify::Factors => {
            "the equations are solved, but between its points the motion needs more torque than its limits, which is \
             cut off, than verify = \"factors\" allows (nothing was integrated)"
                .into()
        }
        Status::NotVerified => failed.map_or_else(
            || {
                "the equations are solved, but integrated again with its torques the motion goes elsewhere".into()
            },
            failed_checks,
        ),
        // What a status says has the form "reason; advice for all problems".
        status => status.to_string().split(';').next().unwrap_or_default().to_owned(),
    };
    let cause = fast.map(|fast| format!("; {}", too_fast(problem, &fast))).unwrap_or_default();
    Some(format!("{reason}{cause}; what may help: {}", remedies.join("; ")))
}

/// Which checks of a verification failed, by how much, where.
fn failed_checks(verified: &Verification) -> String {
    let all = verified.reasons().join(" and ");
    format!("the equations are solved, but the motion fails its verification: {all}")
}

/// The same with what helps where torques lead along the motion.
fn unverified(verified: &Verification) -> String {
    let Verification { cost, limits, optimality, .. } = verified;
    let mut remedies = vec!["more solver.nodes".to_owned()];
    if limits.fails() {
        remedies.extend(limits.subject.iter().map(|limit| format!("a wider limit ({limit})")));
    }
    if cost.fails() || optimality.fails() {
        remedies.push("another start (solver.starts)".into());
    }
    format!("{}; what may help: {}", failed_checks(verified), remedies.join("; "))
}

/// Whether limits of a task with obstacles are exceeded between the points of the mesh.
fn passes_through(problem: &Problem, solution: &Solution) -> bool {
    let is_beyond = solution.limits.task.as_ref().is_some_and(|usage| usage.worst_between.is_some());
    is_beyond && !problem.task.obstacles.is_empty()
}

/// The estimated error of the cost, relative to it.
fn error(solution: &Solution) -> f64 {
    solution.motion.errors.first().copied().unwrap_or(f64::INFINITY)
}

/// Why no mesh of the direct method was fine enough.
fn unresolved(solution: &Solution) -> String {
    let Solution { motion, options, .. } = solution;
    let (error, nodes) = (short(error(solution), 2), solution.mesh_nodes());
    if motion.smoothing_bound > SMOOTHED {
        return format!(
            "least time was solved with a cost of torques only, and that may cost {} relative",
            short(motion.smoothing_bound, 2)
        );
    }
    let reached = format!(
        "the error of its cost is estimated at {error} relative and may be larger, solver.tolerance {}",
        options.tolerance
    );
    if !motion.errors.first().is_some_and(|error| *error <= UNRESOLVED) {
        return format!(
            "the meshes that were tried, the last one of {nodes} nodes, do not resolve the motion: {reached}"
        );
    }
    if 2 * nodes > options.max_nodes {
        return format!(
            "the next mesh would have more than the {} nodes that are allowed: {reached}",
            options.max_nodes
        );
    }
    let beyond = match solution.limits.violations_between().next() {
        Some(_) => ", and limits are exceeded between points",
        None => "",
    };
    format!("the search ended with a mesh of {nodes} nodes: {reached}{beyond}")
}

/// That the equations of an indirect method amplify rounding errors too much.
fn amplified(solution: &Solution) -> Option<String> {
    let Solution { motion, .. } = solution;
    let is_it = motion.status == Status::NotVerified && motion.verification == Verify::Factors;
    is_it.then(|| {
        format!(
            "the equations are solved, but they amplify rounding errors by {}, too much for solver.tolerance (nothing \
             was integrated); what may help: a larger solver.tolerance; solver.method = \"direct\"",
            scientific(motion.conditioning)
        )
    })
}

/// Which checks of the verification of an extremal failed.
fn unverified_extremal(solution: &Solution) -> Option<String> {
    let verified = solution.verified.as_ref().filter(|verified| verified.failure().is_some())?;
    (solution.motion.status == Status::NotVerified).then(|| {
        format!(
            "{}; what may help: more solver.nodes; a smaller solver.tolerance; solver.method = \"direct\"",
            failed_checks(verified)
        )
    })
}

/// A phase shorter than this part of the motion goes to zero.
const EMPTY: f64 = 1e-3;

/// That a phase beside a via with a free time goes to zero.
fn empty_phase(problem: &Problem, solution: &Solution) -> Option<String> {
    let (times, last) = (&solution.trajectory.via_times, solution.motion.final_time);
    let ends: Vec<f64> = [&[0.0][..], times, &[last]].concat();
    let phase = ends.windows(2).position(|ends| ends[1] - ends[0] < EMPTY * last)?;
    let place = |end: usize| match end {
        0 => "the start".to_owned(),
        end if end > times.len() => "the end".to_owned(),
        via => format!("via {via}"),
    };
    let is_free = |end: usize| end > 0 && problem.vias.get(end - 1).is_some_and(|via| via.time.is_none());
    let via = [phase, phase + 1].into_iter().find(|&end| is_free(end))?;
    Some(format!(
        "the time between {} and {} goes to zero: as {}'s time is free, it costs least there; give it a time, or what \
         it asks another place (q, tool), or remove it",
        place(phase),
        place(phase + 1),
        place(via)
    ))
}

/// That the cost is known to little less than was asked for.
fn nearly(solution: &Solution) -> Option<String> {
    let (error, tolerance) = (*solution.motion.errors.first()?, solution.options.tolerance);
    let keeps = solution.limits.violations().next().is_none();
    let few = solution.motion.status == Status::MeshLimit && keeps && tolerance < FINE;
    (few && error > tolerance && error < NEARLY.min(NEARER * tolerance)).then(|| {
        let reached = short(1.5 * error, 2);
        format!(
            "its cost is known to {} relative, which is more than solver.tolerance; {reached} is reached: rounding \
             and the nodes that a mesh may have leave no more digits",
            short(error, 2)
        )
    })
}

/// Whether controls jump between their limits, or are not determined by what costs: a joint without effort,
/// and nothing that makes torques continuous.
fn jumps(problem: &Problem) -> bool {
    let (cost, limits) = (&problem.cost, &problem.limits);
    let costs = |list: &Option<Vec<f64>>| list.as_ref().is_some_and(|list| list.iter().any(|&w| w > 0.0));
    let limited = |list: &Option<Vec<f64>>| {
        list.as_ref().is_some_and(|list| list.iter().any(|limit| limit.is_finite()))
    };
    let smooth = costs(&cost.jerk)
        || costs(&cost.torque_rate)
        || limited(&limits.jerk_max)
        || limited(&limits.torque_rate_max);
    (cost.time > 0.0 || cost.has_energy()) && cost.effort.contains(&0.0) && !smooth
}
