//! Motions at a fixed rate.

use costate::lagrangian::Lagrangian;
use costate::robot::LoadOptions;
use costate_control::{
    MotionLimits, Polish, Problem, ProblemFile, SampleError, Samples, Solution, Solver, SolverOptions,
    Trajectory,
};

fn problem(name: &str) -> Problem {
    let file = ProblemFile::read(format!("../examples/problems/{name}.toml"), LoadOptions::default());
    file.unwrap().problem
}

fn solve(problem: &Problem, options: SolverOptions) -> Solution {
    let solution = Solver::new(problem, options).unwrap().solve();
    assert!(solution.motion.status.is_solved(), "{}", solution.motion.status);
    solution
}

/// Largest difference of two lists of rows.
fn difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().flatten().zip(b.iter().flatten()).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// Torque, acceleration and state of every sample belong together.
fn check_dynamics(problem: &Problem, samples: &Samples) {
    let mut model = Lagrangian::<f64>::new(&problem.robot);
    for k in 0..samples.t.len() {
        let tau = model.inverse_dynamics(&samples.q[k], &samples.v[k], &samples.a[k]).unwrap();
        for (i, (found, expected)) in samples.tau[k].iter().zip(tau).enumerate() {
            assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{found} {expected}");
            assert!((problem.gain[i] * samples.u[k][i] - found).abs() < 1e-12 * found.abs().max(1.0));
        }
    }
}

#[test]
fn both_methods_give_the_same_samples_and_the_last_is_at_the_end() {
    let problem = problem("puma560_pick_and_place").with_limits(MotionLimits::none());
    let indirect = solve(&problem, SolverOptions::default().with_tolerance(1e-6));
    let direct = solve(&problem, SolverOptions::default().with_tolerance(1e-9).with_polish(Polish::Never));
    // 1 s is not a multiple of 1/30.7 s.
    let [a, b] = [&indirect, &direct].map(|solution| solution.sample(&problem, 30.7).unwrap());
    for samples in [&a, &b] {
        assert_eq!(samples.t.len(), 32);
        assert_eq!((samples.t[0], samples.t[30], samples.t[31]), (0.0, 30.0 / 30.7, 1.0));
        check_dynamics(&problem, samples);
    }
    assert!(difference(&a.q, &b.q) < 1e-6 && difference(&a.v, &b.v) < 1e-5);
    let far = [difference(&a.a, &b.a), difference(&a.tau, &b.tau)];
    assert!(far[0] < 1e-2 && far[1] < 1e-2, "{far:?}");
    // A multiple of the period is one sample, not two.
    assert_eq!(indirect.sample(&problem, 250.0).unwrap().t.len(), 251);
    // Without its polynomials, as it is read from a file, the motion is nearly the same.
    let mut read = direct.clone();
    read.trajectory =
        Trajectory::from_json(&serde_json::to_string(&direct).unwrap(), &problem.robot).unwrap();
    let c = read.sample(&problem, 30.7).unwrap();
    check_dynamics(&problem, &c);
    assert!(difference(&c.q, &b.q) < 1e-5);
}

#[test]
fn torques_are_cut_to_their_limits_and_positions_are_those_of_the_spline() {
    let problem = problem("two_link_bounded").with_limits(MotionLimits::none());
    let solution = solve(&problem, SolverOptions::default().with_tolerance(1e-6).with_polish(Polish::Never));
    let samples = solution.sample(&problem, 2000.0).unwrap();
    let bounds = problem.bounds.as_ref().unwrap();
    for u in &samples.u {
        assert!((0..2).all(|i| (bounds.u_min[i]..=bounds.u_max[i]).contains(&u[i])), "{u:?}");
    }
    // Rates are the derivatives of positions, accelerations those of rates.
    for k in 1..samples.t.len() - 2 {
        let step = samples.t[k + 1] - samples.t[k - 1];
        for i in 0..2 {
            let slope = |rows: &[Vec<f64>]| (rows[k + 1][i] - rows[k - 1][i]) / step;
            assert!((slope(&samples.q) - samples.v[k][i]).abs() < 1e-3, "{k}");
        }
    }
    let last = solution.trajectory.q.len() - 1;
    assert_eq!(samples.q[samples.t.len() - 1], solution.trajectory.q[last]);
}

#[test]
fn what_cannot_be_sampled_is_an_error() {
    let problem = problem("two_link");
    let solution = solve(&problem, SolverOptions::default().with_tolerance(1e-6));
    for rate in [0.0, -1.0, f64::INFINITY, f64::NAN] {
        assert!(matches!(solution.sample(&problem, rate), Err(SampleError::Rate { .. })));
    }
    assert_eq!(solution.sample(&problem, 1e7), Err(SampleError::TooMany { samples: 1e7 + 1.0 }));
    let other = self::problem("pendulum_swing_up");
    let expected = Err(SampleError::OtherRobot { found: 2, expected: 1 });
    assert_eq!(solution.sample(&other, 100.0), expected);
    let mut empty = solution;
    empty.trajectory = Trajectory::default();
    assert_eq!(empty.sample(&problem, 100.0), Err(SampleError::NoMotion));
}

/// Samples at given times are those at a fixed rate; a time outside counts as the start or the end.
#[test]
fn samples_at_given_times_are_those_of_a_rate() {
    let problem = problem("two_link_jerk");
    let solution = solve(&problem, SolverOptions::default().with_tolerance(1e-6));
    let regular = solution.sample(&problem, 50.0).unwrap();
    let given = solution.sample_at(&problem, &regular.t).unwrap();
    assert!(given.rate.is_nan());
    assert_eq!(
        (&given.t, &given.q, &given.a, &given.tau),
        (&regular.t, &regular.q, &regular.a, &regular.tau)
    );
    let end = solution.motion.final_time;
    let outside = solution.sample_at(&problem, &[-1.0, 2.0 * end]).unwrap();
    assert_eq!(outside.q, [regular.q[0].clone(), regular.q[regular.q.len() - 1].clone()]);
    assert!(matches!(
        Solution::sample_at(&solution, &problem, &vec![0.0; 1_000_001]),
        Err(SampleError::TooMany { .. })
    ));
}

/// Jerks and rates of torques are the slopes of accelerations and torques: central differences with a step h,
/// whose error is of order h^2, away from the points of the mesh, where jerks may jump.
#[test]
fn rates_are_the_slopes_of_the_samples() {
    let problem = problem("two_link_jerk");
    let solution = solve(&problem, SolverOptions::default().with_tolerance(1e-6));
    let end = solution.motion.final_time;
    let h = 1e-6 * end;
    let times: Vec<f64> = (1..60).map(|k| end * f64::from(k) / 60.3).collect();
    let away = |t: &&f64| solution.trajectory.t.iter().all(|node| (node - **t).abs() > 2.0 * h);
    let times: Vec<f64> = times.iter().filter(away).copied().collect();
    assert!(times.len() > 40);
    let rates = solution.rates_at(&problem, &times).unwrap().unwrap();
    let shifted = |by: f64| {
        let times: Vec<f64> = times.iter().map(|t| t + by).collect();
        solution.sample_at(&problem, &times).unwrap()
    };
    let [before, after] = [shifted(-h), shifted(h)];
    let torques = problem.joint_limits();
    for (k, t) in times.iter().enumerate() {
        for i in 0..2 {
            let slope = |before: &[Vec<f64>], after: &[Vec<f64>]| (after[k][i] - before[k][i]) / (2.0 * h);
            let (jerk, rate) = (slope(&before.a, &after.a), slope(&before.tau, &after.tau));
            let error = (rates.jerk[k][i] - jerk).abs();
            assert!(error < 1e-4 * (1.0 + jerk.abs()), "t = {t}, joint {i}: {} {jerk}", rates.jerk[k][i]);
            // Torques are cut to their limits, where they have no slope.
            let [low, high] = torques[i].torque;
            if before.tau[k][i] > low && after.tau[k][i] < high {
                let error = (rates.torque_rate[k][i] - rate).abs();
                assert!(
                    error < 1e-4 * (1.0 + rate.abs()),
                    "t = {t}, joint {i}: {} {rate}",
                    rates.torque_rate[k][i]
                );
            }
        }
    }
    // Accelerations of an indirect motion are those of forward dynamics: no polynomial has their slopes.
    let indirect = self::problem("puma560_pick_and_place").with_limits(MotionLimits::none());
    let indirect = (solve(&indirect, SolverOptions::default().with_tolerance(1e-6)), indirect);
    assert!(indirect.0.rates_at(&indirect.1, &[0.1]).unwrap().is_none());
}
