//! How much of the bound of `costate check` rounding uses, over many random robots: see docs/check.md.

use costate::EvalError;
use costate::configuration::ConfigurationSpace;
use costate::derivative::{Figure, Routes, Verdict};
use costate::hamiltonian::Hamiltonian;
use costate::step::{StepError, StepRoutes};
use costate_test_support::random_robot::{Case, cases, free_cases};
use fastrand::Rng;
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use std::collections::BTreeMap;

/// Random states of each robot.
const STATES: usize = 5;

/// Duration of the steps (s).
const STEP: f64 = 1e-3;

/// Spreads the masses of some robots over up to twelve decades.
fn spread(case: &mut Case, rng: &mut Rng) {
    let decades = [0.0, 0.0, 1.0, 2.0, 4.0, 6.0][rng.usize(..6)];
    for part in &mut case.parts {
        part.mass *= 10_f64.powf(decades * (2.0 * rng.f64() - 1.0));
    }
}

/// q = 0, close to quarter turns, or anywhere; of floating and spherical joints a direction from the neutral
/// configuration.
fn change_state(case: &mut Case, space: &ConfigurationSpace, rng: &mut Rng) {
    let near = 10_f64.powf(-6.0 * rng.f64());
    let kind = rng.usize(..6);
    let direction = |_| {
        let turns = 3.0 * (2.0 * rng.f64() - 1.0);
        match kind {
            0 => 0.0,
            1 => std::f64::consts::FRAC_PI_2 * turns.round() + near * turns,
            _ => turns,
        }
    };
    let d: Vec<f64> = (0..space.dof()).map(direction).collect();
    space.integrate(&space.neutral(), &d, &mut case.q).unwrap();
    case.v.iter_mut().for_each(|v| *v = 3.0 * rng.f64() - 1.5);
}

#[derive(Default)]
struct Found {
    ratios: Vec<f64>,
    bounds: Vec<f64>,
    not_comparable: usize,
}

/// `COSTATE_SCAN=robots,seed`; with floating and spherical joints: `COSTATE_SCAN=robots,seed,free`.
#[test]
#[ignore = "takes minutes"]
fn rounding_errors_of_many_random_robots() {
    let text = std::env::var("COSTATE_SCAN").unwrap_or_else(|_| "200,1".to_owned());
    let fields: Vec<&str> = text.split(',').collect();
    let (robots, seed): (usize, u64) = (fields[0].parse().unwrap(), fields[1].parse().unwrap());
    let all = if fields.get(2) == Some(&"free") { free_cases(3).boxed() } else { cases(8).boxed() };
    let mut rng = Rng::with_seed(seed);
    let bytes: Vec<u8> = seed.to_le_bytes().repeat(4);
    let mut runner =
        TestRunner::new_with_rng(Config::default(), TestRng::from_seed(RngAlgorithm::ChaCha, &bytes));
    let mut rows: BTreeMap<String, Found> = BTreeMap::new();
    let (mut states, mut singular, mut inaccurate) = (0, 0, 0);
    for robot in 0..robots {
        let mut case = all.new_tree(&mut runner).unwrap().current();
        spread(&mut case, &mut rng);
        let built = case.robot();
        let space = ConfigurationSpace::new(&built);
        let (mut routes, mut steps) = (Routes::new(&built), StepRoutes::new(&built));
        for state in 0..STATES {
            change_state(&mut case, &space, &mut rng);
            let Ok(p) = Hamiltonian::<f64>::new(&built).momentum(&case.q, &case.v).map(<[f64]>::to_vec)
            else {
                continue;
            };
            let x = [&case.q[..], &p].concat();
            let Ok(mut report) = routes.compare(&x, &case.u, &case.y) else {
                singular += 1;
                continue;
            };
            match steps.compare(&x, &case.u, STEP, &case.y, &mut report.figures) {
                Ok(()) => {}
                Err(
                    StepError::Inaccurate { .. }
                    | StepError::NotConverged { .. }
                    | StepError::Dynamics(EvalError::SingularMassMatrix { .. }),
                ) => inaccurate += 1,
                Err(error) => panic!("{error}"),
            }
            states += 1;
            for figure in &report.figures {
                let Figure { quantity, route, bound, .. } = *figure;
                let found = rows.entry(format!("{quantity:26} {route}")).or_default();
                match figure.verdict(1.0) {
                    Verdict::NotComparable => found.not_comparable += 1,
                    verdict => {
                        found.ratios.push(figure.ratio());
                        found.bounds.push(bound);
                        if verdict == Verdict::Differs {
                            println!(
                                "robot {robot}, state {state}, cond {:.0e}: {figure:?}",
                                report.condition
                            );
                        }
                    }
                }
            }
        }
    }
    println!("{states} states, {singular} singular, {inaccurate} without steps");
    println!("{:48} largest     99%  median   bound: median     99%  not comparable", "ratio");
    let mut worst = 0.0_f64;
    for (name, mut found) in rows {
        found.ratios.sort_by(f64::total_cmp);
        found.bounds.sort_by(f64::total_cmp);
        let at = |sorted: &[f64], part: f64| sorted[((sorted.len() - 1) as f64 * part) as usize];
        let [largest, most, median] = [1.0, 0.99, 0.5].map(|part| at(&found.ratios, part));
        let [typical, high] = [0.5, 0.99].map(|part| at(&found.bounds, part));
        let none = found.not_comparable;
        println!("{name:48} {largest:7.3} {most:7.3} {median:7.3}   {typical:13.0e} {high:7.0e}  {none}");
        worst = if largest.is_nan() { f64::INFINITY } else { worst.max(largest) };
    }
    assert!(worst <= 1.0, "{worst}");
}
