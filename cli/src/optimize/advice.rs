//! What helps where the direct method did not get there: it depends on what costs, and on the robot.

use costate::robot::printable;
use costate_control::{Method, Problem, Solution, Status};

/// Most joints in a sentence.
const MOST_JOINTS: usize = 3;

/// The reason of a status with what helps this problem; `None` where what the status says is all.
pub fn advice(problem: &Problem, solution: &Solution) -> Option<String> {
    let status = &solution.motion.status;
    let hard = matches!(
        status,
        Status::NotVerified | Status::MeshLimit | Status::IterationLimit | Status::NewtonFailed
    );
    if !hard || solution.options.method != Method::Direct {
        return None;
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
    // Fast motions of what is nearly without inertia are behind the others too.
    let light = without_rotors(problem).filter(|_| jumps || energy || *status != Status::NewtonFailed);
    remedies
        .extend(light.map(|joints| format!("robot.armature, the inertia of rotors, which {joints} without")));
    match status {
        Status::NotVerified => remedies.push("--feedback to replay the motion".into()),
        _ if remedies.is_empty() => return None,
        Status::MeshLimit if !jumps && !energy => remedies.push("a larger solver.tolerance".into()),
        _ => {}
    }
    // What a status says has the form "reason; advice for all problems".
    let text = status.to_string();
    let reason = text.split(';').next().unwrap_or_default();
    Some(format!("{reason}; what may help: {}", remedies.join("; ")))
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

/// The joints without inertia of a rotor: "all joints are", "'a' and 'b' are".
fn without_rotors(problem: &Problem) -> Option<String> {
    let robot = &problem.robot;
    let has_none = |&&i: &&usize| robot.armature_entry(i, i) == 0.0;
    let all = robot.independent_indices();
    let light: Vec<usize> = all.iter().filter(has_none).copied().collect();
    let names: Vec<String> = light
        .iter()
        .take(MOST_JOINTS)
        .map(|&i| format!("'{}'", printable(&robot.joints()[i].name)))
        .collect();
    match light.len() {
        0 => None,
        count if count == all.len() => Some("all joints are".into()),
        1 => Some(format!("joint {} is", names.concat())),
        count if count > MOST_JOINTS => {
            Some(format!("joints {} and {} more are", names.join(", "), count - MOST_JOINTS))
        }
        _ => Some(format!("joints {} are", names.join(", "))),
    }
}
