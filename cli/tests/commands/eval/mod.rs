//! `costate eval`.

mod frames;
mod refused;

use crate::child::{costate, flat, json_lines, root, stderr};
use serde_json::json;
use std::process::Output;

/// All routes.
pub const ROUTES: &[&str] = &[
    "analytic",
    "dual",
    "hyperdual",
    "tensors",
    #[cfg(feature = "jit")]
    "jit",
];

/// Numbers come back as they were given, to the last bit.
#[test]
fn numbers_round_trip() {
    let mut random = fastrand::Rng::with_seed(11);
    let mut number = || (random.f64() - 0.5) * 10.0_f64.powi(random.i32(-3..4));
    let states: Vec<[f64; 4]> = (0..2000).map(|_| [number(), number(), number(), number()]).collect();
    let lines: Vec<String> =
        states.iter().map(|[a, b, c, d]| format!("{{\"q\":[{a},{b}],\"p\":[{c},{d}]}}\n")).collect();
    let answers = json_lines(&costate(&["eval", "robots/two_link.toml"], lines.concat().as_bytes()));
    for (answer, [a, b, c, d]) in answers.iter().zip(&states) {
        assert_eq!((flat(&answer["q"]), flat(&answer["p"])), (vec![*a, *b], vec![*c, *d]));
    }
}

#[test]
fn friction_of_a_urdf_on_request() {
    let robot = std::env::temp_dir().join(format!("costate-rough-{}.urdf", std::process::id()));
    let text = std::fs::read_to_string(root().join("robots/ur5.urdf")).unwrap();
    let rough = text.replacen("<limit", "<dynamics damping=\"2\" friction=\"0\"/><limit", 1);
    std::fs::write(&robot, rough).unwrap();
    let state = br#"{"q":[0,0,0,0,0,0],"v":[1,0,0,0,0,0]}"#;
    let path = robot.to_str().unwrap();
    let (without, with) = (costate(&["eval", path], state), costate(&["eval", path, "--friction"], state));
    std::fs::remove_file(&robot).unwrap();
    assert!(stderr(&without).contains("--friction") && with.stderr.is_empty());
    let rate = |output: &Output| flat(&json_lines(output)[0]["f"])[6];
    assert!((rate(&with) - rate(&without) + 2.0).abs() < 1e-12);
}

#[test]
fn velocities_or_momenta_and_defaults() {
    let input = br#"{"q":[0.1,0.2],"v":[1.0,-0.5],"f":"ignored"}
{"q":[0.1,0.2],"p":[0.3,0.4],"v":[9,9],"u":[0,0]}
{"q":[0.1,0.2],"p":[0.3,0.4],"u":[1.0,2.0],"y":null}
"#;
    let answers = json_lines(&costate(&["eval", "robots/two_link.toml"], input));
    assert_eq!(
        flat(&answers[0]["v"]).iter().map(|v| (v * 1e12).round() / 1e12).collect::<Vec<_>>(),
        [1.0, -0.5]
    );
    assert_eq!(flat(&answers[1]["p"]), [0.3, 0.4]);
    let (without, with) = (flat(&answers[1]["f"]), flat(&answers[2]["f"]));
    assert!((with[2] - without[2] - 1.0).abs() < 1e-15 && (with[3] - without[3] - 2.0).abs() < 1e-15);
    assert!(answers.iter().all(|answer| answer.get("y_f_xx").is_none()));
    assert_eq!(answers[0]["f_x"].as_array().unwrap().len(), 4);
}

/// `v` holds in Lagrangian coordinates, `p` where it stands alone; the velocities' half of y is contracted
/// with.
#[test]
fn velocities_or_momenta_in_lagrangian_coordinates() {
    let input = br#"{"q":[0.1,0.2],"v":[1.0,-0.5],"p":[9,9],"y":[7,7,0,0]}
{"q":[0.1,0.2],"p":[0.3,0.4],"u":[1.0,2.0]}
{"q":[0.1,0.2],"p":[0.3,0.4]}
"#;
    for &route in ROUTES.iter().filter(|route| **route != "tensors") {
        let arguments = ["eval", "robots/two_link.toml", "--coordinates", "lagrangian", "--route", route];
        let answers = json_lines(&costate(&arguments, input));
        assert_eq!(flat(&answers[0]["v"]), [1.0, -0.5]);
        assert_eq!(flat(&answers[0]["yv_qdd_zz"]), [0.0; 36], "the other half of dx/dt is linear");
        assert!(answers[1].get("yv_qdd_zz").is_none());
        let (m, v) = (flat(&answers[1]["M"]), flat(&answers[1]["v"]));
        assert!((m[0] * v[0] + m[1] * v[1] - 0.3).abs() < 1e-14);
        assert!((m[2] * v[0] + m[3] * v[1] - 0.4).abs() < 1e-14);
        let (driven, free) = (flat(&answers[1]["qdd"]), flat(&answers[2]["qdd"]));
        let jumps = [driven[0] - free[0], driven[1] - free[1]];
        assert!((m[0] * jumps[0] + m[1] * jumps[1] - 1.0).abs() < 1e-13);
        assert!((m[2] * jumps[0] + m[3] * jumps[1] - 2.0).abs() < 1e-13);
        assert_eq!(
            (flat(&answers[1]["qdd_z"]).len(), answers[1]["qdd_z"].as_array().unwrap().len()),
            (12, 2)
        );
    }
}

/// Of `p` and `v` the one that the coordinates do not use is ignored, whatever its value.
#[test]
fn unused_momenta_or_velocities_are_not_read() {
    for (coordinates, line) in [
        ("hamiltonian", br#"{"q":[0.1,0.2],"p":[1.0,-0.5],"v":"fast"}"#),
        ("lagrangian", br#"{"q":[0.1,0.2],"v":[1.0,-0.5],"p":"much"}"#),
    ] {
        let output = costate(&["eval", "robots/two_link.toml", "--coordinates", coordinates], line);
        assert!(output.status.success(), "{}", stderr(&output));
    }
}

/// What is too long to be compiled is computed by the generic code, and stderr says so once.
#[cfg(feature = "jit")]
#[test]
fn jit_falls_back_with_a_note() {
    let robot = std::env::temp_dir().join(format!("costate-snake-{}.toml", std::process::id()));
    let joint = |k: usize| {
        let axis = ["[1.0, 0.0, 0.2]", "[0.1, 1.0, 0.0]", "[0.0, 0.3, 1.0]"][k % 3];
        format!(
            "[[joint]]\nname = 'j{k}'\naxis = {axis}\nplacement = {{ xyz = [0.1, 0.2, 0.3] }}\nmass = 1.0\n\
             com = [0.1, 0.1, 0.0]\ninertia = {{ xx = 0.1, yy = 0.1, zz = 0.1 }}\n"
        )
    };
    let text = (0..40).map(joint).fold(String::from("name = 'snake'\n"), |text, joint| text + &joint);
    std::fs::write(&robot, text).unwrap();
    let line = json!({ "q": vec![0.2; 40], "p": vec![0.1; 40] }).to_string();
    let line = format!("{line}\n{line}\n");
    let arguments = ["eval", robot.to_str().unwrap(), "--route"];
    let [jit, analytic] =
        ["jit", "analytic"].map(|route| costate(&[&arguments[..], &[route]].concat(), line.as_bytes()));
    std::fs::remove_file(&robot).unwrap();
    assert!(jit.status.success() && analytic.stderr.is_empty());
    // M by itself and M on the way to F_x differ by rounding.
    let [found, expected] = [&jit, &analytic].map(json_lines);
    assert_eq!((found.len(), expected.len()), (2, 2));
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!((&found["F"], &found["F_x"]), (&expected["F"], &expected["F_x"]));
        let [m, of_analytic] = [found, expected].map(|line| flat(&line["M"]));
        let size = of_analytic.iter().fold(0.0, |size: f64, entry| size.max(entry.abs()));
        assert_eq!(m.len(), 1600);
        assert!(m.iter().zip(&of_analytic).all(|(a, b)| (a - b).abs() <= 1e-13 * size));
    }
    let notes = stderr(&jit);
    assert!(notes.starts_with("note: f_x by the generic code: ") && notes.lines().count() == 1, "{notes}");
}

/// An output line is a valid input line; a message names the line of the input, not that of the JSON text.
#[test]
fn output_lines_are_valid_input_and_messages_name_one_line() {
    let first = costate(&["eval", "robots/two_link.toml"], br#"{"q":[0.1,0.2],"p":[0.3,0.4],"y":[1,2,3,4]}"#);
    let second = costate(&["eval", "robots/two_link.toml", "--coordinates", "lagrangian"], &first.stdout);
    assert!(second.status.success(), "{}", stderr(&second));
    assert_eq!(json_lines(&second)[0]["q"], json!([0.1, 0.2]));
    let bad = costate(&["eval", "robots/two_link.toml"], b"\n\n\n\n{\"q\":[0.1,oops]}\n");
    assert!(stderr(&bad).starts_with("error: line 5, column 11: not JSON"), "{}", stderr(&bad));
    assert!(!stderr(&bad).contains("line 1"), "{}", stderr(&bad));
}
