//! Machine code of every quantity against the generic code.

use costate::EvalError;
use costate::codegen::{CodegenError, Coordinates, ProgramOptions, Quantity, robot_program};
use costate::configuration::ConfigurationSpace;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{JointSpec, LinkInertia, LoadOptions, Robot};
use costate_jit::{Backend, Compiled, DEFAULT_LIMIT, JitError, JitLanes, JitModel, JitQuantity};
use costate_test_support::generic::{Rounding, State, expected, judge};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases};
use costate_test_support::rounding::At;
use proptest::prelude::*;
use std::cell::LazyCell;
use std::path::Path;

const ALL_COORDINATES: [Coordinates; 2] = [Coordinates::Hamiltonian, Coordinates::Lagrangian];

/// Whether machine code is made here; that the processor is not known is the only excuse.
fn compiles() -> bool {
    let program = robot_program(
        &Robot::from_file(folder().join("robots/pendulum.toml")).unwrap(),
        Quantity::F,
        Coordinates::Hamiltonian,
        &ProgramOptions::default(),
    );
    match Compiled::new(&program.unwrap()) {
        Ok(_) => true,
        Err(JitError::Processor { .. }) => false,
        Err(error) => panic!("{error}"),
    }
}

fn folder() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// All robot files, with what friction they have; one has Coulomb friction on every joint.
fn all_robots() -> Vec<Robot> {
    let mut files: Vec<_> =
        std::fs::read_dir(folder().join("robots")).unwrap().map(|e| e.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "urdf" || e == "toml"));
    files.push(folder().join("tests/fixtures/friction_tree.toml"));
    files.push(folder().join("tests/fixtures/mimic_tree.toml"));
    files.sort();
    assert!(files.len() >= 9);
    let options = LoadOptions::default().friction(true);
    files.iter().map(|file| Robot::from_file_with(file, options).unwrap()).collect()
}

fn quantities() -> impl Iterator<Item = (Quantity, Coordinates)> {
    Quantity::ALL.into_iter().flat_map(|quantity| ALL_COORDINATES.map(|coordinates| (quantity, coordinates)))
}

/// Above the steps of every program that is compiled here, with the guard of a [`JitQuantity`]; the default
/// limit refuses some.
const LIMIT: usize = 45_000;

/// Longer programs, of humanoids, are not compiled: they take the test too long.
const LONGEST: usize = 40_000;

/// Every quantity of a robot at states (q, v, u, y), compiled once, and by the evaluator compiled and not.
fn check(robot: &Robot, states: &[[Vec<f64>; 4]]) -> Result<(), String> {
    let directions: Vec<Vec<f64>> =
        states.iter().map(|[.., y]| y.iter().map(|y| 0.3 - y).collect()).collect();
    let rounding =
        |([q, v, u, y], d): (&[Vec<f64>; 4], &Vec<f64>)| Rounding::new(robot, At { q, v, u, y, d });
    // Counted where a program is judged: of a robot with constraints there is none.
    let roundings: LazyCell<Vec<Rounding>, _> =
        LazyCell::new(|| states.iter().zip(&directions).map(rounding).collect());
    for (quantity, coordinates) in quantities() {
        let Ok(program) = robot_program(robot, quantity, coordinates, &ProgramOptions::default()) else {
            continue;
        };
        if program.steps() > LONGEST {
            continue;
        }
        let compiled = Compiled::<f64>::with_limit(&program, LIMIT).map_err(|error| error.to_string())?;
        let lanes = Compiled::lanes(&program).map_err(|error| error.to_string())?;
        let mut evaluator = JitQuantity::with_limit(robot, quantity, coordinates, LIMIT).unwrap();
        let mut fallback = JitQuantity::with_limit(robot, quantity, coordinates, 0).unwrap();
        for (([q, v, u, y], d), rounding) in states.iter().zip(&directions).zip(roundings.iter()) {
            let p = Hamiltonian::<f64>::new(robot).momentum(q, v).unwrap().to_vec();
            let second = if coordinates == Coordinates::Hamiltonian { p } else { v.clone() };
            let state = State { q: q.clone(), second, u: u.clone(), y: y.clone(), d: d.clone() };
            let inputs = state.inputs(&program);
            let expected = expected(robot, quantity, coordinates, &state, rounding);
            let mut outputs = vec![f64::NAN; compiled.outputs()];
            compiled.call(&inputs, &mut outputs).unwrap();
            judge(&program, &outputs, &expected)?;
            let four: Vec<[f64; 4]> =
                inputs.iter().map(|&input| [input, 0.5 * input, input, -input]).collect();
            let mut in_lanes = vec![[f64::NAN; 4]; compiled.outputs()];
            lanes.call(&four, &mut in_lanes).unwrap();
            for lane in [0, 2] {
                let outputs: Vec<f64> = in_lanes.iter().map(|output| output[lane]).collect();
                judge(&program, &outputs, &expected)?;
            }
            let mut again = vec![f64::NAN; evaluator.outputs()];
            evaluator.evaluate(&inputs, &mut again).unwrap();
            judge(&program, &again, &expected)?;
            fallback.evaluate(&inputs, &mut again).unwrap();
            judge(&program, &again, &expected)?;
        }
    }
    Ok(())
}

#[test]
fn every_quantity_of_every_robot_file_agrees_with_the_generic_code() {
    if !compiles() {
        return;
    }
    for robot in all_robots() {
        let n = robot.dof();
        let mut random = fastrand::Rng::with_seed(5);
        let mut numbers = |count: usize, size: f64| -> Vec<f64> {
            (0..count).map(|_| size * (2.0 * random.f64() - 1.0)).collect()
        };
        let mut states: Vec<[Vec<f64>; 4]> = (0..4)
            .map(|_| [numbers(n, 3.0), numbers(n, 2.0), numbers(n, 5.0), numbers(2 * n, 1.0)])
            .collect();
        // Both sides of every choice of smooth friction: velocities of both signs, and rest.
        let mirrored = states[0].clone().map(|part| part.iter().map(|x| -x).collect());
        states.push(mirrored);
        states.push([vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![1.0; 2 * n]]);
        check(&robot, &states).unwrap();
    }
}

/// A floating body with a spherical and a revolute joint, as programs and as machine code; where a quaternion
/// has another length than 1 the generic code decides.
#[test]
fn robots_with_quaternions_agree_with_the_generic_code() {
    if !compiles() {
        return;
    }
    let body = |x: f64| LinkInertia::about_com(1.0 + x, [x, 0.2, -0.1], nalgebra::Matrix3::identity() * 0.3);
    let robot = Robot::builder("flying")
        .joint(JointSpec::floating("root").carrying(body(0.3)))
        .joint(JointSpec::spherical("hip").on("root").carrying(body(0.5)))
        .joint(JointSpec::revolute("knee").on("hip").axis([0.3, -0.5, 0.8]).carrying(body(0.1)))
        .build()
        .unwrap();
    let (space, mut random) = (ConfigurationSpace::new(&robot), fastrand::Rng::with_seed(3));
    let mut numbers = |count: usize, size: f64| -> Vec<f64> {
        (0..count).map(|_| size * (2.0 * random.f64() - 1.0)).collect()
    };
    let n = space.dof();
    let states: Vec<[Vec<f64>; 4]> = (0..4)
        .map(|_| {
            let mut q = space.neutral();
            space.integrate(&space.neutral(), &numbers(n, 2.0), &mut q).unwrap();
            [q, numbers(n, 2.0), numbers(n, 5.0), numbers(2 * n, 1.0)]
        })
        .collect();
    check(&robot, &states).unwrap();
    let mut inertia = JitQuantity::new(&robot, Quantity::MassMatrix, Coordinates::Hamiltonian).unwrap();
    assert!(matches!(inertia.backend(), Backend::Compiled { .. }), "{}", inertia.backend());
    let (mut q, mut m) = (states[0][0].clone(), vec![0.0; n * n]);
    inertia.evaluate(&q, &mut m).unwrap();
    let four = JitLanes::new(&robot, Quantity::MassMatrix, Coordinates::Hamiltonian).unwrap().unwrap();
    q[8] *= 1.1;
    let error = inertia.evaluate(&q, &mut m).unwrap_err();
    assert!(matches!(&error, EvalError::NotUnit { joint, .. } if joint == "hip"), "{error}");
    let lanes: Vec<[f64; 4]> = (0..q.len()).map(|k| [states[0][0][k], q[k], states[1][0][k], q[k]]).collect();
    let certain = four.evaluate(&lanes, &mut vec![[0.0; 4]; n * n]).unwrap();
    assert_eq!(certain, [true, false, true, false]);
    // A model for steps has x = (q, p) of 2n entries.
    let error = JitModel::new(&robot, Coordinates::Hamiltonian).unwrap_err();
    assert!(matches!(error, CodegenError::Eval(EvalError::FreeJoint { .. })), "{error}");
}

properties! {
    64;

    #[test]
    fn every_quantity_of_random_robots_agrees_with_the_generic_code(case in cases(8)) {
        if compiles() {
            let Case { q, v, u, y, .. } = &case;
            check(&case.robot(), &[[q.clone(), v.clone(), u.clone(), y.clone()]]).map_err(TestCaseError::fail)?;
        }
    }
}

#[test]
fn the_backend_has_the_reason_and_what_to_do() {
    let robot = Robot::from_file(folder().join("robots/ur5.urdf")).unwrap();
    let with_limit =
        |limit| JitQuantity::with_limit(&robot, Quantity::FX, Coordinates::Hamiltonian, limit).unwrap();
    let (long, far_too_long, unwanted) = (with_limit(800), with_limit(10), with_limit(0));
    assert!(matches!(unwanted.backend(), Backend::Generic { reason: JitError::NotAsked }));
    if compiles() {
        for (evaluator, begin, limit) in [
            (&long, "generic code: the program has ", "the limit is 800"),
            (&far_too_long, "generic code: the recording was stopped after ", "more than 10 steps"),
        ] {
            let text = evaluator.backend().to_string();
            assert!(text.starts_with(begin) && text.contains(limit) && text.contains("with_limit"), "{text}");
        }
        assert!(matches!(long.backend(), Backend::Generic { reason: JitError::TooLong { limit: 800, .. } }));
        let given_up = Backend::Generic { reason: &JitError::GivenUp { operations: 40, limit: 10 } };
        assert_eq!(far_too_long.backend().to_string(), given_up.to_string());
        let compiled = with_limit(DEFAULT_LIMIT);
        assert!(compiled.backend().to_string().starts_with("machine code: "), "{}", compiled.backend());
    }
    let none = JitQuantity::new(&robot, Quantity::InverseDynamics, Coordinates::Hamiltonian);
    assert!(
        none.unwrap_err().to_string().contains("there is no inverse_dynamics in hamiltonian coordinates")
    );
}
