//! `costate codegen`.

use crate::child::{costate, root, stderr, stdout};

#[test]
fn codegen_writes_what_the_library_does() {
    use costate::codegen::{COptions, Coordinates, ProgramOptions, Quantity, RustOptions, robot_program};
    let robot = costate::robot::Robot::from_file(root().join("robots/two_link.toml")).unwrap();
    let (hamiltonian, lagrangian) = (Coordinates::Hamiltonian, Coordinates::Lagrangian);
    let program =
        robot_program(&robot, Quantity::YFXX, hamiltonian, &ProgramOptions::default().with_only(true))
            .unwrap();
    let arguments = ["codegen", "robots/two_link.toml", "--quantity", "y_f_xx", "--only"];
    let output = costate(&arguments, b"");
    assert!(output.status.success() && output.stderr.is_empty(), "{}", stderr(&output));
    assert_eq!(stdout(&output), program.to_rust(&RustOptions::default()).unwrap());
    let program = robot_program(&robot, Quantity::F, lagrangian, &ProgramOptions::default()).unwrap();
    let file = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("two_link.c");
    let path = file.to_str().unwrap();
    let arguments = ["codegen", "robots/two_link.toml", "--quantity", "f", "--coordinates", "lagrangian"];
    let output = costate(&[&arguments[..], &["--lang", "c", "-o", path]].concat(), b"");
    assert!(output.status.success() && output.stdout.is_empty(), "{}", stderr(&output));
    assert_eq!(std::fs::read_to_string(file).unwrap(), program.to_c(&COptions::default()).unwrap());
}

/// In both languages, of robots with quaternions in TOML and of URDFs on a floating base.
#[test]
fn codegen_takes_robots_with_quaternions() {
    use costate::codegen::{
        COptions, Coordinates, ProgramOptions, Quantity, RustOptions, c_header, c_source, robot_program,
    };
    use costate::robot::{LoadOptions, Robot};
    let robot = Robot::from_file(root().join("examples/problems/robots/satellite.toml")).unwrap();
    let options = ProgramOptions::default();
    let of = |quantity, coordinates| robot_program(&robot, quantity, coordinates, &options).unwrap();
    let satellite = ["codegen", "examples/problems/robots/satellite.toml", "--quantity"];
    let output = costate(&[&satellite[..], &["y_f_xx"]].concat(), b"");
    assert!(output.status.success() && output.stderr.is_empty(), "{}", stderr(&output));
    let program = of(Quantity::YFXX, Coordinates::Hamiltonian);
    assert_eq!(stdout(&output), program.to_rust(&RustOptions::default()).unwrap());
    let header = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("satellite.h");
    let more = ["f_x", "--quantity", "inverse_dynamics", "--coordinates", "lagrangian", "--lang", "c"];
    let to = ["--column-major", "--header", header.to_str().unwrap()];
    let output = costate(&[&satellite[..], &more, &to].concat(), b"");
    assert!(output.status.success() && output.stderr.is_empty(), "{}", stderr(&output));
    let programs = [Quantity::FX, Quantity::InverseDynamics]
        .map(|quantity| of(quantity, Coordinates::Lagrangian).column_major());
    assert_eq!(stdout(&output), c_source(&programs, &COptions::default()).unwrap());
    assert_eq!(std::fs::read_to_string(header).unwrap(), c_header(&programs).unwrap());
    let output = costate(&["codegen", "robots/ur5.urdf", "--floating-base", "--quantity", "f"], b"");
    assert!(output.status.success(), "{}", stderr(&output));
    let floating = LoadOptions::default().floating_base(true);
    let robot = Robot::from_file_with(root().join("robots/ur5.urdf"), floating).unwrap();
    let program = robot_program(&robot, Quantity::F, Coordinates::Hamiltonian, &options).unwrap();
    assert_eq!(stdout(&output), program.to_rust(&RustOptions::default()).unwrap());
}

#[test]
fn codegen_names_the_joint_and_what_takes_no_quaternions() {
    let step = ["--scheme", "rk4", "--dt", "0.01"];
    for (asked, reason) in [
        (&["--quantity", "f", "--parameters"][..], "--parameters"),
        (&["--abi", "casadi"], "--abi"),
        (&["--abi", "acados"], "--abi"),
        (&[&["--quantity", "step"][..], &step].concat(), "--quantity step, step_z and y_step_zz"),
        (&["--quantity", "pontryagin"], "--quantity pontryagin and pontryagin_rate"),
    ] {
        let robot = ["codegen", "tests/fixtures/free_tree.toml"];
        let output = costate(&[&robot[..], asked].concat(), b"");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{asked:?}");
        let error = stderr(&output);
        let expected =
            format!("'root' is floating, its orientation a quaternion, and cannot be taken by {reason};");
        assert!(error.contains(&expected), "{error}");
    }
}

#[test]
fn codegen_says_why_it_writes_nothing() {
    for (quantity, more, reason) in [
        ("f_x", ["--limit", "100"], "the limit is 100"),
        ("y_f_xx_d", ["--coordinates", "lagrangian"], "available: f, f_x, y_f_x, y_f_xx"),
        ("step", ["--lang", "c"], "--scheme rk4 --dt 0.01"),
        ("f", ["--quantity", "f_x"], "need --lang c"),
        ("f", ["--header", "target/f.h"], "--lang c"),
        ("f", ["--abi", "casadi"], "cannot be used with"),
        ("momentum", ["--lang", "c"], "mass_matrix"),
        (
            "f",
            ["--problem", "examples/problems/ur5_reach.toml"],
            "--problem can only be used with --quantity pontryagin",
        ),
        (
            "pontryagin",
            ["--problem", "examples/problems/two_link.toml"],
            "robot 'two_link' is not the robot 'ur5",
        ),
        ("pontryagin", ["--coordinates", "lagrangian"], "--coordinates lagrangian cannot be used with"),
        ("pontryagin_rate", ["--limit", "10"], "the limit is 10"),
        ("f", ["-o", "nowhere/at/all.rs"], "nowhere/at/all.rs"),
    ] {
        let output =
            costate(&[&["codegen", "robots/ur5.urdf", "--quantity", quantity], &more[..]].concat(), b"");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{quantity}");
        assert!(stderr(&output).contains(reason), "{}", stderr(&output));
    }
}

#[test]
fn codegen_writes_files_for_other_programs() {
    use costate::Coordinates;
    use costate::codegen::{
        COptions, ProgramOptions, Quantity, StepOrder, StepSpec, acados_source, c_header, c_source,
        casadi_source, robot_program, step_program,
    };
    let robot = costate::robot::Robot::from_file(root().join("robots/two_link.toml")).unwrap();
    let step = StepSpec::RungeKutta4 { dt: 0.01, coordinates: Coordinates::Lagrangian };
    let timed = ["--scheme", "rk4", "--dt", "0.01"];
    let c = COptions::default();
    let expected =
        [casadi_source(&robot, Some(step), &c).unwrap(), acados_source(&robot, Some(step), &c).unwrap()];
    for (abi, expected) in ["casadi", "acados"].into_iter().zip(expected) {
        let arguments = ["codegen", "robots/two_link.toml", "--abi", abi];
        let output = costate(&[&arguments[..], &timed].concat(), b"");
        assert!(output.status.success(), "{}", stderr(&output));
        assert_eq!(stdout(&output), expected);
    }
    let header = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("two_link.h");
    let arguments =
        ["codegen", "robots/two_link.toml", "--quantity", "f_x", "--quantity", "step_z", "--lang", "c"];
    let more = ["--coordinates", "lagrangian", "--column-major", "--header", header.to_str().unwrap()];
    let output = costate(&[&arguments[..], &more, &timed].concat(), b"");
    assert!(output.status.success(), "{}", stderr(&output));
    let options = ProgramOptions::default();
    let programs = [
        robot_program(&robot, Quantity::FX, Coordinates::Lagrangian, &options).unwrap().column_major(),
        step_program(&robot, step, StepOrder::First, &options).unwrap().column_major(),
    ];
    assert_eq!(stdout(&output), c_source(&programs, &c).unwrap());
    assert_eq!(std::fs::read_to_string(header).unwrap(), c_header(&programs).unwrap());
}

#[test]
fn codegen_writes_the_extremals_of_a_problem_file() {
    use costate::codegen::RustOptions;
    use costate_control::{Bounds, Problem, ProgramOf, pontryagin_program};
    let robot = costate::robot::Robot::from_file(root().join("robots/two_link.toml")).unwrap();
    let plain = Problem::rest_to_rest(robot, &[0.0; 2], &[0.0; 2], 1.0);
    let bounded = plain.clone().with_bounds(Bounds::new(vec![-12.0, -5.0], vec![12.0, 5.0]));
    let asked = ["--problem", "examples/problems/two_link_bounded.toml"];
    for (quantity, more, problem, of) in [
        ("pontryagin", &[][..], &plain, ProgramOf::Jacobian),
        ("pontryagin", &asked[..], &bounded, ProgramOf::Jacobian),
        ("pontryagin_rate", &asked[..], &bounded, ProgramOf::Rate),
    ] {
        let output =
            costate(&[&["codegen", "robots/two_link.toml", "--quantity", quantity], more].concat(), b"");
        assert!(output.status.success() && output.stderr.is_empty(), "{}", stderr(&output));
        let source = pontryagin_program(problem, of).unwrap().to_rust(&RustOptions::default()).unwrap();
        assert_eq!(stdout(&output), source);
    }
}
