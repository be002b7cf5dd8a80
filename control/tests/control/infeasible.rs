//! Problems that cannot be solved: which limit has to give, when, by how much.

use crate::sledge;
use costate::robot::{LoadOptions, Robot};
use costate_control::{
    Bounds, FinalTime, Infeasibility, Keep, Kept, MotionLimits, Objective, Phase, Polish, Problem,
    ProblemFile, RelaxedLimit, Solution, Solver, SolverOptions, Status, Task, Via,
};
use std::f64::consts::{FRAC_PI_2, PI};

const INF: f64 = f64::INFINITY;

fn solve(problem: &Problem) -> Solution {
    Solver::new(problem, SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never))
        .unwrap()
        .solve()
}

/// What a problem lacks. Only what is proven is infeasible, and with a time that is proposed it is solved.
fn lacks(problem: &Problem) -> Infeasibility {
    let solution = solve(problem);
    let found = solution.limits.infeasible.clone().unwrap();
    let status = if found.is_global { Status::Infeasible } else { Status::LocallyInfeasible };
    assert_eq!(solution.motion.status, status, "{:?}", solution.limits);
    assert_eq!(found.proof.is_some(), found.is_global, "{found:?}");
    assert!(!solution.motion.status.is_solved() && solution.trajectory.t.len() > 1);
    let saved: Solution = serde_json::from_value(serde_json::to_value(&solution).unwrap()).unwrap();
    assert_eq!((&saved.limits, saved.motion.status), (&solution.limits, status));
    if let Some(time) = found.final_time {
        let longer = solve(&problem.clone().with_time(FinalTime::Fixed(time)));
        assert!(longer.check(&problem.clone().with_time(FinalTime::Fixed(time))).is_ok(), "{time}");
        // The words show all digits.
        assert!(solution.message(problem).contains(&format!("with a final time of {time} s")), "{time}");
    }
    found
}

/// A metre in a second with a mass of one kilogram.
fn metre(limits: MotionLimits) -> Problem {
    Problem::rest_to_rest(sledge(), &[0.0], &[1.0], 1.0).with_limits(limits)
}

fn only(found: &Infeasibility) -> &RelaxedLimit {
    assert_eq!(found.limits.len(), 1, "{found:?}");
    &found.limits[0]
}

fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found / expected - 1.0).abs() < tolerance, "{found} instead of {expected}");
}

#[test]
fn a_force_that_is_too_small_gives_as_far_as_from_bound_to_bound() {
    // From bound to bound that takes 4 N, or two seconds.
    let found = lacks(&metre(MotionLimits::none().with_torque_max(vec![1.0])));
    let limit = only(&found);
    assert_eq!((&limit.kind[..], &limit.name[..], &limit.unit[..]), ("torque", "x", "N"));
    assert_eq!(limit.limit.map(f64::abs), Some(1.0));
    close(limit.amount, 3.0, 2e-3);
    close(found.final_time.unwrap(), 2.0, 2e-2);
    assert!(found.least_time.is_none() && !found.is_global, "{found:?}");
    // Both sides give alike: 2 / (8 + e) + 2 / (1 + e) = 1.
    let mut braked = metre(MotionLimits::none());
    braked.bounds = Some(Bounds::new(vec![-1.0], vec![8.0]));
    close(only(&lacks(&braked)).amount, 0.5 * (65.0_f64.sqrt() - 5.0), 0.02);
}

/// A polish makes the search rough at first. What is infeasible then is looked at once more from its best
/// motion, not from all starts, which would take twice the steps.
#[test]
fn infeasible_starts_are_not_all_repeated_to_the_tolerance() {
    let problem = metre(MotionLimits::none().with_torque_max(vec![1.0]));
    let steps = |polish: Polish| {
        let options = SolverOptions::default().with_polish(polish).with_starts(4).with_tolerance(1e-8);
        let solution = Solver::new(&problem, options).unwrap().solve();
        assert_eq!((&solution.motion.status, solution.starts.len()), (&Status::LocallyInfeasible, 4));
        solution.newton_iterations as f64
    };
    let (without, with) = (steps(Polish::Never), steps(Polish::Always));
    assert!(with < 1.5 * without, "{with} steps, {without} without a polish");
}

#[test]
fn a_rate_or_an_acceleration_that_is_too_small_is_proven() {
    let found = lacks(&metre(MotionLimits::none().with_a_max(vec![1.0])));
    let limit = only(&found);
    assert_eq!((&limit.kind[..], &limit.name[..], &limit.unit[..]), ("acceleration", "x", "m/s^2"));
    close(limit.amount, 3.0, 2e-3);
    close(found.least_time.unwrap(), 2.0, 1e-9);
    close(found.final_time.unwrap(), 2.0, 2e-2);
    assert!(found.is_global);
    // A quarter turn in a second at no more than 1 rad/s; the way to full speed takes no time.
    let robot = Robot::from_file("../robots/two_link.toml").unwrap();
    let arm = Problem::rest_to_rest(robot, &[0.0; 2], &[FRAC_PI_2; 2], 1.0);
    let found = lacks(&arm.clone().with_limits(MotionLimits::none().with_v_max(vec![1.0, INF])));
    let limit = only(&found);
    assert_eq!((&limit.kind[..], &limit.name[..], &limit.unit[..]), ("rate", "shoulder", "rad/s"));
    assert!(limit.amount > FRAC_PI_2 - 1.0 && limit.amount < 0.62, "{limit:?}");
    assert_eq!((limit.limit, &limit.side[..]), (Some(1.0), "max"));
    close(found.least_time.unwrap(), FRAC_PI_2, 1e-9);
    // A motion that slides for all of its time is not rest to rest.
    assert!(found.final_time.unwrap() > FRAC_PI_2 && found.final_time.unwrap() < 2.0, "{found:?}");
    // Both joints.
    let found = lacks(&arm.with_limits(MotionLimits::none().with_v_max(vec![1.0, 1.2])));
    let names: Vec<_> = found.limits.iter().map(|limit| &limit.name[..]).collect();
    assert_eq!(names, ["shoulder", "elbow"], "{found:?}");
}

/// What splines on a mesh cannot keep is no proof, even where all limits are linear in the motion.
#[test]
fn a_mesh_proves_nothing() {
    // A motion with |a| = 1 that switches once takes exactly a second. On six intervals splines need 1.000631
    // at Gauss's points.
    let mut tight = metre(MotionLimits::none().with_a_max(vec![1.0005]));
    (tight.end.q, tight.end.v) = (vec![0.281677], vec![0.0655]);
    let options = SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never).with_nodes(19);
    let solution = Solver::new(&tight, options).unwrap().solve();
    if let Some(found) = &solution.limits.infeasible {
        assert!(!found.is_global && found.least_time.is_none(), "{found:?}");
    }
    // Against a wall: a joint that has time enough, but starts too fast to stop.
    let mut wall = metre(MotionLimits::none().with_q_max(vec![1.05]).with_a_max(vec![8.0]));
    (wall.start.v, wall.time) = (vec![8.0], FinalTime::Fixed(4.0));
    let found = lacks(&wall);
    assert!(!found.is_global && found.least_time.is_none() && !found.limits.is_empty(), "{found:?}");
}

/// A proof counts even where a motion on a mesh keeps its limits, or where limits do not give.
#[test]
fn a_proof_needs_no_motion() {
    // From bound to bound 4 m/s^2 are enough; on a coarse mesh that is not resolved.
    for lacking in [1e-2, 1e-4, 1e-6] {
        let slow = metre(MotionLimits::none().with_a_max(vec![4.0 * (1.0 - lacking)]));
        let found = lacks(&slow);
        assert!(found.is_global && found.least_time.unwrap() > 1.0 && !found.limits.is_empty(), "{found:?}");
    }
    // Nearly at the end from the start, too fast to stop there.
    let mut near = metre(MotionLimits::none().with_a_max(vec![1.0]));
    (near.end.q, near.start.v) = (vec![1e-3], vec![0.6]);
    assert!(lacks(&near).is_global);
    // The straight way at constant rate is too fast by what counts as kept at points.
    let mut slides = metre(MotionLimits::none().with_v_max(vec![1.0 - 2e-8]));
    (slides.start.v_free, slides.end.v_free) = (vec![0], vec![0]);
    assert!(lacks(&slides).is_global);
    let smooth = metre(MotionLimits::none().with_a_max(vec![1.0]).with_jerk_max(vec![1e4]));
    assert!(lacks(&smooth).is_global);
}

/// Jerks and rates of torques give as other limits do, and what else is limited with them.
#[test]
fn limits_give_where_accelerations_are_continuous() {
    let none = MotionLimits::none;
    let at_rest = |mut problem: Problem| {
        problem.start = problem.start.with_a(&[0.0]);
        problem.end = problem.end.with_a(&[0.0]);
        problem
    };
    // From bound to bound: j = 32 d/T^3 from rest, 12 d/T^3 with any acceleration at the ends.
    let cases = [
        (at_rest(metre(none().with_jerk_max(vec![10.0]))), "jerk", "m/s^3", 22.0, 3.2_f64.cbrt()),
        (metre(none().with_jerk_max(vec![3.0])), "jerk", "m/s^3", 9.0, 4.0_f64.cbrt()),
        (at_rest(metre(none().with_torque_rate_max(vec![10.0]))), "torque_rate", "N/s", 22.0, 3.2_f64.cbrt()),
    ];
    for (problem, kind, unit, amount, time) in cases {
        let found = lacks(&problem);
        let limit = only(&found);
        assert_eq!((&limit.kind[..], &limit.name[..], &limit.unit[..]), (kind, "x", unit));
        close(limit.amount, amount, 1.5e-2);
        close(found.final_time.unwrap(), time, 2e-2);
    }
    // Forces of 1 N where 4 N are needed, with jerks that hardly matter.
    let found = lacks(&metre(none().with_torque_max(vec![1.0]).with_jerk_max(vec![1e3])));
    let limit = only(&found);
    assert_eq!(&limit.kind[..], "torque");
    close(limit.amount, 3.0, 3e-2);
    // The start is too fast to stop before the wall: |v| falls by a^2/2j while the brake comes on.
    let wall = metre(none().with_q_max(vec![1.05]).with_jerk_max(vec![30.0]));
    let wall = wall.with_time(FinalTime::Fixed(4.0));
    let fast = |v: f64| {
        let mut wall = at_rest(wall.clone());
        wall.start.v = vec![v];
        wall
    };
    assert!(solve(&fast(0.5)).motion.status.is_solved());
    let found = lacks(&fast(4.0));
    assert!(found.limits.iter().all(|limit| ["position", "jerk"].contains(&&limit.kind[..])), "{found:?}");
}

/// Two phases: the first one is too short for the limit of jerks.
#[test]
fn a_via_that_comes_too_early_is_told() {
    let via = Via::at(&[0.5]).with_time(0.3);
    let problem = metre(MotionLimits::none().with_jerk_max(vec![40.0])).with_via(via);
    let mut problem = problem.with_time(FinalTime::Fixed(2.0));
    problem.start = problem.start.with_a(&[0.0]);
    let found = lacks(&problem);
    let limit = only(&found);
    // From rest: d = j t^3/6.
    assert_eq!(&limit.kind[..], "jerk");
    close(limit.amount, 6.0 * 0.5 / 0.3_f64.powi(3) - 40.0, 1e-2);
    assert!(limit.time < 0.3 && found.final_time.is_none(), "{found:?}");
}

/// The elastic phase takes no more nodes and steps than the options allow.
#[test]
fn an_elastic_phase_has_the_limits_of_the_options() {
    let weak = metre(MotionLimits::none().with_torque_max(vec![1.0]));
    let options = SolverOptions::default()
        .with_tolerance(1e-6)
        .with_nodes(16)
        .with_max_nodes(20)
        .with_max_iterations(3);
    let solution = Solver::new(&weak, options.with_polish(Polish::Never)).unwrap().solve();
    assert!(!solution.motion.status.is_solved());
    let iterations = &solution.motion.iterations;
    assert!(iterations.iter().any(|iteration| iteration.phase == Phase::Restoration));
    assert!(
        iterations.iter().all(|iteration| iteration.nodes <= 20 && iteration.number <= 3),
        "{iterations:?}"
    );
}

/// What lacks is the motor of the crank or of the cart, never the constraint that closes the loop or a motor
/// that a joint does not have: these are laws of physics, not limits.
#[test]
fn laws_of_physics_do_not_give() {
    let four_bar = ProblemFile::read("../examples/problems/four_bar.toml", LoadOptions::default()).unwrap();
    // 10 N m are enough.
    for most in [8.0, 5.5] {
        let mut problem = four_bar.problem.clone();
        problem.limits.torque_max = Some(vec![most, 0.0, 0.0]);
        let found = lacks(&problem);
        let limit = only(&found);
        assert_eq!((&limit.kind[..], &limit.name[..], &limit.unit[..]), ("torque", "crank", "N m"));
        assert_eq!(limit.limit.map(f64::abs), Some(most));
        assert!(limit.amount > 0.1 && limit.amount < 10.0 - most, "{limit:?}");
    }
    let cart = Robot::from_file("../robots/cart_pole.toml").unwrap();
    for most in [2.0, 0.5] {
        let problem = Problem::rest_to_rest(cart.clone(), &[0.0, PI], &[1.0, 0.0], 1.5)
            .with_cost(Objective::new(0.0, vec![1.0, 0.0]))
            .with_limits(MotionLimits::none().with_torque_max(vec![most, 0.0]));
        let found = lacks(&problem);
        let limit = only(&found);
        assert_eq!((&limit.kind[..], &limit.name[..], &limit.unit[..]), ("torque", "cart", "N"));
        assert!(limit.amount > 0.1, "{limit:?}");
        // With so much it can be done.
        let mut problem = problem;
        problem.limits.torque_max = Some(vec![most + 1.02 * limit.amount, 0.0]);
        let solution = solve(&problem);
        assert!(solution.limits.torque.unwrap().at_points < 1e-6, "{}", solution.motion.status);
    }
}

#[test]
fn a_tool_that_is_too_slow_is_told() {
    let task = Task::default().with_keep(Keep::new("x", Kept::Speed { max: 0.5 }));
    let found = lacks(&metre(MotionLimits::none()).with_task(task));
    let limit = only(&found);
    assert_eq!((&limit.kind[..], &limit.unit[..], limit.limit), ("task", "m/s", None));
    assert!(limit.name.contains("speed of the tool"), "{limit:?}");
    assert!(limit.amount > 0.5 && limit.amount < 0.56, "{limit:?}");
}

/// A post in the way of an arm without other limits, which meshes do not resolve: it is beaten past the post
/// between points at which all limits are kept, so that none has to give there. That it passes through is
/// told.
#[test]
fn a_way_that_is_blocked_is_told() {
    let text = std::fs::read_to_string("../examples/problems/two_link.toml").unwrap();
    let text = text.replace("\"../../robots/", "\"../robots/");
    let link = |joint: &str| {
        format!(
            "[[collision.capsule]]\nframe = \"joint:{joint}\"\nname = \"{joint}\"\nfrom = [0, 0, 0]\n\
             to = [1, 0, 0]\nradius = 0.05\n"
        )
    };
    let post = "[limits]\nfrom_robot = false\n[[obstacle]]\nname = \"post\"\nkind = \"capsule\"\n\
                from = [0.5, 0.5, -1]\nto = [0.5, 0.5, 1]\nradius = 0.1\n";
    let text = format!("{text}\n{post}{}{}", link("elbow"), link("shoulder"));
    let file = ProblemFile::from_text(&text, ".", LoadOptions::default()).unwrap();
    let solution = solve(&file.problem);
    assert!(!solution.motion.status.is_solved(), "{}", solution.motion.status);
    let unfit = solution.check(&file.problem).unwrap_err();
    let post = unfit.remarks.iter().find(|remark| remark.text.contains("'post'"));
    assert!(post.is_some_and(|remark| remark.excess.is_some_and(|excess| excess > 0.05)), "{unfit:?}");
}

/// A free time begins no shorter than limits of rates, accelerations and jerks allow: 20 000 m at 1 m/s take
/// that and two seconds of jerk-limited ramps, whatever the guess is.
#[test]
fn a_free_time_is_found_from_any_guess() {
    let limits = MotionLimits::none().with_v_max(vec![1.0]).with_a_max(vec![2.7]).with_jerk_max(vec![1.0]);
    for guess in [1e-3, 1.0, 1e6] {
        let mut problem = Problem::rest_to_rest(sledge(), &[0.0], &[20_000.0], 1.0)
            .with_time(FinalTime::Free { guess })
            .with_cost(Objective::new(1.0, vec![0.0]))
            .with_limits(limits.clone());
        (problem.start, problem.end) = (problem.start.with_a(&[0.0]), problem.end.with_a(&[0.0]));
        let solution = solve(&problem);
        assert_eq!(solution.motion.status, Status::Converged, "{guess}: {}", solution.message(&problem));
        close(solution.motion.final_time, 20_002.0, 2e-6);
    }
}

/// Where limits of torques alone keep a motion from being fast, it is slowed down.
#[test]
fn a_free_time_is_never_infeasible_where_slower_motions_are_not() {
    for guess in [1e-3, 1.0, 30.0] {
        let problem = metre(MotionLimits::none().with_torque_max(vec![1e-4]));
        let problem = problem.with_time(FinalTime::Free { guess }).with_cost(Objective::new(1.0, vec![0.0]));
        let solution = solve(&problem);
        assert_eq!(solution.motion.status, Status::Converged, "{guess}: {}", solution.message(&problem));
        close(solution.motion.final_time, 200.0, 1e-4);
    }
}

/// A swing-up with too little torque to lift the pendulum: it is possible, whether it is found or not.
#[test]
fn what_is_possible_is_never_called_infeasible() {
    let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
    let problem = Problem::rest_to_rest(robot, &[0.0], &[PI], 3.0)
        .with_limits(MotionLimits::none().with_torque_max(vec![2.0]));
    let solution = solve(&problem);
    assert_ne!(solution.motion.status, Status::Infeasible);
    assert!(
        !solution.message(&problem).contains("no motion keeps all limits"),
        "{}",
        solution.message(&problem)
    );
}

/// Jerks from rest to rest, with given and with free accelerations at the ends.
#[test]
fn a_jerk_that_is_too_small_is_proven() {
    let still = |problem: Problem| {
        let (start, end) = (problem.start.clone().with_a(&[0.0]), problem.end.clone().with_a(&[0.0]));
        problem.with_start(start).with_end(end)
    };
    let limits = |jerk: f64| MotionLimits::none().with_jerk_max(vec![jerk]);
    for (problem, least) in [
        (metre(limits(11.0)), (12.0_f64 / 11.0).cbrt()),
        (still(metre(limits(30.0))), (32.0_f64 / 30.0).cbrt()),
    ] {
        let found = lacks(&problem);
        assert!(found.is_global, "{found:?}");
        close(found.least_time.unwrap(), least, 1e-9);
        // That is no least time of these accelerations and rates.
        let slow = problem.clone().with_time(FinalTime::Fixed(1.02 * least));
        assert_eq!(solve(&slow).motion.status, Status::Converged);
    }
}
