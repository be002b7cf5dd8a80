//! What tests of gaits share: examples and their motions, legs exchanged, steps integrated again.

use costate::robot::LoadOptions;
use costate_control::{
    FinalTime, Objective, Problem, ProblemFile, Solution, Solver, SolverOptions, Status, Trajectory,
};

/// Rows of a trajectory for each interval: its ends, and three points of Gauss.
pub(crate) const ROWS: usize = 5;
/// Steps of the integration for each interval.
const PARTS: usize = 8;

/// An example by its name.
pub(crate) fn example(name: &str) -> ProblemFile {
    ProblemFile::read(format!("../examples/problems/{name}.toml"), LoadOptions::default()).unwrap()
}

/// The motion of a problem, and what it is like, printed.
pub(crate) fn solved(problem: &Problem, options: SolverOptions) -> Solution {
    let solution = Solver::new(problem, options).unwrap().solve();
    println!(
        "{} J {:.9} T {:.4} gait {:?} end {:.1e} nodes {} steps {} drift {:?} errors {:?}",
        solution.motion.status,
        solution.total(),
        solution.motion.final_time,
        solution.gait,
        solution.end_defect,
        solution.nodes(),
        solution.newton_iterations,
        solution.constraints.iter().map(|one| one.drift).collect::<Vec<_>>(),
        solution.motion.errors,
    );
    solution
}

/// With all energy of a step as its cost: the work of the motors where they drive, smoothed, their heat, and
/// 40 W at rest. The time is free; the first three joints have no motors.
pub(crate) fn least_energy(problem: &Problem, guess: f64) -> Problem {
    let motors = |weight: f64| (0..problem.robot.dof()).map(|i| if i < 3 { 0.0 } else { weight }).collect();
    let cost = Objective::new(40.0, motors(0.1)).with_energy(motors(1.0)).with_energy_smoothing(1.0);
    problem.clone().with_cost(cost).with_time(FinalTime::Free { guess })
}

/// Whether a step takes the best duration: those beside it cost more, J has no slope there, and -H* is its
/// slope beside it.
pub(crate) fn is_best_duration(problem: &Problem, options: &SolverOptions, free: &Solution) {
    let time = free.motion.final_time;
    let beside = [0.95, 1.05].map(|part| {
        let given = solved(&problem.clone().with_time(FinalTime::Fixed(part * time)), options.clone());
        assert_eq!(given.motion.status, Status::Converged);
        assert!(given.total() > free.total(), "{part}: {} {}", given.total(), free.total());
        given
    });
    assert!(free.motion.hamiltonian.abs() * time < 1e-3 * free.total(), "{}", free.motion.hamiltonian);
    let slopes = beside.each_ref().map(|given| -given.motion.hamiltonian);
    assert!(slopes[0] < 0.0 && slopes[1] > 0.0, "{slopes:?}");
    // By the trapezium on each side.
    for (given, slope) in beside.iter().zip(slopes) {
        let (rise, step) = (given.total() - free.total(), given.motion.final_time - time);
        let expected = 0.5 * step * (slope - free.motion.hamiltonian);
        assert!((rise - expected).abs() < 0.2 * rise, "{rise} {expected}");
    }
}

/// The end of double support (s).
pub(crate) fn lift_off(solution: &Solution) -> f64 {
    let [time] = solution.trajectory.via_times[..] else { panic!("{:?}", solution.trajectory.via_times) };
    time
}

pub(crate) fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |most, (a, b)| most.max((a - b).abs()))
}

/// Joints without a motor, the first three, have no torque, knees do not bend forward, and motors keep their
/// limits.
pub(crate) fn keeps_its_limits(problem: &Problem, motion: &Trajectory) {
    let [least, most] = [problem.limits.q_min.as_ref().unwrap(), problem.limits.torque_max.as_ref().unwrap()];
    for k in 0..motion.t.len() {
        assert!(motion.u[k][..3].iter().all(|u| u.abs() < 1e-5), "{k}: {:?}", motion.u[k]);
        assert!(motion.q[k].iter().zip(least).all(|(q, least)| *q > least - 1e-6), "{k}: {:?}", motion.q[k]);
        assert!(motion.u[k].iter().zip(most).all(|(u, most)| u.abs() <= most * (1.0 + 1e-6) + 1e-5));
    }
}

/// The state (q, v) at the end, from that at the start and the torques of all motors, those of all joints but
/// the first three, by the method of Runge and Kutta, eight steps to an interval. `accelerate` is forward
/// dynamics: a by the time in the middle of the interval, q, v and torques.
pub(crate) fn integrated(
    motion: &Trajectory,
    mut accelerate: impl FnMut(f64, &[f64], &[f64], &[f64]) -> Vec<f64>,
) -> Vec<f64> {
    let n = motion.q[0].len();
    let mut x = [&motion.q[0][..], &motion.v[0]].concat();
    for (t, u) in motion.t.chunks_exact(ROWS).zip(motion.u.chunks_exact(ROWS)) {
        // The polynomial through the torques of an interval.
        let torques = |at: f64| {
            let mut sum = vec![0.0; n];
            for (row, u) in u.iter().enumerate() {
                let others = (0..ROWS).filter(|other| *other != row);
                let part: f64 = others.map(|other| (at - t[other]) / (t[row] - t[other])).product();
                (3..n).for_each(|i| sum[i] += part * u[i]);
            }
            sum
        };
        let mut rate = |x: &[f64], at: f64| {
            let (q, v) = x.split_at(n);
            [v, &accelerate(t[ROWS / 2], q, v, &torques(at))].concat()
        };
        let h = (t[ROWS - 1] - t[0]) / PARTS as f64;
        for part in 0..PARTS {
            let at = t[0] + part as f64 * h;
            let moved = |x: &[f64], by: &[f64], h: f64| -> Vec<f64> {
                x.iter().zip(by).map(|(x, by)| x + h * by).collect()
            };
            let first = rate(&x, at);
            let second = rate(&moved(&x, &first, 0.5 * h), at + 0.5 * h);
            let third = rate(&moved(&x, &second, 0.5 * h), at + 0.5 * h);
            let fourth = rate(&moved(&x, &third, h), at + h);
            for i in 0..2 * n {
                x[i] += h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]);
            }
        }
    }
    x
}
