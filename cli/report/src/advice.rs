//! What helps where the direct method did not get there: it depends on what costs, and on the robot.

use crate::light_joints::{too_fast, with_rotor, without_rotors};
use crate::numbers::{scientific, short};
use costate_control::{Method, Problem, Solution, Status, Verify};

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
pub fn advice(problem: &Problem, solution: &Solution) -> Option<String> {
    let status = &solution.motion.status;
    let hard = matches!(
        status,
        Status::NotVerified | Status::MeshLimit | Status::IterationLimit | Status::NewtonFailed
    );
    if !hard {
        return None;
    }
    if solution.options.method != Method::Direct {
        return amplified(solution);
    }
    if let Some(reason) = empty_phase(problem, solution).or_else(|| nearly(solution)) {
        return Some(reason);
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
        None => without_rotors(problem)
            .filter(|_| jumps || energy || others)
            .map(|joints| format!("robot.armature (the inertia of rotors: {joints} without)")),
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
        // What a status says has the form "reason; advice for all problems".
        status => status.to_string().split(';').next().unwrap_or_default().to_owned(),
    };
    let cause = fast.map(|fast| format!("; {}", too_fast(problem, &fast))).unwrap_or_default();
    Some(format!("{reason}{cause}; what may help: {}", remedies.join("; ")))
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
    let reached =
        format!("the error of its cost is {error} relative, solver.tolerance {}", options.tolerance);
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
    format!("the search ended with a mesh of {nodes} nodes: {reached}, or limits are exceeded between points")
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

#[cfg(test)]
mod tests {
    use super::advice;
    use costate::robot::{LoadOptions, Robot};
    use costate_control::{
        FinalTime, Objective, Problem, ProblemFile, Solution, Solver, SolverOptions, Status, Verify,
    };

    fn arm(robot: Robot, cost: Objective) -> Problem {
        Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0).with_cost(cost)
    }

    /// With another status.
    fn ended(solution: &Solution, status: Status) -> Solution {
        let mut solution = solution.clone();
        solution.motion.status = status;
        solution
    }

    #[test]
    fn what_helps_depends_on_costs_and_rotors() {
        let light = Robot::from_file("../../robots/two_link.toml").unwrap();
        let heavy = ["shoulder", "elbow"]
            .iter()
            .fold(light.clone(), |robot, joint| robot.with_joint_armature(joint, 0.1).unwrap());
        let effort = || Objective::new(0.0, vec![1.0; 2]);
        let solved = Solver::new(&arm(light.clone(), effort()), SolverOptions::default()).unwrap().solve();
        let told = |robot: &Robot, cost: Objective, status: Status| {
            let problem = arm(robot.clone(), cost).with_time(FinalTime::Free { guess: 1.0 });
            advice(&problem, &ended(&solved, status))
        };
        assert_eq!(told(&light, effort(), Status::Converged), None);
        assert_eq!(told(&heavy, effort(), Status::IterationLimit), None);
        let least_time = told(&heavy, Objective::new(1.0, vec![0.0; 2]), Status::MeshLimit).unwrap();
        assert!(least_time.ends_with("what may help: a little cost.effort beside cost.time"), "{least_time}");
        let energy = Objective::new(0.0, vec![0.0; 2]).with_energy(vec![1.0; 2]);
        let energy = told(&light, energy, Status::IterationLimit).unwrap();
        for part in
            ["beside cost.energy", "cost.energy_smoothing", "robot.armature", "all joints are without"]
        {
            assert!(energy.contains(part), "{energy}");
        }
        let one = light.with_joint_armature("shoulder", 0.1).unwrap();
        let drifts = told(&one, effort(), Status::NotVerified).unwrap();
        assert!(
            drifts.contains("joint 'elbow' is without") && drifts.ends_with("a smaller solver.tolerance")
        );
        let fine = told(&light, effort(), Status::MeshLimit).unwrap();
        assert!(fine.contains("a larger solver.tolerance") && !fine.contains("cost.effort"), "{fine}");
        let mut coarse = ended(&solved, Status::MeshLimit);
        coarse.motion.errors = vec![0.64];
        let coarse = advice(&arm(light.clone(), effort()), &coarse).unwrap();
        assert!(coarse.contains("do not resolve the motion: the error of its cost is 0.64"), "{coarse}");
        assert!(!coarse.contains("larger solver.tolerance") && !coarse.contains("armature"), "{coarse}");
        let file = "../../examples/problems/satellite_arm.toml";
        let satellite = ProblemFile::read(file, LoadOptions::default()).unwrap();
        let turned = Solver::new(&satellite.problem, satellite.options).unwrap().solve();
        for status in [Status::IterationLimit, Status::NewtonFailed] {
            let told = advice(&satellite.problem, &ended(&turned, status)).unwrap();
            assert!(
                told.ends_with("what may help: another start (solver.starts), another time (time.final)"),
                "{told}"
            );
        }
        let mut cut = ended(&solved, Status::NotVerified);
        cut.motion.verification = Verify::Factors;
        let cut = advice(&arm(light, effort()), &cut).unwrap();
        assert!(cut.contains("cut off") && cut.contains("nothing was integrated"), "{cut}");
    }
}
