//! Limits of powers, of motors and costs of energy that are refused, and their keys in problem files.

use super::power::{INF, arm, none, with_energy};
use costate::robot::LoadOptions;
use costate_control::{
    Continuation, Method, Objective, Parameter, Problem, ProblemError, ProblemFile, Solver, SolverOptions,
    TorqueSpeedError,
};

#[test]
fn wrong_limits_and_costs_are_refused() {
    let refused = |problem: &Problem| Solver::new(problem, SolverOptions::default()).unwrap_err().to_string();
    let motors =
        |corner: [f64; 2], no_load: [f64; 2]| none().with_torque_speed(corner.into(), no_load.into());
    let mut alone = none();
    alone.corner_speed = Some(vec![1.0; 2]);
    for (limits, key, what) in [
        (none().with_power_max(vec![1.0]), "limits.power_max", "1 entry"),
        (none().with_power_max(vec![1.0, f64::NAN]), "limits.power_max", "elbow"),
        (none().with_power_max(vec![0.0, 1.0]), "limits.power_max", "shoulder"),
        (none().with_total_power_max(-2.0), "limits.total_power_max", "-2"),
        (none().with_total_power_max(f64::NAN), "limits.total_power_max", "NaN"),
        (alone, "limits.corner_speed", "both"),
        (motors([1.0, 0.0], [2.0, 2.0]), "limits.corner_speed", "elbow"),
        (
            motors([1.0, 3.0], [2.0, 2.0]).with_torque_max(vec![1.0; 2]),
            "limits.corner_speed",
            "no-load speed, 2",
        ),
        (motors([1.0, 1.0], [2.0, 2.0]).with_torque_max(vec![1.0, INF]), "limits.corner_speed", "'elbow'"),
    ] {
        let error = refused(&arm(limits));
        assert!(error.starts_with(key) && error.contains(what), "{error}");
    }
    // A robot's effort is a torque limit; no speed is none.
    let fine = motors([0.5, INF], [2.0, INF]).with_from_robot(true);
    assert!(Solver::new(&arm(fine), SolverOptions::default()).is_ok());
    let cause = TorqueSpeedError::NoTorqueLimit { joint: "shoulder".into() };
    let error = Solver::new(&arm(motors([0.5, INF], [2.0, INF])), SolverOptions::default()).unwrap_err();
    assert!(matches!(&error, ProblemError::TorqueSpeed { cause: found, .. } if *found == cause), "{error}");
    let costly =
        |energy: Vec<f64>| arm(none()).with_cost(Objective::new(0.0, vec![1.0; 2]).with_energy(energy));
    for (problem, key, what) in [
        (costly(vec![1.0]), "cost.energy", "1 entry"),
        (costly(vec![1.0, -1.0]), "cost.energy", "elbow"),
        (costly(vec![INF, 1.0]), "cost.energy", "shoulder"),
    ] {
        let error = refused(&problem);
        assert!(error.starts_with(key) && error.contains(what), "{error}");
    }
    let mut rough = costly(vec![1.0; 2]);
    rough.cost.energy_smoothing = 0.0;
    assert!(refused(&rough).starts_with("cost.energy_smoothing"), "{}", refused(&rough));
    // Energy alone is a cost where torques are bounded.
    let mut only = costly(vec![1.0; 2]).with_limits(none().with_torque_max(vec![30.0; 2]));
    only.cost.effort = vec![0.0; 2];
    assert!(Solver::new(&only, SolverOptions::default()).is_ok());
    only.cost.energy = None;
    assert_eq!(Solver::new(&only, SolverOptions::default()).unwrap_err(), ProblemError::NothingToMinimise);
}

#[test]
fn other_methods_refuse_powers_and_energy() {
    let costly = with_energy(none());
    for method in [Method::Collocation, Method::Shooting] {
        let options = SolverOptions::default().with_method(method);
        let error = Solver::new(&costly, options.clone()).unwrap_err();
        assert_eq!(error, ProblemError::EnergyNeedsDirect);
        assert!(
            error.to_string().starts_with("cost.energy: ") && error.to_string().contains("direct"),
            "{error}"
        );
        for limits in [none().with_power_max(vec![9.0; 2]), none().with_total_power_max(9.0)] {
            let error = Solver::new(&arm(limits), options.clone()).unwrap_err();
            assert_eq!(error, ProblemError::LimitsNeedDirect);
        }
        let free = arm(none()).with_cost(Objective::new(0.0, vec![1.0; 2]).with_energy(vec![0.0; 2]));
        assert!(Solver::new(&free, options).is_ok(), "energy that costs nothing");
    }
    let options = SolverOptions::default();
    let error = Continuation::new(&costly, Parameter::FinalTime, 1.0, 2.0, options).unwrap_err();
    assert!(error.to_string().contains("energy"), "{error}");
}

#[test]
fn problem_files_choose_the_direct_method() {
    let file = |cost: &str, limits: &str, solver: &str| {
        let text = std::fs::read_to_string("../examples/problems/two_link.toml").unwrap();
        let (text, _) = text.split_once("[solver]").unwrap();
        let text = format!("{text}\n{cost}\n[limits]\nfrom_robot = false\n{limits}\n[solver]\n{solver}\n");
        ProblemFile::from_text(&text, "../examples/problems", LoadOptions::default())
    };
    let found = file("energy = 0.5\nenergy_smoothing = 2.0", "", "").unwrap();
    assert_eq!(found.options, SolverOptions::default());
    assert_eq!(
        found.problem.cost,
        Objective::new(0.0, vec![1.0; 2]).with_energy(vec![0.5; 2]).with_energy_smoothing(2.0)
    );
    let found = file("energy = [0.5, 1]", "", "").unwrap();
    assert_eq!(found.problem.cost.energy, Some(vec![0.5, 1.0]));
    assert_eq!(found.problem.cost.energy_smoothing, Objective::new(0.0, Vec::new()).energy_smoothing);
    assert_eq!(file("energy = 0.0", "", "").unwrap().options, SolverOptions::default());
    let limits = "power_max = [30.0, inf]\ntotal_power_max = 120\ntorque_max = [20, 28]\ncorner_speed = [3, inf]\nno_load_speed = [8, inf]";
    let found = file("", limits, "").unwrap();
    assert_eq!(found.options, SolverOptions::default());
    let expected =
        none().with_power_max(vec![30.0, INF]).with_total_power_max(120.0).with_torque_max(vec![20.0, 28.0]);
    assert_eq!(found.problem.limits, expected.with_torque_speed(vec![3.0, INF], vec![8.0, INF]));
    for (cost, limits, solver, key) in [
        ("energy = \"much\"", "", "", "cost.energy"),
        ("energy = [1.0, true]", "", "", "cost.energy"),
        ("energy = -1.0", "", "", "cost.energy"),
        ("energy = 1.0", "", "method = \"collocation\"", "cost.energy"),
        ("energy = 1.0\nenergy_smoothing = -1.0", "", "", "cost.energy_smoothing"),
        ("", "total_power_max = 0.0", "", "limits.total_power_max"),
        ("", "power_max = [1.0, -1.0]", "", "limits.power_max"),
        ("", "no_load_speed = [1.0, 1.0]", "", "limits.no_load_speed"),
    ] {
        let error = file(cost, limits, solver).unwrap_err().to_string();
        assert!(error.contains(&format!(": {key}: ")), "{error}");
    }
}
