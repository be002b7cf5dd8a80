//! What is minimised, in words.

use crate::figures::time_is_free;
use crate::numbers::short;
use costate_control::{Problem, Reference, Solution, Status};

/// What is minimised: `minimum of T + 1/2 u'Ru + tools, final time free, actuation bounded, limits kept`.
/// Bounds and limits that the motion does not satisfy are left out.
pub fn criterion(problem: &Problem, solution: &Solution) -> String {
    let status = &solution.motion.status;
    let effort = problem.cost.effort.iter().any(|&r| r != 0.0);
    let time = match problem.cost.time {
        0.0 => None,
        1.0 => Some("T".to_owned()),
        weight => Some(format!("{} T", short(weight, 6))),
    };
    let energy = problem.cost.has_energy();
    let costs = |list: &Option<Vec<f64>>| list.as_ref().is_some_and(|list| list.iter().any(|&w| w != 0.0));
    let (rate, jerk) = (costs(&problem.cost.torque_rate), costs(&problem.cost.jerk));
    let tools = &problem.task.tool_costs;
    let tools = tools.iter().any(|cost| cost.position_weight != 0.0 || cost.orientation_weight != 0.0);
    let follows = |tool: fn(&Reference) -> bool| problem.task.references.iter().any(tool);
    let terms = [
        time,
        effort.then(|| "\u{222b} \u{bd} \u{3a3} r\u{1d62} u\u{1d62}\u{b2} dt".to_owned()),
        energy.then(|| "\u{222b} \u{3a3} e\u{1d62} (\u{3c4}\u{1d62} v\u{1d62})\u{207a} dt".to_owned()),
        rate.then(|| "\u{222b} \u{bd} \u{3a3} w\u{1d62} (d\u{3c4}\u{1d62}/dt)\u{b2} dt".to_owned()),
        jerk.then(|| "\u{222b} \u{bd} \u{3a3} w\u{1d62} (da\u{1d62}/dt)\u{b2} dt".to_owned()),
        tools.then(|| "costs of tools".to_owned()),
        follows(|reference| matches!(reference, Reference::Joints(_)))
            .then(|| "distance of joints to references".into()),
        follows(|reference| matches!(reference, Reference::Tool(_)))
            .then(|| "distance of tools to references".into()),
        (!problem.terms.is_empty()).then(|| "user terms".to_owned()),
    ];
    let terms: Vec<_> = terms.into_iter().flatten().collect();
    let minimum = match terms.is_empty() {
        true => "motion without a cost".into(),
        false => format!("minimum of {}", terms.join(" + ")),
    };
    let time = if time_is_free(problem) { "final time free" } else { "final time fixed" };
    let exceeded = status.exceeds_limits() || *status == Status::BoundsNotReached;
    let within_bounds = problem.bounds.is_some() && !exceeded;
    let bounds = if within_bounds { ", actuation bounded" } else { "" };
    let penalty = if problem.penalty.is_some() { ", with penalties" } else { "" };
    let at_points = !solution.limits.is_empty() && solution.limits.violations().next().is_none();
    let limits = match (solution.limits.are_kept(), at_points) {
        (true, _) => ", limits kept",
        (false, true) => ", limits kept at points, exceeded between them",
        (false, false) => "",
    };
    format!("{minimum}, {time}{bounds}{penalty}{limits}")
}

#[cfg(test)]
mod tests {
    use super::criterion;
    use costate::robot::Robot;
    use costate_control::{
        JointReference, Objective, Problem, Solver, SolverOptions, Task, ToolCost, ToolPose,
    };

    #[test]
    fn every_part_of_the_cost_is_named() {
        let robot = Robot::from_file("../../robots/two_link.toml").unwrap();
        let plain = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0; 2], 1.0);
        let solution = Solver::new(&plain, SolverOptions::default()).unwrap().solve();
        let pose = ToolPose::of("joint:elbow").with_position([0.0, 1.0, f64::INFINITY]);
        let tool = Task::default().with_tool_cost(ToolCost::new(pose, 1.0, 0.0));
        let free = plain.clone().with_cost(Objective::new(0.0, vec![0.0; 2]));
        assert!(criterion(&free, &solution).starts_with("motion without a cost"));
        let words = criterion(&free.with_task(tool.clone()), &solution);
        assert!(words.starts_with("minimum of costs of tools, final time fixed"), "{words}");
        let joints = JointReference::new(vec![0.0, 1.0], vec![vec![0.0; 2], vec![1.0; 2]], vec![1.0; 2]);
        let words = criterion(&plain.clone().with_task(tool.with_reference(joints)), &solution);
        assert!(
            words.contains("u\u{1d62}\u{b2} dt + costs of tools + distance of joints to references"),
            "{words}"
        );
        assert!(!criterion(&plain, &solution).contains("tools"));
    }
}
