//! Generated source: what it looks like, and that the C of it computes what the generic code does.

use costate::codegen::{
    COptions, CodegenError, Coordinates, Expr, Program, ProgramOptions, Quantity, RecordedResult,
    RustOptions, c_header, c_source, robot_program,
};
use costate::configuration::ConfigurationSpace;
use costate::hamiltonian::Hamiltonian;
use costate::robot::{JointSpec, LinkInertia, LoadOptions, Robot};
use costate::scalar::Scalar;
use costate_test_support::generic::{Rounding, State, expected, judge};
use costate_test_support::rounding::At;
use std::path::{Path, PathBuf};
use std::process::Command;

fn robot(file: &str) -> Robot {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    Robot::from_file_with(path, LoadOptions::default().friction(true)).unwrap()
}

fn program(file: &str, quantity: Quantity, coordinates: Coordinates) -> Program {
    robot_program(&robot(file), quantity, coordinates, &ProgramOptions::default()).unwrap()
}

/// Without the version, which changes with every release.
fn stable(text: &str) -> String {
    text.replace(env!("CARGO_PKG_VERSION"), "VERSION")
}

#[test]
fn rust_source_of_two_links_looks_like_this() {
    let program = program("robots/two_link.toml", Quantity::FX, Coordinates::Hamiltonian);
    insta::assert_snapshot!("two_link_f_x_rust", stable(&program.to_rust(&RustOptions::default()).unwrap()));
}

#[test]
fn rust_source_for_an_existing_trait_looks_like_this() {
    let program = program("robots/pendulum.toml", Quantity::YFX, Coordinates::Hamiltonian);
    let options = RustOptions::default().with_number(Some("costate::scalar::Scalar".into()));
    insta::assert_snapshot!("pendulum_y_f_x_rust", stable(&program.to_rust(&options).unwrap()));
}

#[test]
fn c_source_of_two_links_looks_like_this() {
    let program = program("robots/two_link.toml", Quantity::F, Coordinates::Lagrangian);
    insta::assert_snapshot!("two_link_qdd_c", stable(&program.to_c(&COptions::default()).unwrap()));
}

#[test]
fn the_same_robot_gives_the_same_text() {
    let texts = || {
        let program = program("tests/fixtures/friction_tree.toml", Quantity::YFXX, Coordinates::Hamiltonian);
        (program.to_rust(&RustOptions::default()).unwrap(), program.to_c(&COptions::default()).unwrap())
    };
    let here = texts();
    assert!(here == texts() && here == std::thread::spawn(texts).join().unwrap());
}

#[test]
fn too_long_a_text_is_refused_with_its_size_and_the_way_out() {
    let program = program("robots/ur5.urdf", Quantity::FX, Coordinates::Hamiltonian);
    let (steps, limit) = (program.steps(), program.steps() - 1);
    let name = program.name().to_string();
    let error = program.to_c(&COptions::default().with_limit(limit)).unwrap_err();
    assert_eq!(error, CodegenError::TooLarge { name, steps, limit });
    assert!(error.to_string().contains(&format!("--limit {steps}")));
    assert_eq!(program.to_rust(&RustOptions::default().with_limit(limit)).unwrap_err(), error);
    assert!(program.to_c(&COptions::default().with_limit(steps)).is_ok());
}

/// A C compiler of this system, or why there is none.
pub(crate) fn compiler() -> Result<String, String> {
    let name = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    match Command::new(&name).arg("--version").output() {
        Ok(output) if output.status.success() => Ok(name),
        _ => Err(format!("skipped: there is no C compiler '{name}'")),
    }
}

/// Compiles the C source of a program together with a main function that prints its results at these inputs.
pub(crate) fn run_c(cc: &str, program: &Program, inputs: &[f64], flags: &[&str]) -> Vec<f64> {
    let text = program.to_c(&COptions::default()).unwrap();
    let mut rest = inputs;
    let mut arguments = Vec::new();
    let mut main = String::from("\n#include <stdio.h>\nint main(void)\n{\n");
    for argument in program.arguments() {
        let (values, more) = rest.split_at(argument.entries);
        rest = more;
        let values: Vec<String> = values
            .iter()
            .map(|value| format!("{value:?}").replace("NaN", "NAN").replace("inf", "INFINITY"))
            .collect();
        main += &format!("    const double {}[] = {{{}}};\n", argument.name, values.join(", "));
        arguments.push(argument.name.clone());
    }
    let mut prints = String::new();
    for result in program.results() {
        let (name, count) = (&result.name, result.entries.len());
        main += &format!("    double {name}[{count}];\n");
        prints += &format!("    for (int i = 0; i < {count}; i++) printf(\"%.17g\\n\", {name}[i]);\n");
        arguments.push(name.clone());
    }
    main += &format!("    {}({});\n{prints}    return 0;\n}}\n", program.name(), arguments.join(", "));
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let stem = format!("{}_{}", program.name(), flags.concat().replace(['-', '='], "_"));
    let (source, binary) = (folder.join(format!("{stem}.c")), folder.join(&stem));
    std::fs::write(&source, text + &main).unwrap();
    let mut command = Command::new(cc);
    command.args(["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror"]).args(flags);
    let output = command.arg(&source).arg("-o").arg(&binary).arg("-lm").output().unwrap();
    assert!(output.status.success(), "{stem}: {}", String::from_utf8_lossy(&output.stderr));
    let output = Command::new(&binary).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(|line| if line.contains("nan") { f64::NAN } else { line.parse().unwrap() }).collect()
}

#[test]
fn compiled_c_agrees_with_the_generic_code() {
    let cc = match compiler() {
        Ok(cc) => cc,
        Err(reason) => return println!("{reason}"),
    };
    let cases = [
        ("robots/two_link.toml", Quantity::YFXX, Coordinates::Hamiltonian),
        ("robots/ur5.urdf", Quantity::FX, Coordinates::Hamiltonian),
        ("robots/manutec_r3.toml", Quantity::FX, Coordinates::Lagrangian),
        ("robots/cart_pole.toml", Quantity::HessianProduct, Coordinates::Hamiltonian),
        ("tests/fixtures/friction_tree.toml", Quantity::YFXX, Coordinates::Lagrangian),
    ];
    for (file, quantity, coordinates) in cases {
        let (robot, program) = (robot(file), program(file, quantity, coordinates));
        let n = robot.dof();
        let numbers =
            |from: f64, count: usize| (0..count).map(|i| 2.0 * (from + 1.7 * i as f64).sin()).collect();
        let (q, v): (Vec<f64>, Vec<f64>) = (numbers(0.3, n), numbers(-0.8, n));
        let p = Hamiltonian::<f64>::new(&robot).momentum(&q, &v).unwrap().to_vec();
        let (u, y, d) = (numbers(1.1, n), numbers(2.0, 2 * n), numbers(0.1, 2 * n));
        let rounding = Rounding::new(&robot, At { q: &q, v: &v, u: &u, y: &y, d: &d });
        let second = if coordinates == Coordinates::Hamiltonian { p } else { v };
        let state = State { q, second, u, y, d };
        let expected = expected(&robot, quantity, coordinates, &state, &rounding);
        for flags in [["-O0"].as_slice(), &["-O2", "-march=native"]] {
            let found = run_c(&cc, &program, &state.inputs(&program), flags);
            judge(&program, &found, &expected).unwrap();
        }
    }
}

/// Floating, spherical and revolute joints; q is away from the neutral configuration.
#[test]
fn compiled_c_of_robots_with_quaternions_agrees_with_the_generic_code() {
    let cc = match compiler() {
        Ok(cc) => cc,
        Err(reason) => return println!("{reason}"),
    };
    let body = |x: f64| LinkInertia::about_com(1.0 + x, [x, 0.2, -0.1], nalgebra::Matrix3::identity() * 0.3);
    let robot = Robot::builder("flying")
        .joint(JointSpec::floating("root").carrying(body(0.3)))
        .joint(JointSpec::spherical("hip").on("root").carrying(body(0.5)))
        .joint(JointSpec::revolute("knee").on("hip").axis([0.3, -0.5, 0.8]).carrying(body(0.1)))
        .build()
        .unwrap();
    let (space, n) = (ConfigurationSpace::new(&robot), robot.dof());
    let numbers = |from: f64, count: usize| -> Vec<f64> {
        (0..count).map(|i| 2.0 * (from + 1.7 * i as f64).sin()).collect()
    };
    let mut q = space.neutral();
    space.integrate(&space.neutral(), &numbers(0.3, n), &mut q).unwrap();
    let v = numbers(-0.8, n);
    let p = Hamiltonian::<f64>::new(&robot).momentum(&q, &v).unwrap().to_vec();
    for (quantity, coordinates) in [
        (Quantity::F, Coordinates::Hamiltonian),
        (Quantity::FX, Coordinates::Lagrangian),
        (Quantity::YFXX, Coordinates::Hamiltonian),
        (Quantity::HessianProduct, Coordinates::Hamiltonian),
        (Quantity::InverseDynamics, Coordinates::Lagrangian),
    ] {
        let program = robot_program(&robot, quantity, coordinates, &ProgramOptions::default()).unwrap();
        let (u, y, d) = (numbers(1.1, n), numbers(2.0, 2 * n), numbers(0.1, 2 * n));
        let rounding = Rounding::new(&robot, At { q: &q, v: &v, u: &u, y: &y, d: &d });
        let second = if coordinates == Coordinates::Hamiltonian { p.clone() } else { v.clone() };
        let state = State { q: q.clone(), second, u, y, d };
        let expected = expected(&robot, quantity, coordinates, &state, &rounding);
        let found = run_c(&cc, &program, &state.inputs(&program), &["-O1"]);
        judge(&program, &found, &expected).unwrap();
    }
}

#[test]
fn several_programs_are_one_source_with_a_header() {
    let robot = robot("robots/two_link.toml");
    let of = |quantity| {
        robot_program(&robot, quantity, Coordinates::Lagrangian, &ProgramOptions::default()).unwrap()
    };
    let programs = [of(Quantity::F), of(Quantity::FX).column_major()];
    let (text, header) = (c_source(&programs, &COptions::default()).unwrap(), c_header(&programs).unwrap());
    for (program, order) in programs.iter().zip(["row by row", "column by column"]) {
        let name = format!("void {}(", program.name());
        assert_eq!((text.matches(&name).count(), header.matches(&name).count()), (1, 1));
        assert!(header.contains(&format!("matrices {order}")));
    }
    assert_eq!(text.matches("static inline void sin_cos").count(), 1);
    assert!(header.contains("    double *qdd_z);\n") && header.contains("extern \"C\""));
    let twice = [of(Quantity::F), of(Quantity::F)];
    assert!(matches!(c_source(&twice, &COptions::default()).unwrap_err(), CodegenError::Name { .. }));
    let inputs = [0.3, -0.8, 1.0, 0.5, 0.2, -0.4];
    let [mut rows, mut columns] = [vec![0.0; 14], vec![0.0; 14]];
    of(Quantity::FX).evaluate(&inputs, &mut rows, &mut Vec::new()).unwrap();
    programs[1].evaluate(&inputs, &mut columns, &mut Vec::new()).unwrap();
    assert_eq!(rows[..2], columns[..2]);
    assert!((0..12).all(|k| rows[2 + k] == columns[2 + k % 6 * 2 + k / 6]));
    let Ok(cc) = compiler() else { return };
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("several");
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("all.h"), header).unwrap();
    std::fs::write(folder.join("all.c"), format!("#include \"all.h\"\n{text}")).unwrap();
    let flags = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-c", "-o", "all.o", "all.c"];
    let output = Command::new(cc).args(flags).current_dir(&folder).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn compiled_c_agrees_with_the_interpreter_at_the_edges() {
    let cc = match compiler() {
        Ok(cc) => cc,
        Err(reason) => return println!("{reason}"),
    };
    let program = Program::record("edges", &[("x", 8), ("unused", 2)], |arguments| {
        let x = &arguments[0];
        let mut entries: Vec<Expr> =
            x.iter().flat_map(|x| [x.sin_cos().0, x.sin_cos().1, Scalar::tanh(*x)]).collect();
        entries.extend(x.iter().map(|&x| Expr::select(x.less(x.times(2.0)), x.sqrt(), -x.exp())));
        entries.extend([f64::INFINITY, -f64::INFINITY, f64::NAN, -0.1].map(Expr::from_f64));
        entries.push(x[0].times(-0.25).plus(-1e300));
        vec![RecordedResult::vector("t", entries)]
    })
    .unwrap();
    let quarter = std::f64::consts::FRAC_PI_2;
    let inputs = [0.0, -3.0 * quarter, 7.0 * quarter, 99_999.5, 1e22, f64::NAN, -0.7, 1e-300, 0.0, 0.0];
    let mut expected = vec![0.0; program.outputs()];
    program.evaluate(&inputs, &mut expected, &mut Vec::new()).unwrap();
    let found = run_c(&cc, &program, &inputs, &["-O2"]);
    for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
        let same = found == expected || (found.is_nan() && expected.is_nan());
        assert!(same || (found - expected).abs() <= 1e-15 * expected.abs(), "{k}: {found} is not {expected}");
    }
}

/// Names of robots and joints may hold anything; none of it may leave the comment at the head.
#[test]
fn no_name_leaves_the_head() {
    let nasty = "arm\nstd::compile_error!(\"out\");\u{2028}\u{202e}*\\\r\n/ int evil; /* */ int bad; //";
    let text =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("robots/two_link.toml")).unwrap();
    let line = text.lines().find(|line| line.starts_with("name = ")).unwrap();
    let text = text.replacen(line, &format!("name = {}", serde_json::to_string(nasty).unwrap()), 1);
    let robot: Robot = costate::robot::file::parse(&text, LoadOptions::default()).unwrap();
    let program =
        robot_program(&robot, Quantity::F, Coordinates::Hamiltonian, &ProgramOptions::default()).unwrap();
    let rust = program.to_rust(&RustOptions::default()).unwrap();
    assert!(rust.contains(r"\u{2028}\u{202e}*") && !rust.contains('\u{202e}'), "{rust}");
    let code = rust.lines().filter(|line| !line.trim_start().starts_with("//"));
    assert!(
        code.clone().all(|line| !line.contains("compile_error!") && !line.contains("int evil;")),
        "{rust}"
    );
    let c = program.to_c(&COptions::default()).unwrap();
    let (head, code) = c.split_once("*/").unwrap();
    assert!(head.contains("int evil;") && !code.contains("int evil;") && !code.contains("int bad;"), "{c}");
    assert!(!head.lines().any(|line| line.ends_with('\\')), "{head}");
    assert!(head.contains(r"\u{2028}\u{202e}*") && !c.contains('\u{202e}'), "{c}");
}

/// On many processors the outcome of 0 / 0 has its sign bit set.
#[test]
fn c_has_a_name_for_every_kind_of_nan() {
    let program = Program::record("edge", &[("x", 1)], |a| {
        vec![RecordedResult::matrix(
            "r",
            1,
            3,
            vec![a[0][0], Expr::from_f64(-f64::NAN), Expr::from_f64(-2.5)],
        )]
    });
    let c = program.unwrap().to_c(&COptions::default()).unwrap();
    assert!(c.contains("r[1] = NAN;") && c.contains("r[2] = -2.5;"), "{c}");
    for name in ["pow", "y1", "isnan"] {
        let refused = Program::record(name, &[("x", 1)], |a| vec![RecordedResult::vector("r", a[0].clone())]);
        assert!(matches!(refused, Err(CodegenError::Name { .. })), "{name}");
    }
    let options = RustOptions::default().with_number(Some("f64> {} fn g<U".into()));
    let ok =
        Program::record("edge", &[("x", 1)], |a| vec![RecordedResult::vector("r", a[0].clone())]).unwrap();
    assert!(matches!(ok.to_rust(&options), Err(CodegenError::Name { .. })));
}
