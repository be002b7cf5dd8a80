//! Lines and robots that are refused, and warnings.

use super::ROUTES;
use crate::child::{costate, empty_folder, json_lines, stderr, stdout};
use serde_json::json;

#[test]
fn a_route_that_does_not_lead_to_the_coordinates_is_refused_before_any_line_is_read() {
    let arguments = ["eval", "robots/two_link.toml", "--coordinates", "qv", "--route", "tensors"];
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
