//! `costate eval`, `check`, `count` and `bench` with floating and spherical joints.

use crate::child::{costate, flat, json_lines, root, stderr, stdout};
use crate::eval::ROUTES;
use serde_json::{Value, json};

const ROBOT: &str = "tests/fixtures/free_tree.toml";

/// The state of the reference by Pinocchio, whose joints have the order of the file.
fn case() -> Value {
    let text = std::fs::read_to_string(root().join("tests/fixtures/free_joints_pinocchio.jsonl")).unwrap();
    serde_json::from_str(text.lines().find(|line| line.contains("free_tree")).unwrap()).unwrap()
}

fn close(what: &str, found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let size = expected.iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance * size, "{what}: {found} {expected}");
    }
}

#[test]
fn eval_agrees_with_pinocchio_and_every_route_with_the_others() {
    let case = case();
    let y: Vec<f64> = (0..34).map(|k| (1.3 * f64::from(k)).sin()).collect();
    let line = json!({ "q": case["q"], "v": case["v"], "u": case["tau"], "y": y }).to_string();
    for coordinates in ["lagrangian", "hamiltonian"] {
        let mut first: Option<Value> = None;
        for &route in ROUTES.iter().filter(|route| **route != "tensors") {
            let arguments = ["eval", ROBOT, "--coordinates", coordinates, "--route", route];
            let output = costate(&arguments, line.as_bytes());
            assert!(output.status.success(), "{}", stderr(&output));
            let answer = json_lines(&output).remove(0);
            close("M", &flat(&answer["M"]), &flat(&case["M"]), 1e-12);
            if coordinates == "lagrangian" {
                close(route, &flat(&answer["qdd"]), &flat(&case["a"]), 1e-10);
                let rows = answer["qdd_z"].as_array().unwrap();
                for (i, row) in rows.iter().enumerate() {
                    let row = flat(row);
                    for (k, key) in ["a_q", "a_v", "a_tau"].into_iter().enumerate() {
                        let expected = flat(&case[key][i]);
                        let size = flat(&case[key]).iter().fold(0.0_f64, |size, entry| size.max(entry.abs()));
                        for (found, expected) in row[17 * k..17 * (k + 1)].iter().zip(expected) {
                            assert!((found - expected).abs() < 1e-9 * size, "{route} {key}");
                        }
                    }
                }
            }
            let keys: &[&str] = match coordinates {
                "lagrangian" => &["qdd", "qdd_z", "yv_qdd_zz", "energy"],
                _ => &["f", "f_x", "y_f_xx", "p", "v"],
            };
            let expected = first.get_or_insert_with(|| answer.clone());
            for &key in keys {
                close(&format!("{route} {key}"), &flat(&answer[key]), &flat(&expected[key]), 1e-9);
            }
        }
    }
}

#[test]
fn eval_answers_frames_and_refuses_quaternions_by_their_length() {
    let case = case();
    let mut q = flat(&case["q"]);
    let line = json!({ "q": q, "frames": [{ "name": "root", "axes": "local", "w": [1, 2, 3] }] }).to_string();
    let output = costate(&["eval", ROBOT], line.as_bytes());
    assert!(output.status.success(), "{}", stderr(&output));
    let frame = &json_lines(&output)[0]["frames"][0];
    let (jacobian, hessian) = (flat(&frame["jacobian"]), flat(&frame["w_x_qq"]));
    assert_eq!((jacobian.len(), hessian.len()), (6 * 17, 17 * 17));
    // The twist of the root in its own axes: angular, then linear.
    for i in 0..6 {
        for j in 0..17 {
            let expected = f64::from(u8::from(j < 6 && (i + 3) % 6 == j));
            assert!((jacobian[17 * i + j] - expected).abs() < 1e-14, "{i} {j}");
        }
    }
    let tensors = costate(&["eval", ROBOT, "--route", "tensors"], line.as_bytes());
    assert!(stderr(&tensors).contains("'root' is floating") && stderr(&tensors).contains("use analytic"));
    q[7..11].iter_mut().for_each(|entry| *entry *= 1.25);
    let output = costate(&["eval", ROBOT], json!({ "q": q, "v": case["v"] }).to_string().as_bytes());
    assert_eq!(output.status.code(), Some(2));
    let error = json_lines(&output)[0]["error"].as_str().unwrap().to_owned();
    assert!(error.contains("joint 'hip', `q[7]` to `q[10]`, has the length 1.25"), "{error}");
    let short = costate(&["eval", ROBOT], json!({ "q": case["v"], "v": case["v"] }).to_string().as_bytes());
    assert!(stderr(&short).contains("`q` has 17 numbers, not 20"), "{}", stderr(&short));
}

#[test]
fn check_compares_the_methods_that_take_quaternions() {
    let output = costate(&["check", ROBOT, "--samples", "1"], b"");
    let table = stdout(&output);
    assert!(output.status.success() && table.contains("PASS"), "{table}{}", stderr(&output));
    // Rows begin with what is compared; the legend below does not.
    let begins = |row: &str| table.lines().any(|line| line.trim_start().starts_with(&format!("{row}  ")));
    let steps = ["Phi_z, z = (x, u, h)", "y'Phi_zz d, z = (x, u)"];
    for row in ["F_x", "y'F_x", "y'F_xx", "y'F_xx y", "a_z, z = (q, v, u)", "y'a_zz"].iter().chain(&steps) {
        assert!(begins(row), "{row}: {table}");
    }
    for scheme in ["RK4 (q, p)  ", "Verlet (q, p)  ", "midpoint (q, p)  ", "RK4 (q, v)  "] {
        assert_eq!(table.matches(scheme).count(), 2, "{scheme}: {table}");
    }
    assert!(table.contains("energy drift"), "{table}");
    for row in
        ["w'tau_zz", "(w.V)_v of frames", "(w.V)_q v of frames", "(w.x)_qq of frames", "(w.c)_q", "(w.h)_v"]
    {
        assert!(begins(row), "{row}: {table}");
    }
    assert!(table.contains("machine code  "), "{table}");
    for row in ["asymmetry of J F_x", "packed tensor", "(w.V)_zz", "semi-implicit"] {
        assert!(!table.contains(row), "{row}: {table}");
    }
    let output = costate(
        &["check", "examples/problems/robots/satellite.toml", "--samples", "1", "--tolerance", "1e-25"],
        b"",
    );
    assert!(stdout(&output).contains("FAIL: F_x by analytic differs by"), "{}", stdout(&output));
    assert!(
        stdout(&output).contains("FAIL: Phi_z, z = (x, u, h) by RK4 (q, v) differs by"),
        "{}",
        stdout(&output)
    );
}

#[test]
fn count_counts_the_methods_that_take_quaternions() {
    let robot = "examples/problems/robots/satellite.toml";
    let output = costate(&["count", robot, "--json"], b"");
    assert!(output.status.success(), "{}", stderr(&output));
    let table = &json_lines(&output)[0];
    assert_eq!((table["n"].as_u64(), table["nq"].as_u64()), (Some(8), Some(9)));
    let mul = |quantity: &str, route: &str| {
        let is_it = |row: &&Value| row["quantity"] == quantity && row["route"] == route;
        table["rows"].as_array().unwrap().iter().find(is_it).map(|row| row["mul"].as_u64().unwrap())
    };
    let [m, f, f_x, y_f_xx] =
        ["mass_matrix", "f", "f_x", "y_f_xx"].map(|quantity| mul(quantity, "analytic").unwrap());
    assert!(0 < m && m < f && f < f_x && f_x < y_f_xx, "{table}");
    for (quantity, analytic) in [("f_x", f_x), ("y_f_xx", y_f_xx)] {
        for route in ["dual", "hyperdual"] {
            assert!(mul(quantity, route) > Some(analytic), "{table}");
        }
        assert_eq!(mul(quantity, "tensors"), None);
    }
    assert!(mul("y_f_x", "analytic") > Some(f) && mul("y_f_xx_d", "analytic").is_some());
    assert_eq!((mul("y_f_xx", "dual pass"), mul("f_xx", "analytic")), (None, None));
    let output = costate(&["count", robot], b"");
    assert!(stdout(&output).contains("3 joints with 8 degrees of freedom"), "{}", stdout(&output));
    assert!(stdout(&output).contains("tangent space"), "{}", stdout(&output));
}

#[test]
fn bench_times_the_methods_that_take_quaternions() {
    let robot = "examples/problems/robots/satellite.toml";
    let output = costate(&["bench", robot, "--batches", "3", "--json"], b"");
    assert!(output.status.success(), "{}", stderr(&output));
    let table = &json_lines(&output)[0];
    let rows = table["rows"].as_array().unwrap();
    for row in rows {
        let (route, error) = (row["route"].as_str().unwrap(), row["relative_error"].as_f64().unwrap());
        let bound = if route.contains("differences") { 1e-6 } else { 1e-10 };
        assert!(error < bound && row["median_ns"].as_f64().unwrap() > 0.0, "{row}");
        assert!(!route.contains("tensor") && !route.contains("batch"), "{row}");
    }
    for route in ["dual numbers", "2n+1 rule", "dual in dual numbers through F", "hyper-dual pairs through F"]
    {
        assert!(rows.iter().any(|row| row["route"] == route), "{route}: {table}");
    }
    assert!(table["notes"].to_string().contains("tangent space"), "{table}");
}
