//! Programs of robots, evaluated step by step, against the generic code.

use costate::EvalError;
use costate::codegen::{
    COptions, CodegenError, Coordinates, DEFAULT_LIMIT, Program, ProgramOptions, Quantity, acados_source,
    casadi_source, parameter_names, parameter_values, robot_program,
};
use costate::hamiltonian::Hamiltonian;
use costate::robot::{JointSpec, LinkInertia, LoadOptions, Placement, Robot, Spring, Wrench};
use costate_test_support::generic::{Rounding, State, expected, judge};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases, free_cases};
use costate_test_support::rounding::At;
use costate_test_support::wrenches::pulled;
use proptest::prelude::*;
use std::path::Path;

/// All quantities of a robot, in all coordinates, whole and alone.
fn programs(robot: &Robot) -> Vec<(Program, Quantity, Coordinates)> {
    let mut programs = Vec::new();
    for coordinates in [Coordinates::Hamiltonian, Coordinates::Lagrangian] {
        for quantity in Quantity::ALL {
            for only in [false, true] {
                match robot_program(robot, quantity, coordinates, &ProgramOptions::default().with_only(only))
                {
                    Ok(program) => programs.push((program, quantity, coordinates)),
                    Err(CodegenError::Quantity { .. }) => {}
                    Err(error) => panic!("{}: {error}", robot.name()),
                }
            }
        }
    }
    assert_eq!(programs.len(), 2 * (7 + 9));
    programs
}

/// Every program of a robot at one state (q, v).
fn check(robot: &Robot, q: &[f64], v: &[f64], u: &[f64], y: &[f64]) -> Result<(), String> {
    let p = Hamiltonian::<f64>::new(robot).momentum(q, v).unwrap().to_vec();
    let d: Vec<f64> = y.iter().map(|y| 0.3 - y).collect();
    let rounding = Rounding::new(robot, At { q, v, u, y, d: &d });
    let mut work = Vec::new();
    for (program, quantity, coordinates) in programs(robot) {
        let second = if coordinates == Coordinates::Hamiltonian { p.clone() } else { v.to_vec() };
        let state = State { q: q.to_vec(), second, u: u.to_vec(), y: y.to_vec(), d: d.clone() };
        let mut outputs = vec![0.0; program.outputs()];
        program.evaluate(&state.inputs(&program), &mut outputs, &mut work).unwrap();
        judge(&program, &outputs, &expected(robot, quantity, coordinates, &state, &rounding))?;
    }
    Ok(())
}

fn all_robots() -> Vec<Robot> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut files: Vec<_> =
        std::fs::read_dir(folder.join("robots")).unwrap().map(|e| e.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "urdf" || e == "toml"));
    files.extend(
        ["friction_tree.toml", "mimic_tree.toml", "pulled_arm.toml"]
            .map(|name| folder.join("tests/fixtures").join(name)),
    );
    files.sort();
    assert!(files.len() >= 9);
    let options = LoadOptions::default().friction(true);
    let open = |file| Robot::from_file_with(file, options).unwrap().without_constraints();
    files.iter().map(open).collect()
}

/// With constants as arguments, too.
#[test]
fn programs_of_robots_with_constraints_are_refused_by_name() {
    let four_bar = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/four_bar.toml")).unwrap();
    for options in [ProgramOptions::default(), ProgramOptions::default().with_parameters(true)] {
        for coordinates in [Coordinates::Hamiltonian, Coordinates::Lagrangian] {
            let error = robot_program(&four_bar, Quantity::F, coordinates, &options).unwrap_err();
            assert!(error.to_string().contains("'rocker_pivot'"), "{error}");
        }
    }
}

/// Constants of a robot with quaternions are numbers; functions of x = (q, v) for other tools take none.
#[test]
fn what_takes_no_quaternions_is_refused_by_name() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/free_tree.toml");
    let robot = Robot::from_file(file).unwrap();
    let options = ProgramOptions::default();
    let inertia = robot_program(&robot, Quantity::MassMatrix, Coordinates::Lagrangian, &options).unwrap();
    assert_eq!((inertia.inputs(), inertia.outputs()), (20, 17 * 17));
    let notes = inertia.to_c(&COptions::default()).unwrap();
    assert!(notes.contains("joint root is a quaternion") && notes.contains("unit quaternions"), "{notes}");
    let options = options.with_parameters(true);
    let errors = [
        robot_program(&robot, Quantity::F, Coordinates::Lagrangian, &options).unwrap_err(),
        casadi_source(&robot, None, &COptions::default()).unwrap_err(),
        acados_source(&robot, None, &COptions::default()).unwrap_err(),
    ];
    assert!(errors.iter().all(|error| error.to_string().contains("'root' is floating")), "{errors:?}");
    let with_wrench = robot.with_wrench("root", Wrench::default()).unwrap();
    for coordinates in Coordinates::ALL {
        let error =
            robot_program(&with_wrench, Quantity::F, coordinates, &ProgramOptions::default()).unwrap_err();
        let expected = EvalError::FreeJointAndWrench { joint: "root".into(), kind: "floating" };
        assert!(matches!(&error, CodegenError::Eval(found) if *found == expected), "{error}");
        assert!(error.to_string().contains("take no wrenches"), "{error}");
    }
}

#[test]
fn programs_of_every_robot_file_agree_with_the_generic_code() {
    for robot in all_robots() {
        let n = robot.dof();
        for seed in 0..3 {
            let mut random = fastrand::Rng::with_seed(seed);
            let mut numbers = |count: usize, size: f64| -> Vec<f64> {
                (0..count).map(|_| size * (2.0 * random.f64() - 1.0)).collect()
            };
            let (q, v, u, y) = (numbers(n, 3.0), numbers(n, 2.0), numbers(n, 5.0), numbers(2 * n, 1.0));
            check(&robot, &q, &v, &u, &y).unwrap();
        }
    }
}

properties! {
    48;

    #[test]
    fn programs_of_random_robots_agree_with_the_generic_code(case in cases(7)) {
        let Case { q, v, u, y, .. } = &case;
        check(&case.robot(), q, v, u, y).map_err(TestCaseError::fail)?;
    }
}

properties! {
    16;

    #[test]
    fn programs_of_random_robots_with_quaternions_agree_with_the_generic_code(case in free_cases(3)) {
        let Case { q, v, u, y, .. } = &case;
        check(&case.robot(), q, v, u, y).map_err(TestCaseError::fail)?;
    }
}

/// Every program of one robot with parameters, given those of another one.
fn check_other(recorded: &Robot, other: &Robot, state: &State) -> Result<(), String> {
    assert_eq!(parameter_names(recorded), parameter_names(other));
    let p = Hamiltonian::<f64>::new(other).momentum(&state.q, &state.second).unwrap().to_vec();
    let State { q, second: v, u, y, d } = state;
    let rounding = Rounding::new(other, At { q, v, u, y, d });
    for coordinates in [Coordinates::Hamiltonian, Coordinates::Lagrangian] {
        for quantity in Quantity::ALL {
            let options = ProgramOptions::default().with_parameters(true);
            let program = match robot_program(recorded, quantity, coordinates, &options) {
                Err(CodegenError::Quantity { .. }) => continue,
                program => program.map_err(|error| error.to_string())?,
            };
            let mut state = state.clone();
            if coordinates == Coordinates::Hamiltonian {
                state.second.clone_from(&p);
            }
            let expected = expected(other, quantity, coordinates, &state, &rounding);
            let mut inputs = state.inputs(&program);
            inputs.extend(parameter_values(other));
            let mut outputs = vec![0.0; program.outputs()];
            program.evaluate(&inputs, &mut outputs, &mut Vec::new()).unwrap();
            judge(&program, &outputs, &expected)?;
        }
    }
    Ok(())
}

#[test]
fn wrenches_and_the_places_of_their_frames_are_parameters() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/pulled_arm.toml");
    let text = std::fs::read_to_string(file).unwrap();
    let read = |text: &str| Robot::from_toml_str(text, LoadOptions::default()).unwrap();
    let recorded = read(&text);
    let names = parameter_names(&recorded);
    let of_wrenches: Vec<&str> =
        names.iter().skip_while(|name| *name != "gravity_z").map(String::as_str).collect();
    assert_eq!(of_wrenches[1..5], ["frame tip.x", "frame tip.y", "frame tip.z", "wrench 0 at tip.moment_x"]);
    assert_eq!((of_wrenches.len(), of_wrenches[15]), (1 + 3 + 2 * 6, "wrench 1 at branch.force_z"));
    let mut changed = text.clone();
    for (from, to) in [
        ("force = [4.0, -7.0, 2.0]", "force = [-1.0, 2.5, 6.0]"),
        ("moment = [0.5, -0.2, 0.0]", "moment = [-0.1, 0.0, 0.7]"),
        ("xyz = [0.0, 0.0, 0.12]", "xyz = [0.05, -0.03, 0.3]"),
        ("xyz = [0.4, 0.1, 0.0]", "xyz = [0.3, -0.2, 0.15]"),
        ("mass = 1.5", "mass = 2.5"),
    ] {
        assert!(changed.contains(from), "{from}");
        changed = changed.replace(from, to);
    }
    let state = State {
        q: vec![0.3, -0.4, 1.1, -0.8],
        second: vec![-0.5, 0.2, 0.9, 1.3],
        u: vec![0.1, 0.4, -0.7, 1.0],
        y: vec![0.8, 0.5, -0.2, 0.1, -0.4, -0.7, 1.0, 1.3],
        d: vec![-0.6, -0.2, 0.2, 0.6, 1.0, 1.4, -1.8, 2.2],
    };
    for other in [&recorded, &read(&changed)] {
        check_other(&recorded, other, &state).unwrap();
    }
}

/// The same joints with other masses, lengths, springs, friction, armature and gravity.
fn varied(case: &Case, factor: f64) -> Case {
    let mut other = case.clone();
    for (i, part) in other.parts.iter_mut().enumerate() {
        let shift = factor * (1.0 + i as f64);
        part.xyz = part.xyz.map(|x| 0.7 * x + 0.1 * shift.sin());
        part.com = part.com.map(|x| 0.5 * x - 0.1 * shift.cos());
        part.radii = part.radii.map(|r| r * (1.2 + 0.3 * shift.sin()));
        part.mass *= 1.5 + shift.sin();
        part.massless = false;
        part.armature *= 1.3;
        part.spring = [part.spring[0] * 0.8, part.spring[1] * 1.1];
        part.friction = [part.friction[0] * 1.2, part.friction[1] * 0.6, part.friction[2] * 1.5];
    }
    other.coupling.iter_mut().for_each(|entry| *entry *= 1.1);
    other.gravity = other.gravity.map(|g| 1.2 * g + 0.3);
    other
}

properties! {
    64;

    /// A program recorded from one robot, with the parameters of another one.
    #[test]
    fn programs_with_parameters_are_right_for_other_robots(case in cases(5), factor in 0.3..2.0_f64) {
        let (mut recorded, mut other) = (case.robot(), varied(&case, factor).robot());
        if factor > 1.0 {
            (recorded, other) = (pulled(&recorded, 1.0), pulled(&other, factor));
        }
        prop_assume!(costate_test_support::random_robot::condition(&other, &case.q) < 1e9);
        let Case { q, v, u, y, .. } = case;
        let d = y.iter().map(|y| 0.3 - y).collect();
        check_other(&recorded, &other, &State { q, second: v, u, y, d }).map_err(TestCaseError::fail)?;
    }
}

/// A chain of revolute joints in general directions.
fn chain(joints: usize) -> Robot {
    let body = LinkInertia::about_com(1.0, [0.1, 0.2, 0.3], nalgebra::Matrix3::identity() * 0.1);
    let mut builder = Robot::builder(format!("chain of {joints}"));
    for k in 0..joints {
        let placed = Placement::from_xyz_rpy([0.1, 0.2, 0.3], [0.4, 0.5 + 0.01 * k as f64, 0.6]);
        let joint = JointSpec::revolute(format!("j{k}")).placed(placed).axis([0.2, -0.4, 0.7]).carrying(body);
        builder = builder.joint(if k > 0 { joint.on(format!("j{}", k - 1)) } else { joint });
    }
    builder.build().unwrap()
}

/// A bush of joints in general directions with all that a joint can have; masses, springs and lengths are
/// multiplied.
fn bush(joints: usize, factor: f64) -> Robot {
    let body =
        LinkInertia::about_com(factor, [0.1, 0.2, 0.3], nalgebra::Matrix3::identity() * (0.1 * factor));
    let mut builder = Robot::builder(format!("bush of {joints}"));
    for k in 0..joints {
        let (x, name) = (k as f64, format!("j{k}"));
        let joint = if k == 2 { JointSpec::prismatic(name) } else { JointSpec::revolute(name) };
        let placed = Placement::from_xyz_rpy([0.1 * factor, 0.2, 0.3], [0.4, 0.5 + 0.1 * x, 0.6 - 0.2 * x]);
        let mut joint = joint.placed(placed).axis([0.2 + 0.1 * x, -0.4, 0.7]).carrying(body);
        joint = joint.armature(0.1 * factor).spring(Spring { stiffness: 2.0 * factor, rest: 0.1 });
        if k + 1 == joints {
            joint = joint.mimicking("j1", -0.7, 0.3);
        }
        let parent = if k == 6 { 3 } else { k.wrapping_sub(1) };
        builder = builder.joint(if k > 0 { joint.on(format!("j{parent}")) } else { joint });
    }
    builder.build().unwrap()
}

/// Second derivatives in (q, v) are recorded in the axes of the world then.
#[test]
fn programs_of_axes_in_general_directions_are_right() {
    for joints in [6, 9] {
        let robot = bush(joints, 1.0);
        let numbers =
            |from: f64, count: usize| (0..count).map(|i| (from + 1.3 * i as f64).sin()).collect::<Vec<_>>();
        let n = robot.dof();
        let [q, v, u] = [0.3, 0.5, 0.7].map(|from| numbers(from, n));
        let y = numbers(0.9, 2 * n);
        check(&robot, &q, &v, &u, &y).unwrap();
        let d = y.iter().map(|y| 0.3 - y).collect();
        check_other(&robot, &bush(joints, 1.3), &State { q, second: v, u, y, d }).unwrap();
    }
}

#[test]
fn long_chains_are_refused_before_they_are_recorded_to_the_end() {
    let options = ProgramOptions::default().with_limit(DEFAULT_LIMIT);
    for coordinates in Coordinates::ALL {
        let refused =
            |joints| robot_program(&chain(joints), Quantity::YFXX, coordinates, &options).unwrap_err();
        let name = format!("chain_of_100_{coordinates}_y_f_xx");
        let (operations, limit) = (100_000, DEFAULT_LIMIT);
        assert_eq!(refused(100), CodegenError::LongRecording { name, operations, limit });
        let (robot, joints, entries) = (String::from("chain of 500"), 500, 125_250);
        assert_eq!(refused(500), CodegenError::LargeRobot { robot, joints, entries, limit });
    }
}

/// A recording is longer than its program, but not so much that the limit refuses a program that it allows.
#[test]
fn programs_within_the_limit_are_recorded() {
    for robot in all_robots() {
        for coordinates in Coordinates::ALL {
            for quantity in Quantity::ALL {
                for (only, parameters) in [(false, false), (true, false), (false, true)] {
                    let options = ProgramOptions::default().with_only(only).with_parameters(parameters);
                    let whole = match robot_program(&robot, quantity, coordinates, &options) {
                        Err(CodegenError::Quantity { .. }) => continue,
                        whole => whole.unwrap(),
                    };
                    let options = options.with_limit(DEFAULT_LIMIT);
                    let limited = robot_program(&robot, quantity, coordinates, &options);
                    assert_eq!(limited.is_ok(), whole.steps() <= DEFAULT_LIMIT, "{}", whole.name());
                }
            }
        }
    }
}
