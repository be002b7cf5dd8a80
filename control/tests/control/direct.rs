//! The direct method: values with hard limits that other methods found, and problems that cannot be solved.

use costate_control::{
    Bounds, FinalTime, MotionLimits, Objective, Problem, ProblemError, ProblemFile, Solution, Solver,
    SolverOptions, Status,
};
use std::f64::consts::FRAC_PI_2;

/// A problem of examples/problems.
fn problem(name: &str) -> Problem {
    let file = ProblemFile::read(format!("../examples/problems/{name}.toml"), Default::default()).unwrap();
    file.problem.with_limits(MotionLimits::none())
}

fn solve(problem: &Problem) -> Solution {
    Solver::new(problem, SolverOptions::direct()).unwrap().solve()
}

fn check(name: &str, problem: &Problem, value: f64) {
    let solution = solve(problem);
    let motion = &solution.motion;
    println!(
        "{name} {} {} {} defect {:.1e} {} H {:.4} drift {:.1e} {:?}",
        motion.status,
        motion.cost,
        value,
        solution.end_defect,
        solution.nodes(),
        motion.hamiltonian,
        motion.hamiltonian_drift,
        solution
            .limits
            .kinds()
            .filter_map(|(name, usage)| usage.map(|usage| (name, usage.at_points, usage.between)))
            .collect::<Vec<_>>()
    );
}

#[test]
fn values() {
    check("two_link", &problem("two_link"), 145.13113754);
    for (name, value) in [
        ("puma560_pick_and_place", 0.05602436),
        ("ur5_reach", 0.00929041),
        ("pendulum_swing_up", 74.0616592207),
        ("two_link_bounded", 18.5256),
        ("two_link_free_time", 0.0),
        ("two_link_least_time", 2.98228),
        ("manutec_r3_least_energy", 20.40425),
        ("manutec_r3_least_time", 0.0),
        ("puma560_least_time", 0.511448),
        ("cart_pole", 0.0),
        ("double_integrator_min_time", 0.0),
        ("puma560_free_flange", 0.0),
        ("panda_penalties", 0.0),
    ] {
        check(name, &problem(name), value);
    }
    let limited = |name: &str, v_max: &[f64]| {
        problem(name).with_limits(MotionLimits::none().with_v_max(v_max.to_vec()))
    };
    check("A", &limited("two_link", &[f64::INFINITY, 7.0]), 155.74483972);
    check("D", &limited("two_link_least_time", &[0.35, 1.0]), 3.2300988);
    let mut manutec = limited("manutec_r3_least_time", &[3.0, 1.5, 5.2]);
    manutec.penalty = None;
    check("E", &manutec, 0.49518904);
    let _ = (FRAC_PI_2, FinalTime::Fixed(1.0), Bounds::symmetric(vec![]), Objective::new(0.0, vec![]));
    let _: Option<(ProblemError, Status)> = None;
}
