//! Functions for CasADi and acados: compiled, asked for their signatures, and called by them as those
//! programs do; the values against the library.

use crate::text::compiler;
use costate::Coordinates;
use costate::codegen::{
    COptions, ProgramOptions, StepOrder, StepSpec, acados_source, casadi_source, step_program,
};
use costate::dynamics::Dynamics;
use costate::lagrangian::LagrangianSecondOrder;
use costate::robot::Robot;
use costate::step::{RungeKutta4, Step};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

const N: usize = 6;
const STEP: StepSpec = StepSpec::RungeKutta4 { dt: 0.01, coordinates: Coordinates::Lagrangian };
const OPTIONS: usize = 200_000;

fn robot() -> Robot {
    Robot::from_file(Path::new(env!("CARGO_MANIFEST_DIR")).join("robots/ur5.urdf")).unwrap()
}

fn numbers(from: f64, count: usize) -> Vec<f64> {
    (0..count).map(|k| (from + 1.7 * k as f64).sin()).collect()
}

/// A result: rows, columns, and its entries column by column; none where it is empty.
type Result = (usize, usize, Vec<f64>);

/// Compiles a source with a main function that asks each function for its signature and calls it; arguments
/// by their names, NULL for the others. The results by function and name.
fn run(
    cc: &str,
    stem: &str,
    source: &str,
    functions: &[&str],
    given: &[(&str, Vec<f64>)],
) -> BTreeMap<String, Result> {
    let mut main = String::from("#include <stdio.h>\n#include <stdlib.h>\n");
    for (name, values) in given {
        let _ = writeln!(
            main,
            "static const double given_{name}[] = {{{}}};",
            format!("{values:?}").trim_matches(['[', ']'])
        );
    }
    main += "static const double *find(const char *name)\n{\n";
    for (name, _) in given {
        let _ = writeln!(main, "    if (!strcmp(name, \"{name}\")) return given_{name};");
    }
    main += "    return 0;\n}\n\
        static casadi_int entries(const casadi_int *s) { return s[2] == 1 ? s[0] * s[1] : 0; }\n\
        #define CALL(F) do { \\\n\
            casadi_int a, r, i, w; int k; \\\n\
            if (F##_work(&a, &r, &i, &w)) return 1; \\\n\
            const double **arg = calloc(a, sizeof *arg); double **res = calloc(r, sizeof *res); \\\n\
            double *work = calloc(w + 1, sizeof *work); \\\n\
            for (k = 0; k < F##_n_in(); k++) arg[k] = find(F##_name_in(k)); \\\n\
            for (k = 0; k < F##_n_out(); k++) res[k] = calloc(entries(F##_sparsity_out(k)) + 1, sizeof **res); \\\n\
            if (F##_name_in(F##_n_in()) || F##_sparsity_out(-1)) return 2; \\\n\
            if (F(arg, res, 0, work, 0)) return 3; \\\n\
            for (k = 0; k < F##_n_out(); k++) { \\\n\
                const casadi_int *s = F##_sparsity_out(k); casadi_int e; \\\n\
                printf(#F \"/%s %d %d\", F##_name_out(k), (int)s[0], (int)s[1]); \\\n\
                for (e = 0; e < entries(s); e++) printf(\" %.17g\", res[k][e]); \\\n\
                printf(\"\\n\"); \\\n\
                double *kept = res[k]; res[k] = 0; \\\n\
                if (F(arg, res, 0, work, 0)) return 4; \\\n\
                res[k] = kept; } \\\n\
        } while (0)\n\
        int main(void)\n{\n";
    for function in functions {
        let _ = writeln!(main, "    CALL({function});");
    }
    main += "    return 0;\n}\n";
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let (file, binary) = (folder.join(format!("{stem}.c")), folder.join(stem));
    std::fs::write(&file, format!("{source}{main}")).unwrap();
    let mut compile = Command::new(cc);
    compile
        .args(["-std=c99", "-O0", "-Wall", "-Wextra", "-pedantic", "-Werror"])
        .arg(&file)
        .arg("-o")
        .arg(&binary);
    let output = compile.arg("-lm").output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let output = Command::new(&binary).output().unwrap();
    assert!(output.status.success(), "{:?}", output.status);
    let line = |line: &str| {
        let words: Vec<&str> = line.split(' ').collect();
        let values = words[3..].iter().map(|word| word.parse().unwrap()).collect();
        (words[0].to_owned(), (words[1].parse().unwrap(), words[2].parse().unwrap(), values))
    };
    String::from_utf8(output.stdout).unwrap().lines().map(line).collect()
}

/// Compares a result with a matrix.
fn agree(
    results: &BTreeMap<String, Result>,
    name: &str,
    rows: usize,
    columns: usize,
    entry: impl Fn(usize, usize) -> f64,
) {
    let (found_rows, found_columns, values) = results.get(name).unwrap_or_else(|| panic!("no {name}"));
    assert_eq!((*found_rows, *found_columns, values.len()), (rows, columns, rows * columns), "{name}");
    let expected: Vec<f64> = (0..rows * columns).map(|k| entry(k % rows, k / rows)).collect();
    let size = expected.iter().fold(1.0, |size: f64, value| size.max(value.abs()));
    let worst = values.iter().zip(&expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst <= 1e-10 * size, "{name} is off by {worst:e} of {size:e}");
}

#[test]
fn functions_for_casadi_have_the_derivatives_of_the_library() {
    let Ok(cc) = compiler() else { return println!("skipped: there is no C compiler") };
    let robot = robot();
    let source = casadi_source(&robot, Some(STEP), &COptions::default().with_limit(OPTIONS)).unwrap();
    let (q, v, tau, y) = (numbers(0.3, N), numbers(1.1, N), numbers(2.0, N), numbers(0.7, N));
    let x = [q.clone(), v.clone()].concat();
    let given =
        [("q", q.clone()), ("v", v.clone()), ("tau", tau.clone()), ("a", tau.clone()), ("adj_a", y.clone())];
    let mut given = given.to_vec();
    given.extend([("adj_tau", y.clone()), ("x", x.clone()), ("adj_x_next", numbers(0.2, 2 * N))]);
    let functions: Vec<String> = ["fd", "id", "step"]
        .iter()
        .flat_map(|name| ["", "jac_", "adj1_", "jac_adj1_"].map(|prefix| format!("{prefix}ur5_{name}")))
        .collect();
    let functions: Vec<&str> = functions.iter().map(String::as_str).collect();
    let results = run(&cc, "ur5_casadi", &source, &functions, &given);
    let mut library = LagrangianSecondOrder::<f64>::new(&robot);
    let costate = [vec![0.0; N], y.clone()].concat();
    let parts = ["q", "v", "tau"];
    {
        let second = Dynamics::contract(&mut library, &x, &tau, &costate).unwrap();
        let mut hessian = vec![0.0; 324];
        second.hessian(&mut hessian);
        let mut jacobian = vec![0.0; 216];
        second.first.jacobian(&mut jacobian);
        let slope = |i: usize, k: usize| jacobian[(N + i) * 18 + k];
        agree(&results, "ur5_fd/a", N, 1, |i, _| second.first.f[N + i]);
        for (k, part) in parts.iter().enumerate() {
            agree(&results, &format!("jac_ur5_fd/jac_a_{part}"), N, N, |i, j| slope(i, k * N + j));
            let product = |j: usize| (0..N).map(|i| y[i] * slope(i, k * N + j)).sum();
            agree(&results, &format!("adj1_ur5_fd/adj_{part}"), N, 1, |j, _| product(j));
            let name = |by: &str| format!("jac_adj1_ur5_fd/jac_adj_{part}_{by}");
            agree(&results, &name("adj_a"), N, N, |i, j| slope(j, k * N + i));
            assert!(results[&name("out_a")].2.is_empty());
            for (l, by) in parts.iter().enumerate() {
                if k + l < 3 {
                    agree(&results, &name(by), N, N, |i, j| hessian[(k * N + i) * 18 + l * N + j]);
                } else {
                    assert!(results[&name(by)].2.is_empty(), "second derivatives in v, tau vanish");
                }
            }
        }
    }
    let second = library.contract_inverse_dynamics(&q, &v, &tau, &y).unwrap();
    let linear = second.inverse_dynamics();
    agree(&results, "ur5_id/tau", N, 1, |i, _| linear.tau[i]);
    agree(&results, "jac_ur5_id/jac_tau_v", N, N, |i, j| linear.tau_v.row(i)[j]);
    agree(&results, "adj1_ur5_id/adj_q", N, 1, |j, _| (0..N).map(|i| y[i] * linear.tau_q.row(i)[j]).sum());
    agree(&results, "jac_adj1_ur5_id/jac_adj_q_v", N, N, |i, j| second.xx()[(i, N + j)]);
    agree(&results, "jac_adj1_ur5_id/jac_adj_q_a", N, N, |i, j| second.aq()[(j, i)]);
    agree(&results, "jac_adj1_ur5_id/jac_adj_a_q", N, N, |i, j| second.aq()[(i, j)]);

    let costate = numbers(0.2, 2 * N);
    let mut step = RungeKutta4::new(library);
    let second = step.contract(&x, &tau, 0.01, &costate).unwrap();
    agree(&results, "ur5_step/x_next", 2 * N, 1, |i, _| second.first.next[i]);
    agree(&results, "jac_ur5_step/jac_x_next_tau", 2 * N, N, |i, j| second.first.phi_u[(i, j)]);
    let product = |j: usize| (0..2 * N).map(|i| costate[i] * second.first.phi_x[(i, j)]).sum();
    agree(&results, "adj1_ur5_step/adj_x", 2 * N, 1, |j, _| product(j));
    agree(&results, "jac_adj1_ur5_step/jac_adj_x_x", 2 * N, 2 * N, |i, j| second.xx[(i, j)]);
    agree(&results, "jac_adj1_ur5_step/jac_adj_tau_tau", N, N, |i, j| second.uu.unwrap()[(i, j)]);
    agree(&results, "jac_adj1_ur5_step/jac_adj_tau_adj_x_next", N, 2 * N, |i, j| second.first.phi_u[(j, i)]);
}

#[test]
fn functions_for_acados_are_those_of_its_generator() {
    let Ok(cc) = compiler() else { return println!("skipped: there is no C compiler") };
    let robot = robot();
    let source = acados_source(&robot, Some(STEP), &COptions::default().with_limit(OPTIONS)).unwrap();
    let (x, u, lam) = (numbers(0.3, 2 * N), numbers(2.0, N), numbers(0.7, 2 * N));
    let (sx, su) = (numbers(0.1, 144), numbers(0.9, 72));
    let given =
        [("x", x.clone()), ("u", u.clone()), ("lam", lam.clone()), ("sx", sx.clone()), ("su", su.clone())];
    let functions = ["expl_ode_fun", "expl_vde_forw", "expl_vde_adj", "expl_ode_hess", "dyn_disc_phi_fun"];
    let functions = [&functions[..], &["dyn_disc_phi_fun_jac", "dyn_disc_phi_fun_jac_hess"]].concat();
    let functions: Vec<String> = functions.iter().map(|name| format!("ur5_{name}")).collect();
    let functions: Vec<&str> = functions.iter().map(String::as_str).collect();
    assert!(source.contains("casadi_int int\n"), "acados has numbers of entries as int");
    let results = run(&cc, "ur5_acados", &source, &functions, &given);
    let mut library = LagrangianSecondOrder::<f64>::new(&robot);
    {
        let second = Dynamics::contract(&mut library, &x, &u, &lam).unwrap();
        let first = second.first;
        let (mut jacobian, mut h) = (vec![0.0; 216], vec![0.0; 324]);
        first.jacobian(&mut jacobian);
        second.hessian(&mut h);
        agree(&results, "ur5_expl_ode_fun/f", 12, 1, |i, _| first.f[i]);
        agree(&results, "ur5_expl_vde_forw/f", 12, 1, |i, _| first.f[i]);
        let along =
            |s: &[f64], i: usize, j: usize| (0..12).map(|k| first.f_x[(i, k)] * s[j * 12 + k]).sum::<f64>();
        agree(&results, "ur5_expl_vde_forw/vde_x", 12, 12, |i, j| along(&sx, i, j));
        agree(&results, "ur5_expl_vde_forw/vde_u", 12, 6, |i, j| first.f_u[(i, j)] + along(&su, i, j));
        let product = |j: usize| (0..12).map(|i| lam[i] * jacobian[i * 18 + j]).sum();
        agree(&results, "ur5_expl_vde_adj/adj", 18, 1, |j, _| product(j));
        agree(&results, "ur5_expl_ode_hess/adj", 18, 1, |j, _| product(j));
        let s = |i: usize, j: usize| match (i, j) {
            (0..12, 0..12) => sx[j * 12 + i],
            (0..12, _) => su[(j - 12) * 12 + i],
            _ => f64::from(u8::from(i == j)),
        };
        let entry = |i: usize, j: usize| -> f64 {
            let term = |k: usize, l: usize| s(k, i) * h[k * 18 + l] * s(l, j);
            (0..18).map(|k| (0..18).map(|l| term(k, l)).sum::<f64>()).sum()
        };
        let places: Vec<(usize, usize)> = (0..18).flat_map(|j| (j..18).map(move |i| (i, j))).collect();
        agree(&results, "ur5_expl_ode_hess/hess", 171, 1, |k, _| entry(places[k].0, places[k].1));
    }
    let mut step = RungeKutta4::new(library);
    let second = step.contract(&x, &u, 0.01, &lam).unwrap();
    let (mut jacobian, mut h) = (vec![0.0; 216], vec![0.0; 324]);
    second.first.jacobian(&mut jacobian);
    second.hessian(&mut h);
    let place = |k: usize| if k < 6 { 12 + k } else { k - 6 };
    for function in ["fun", "fun_jac", "fun_jac_hess"] {
        agree(&results, &format!("ur5_dyn_disc_phi_{function}/phi"), 12, 1, |i, _| second.first.next[i]);
    }
    for function in ["fun_jac", "fun_jac_hess"] {
        let name = format!("ur5_dyn_disc_phi_{function}/jac_ux");
        agree(&results, &name, 18, 12, |i, j| jacobian[j * 18 + place(i)]);
    }
    agree(&results, "ur5_dyn_disc_phi_fun_jac_hess/hess_ux", 18, 18, |i, j| h[place(i) * 18 + place(j)]);
}

#[test]
fn steps_are_programs_too() {
    let robot = robot();
    let step = StepSpec::SemiImplicitEuler { dt: 0.02 };
    let options = ProgramOptions::default().with_only(true);
    let program = step_program(&robot, step, StepOrder::First, &options).unwrap();
    assert_eq!((program.inputs(), program.outputs()), (18, 216));
    let (x, u) = (numbers(0.3, 2 * N), numbers(2.0, N));
    let mut found = vec![0.0; 216];
    program.evaluate(&[x.clone(), u.clone()].concat(), &mut found, &mut Vec::new()).unwrap();
    let mut library = costate::step::SemiImplicitEuler::new(LagrangianSecondOrder::<f64>::new(&robot));
    let mut expected = vec![0.0; 216];
    library.linearise(&x, &u, 0.02).unwrap().jacobian(&mut expected);
    let size = expected.iter().fold(1.0, |size: f64, value| size.max(value.abs()));
    assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= 1e-11 * size));
    let limited = ProgramOptions::default().with_limit(100);
    assert!(step_program(&robot, STEP, StepOrder::Second, &limited).is_err());
}
