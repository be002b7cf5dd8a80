//! Limits between the points of a mesh, as fine samples of a motion show them.

use costate::robot::{LoadOptions, Robot};
use costate_control::{
    BoundaryState, FinalTime, MotionLimits, Objective, Problem, ProblemFile, Solution, Solver, SolverOptions,
    Status, Verify,
};

const RATE: f64 = 50_000.0;

/// Largest change of accelerations, or of torques, from sample to sample, as a part of what a limit allows.
fn most(solution: &Solution, problem: &Problem, limits: &[f64], torques: bool) -> f64 {
    let samples = solution.sample(problem, RATE).unwrap();
    let rows = if torques { &samples.tau } else { &samples.a };
    let pairs = samples.t.windows(2).zip(rows.windows(2));
    let part = |(t, x): (&[f64], &[Vec<f64>])| {
        let rates = x[0].iter().zip(&x[1]).zip(limits).map(|((a, b), limit)| (b - a).abs() / limit);
        rates.fold(0.0, f64::max) / (t[1] - t[0])
    };
    // The last step may be so short that rounding shows.
    pairs.filter(|(t, _)| t[1] - t[0] > 0.5 / RATE).map(part).fold(0.0, f64::max)
}

fn solve(problem: &Problem) -> Solution {
    Solver::new(problem, SolverOptions::default().with_tolerance(1e-6)).unwrap().solve()
}

fn two_link() -> Robot {
    Robot::from_file("../robots/two_link.toml").unwrap()
}

/// Limits count as kept if and only if no sample is beyond them, here by this part of what they are.
fn is_told(found: &Solution, part: f64) {
    assert_eq!(found.limits.are_kept(), part < 1.0 + 4e-4, "{part} {:?}", found.limits);
}

/// Jerks that jump from limit to limit, beside limits of motors and of the power.
#[test]
fn jerks_that_jump_are_kept_or_told() {
    let mut limits = MotionLimits::none().with_torque_max(vec![25.0, 28.0]).with_jerk_max(vec![60.0, 80.0]);
    limits.corner_speed = Some(vec![3.0, 4.0]);
    limits.no_load_speed = Some(vec![8.0, 12.0]);
    limits.total_power_max = Some(80.0);
    let problem = Problem::rest_to_rest(two_link(), &[0.0; 2], &[1.57; 2], 1.2)
        .with_time(FinalTime::Free { guess: 1.2 })
        .with_cost(Objective::new(1.0, vec![0.01; 2]).with_energy(vec![0.5; 2]))
        .with_limits(limits);
    let mut still = problem.clone();
    for end in [&mut still.start, &mut still.end] {
        *end = BoundaryState::fixed(&end.q, &end.v).with_a(&[0.0; 2]);
    }
    for problem in [problem, still] {
        let found = solve(&problem);
        // More than a tenth is no overshoot of a polynomial beside a jump: the limit is not kept.
        let worst = found.limits.jerk.as_ref().and_then(|jerk| jerk.worst_between.as_ref());
        let is_kept = worst.is_none_or(|worst| worst.part <= 0.1);
        let status = &found.motion.status;
        assert!(is_kept || !status.is_converged(), "{status}");
        is_told(&found, most(&found, &problem, &[60.0, 80.0], false));
    }
}

/// The same of rates of torques.
#[test]
fn rates_of_torques_are_kept_or_told() {
    let problem = Problem::rest_to_rest(two_link(), &[0.0; 2], &[1.57; 2], 1.0)
        .with_limits(MotionLimits::none().with_torque_rate_max(vec![75.0, 120.0]));
    let found = solve(&problem);
    assert_eq!(found.motion.status, Status::Converged);
    is_told(&found, most(&found, &problem, &[75.0, 120.0], true));
}

/// A problem of a UR5 whose rotors count, with these lines at the end of its file.
fn ur5(time: f64, lines: &str) -> Problem {
    let text = format!(
        "[robot]\nfile = \"ur5.urdf\"\narmature = {{ shoulder_pan_joint = 1.0, shoulder_lift_joint = 1.0, \
         elbow_joint = 1.0, wrist_1_joint = 0.2, wrist_2_joint = 0.2, wrist_3_joint = 0.2 }}\n\
         [start]\nq = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]\n[end]\nq = [1.5, -1.0, 1.2, -1.5, -1.57, 0.5]\n\
         [time]\nfinal = {time}\n[cost]\neffort = [1, 1, 1, 1, 1, 1]\n[limits]\nfrom_robot = true\n{lines}"
    );
    ProblemFile::from_text(&text, "../robots", LoadOptions::default()).unwrap().problem
}

/// Six joints with continuous accelerations, whose jerks jump at many times: no sample is beyond the limit
/// but for rounding, also where the rate of a joint is at its limit too.
#[test]
fn jerks_of_an_arm_are_kept() {
    for most_jerk in [40.0, 80.0] {
        let problem = ur5(1.5, &format!("jerk_max = {:?}\n", [most_jerk; 6]));
        let found = solve(&problem);
        assert_eq!(found.motion.status, Status::Converged);
        let usage = found.limits.jerk.as_ref().unwrap();
        assert!(found.limits.are_kept() && !usage.active.is_empty(), "{usage:?}");
        // 1e-6 of the range.
        assert!(usage.between < 2e-6 * most_jerk, "{usage:?}");
        let part = most(&found, &problem, &[most_jerk; 6], false);
        assert!(part < 1.0 + 1e-4, "{part}");
    }
}

/// Powers, accelerations of joints and of a tool, whose values jump with the accelerations.
#[test]
fn powers_and_accelerations_are_kept() {
    let keep = "[[keep]]\nkind = \"acceleration\"\nframe = \"tool0\"\nacceleration = 6.0\n";
    let power = "power_max = [40, 40, 40, 8, 8, 8]\n";
    for lines in [power, "total_power_max = 60\n", "a_max = [5, 5, 5, 5, 5, 5]\n", keep] {
        let found = solve(&ur5(1.2, lines));
        assert_eq!(found.motion.status, Status::Converged, "{lines}");
        assert!(found.limits.are_kept(), "{lines} {:?}", found.limits);
        let kinds = [&found.limits.power, &found.limits.acceleration, &found.limits.task];
        assert!(kinds.into_iter().flatten().any(|usage| !usage.active.is_empty()), "{lines}");
    }
    for limits in [
        MotionLimits::none().with_power_max(vec![30.0, 150.0]),
        MotionLimits::none().with_total_power_max(120.0),
    ] {
        let turn = std::f64::consts::FRAC_PI_2;
        let found = solve(&Problem::rest_to_rest(two_link(), &[0.0; 2], &[turn; 2], 1.0).with_limits(limits));
        assert_eq!(found.motion.status, Status::Converged);
        assert!(found.limits.are_kept(), "{:?}", found.limits);
    }
}

/// What is not kept between the points is told: with where, and how much.
#[test]
fn what_is_exceeded_between_points_is_told() {
    let limits = MotionLimits::none().with_torque_max(vec![25.0, 28.0]).with_a_max(vec![9.0, 14.0]);
    let problem = Problem::rest_to_rest(two_link(), &[0.0; 2], &[1.57; 2], 1.2)
        .with_time(FinalTime::Free { guess: 1.2 })
        .with_cost(Objective::new(1.0, vec![0.0; 2]))
        .with_limits(limits);
    // What is only to begin with is not mended.
    let rough = SolverOptions::default().with_tolerance(1e-3).with_verify(Verify::None);
    let found = Solver::new(&problem, rough).unwrap().solve();
    let usage = found.limits.acceleration.as_ref().unwrap();
    assert!(usage.between > 28e-4 && !found.limits.are_kept(), "{usage:?}");
    let worst = usage.worst_between.as_ref().unwrap();
    assert!(worst.excess > 18e-4 && worst.value.abs() > worst.limit.abs(), "{worst:?}");
    // No sample is farther beyond its limit.
    let samples = found.sample(&problem, RATE).unwrap();
    let over = samples.a.iter().map(|a| (a[0].abs() - 9.0).max(a[1].abs() - 14.0)).fold(0.0, f64::max);
    assert!(over <= usage.between * (1.0 + 1e-9), "{over} {usage:?}");
    // Nor is the least of all found elsewhere.
    assert!(over > 0.9 * usage.between, "{over} {usage:?}");
}
