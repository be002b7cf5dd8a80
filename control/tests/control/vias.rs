//! Motions through vias: given and free times, payloads that change there, ends that follow the start.
//!
//! The values are those of `bash benches/ocp/run --values in_phases` (`benches/ocp/harness/in_phases.py`):
//! direct collocation on Radau's points with the state (q, v) and the equations of the two-link arm written
//! out, in CasADi with IPOPT, the times of phases among the unknowns, from a guess that leads to the local
//! minimum that is found here. Elements of four points are split until the cost changes by less than a
//! relative 1e-9. With costs of jerks the state is (q, v, a), and the control the jerk.

use costate::robot::{Friction, Robot};
use costate_control::{
    BoundaryState, FinalTime, MotionLimits, Objective, Payload, PolishOutcome, Problem, Solution, Solver,
    SolverOptions, Status, Task, Tool, ToolPose, Via,
};
use std::f64::consts::{FRAC_PI_2, PI};

const PLACE: [f64; 2] = [1.0, 0.2];

/// The unit two-link arm with a quarter turn of both joints in 1 s, least squared torques.
fn arm() -> Problem {
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0).with_limits(MotionLimits::none())
}

/// With a second that costs so much, and a free time.
fn timed(problem: Problem, cost: f64, guess: f64) -> Problem {
    let effort = problem.cost.effort.clone();
    problem.with_time(FinalTime::Free { guess }).with_cost(Objective::new(cost, effort))
}

/// 1 kg at the tip.
fn tip() -> Payload {
    Payload::point("joint:elbow", 1.0, [1.0, 0.0, 0.0])
}

fn solve(problem: &Problem) -> Solution {
    Solver::new(problem, SolverOptions::default().with_tolerance(1e-6)).unwrap().solve()
}

/// Solved with this cost and these times of vias, driven to the end by its torques.
fn check(solution: &Solution, value: f64, vias: &[f64], part: f64) {
    let (cost, times) = (solution.total(), &solution.trajectory.via_times);
    assert_eq!(solution.motion.status, Status::Converged, "{cost}");
    assert!((cost / value - 1.0).abs() < part, "{cost} instead of {value}");
    // The cost is flat around the best times.
    let close = times.iter().zip(vias).all(|(found, expected)| (found - expected).abs() < 0.3 * part.sqrt());
    assert!(close && times.len() == vias.len(), "{times:?} instead of {vias:?}");
    assert!(solution.end_defect < 1e-3, "{}", solution.end_defect);
}

/// H* is that of the phase before after each via with a free time.
fn same_hamiltonians(solution: &Solution, part: f64) {
    let values = &solution.motion.phase_hamiltonians;
    let size = solution.total() / solution.motion.final_time;
    assert!(values.iter().all(|value| (value - values[0]).abs() < part * size), "{values:?} {size}");
}

#[test]
fn a_via_at_a_given_time() {
    let solution = solve(&arm().with_via(Via::at(&PLACE).with_time(0.5)));
    check(&solution, 709.837029, &[0.5], 1e-6);
    let [before, after] = solution.motion.phase_hamiltonians[..] else { panic!() };
    assert!((before - after).abs() > 10.0, "an earlier or later via costs less: {before} {after}");
    let at = solution.trajectory.at(0.5).unwrap();
    assert!(at.q.iter().zip(PLACE).all(|(q, place)| (q - place).abs() < 1e-12), "{:?}", at.q);
    assert_eq!(solution.polish.unwrap().outcome, PolishOutcome::Phases);
}

#[test]
fn a_via_at_any_time() {
    let solution = solve(&arm().with_via(Via::at(&PLACE)));
    check(&solution, 683.075598, &[0.5353498], 1e-6);
    same_hamiltonians(&solution, 1e-3);
    // The path of the best motion without vias, which turns the shoulder by 1 rad on its way.
    let free = solve(&arm());
    let passing = solve(&arm().with_via(Via::at(&[1.0, 2.0]).with_q_free(&[1])));
    check(&passing, free.total(), &[0.7066422], 1e-6);
}

#[test]
fn the_robot_stops_at_a_via() {
    let solution = solve(&arm().with_via(Via::at(&PLACE).stopping()));
    check(&solution, 1763.83704, &[0.5208382], 1e-6);
    same_hamiltonians(&solution, 1e-3);
    let at = solution.trajectory.at(solution.trajectory.via_times[0]).unwrap();
    assert!(at.v.iter().all(|v| v.abs() < 1e-12), "{:?}", at.v);
    // The same as two motions of their own.
    let time = solution.trajectory.via_times[0];
    let robot = arm().robot;
    let first = solve(
        &Problem::rest_to_rest(robot.clone(), &[0.0; 2], &PLACE, time).with_limits(MotionLimits::none()),
    );
    let second = solve(
        &Problem::rest_to_rest(robot, &PLACE, &[FRAC_PI_2; 2], 1.0 - time).with_limits(MotionLimits::none()),
    );
    let sum = first.total() + second.total();
    assert!((sum / solution.total() - 1.0).abs() < 1e-5, "{sum} {}", solution.total());
}

#[test]
fn what_is_carried_counts_from_the_via_on() {
    let pick = timed(arm(), 20.0, 3.0).with_via(Via::at(&PLACE).stopping().with_payload(tip()));
    let solution = solve(&pick);
    check(&solution, 119.2922484, &[2.1005849], 1e-6);
    same_hamiltonians(&solution, 1e-3);
    assert!((solution.motion.final_time - 4.4734593).abs() < 1e-3);

    let back = BoundaryState::fixed(&[0.0; 2], &[0.0; 2]);
    let place = Via::at(&[FRAC_PI_2; 2]).stopping().without_payload();
    let solution = solve(&pick.with_via(place).with_end(back));
    check(&solution, 176.89347, &[2.1005849, 4.4734593], 1e-6);
    assert!((solution.motion.final_time - 6.6335051).abs() < 1e-3);
}

#[test]
fn limits_of_torques_hold_with_the_payload() {
    let problem = arm().with_cost(Objective::new(0.0, vec![0.01; 2]));
    let limits = MotionLimits::none().with_torque_max(vec![5.0; 2]);
    let problem = timed(problem, 1.0, 3.0).with_limits(limits);
    let solution = solve(&problem.with_via(Via::at(&PLACE).stopping().with_payload(tip())));
    check(&solution, 4.283254, &[1.68694], 3e-6);
    same_hamiltonians(&solution, 2e-3);
    assert!(solution.limits.torque.unwrap().at_points < 1e-6);
}

#[test]
fn a_given_time_and_rate_of_one_joint() {
    let via = Via::at(&PLACE).with_v(&[1.0, 0.0]).with_v_free(&[1]).with_time(0.6);
    let solution = solve(&timed(arm(), 20.0, 2.0).with_via(via));
    check(&solution, 406.59564, &[0.6], 3e-6);
    let at = solution.trajectory.at(0.6).unwrap();
    assert!((at.v[0] - 1.0).abs() < 1e-12 && (at.v[1] - 1.42239).abs() < 1e-3, "{:?}", at.v);
}

#[test]
fn a_tool_at_a_via() {
    let tool = Tool::new("joint:elbow").with_offset([1.0, 0.0, 0.0]);
    let ((s, c), (s_2, c_2)) = (PLACE[0].sin_cos(), (PLACE[0] + PLACE[1]).sin_cos());
    let pose = ToolPose::of(tool).with_position([c + c_2, s + s_2, f64::INFINITY]);
    // The position decides both joints, on the branch of the guess. A dearer minimum than in
    // `a_via_at_any_time`, whose motion passes there too: the elbow first bends the other way.
    let via = Via::at(&[0.9, 0.3]).with_q_free(&[0, 1]).with_tool(pose);
    check(&solve(&arm().with_via(via)), 824.610145, &[0.5263784], 1e-6);
    assert!(Task::default().is_empty());
}

#[test]
fn vias_of_motions_without_jumps_of_accelerations() {
    let cost = |time: f64| Objective::new(time, vec![1.0; 2]).with_jerk(vec![1e-3, 2e-3]);
    let solution = solve(&arm().with_cost(cost(0.0)).with_via(Via::at(&PLACE)));
    check(&solution, JERK_VIA.0, &[JERK_VIA.1], 1e-5);
    let pick = timed(arm(), 20.0, 3.0).with_cost(cost(20.0));
    let solution = solve(&pick.with_via(Via::at(&PLACE).stopping().with_payload(tip())));
    check(&solution, JERK_PICK.0, &[JERK_PICK.1], 1e-5);
}

/// Cost and time of the via.
const JERK_VIA: (f64, f64) = (993.712714, 0.5491794);
const JERK_PICK: (f64, f64) = (124.83957, 2.276433);

#[test]
fn a_cycle_ends_where_it_began() {
    let start = BoundaryState::fixed(&[-0.8, 2.0], &[0.0; 2]).with_q_free(&[1]);
    let problem = arm().with_time(FinalTime::Fixed(2.0)).with_start(start).with_period(vec![0.0; 2]);
    let solution = solve(&problem.with_via(Via::at(&PLACE).with_payload(tip())));
    check(&solution, CYCLE.0, &[CYCLE.1], 1e-6);
    let (q, v) = (&solution.trajectory.q, &solution.trajectory.v);
    let last = q.len() - 1;
    assert!((q[0][1] - CYCLE.2).abs() < 1e-3 && q[0][0] == -0.8, "{:?}", q[0]);
    assert!((q[0][1] - q[last][1]).abs() < 1e-12 && v[0] == v[last]);
}

/// Cost, time of the via, and the position of the elbow at the start.
const CYCLE: (f64, f64, f64) = (68.300997, 0.8732841, 2.7045956);

#[test]
fn a_pendulum_turns_against_friction() {
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    let friction = Friction { viscous: 0.5, coulomb: 0.0, coulomb_velocity: 1.0 };
    let robot = robot.with_friction("pivot", friction).unwrap();
    let start = BoundaryState::fixed(&[-PI], &[0.0]).with_v_free(&[0]);
    let problem =
        Problem::rest_to_rest(robot, &[-PI], &[PI], 2.0).with_start(start).with_period(vec![2.0 * PI]);
    let solution = solve(&problem);
    check(&solution, 3.29039479, &[], 1e-6);
    let trajectory = &solution.trajectory;
    let last = trajectory.t.len() - 1;
    assert!((trajectory.v[0][0] - 1.09770715).abs() < 1e-4 && trajectory.v[0] == trajectory.v[last]);
    assert!((trajectory.q[last][0] - PI).abs() < 1e-12);
    // What another rate at the start costs at the start, it gains at the end.
    let costates = [0, last].map(|k| trajectory.y_p[k][0]);
    assert!((costates[0] - costates[1]).abs() < 1e-4, "{costates:?}");
}
