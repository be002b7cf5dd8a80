//! `costate info`, `check`, `count` and `bench`, and robots that are refused.

use crate::child::{costate, flat, stderr, stdout};
use serde_json::{Value, json};

#[test]
fn info_as_json_and_as_a_table() {
    let output = costate(&["info", "robots/cart_pole.toml", "--json"], b"");
    assert!(output.status.success() && output.stderr.is_empty());
    let info: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&info["robot"], &info["n"]), (&json!("cart_pole"), &json!(2)));
    let joints = info["joints"].as_array().unwrap();
    assert_eq!((&joints[0]["type"], &joints[0]["parent"]), (&json!("prismatic"), &Value::Null));
    assert_eq!((&joints[1]["type"], &joints[1]["parent"]), (&json!("revolute"), &joints[0]["name"]));
    assert_eq!(flat(&joints[0]["axis"]), [1.0, 0.0, 0.0]);
    assert_eq!(info["warnings"], json!([]));
    let puma: Value =
        serde_json::from_slice(&costate(&["info", "robots/puma560.toml", "--json"], b"").stdout).unwrap();
    assert!(puma["warnings"][0].as_str().unwrap().contains("principal moments"));
    let table = stdout(&costate(&["info", "robots/ur5.urdf"], b""));
    assert!(table.contains("wrist_3_joint") && table.contains("6 joints"), "{table}");
}

#[test]
fn check_passes_and_fails_by_its_tolerance() {
    let output = costate(&["check", "robots/ur5.urdf", "--samples", "5"], b"");
    let table = stdout(&output);
    assert!(output.status.success() && table.contains("PASS"), "{table}");
    let quantities = [
        "F_x",
        "y'F_x",
        "y'F_xx",
        "y'F_xx y",
        "a_z",
        "y'a_zz",
        "asymmetry of J F_x",
        "energy drift",
        "(w.V)_zz of frames",
        "(w.x)_qq of frames",
        "(w.e)_qq of frames",
        "(w.c)_qq",
        "(w.h)_zz",
        "w'tau_zz",
        "machine code",
    ];
    for row in quantities.into_iter().chain(["analytic", "dual pass", "packed tensor", "tensors", "dual"]) {
        assert!(table.contains(row), "{row}");
    }
    let output = costate(&["check", "robots/biped.toml", "--samples", "5", "--tolerance", "1e-25"], b"");
    assert_eq!(output.status.code(), Some(1));
    assert!(stdout(&output).contains("FAIL: F_x by analytic differs by"), "{}", stdout(&output));
    let again =
        |seed| stdout(&costate(&["check", "robots/panda.urdf", "--samples", "3", "--seed", seed], b""));
    assert_eq!(again("7"), again("7"));
    assert_ne!(again("7"), again("8"));
    let friction = costate(&["check", "tests/fixtures/friction_tree.toml", "--samples", "4"], b"");
    assert!(friction.status.success(), "{}", stdout(&friction));
    let wrenches = costate(&["check", "tests/fixtures/pulled_arm.toml", "--samples", "4"], b"");
    assert!(wrenches.status.success(), "{}", stdout(&wrenches));
}

#[test]
fn check_as_json() {
    let output = costate(&["check", "robots/ur5.urdf", "--samples", "3", "--json"], b"");
    assert!(output.status.success() && output.stderr.is_empty());
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&report["robot"], &report["n"], &report["pass"]), (&json!("ur5"), &json!(6), &json!(true)));
    let rows = report["rows"].as_array().unwrap();
    assert!(rows.len() > 20);
    for row in rows {
        for column in ["zero", "random"] {
            assert_eq!(row[column]["verdict"], json!("agrees"), "{row}");
            assert!(row[column]["ratio"].as_f64().unwrap() <= 1.0, "{row}");
        }
    }
}

/// Joints that move in metres beside joints that turn, in trees and at singular angles.
#[test]
fn check_passes_on_planar_and_floating_joints() {
    let link = |k: usize| {
        format!(
            r#"<link name="l{k}"><inertial><origin xyz="0.1 0 0.2"/><mass value="2"/><inertia ixx="0.3" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.2"/></inertial></link>"#
        )
    };
    for kinds in [["planar", "planar", "planar"], ["floating", "planar", "continuous"]] {
        let joint = |(k, kind): (usize, &&str)| {
            let parent = if k == 0 { "world".into() } else { format!("l{}", k - 1) };
            format!(
                r#"{}<joint name="j{k}" type="{kind}"><parent link="{parent}"/><child link="l{k}"/><origin xyz="0.3 0 0.1"/><axis xyz="0 1 0"/></joint>"#,
                link(k)
            )
        };
        let joints: String = kinds.iter().enumerate().map(joint).collect();
        let text = format!(r#"<robot name="mobile"><link name="world"/>{joints}</robot>"#);
        let output = costate(&["check", "-", "--samples", "4"], text.as_bytes());
        let table = stdout(&output);
        assert!(output.status.success() && !table.contains("NaN"), "{table}");
        assert!(table.lines().all(|line| line.chars().count() <= 110), "{table}");
    }
}

#[test]
fn count_as_json_and_as_a_table() {
    let output = costate(&["count", "robots/cart_pole.toml", "--json"], b"");
    assert!(output.status.success() && output.stderr.is_empty());
    let counts: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!((&counts["robot"], &counts["folded"]), (&json!("cart_pole"), &json!(true)));
    let rows = counts["rows"].as_array().unwrap();
    let mut expected = Vec::new();
    for quantity in ["mass_matrix", "f", "f_x", "y_f_xx"] {
        expected.extend(["tensors", "analytic", "dual", "hyperdual"].map(|route| (quantity, route)));
    }
    expected.extend([("y_f_xx", "dual pass"), ("y_f_x", "analytic"), ("y_f_xx_d", "analytic")]);
    expected.extend(["analytic", "hyperdual"].map(|route| ("f_xx", route)));
    assert_eq!(rows.len(), expected.len());
    let number = |row: &Value, key: &str| row[key].as_u64().unwrap();
    for (row, (quantity, route)) in rows.iter().zip(expected) {
        assert_eq!((&row["quantity"], &row["route"]), (&json!(quantity), &json!(route)));
        for key in ["mul", "add", "div", "sqrt", "sincos"] {
            assert!(row[key].is_u64(), "{row}");
        }
        assert!(number(row, "mul") > 0 && number(row, "sincos") > 0, "{row}");
    }
    let all = costate(&["count", "robots/cart_pole.toml", "--json", "--unfolded"], b"");
    let all: Value = serde_json::from_slice(&all.stdout).unwrap();
    assert_eq!(all["folded"], json!(false));
    for (few, all) in rows.iter().zip(all["rows"].as_array().unwrap()) {
        assert!(number(few, "mul") < number(all, "mul") && number(few, "add") <= number(all, "add"));
    }
    let table = stdout(&costate(&["count", "robots/cart_pole.toml"], b""));
    for words in ["2 joints", "F, F_x, y'F_xx", "tensors", "sincos", "mul / F", "hyperdual"] {
        assert!(table.contains(words), "{words}: {table}");
    }
    let analytic = rows.iter().find(|row| row["quantity"] == "f_x" && row["route"] == "analytic").unwrap();
    let line = table.lines().skip_while(|line| !line.contains("F, F_x ")).nth(1).unwrap();
    let words: Vec<&str> = line.split_whitespace().collect();
    assert_eq!(words[..3], ["analytic".into(), analytic["mul"].to_string(), analytic["add"].to_string()]);
}

/// What is odd about a robot goes to stderr; a robot that is refused gives exit status 2 and no counts.
#[test]
fn count_keeps_stdout_to_itself() {
    let output = costate(&["count", "robots/puma560.toml", "--json"], b"");
    assert!(output.status.success() && stderr(&output).contains("principal moments"));
    assert!(serde_json::from_slice::<Value>(&output.stdout).is_ok());
    for arguments in
        [["count", "robots/puma560.toml", "--strict"].as_slice(), &["count", "robots/nowhere.toml", "--json"]]
    {
        let output = costate(arguments, b"");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{arguments:?}");
        assert!(stderr(&output).starts_with("error: "), "{arguments:?}");
    }
}

#[test]
fn robots_are_refused_with_path_line_and_reason() {
    let output = costate(&["info", "robots/nowhere.urdf"], b"");
    assert_eq!(output.status.code(), Some(2));
    assert!(
        output.stdout.is_empty() && stderr(&output).starts_with("error: robots/nowhere.urdf: does not exist")
    );
    assert!(stderr(&costate(&["info", "README.md"], b"")).contains(".urdf or .toml"));
    let strict = costate(&["info", "robots/puma560.toml", "--strict"], b"");
    assert_eq!(strict.status.code(), Some(2));
    assert!(stderr(&strict).contains("strict") && stderr(&strict).contains("waist"));
    let states = costate(&["eval", "robots/ur5.urdf", "--states", "nowhere.jsonl"], b"");
    assert!(stderr(&states).contains("nowhere.jsonl: cannot be read"));
    assert_eq!(costate(&["check", "robots/ur5.urdf", "--tolerance", "0"], b"").status.code(), Some(2));
}

/// Times differ from run to run; what is timed, and that all routes agree, does not.
#[test]
fn bench_as_json_and_as_a_table() {
    let arguments = ["bench", "robots/two_link.toml", "--batches", "3"];
    let table = stdout(&costate(&arguments, b""));
    assert!(table.contains("2n+1 rule") && table.contains("medians of 3 batches"), "{table}");
    let output = costate(&[&arguments[..], &["--json"]].concat(), b"");
    assert!(output.status.success() && output.stderr.is_empty());
    let bench: Value = serde_json::from_slice(&output.stdout).unwrap();
    let rows = bench["rows"].as_array().unwrap();
    let notes: Vec<&str> = bench["notes"].as_array().unwrap().iter().map(|n| n.as_str().unwrap()).collect();
    for (quantity, route, reason) in [
        ("F, F_x", "batch over F64x4", ""),
        ("F, F_x, y'F_xx", "batch over F64x8", ""),
        ("F, F_x", "machine code", "No machine code"),
        ("F, F_x, y'F_xx", "machine code, 4 states at once", "No machine code"),
        ("F, F_x", "batch over lanes and threads", "No batches over threads"),
    ] {
        let is_there = rows.iter().any(|row| row["quantity"] == quantity && row["route"] == route);
        let excused = notes.iter().any(|note| !reason.is_empty() && note.starts_with(reason));
        assert!(is_there != excused, "{quantity} by {route}: {notes:?}");
    }
    for row in rows {
        let number = |key: &str| row[key].as_f64().unwrap();
        let several = ["batch", "4 states"].iter().any(|word| row["route"].as_str().unwrap().contains(word));
        assert_eq!(number("states") > 1.0, several, "{row}");
        assert!(number("q25_ns") > 0.0 && number("q25_ns") <= number("median_ns"), "{row}");
        assert!(number("median_ns") <= number("q75_ns"), "{row}");
        let differences = row["route"].as_str().unwrap().contains("differences");
        let error = number("relative_error");
        assert!(error < if differences { 1e-6 } else { 1e-12 } && (error > 1e-14 || !differences), "{row}");
    }
    let again = costate(&["bench", "robots/two_link.toml", "--batches", "1"], b"");
    assert!(!again.status.success() && stderr(&again).contains("batches"));
}
