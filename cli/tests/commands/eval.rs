//! `costate eval`.

use crate::child::{costate, empty_folder, flat, json_lines, root, stderr, stdout};
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

#[test]
fn a_route_that_does_not_lead_to_the_coordinates_is_refused_before_any_line_is_read() {
    let arguments = ["eval", "robots/two_link.toml", "--coordinates", "lagrangian", "--route", "tensors"];
    let output = costate(&arguments, br#"{"q":[0.1,0.2],"v":[1.0,-0.5]}"#);
    assert_eq!((output.status.code(), stdout(&output).as_str()), (Some(2), ""));
    assert!(stderr(&output).contains("Hamiltonian coordinates only"), "{}", stderr(&output));
}

/// A bad line gets an error in its place; the good ones around it are evaluated.
#[test]
fn bad_lines_between_good_ones() {
    let good = r#"{"q":[0.1,0.2],"p":[0.3,0.4]}"#;
    let bad = [
        ("{\"q\":[0.1,0.2],", "JSON"),
        ("[1, 2]", "JSON"),
        (r#"{"p":[0.3,0.4]}"#, "`q` is missing"),
        (r#"{"q":[0.1,0.2]}"#, "`p` and `v` are missing"),
        (r#"{"q":[0.1],"p":[0.3,0.4]}"#, "`q` has 1 number, not 2"),
        (r#"{"q":[0.1,0.2],"p":[0.3,0.4],"y":[1,2]}"#, "`y` has 2 numbers, not 4"),
        (r#"{"q":[0.1,"x"],"p":[0.3,0.4]}"#, "`q[1]` is not a number"),
        (r#"{"q":[0.1,NaN],"p":[0.3,0.4]}"#, "JSON"),
        (r#"{"q":[0.1,1e999],"p":[0.3,0.4]}"#, "JSON"),
        (r#"{"q":[0.1,0.2],"p":[0.3,0.4],"tau":[0,0]}"#, "unknown key `tau`, did you mean `u`?"),
        (r#"{"q":[0.1,0.2],"p":[0.3,0.4],"q":[0.1,0.2]}"#, "`q` is given twice"),
        (r#"{"q":[0.1,0.2],"p":[1e200,0.4]}"#, "overflows"),
        ("\u{fffd}\u{0}", "JSON"),
    ];
    let mut input = format!("{good}\n");
    for (line, _) in bad {
        input += &format!("{line}\n{good}\n");
    }
    input += "\n";
    for coordinates in ["hamiltonian", "lagrangian"] {
        let arguments = ["eval", "robots/two_link.toml", "--coordinates", coordinates];
        let output = costate(&arguments, input.as_bytes());
        assert_eq!(output.status.code(), Some(2));
        let answers = json_lines(&output);
        assert_eq!(answers.len(), 2 * bad.len() + 1);
        let complaints = stderr(&output);
        for (k, (line, words)) in bad.into_iter().enumerate() {
            let (answer, number) = (&answers[2 * k + 1], 2 * k + 2);
            assert_eq!(answer["line"], json!(number));
            assert!(answer["error"].as_str().unwrap().contains(words), "{line}: {answer}");
            let named = [":", ","].iter().any(|end| complaints.contains(&format!("line {number}{end} ")));
            assert!(named, "{complaints}");
            assert_eq!(answers[2 * k], answers[0]);
        }
    }
    let bytes = costate(&["eval", "robots/two_link.toml"], b"\xff\xfe\n{\"q\":[0,0],\"p\":[0,0]}\n");
    assert_eq!((bytes.status.code(), json_lines(&bytes).len()), (Some(2), 2));
}

#[test]
fn a_singular_state_is_a_bad_line_that_names_the_joint() {
    let robot = std::env::temp_dir().join(format!("costate-needle-{}.toml", std::process::id()));
    let text = "name = 'needle'\n[[joint]]\nname = 'a'\nmass = 1.0\ncom = [1.0, 0.0, 0.0]\n\
                [[joint]]\nname = 'spin'\nmass = 1.0\nplacement = { xyz = [1.0, 0.0, 0.0] }\n";
    std::fs::write(&robot, text).unwrap();
    let input = br#"{"q":[0,0],"v":[0,0]}"#;
    let output = costate(&["eval", robot.to_str().unwrap()], input);
    let lagrangian = costate(&["eval", robot.to_str().unwrap(), "--coordinates", "lagrangian"], input);
    for &route in ROUTES {
        let by_route = costate(&["eval", robot.to_str().unwrap(), "--route", route], input);
        assert_eq!(json_lines(&by_route), json_lines(&output), "{route}");
    }
    std::fs::remove_file(&robot).unwrap();
    assert_eq!(json_lines(&lagrangian), json_lines(&output));
    assert_eq!(output.status.code(), Some(2));
    assert!(json_lines(&output)[0]["error"].as_str().unwrap().contains("singular at joint 'spin'"));
    let warnings = stderr(&output);
    assert!(warnings.contains("warning: ") && warnings.contains("'spin'"), "{warnings}");
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
    assert_eq!(stdout(&jit), stdout(&analytic));
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

#[test]
fn angles_that_look_like_degrees_are_a_warning_once() {
    let input = br#"{"q":[0.1,12.5],"p":[0,0]}
{"q":[0.1,90],"p":[0,0]}
{"q":[180,90],"p":[0,0]}
"#;
    let output = costate(&["eval", "robots/two_link.toml"], input);
    assert!(output.status.success());
    let warnings = stderr(&output);
    assert!(warnings.starts_with("warning: line 2: revolute joint 'elbow' is at q = 90 rad"), "{warnings}");
    assert_eq!(warnings.lines().count(), 1, "{warnings}");
}

/// On long chains automatic second derivatives are refused with an estimate; the analytic route works.
#[test]
fn automatic_second_derivatives_of_long_chains_are_refused_early() {
    let n = 120;
    let joint = |k: usize| {
        format!(
            "[[joint]]\nname = 'j{k}'\naxis = [0.1, 1.0, 0.2]\nmass = 1.0\ncom = [0.1, 0.1, 0.0]\n\
                 armature = 0.1\nplacement = {{ xyz = [0.1, 0.2, 0.3] }}\n"
        )
    };
    let robot = (0..n).map(joint).fold(String::from("name = 'chain'\n"), |text, joint| text + &joint);
    let folder = empty_folder("long_chain");
    let states = folder.join("states.jsonl");
    let state = |y| json!({ "q": vec![0.1; n], "v": vec![0.1; n], "y": y }).to_string();
    std::fs::write(&states, state(Some(vec![1.0; 2 * n])) + "\n" + &state(None)).unwrap();
    let arguments = ["eval", "-", "--states", states.to_str().unwrap(), "--route"];
    let hyperdual = costate(&[&arguments[..], &["hyperdual"]].concat(), robot.as_bytes());
    assert_eq!((hyperdual.status.code(), hyperdual.stdout.len()), (Some(2), 0));
    assert!(stderr(&hyperdual).contains("operations") && stderr(&hyperdual).contains("--force"));
    let dual = costate(&[&arguments[..], &["dual"]].concat(), robot.as_bytes());
    assert_eq!((dual.status.code(), dual.stdout.len()), (Some(2), 0));
    assert!(stderr(&dual).starts_with("error: second derivatives of 120 joints"), "{}", stderr(&dual));
    let tensors = costate(&[&arguments[..], &["tensors"]].concat(), robot.as_bytes());
    assert_eq!((tensors.status.code(), tensors.stdout.len()), (Some(2), 0));
    assert!(stderr(&tensors).contains("MB (the limit is 256 MB)"), "{}", stderr(&tensors));
    assert!(costate(&[&arguments[..], &["analytic"]].concat(), robot.as_bytes()).status.success());
}

/// Positions, Jacobians and second derivatives of frames by every route, and the line as an input line.
#[test]
fn frames_are_answered_by_every_route() {
    let line = br#"{"q":[0.3,-1.2,0.8,0.1,0.5,0.2],"v":[0,0,0,0,0,0],"frames":["forearm_link",
        {"name":"tool0","axes":"local","w":[0.2,-1.0,0.7]}]}"#;
    let line: Vec<u8> = line.iter().copied().filter(|byte| *byte != b'\n').collect();
    let mut answers = Vec::new();
    for route in ROUTES {
        let output = costate(&["eval", "robots/ur5.urdf", "--route", route], &line);
        assert!(output.status.success(), "{route}: {}", stderr(&output));
        answers.push(json_lines(&output)[0].clone());
    }
    let reference = answers[0]["frames"].as_array().unwrap().clone();
    assert_eq!((reference.len(), &reference[0]["name"]), (2, &json!("forearm_link")));
    assert_eq!((flat(&reference[1]["jacobian"]).len(), flat(&reference[1]["w_x_qq"]).len()), (36, 36));
    assert!(reference[0].get("w_x_qq").is_none() && reference[0]["axes"] == json!("aligned"));
    for (answer, route) in answers.iter().zip(ROUTES) {
        for key in ["position", "rotation", "jacobian", "w_x_qq"] {
            let (found, expected) = (flat(&answer["frames"][1][key]), flat(&reference[1][key]));
            let apart = found.iter().zip(&expected).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
            assert!(found.len() == expected.len() && apart < 1e-13, "{key} by {route}");
        }
    }
    let again = costate(&["eval", "robots/ur5.urdf"], answers[0].to_string().as_bytes());
    assert_eq!(json_lines(&again)[0]["frames"], answers[0]["frames"]);
}

/// Where M is singular, too.
#[test]
fn frames_alone_need_no_motion() {
    let robot = "name = 'wrist'\n[[joint]]\nname = 'a'\nmass = 1.0\ncom = [0.3, 0.0, 0.0]\n[[joint]]\nname = 'idle'\n";
    let states = std::env::temp_dir().join(format!("costate-frames-{}.jsonl", std::process::id()));
    let lines = "{\"q\":[0,0],\"frames\":[\"idle\"]}\n{\"q\":[0,0],\"v\":[0,0],\"frames\":[\"idle\"]}\n\
                 {\"q\":[0,0],\"y\":[0,0,0,0],\"frames\":[\"idle\"]}\n";
    std::fs::write(&states, lines).unwrap();
    let output = costate(&["eval", "-", "--states", states.to_str().unwrap()], robot.as_bytes());
    std::fs::remove_file(states).unwrap();
    let answers = json_lines(&output);
    assert_eq!(answers[0]["frames"][0]["jacobian"][2], json!([1.0, 1.0]));
    assert!(answers[1]["error"].as_str().unwrap().contains("'idle'"), "{}", answers[1]);
    assert!(answers[2]["error"].as_str().unwrap().contains("`p` and `v` are missing"), "{}", answers[2]);
}

#[test]
fn bad_frames_are_explained() {
    for (frames, reason) in [
        (r#"["tol0"]"#, "'tool0'"),
        ("7", "not an array"),
        ("[7]", "`frames[0]` is neither a name"),
        (r#"[{"w":[1,2,3]}]"#, "no `name`"),
        (r#"["tool0",{"name":"tool0","w":[1,2]}]"#, "`frames[1]` has a `w`"),
        (r#"[{"name":"tool0","axis":1}]"#, "unknown key `axis`"),
        (r#"[{"name":"tool0","axes":"base"}]"#, "`axes` other than"),
        (&format!("[{}\"tool0\"]", "\"tool0\",".repeat(300)), "at most 256"),
    ] {
        let line = format!(r#"{{"q":[0,0,0,0,0,0],"v":[0,0,0,0,0,0],"frames":{frames}}}"#);
        let output = costate(&["eval", "robots/ur5.urdf"], line.as_bytes());
        let answer = json_lines(&output)[0]["error"].as_str().unwrap().to_owned();
        assert!(output.status.code() == Some(2) && answer.contains(reason), "{answer}");
    }
}

/// A wrench of a robot file acts as its generalised force does; every route knows it.
#[test]
fn wrenches_of_a_robot_file_are_in_every_route() {
    let text = std::fs::read_to_string(root().join("robots/two_link.toml")).unwrap();
    let pull = "\n[[frame]]\nname = 'tip'\nparent = 'elbow'\nplacement = { xyz = [0.4, 0.0, 0.1] }\n\
        [[wrench]]\nframe = 'tip'\nforce = [1.0, -2.0, 3.0]\nmoment = [0.1, 0.2, 0.3]\naxes = 'AXES'\n";
    let state = r#"{"q":[0.3,-0.8],"v":[1.0,0.5],"y":[1,-2,0.5,0.3],"frames":["tip"]}"#;
    for axes in ["local", "aligned"] {
        let robot = std::env::temp_dir().join(format!("costate-pulled-{axes}-{}.toml", std::process::id()));
        std::fs::write(&robot, text.clone() + &pull.replace("AXES", axes)).unwrap();
        let path = robot.to_str().unwrap();
        for coordinates in ["hamiltonian", "lagrangian"] {
            let mut first = None;
            for route in ROUTES.iter().filter(|route| coordinates == "hamiltonian" || **route != "tensors") {
                let arguments = ["eval", path, "--route", route, "--coordinates", coordinates];
                let answer = json_lines(&costate(&arguments, state.as_bytes()))[0].clone();
                let keys: &[&str] = if coordinates == "hamiltonian" {
                    &["f", "f_x", "y_f_xx"]
                } else {
                    &["qdd", "qdd_z", "yv_qdd_zz"]
                };
                let numbers: Vec<f64> = keys.iter().flat_map(|key| flat(&answer[key])).collect();
                let expected = first.get_or_insert_with(|| numbers.clone());
                let apart =
                    numbers.iter().zip(&*expected).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
                assert!(apart < 1e-11 && numbers.len() == expected.len(), "{axes} {route}: {apart:e}");
            }
            let bare = costate(
                &["eval", "robots/two_link.toml", "--coordinates", coordinates],
                state.replace(r#","frames":["tip"]"#, "").as_bytes(),
            );
            let key = if coordinates == "hamiltonian" { "f" } else { "qdd" };
            let difference: f64 =
                flat(&json_lines(&bare)[0][key]).iter().zip(first.unwrap()).map(|(a, b)| (a - b).abs()).sum();
            assert!(difference > 0.1, "the wrench has no effect");
        }
        std::fs::remove_file(&robot).unwrap();
    }
}
