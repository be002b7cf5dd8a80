//! Motions of the direct method as first guesses of extremals.

use costate::robot::LoadOptions;
use costate_control::{
    Certificate, Method, MotionLimits, Phase, Polish, PolishOutcome, Problem, ProblemFile, Solution, Solver,
    SolverOptions, Status, Verify,
};

const INF: f64 = f64::INFINITY;

/// A problem of examples/problems, without the limits of its robot.
fn problem(name: &str) -> Problem {
    let file = ProblemFile::read(format!("../examples/problems/{name}.toml"), LoadOptions::default());
    file.unwrap().problem.with_limits(MotionLimits::none())
}

fn solve(problem: &Problem, polish: Polish) -> Solution {
    Solver::new(problem, SolverOptions::default().with_tolerance(1e-6).with_polish(polish)).unwrap().solve()
}

fn outcome(solution: &Solution) -> PolishOutcome {
    solution.polish.as_ref().unwrap().outcome
}

/// Polished, with the cost, H* and switches of the extremal that the search without the direct method finds.
fn polished(problem: &Problem) -> Solution {
    let solution = solve(problem, Polish::Always);
    let report = solution.polish.as_ref().unwrap();
    assert_eq!((report.outcome, &solution.motion.status), (PolishOutcome::Polished, &Status::Converged));
    assert_eq!(report.polished_total, Some(solution.total()));
    assert!(solution.motion.hamiltonian_drift < 1e-5, "{}", solution.motion.hamiltonian_drift);
    let extremal = Solver::new(problem, SolverOptions::of(Method::Collocation)).unwrap().solve();
    let close = |a: f64, b: f64, digits: f64| assert!((a - b).abs() <= digits * b.abs().max(1e-3), "{a} {b}");
    close(solution.total(), extremal.total(), 5e-8);
    close(solution.motion.final_time, extremal.motion.final_time, 1e-6);
    assert_eq!(solution.motion.switches.len(), extremal.motion.switches.len());
    for (a, b) in solution.motion.switches.iter().zip(&extremal.motion.switches) {
        close(*a, *b, 1e-5);
    }
    let shown = solution.motion.certificate;
    match extremal.motion.certificate {
        Certificate::NotChecked => assert_eq!(shown, Certificate::LocalMinimumOnMesh),
        checked => assert_eq!(shown, checked),
    }
    solution
}

#[test]
fn smooth_motions_become_extremals() {
    for name in ["two_link", "two_link_free_time", "cart_pole", "puma560_pick_and_place"] {
        let solution = polished(&problem(name));
        assert_eq!(solution.motion.certificate, Certificate::LocalMinimum, "{name}");
        let steps = |phase| solution.motion.iterations.iter().filter(|step| step.phase == phase).count();
        // Newton's method has little left to do, though the first motion is rough.
        assert!((1..=6).contains(&steps(Phase::Polish)), "{name}: {}", steps(Phase::Polish));
        assert!(steps(Phase::Direct) > 0, "{name}");
    }
}

#[test]
fn controls_that_jump_or_stay_at_bounds_get_their_switching_times() {
    // Bang-bang; saturated, of joints with gains of both signs.
    for (name, switches) in [("two_link_least_time", 3), ("manutec_r3_least_energy", 2)] {
        let problem = problem(name);
        let solution = polished(&problem);
        assert_eq!(solution.motion.switches.len(), switches, "{name}: {:?}", solution.motion.switches);
        let torque = solution.limits.torque.as_ref().unwrap();
        assert!(!torque.active.is_empty() && torque.at_points == 0.0, "{name}: {torque:?}");
        let direct = solve(&problem, Polish::Never);
        assert!(direct.polish.is_none());
        // The same sides of the same joints as the direct method reports.
        let sides = |solution: &Solution| {
            let active = solution.limits.torque.clone().unwrap().active;
            let mut sides: Vec<_> = active.into_iter().map(|span| (span.name, span.side)).collect();
            sides.sort();
            sides.dedup();
            sides
        };
        assert_eq!(sides(&solution), sides(&direct), "{name}");
    }
}

#[test]
fn limits_on_torques_are_bounds_on_controls() {
    let mut problem = problem("two_link_bounded");
    let bounded = polished(&problem);
    let most = problem.bounds.take().unwrap().u_max;
    let limited = problem.with_limits(MotionLimits::none().with_torque_max(most));
    let solution = solve(&limited, Polish::Always);
    assert_eq!(outcome(&solution), PolishOutcome::Polished);
    assert!((solution.total() - bounded.total()).abs() < 1e-9 * bounded.total(), "{}", solution.total());
    assert_eq!(solution.motion.switches.len(), bounded.motion.switches.len());
}

#[test]
fn only_limits_that_matter_prevent_it() {
    let limited = |v_max: f64| {
        let limits = MotionLimits::none().with_v_max(vec![INF, v_max]);
        solve(&problem("two_link").with_limits(limits), Polish::Auto)
    };
    let solution = limited(7.0);
    assert_eq!(outcome(&solution), PolishOutcome::Limited);
    assert!((solution.total() / 155.74483972 - 1.0).abs() < 3e-6 && solution.motion.switches.is_empty());
    // The arm never turns so fast.
    let solution = limited(30.0);
    assert_eq!(outcome(&solution), PolishOutcome::Polished);
    assert!((solution.total() / 145.13113754 - 1.0).abs() < 1e-8, "{}", solution.total());
    assert!(solution.limits.rate.as_ref().unwrap().active.is_empty());
    let saved: Solution = serde_json::from_value(serde_json::to_value(&solution).unwrap()).unwrap();
    assert_eq!(saved.polish, solution.polish);
    // A rate that no motion can keep.
    let solution = limited(1.0);
    assert_eq!((outcome(&solution), solution.motion.status), (PolishOutcome::NoMotion, Status::Infeasible));
}

/// Asked for, the motion of a robot that stands, is closed or flies says why it stays as it is.
#[test]
fn motions_that_are_never_extremals_say_so() {
    let causes = [
        ("rabbit_walk", "gait is given"),
        ("four_bar", "the robot has constraints"),
        ("satellite_arm", "joint 'base' is floating"),
    ];
    for (name, cause) in causes {
        let path = format!("../examples/problems/{name}.toml");
        let file = ProblemFile::read(path, LoadOptions::default()).unwrap();
        let options = file.options.with_tolerance(1e-3).with_verify(Verify::None);
        let solve =
            |polish| Solver::new(&file.problem, options.clone().with_polish(polish)).unwrap().solve().polish;
        let report = solve(Polish::Always).unwrap();
        assert_eq!(
            (report.outcome, report.cause.as_deref()),
            (PolishOutcome::Limited, Some(cause)),
            "{name}"
        );
        assert!(solve(Polish::Auto).is_none(), "{name}");
    }
}
