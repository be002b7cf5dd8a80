//! `costate eval` and `check` with floating and spherical joints.

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
    for row in ["asymmetry of J F_x", "packed tensor", "of frames", "semi-implicit"] {
        assert!(!table.contains(row), "{row}: {table}");
    }
    let output = costate(&["check", ROBOT, "--samples", "1", "--tolerance", "1e-25"], b"");
    assert!(stdout(&output).contains("FAIL: F_x by analytic differs by"), "{}", stdout(&output));
    assert!(
        stdout(&output).contains("FAIL: Phi_z, z = (x, u, h) by RK4 (q, v) differs by"),
        "{}",
        stdout(&output)
    );
    let refused = costate(&["count", ROBOT], b"");
    assert!(stderr(&refused).contains("'root' is floating") && stderr(&refused).contains("`check`"));
}
