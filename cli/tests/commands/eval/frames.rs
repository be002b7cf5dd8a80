//! Frames and wrenches.

use super::ROUTES;
use crate::child::{costate, empty_folder, flat, json_lines, root, stderr, stdout};
use serde_json::json;

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

/// A URDF without `<inertial>` has kinematics; edits of the command line give it dynamics.
#[test]
fn a_robot_without_mass_has_frames() {
    let urdf = "<robot name='r'><link name='base'/><link name='l'/><joint name='a' type='continuous'>\
                <parent link='base'/><child link='l'/><axis xyz='0 0 1'/></joint></robot>";
    let path = empty_folder("massless").join("massless.urdf");
    std::fs::write(&path, urdf).unwrap();
    let path = path.to_str().unwrap();
    let output = costate(&["eval", path], b"{\"q\":[0.3],\"frames\":[\"l\"]}\n{\"q\":[0.3],\"v\":[0]}\n");
    assert!(stderr(&output).contains("kinematics only"), "{}", stderr(&output));
    let answers = json_lines(&output);
    assert_eq!(answers[0]["frames"][0]["jacobian"][2], json!([1.0]));
    assert!(answers[1]["error"].as_str().unwrap().contains("'a'"), "{}", answers[1]);
    let flags = ["--armature", "a=0.1", "--strict"];
    let refused = costate(&[&["eval", path][..], &flags].concat(), b"");
    assert!(stderr(&refused).contains("'l' moves but has neither mass"), "{}", stderr(&refused));
    let mended = costate(&["eval", path, "--payload", "l=1,0.1,0,0", "--strict"], b"{\"q\":[0.3],\"v\":[0]}");
    assert!(mended.status.success(), "{}", stderr(&mended));
}

/// Routes about dynamics say what they do about frames.
#[test]
fn the_help_says_by_which_route_frames_are_answered() {
    let help = stdout(&costate(&["eval", "--help"], b""));
    let words: Vec<&str> = help.split_whitespace().collect();
    assert!(words.join(" ").contains("tensors and jit are about dynamics"), "{help}");
    let line = br#"{"q":[0.3,-1.2,0.8,0.1,0.5,0.2],"frames":[{"name":"tool0","w":[0.2,-1.0,0.7]}]}"#;
    let frames =
        |route| json_lines(&costate(&["eval", "robots/ur5.urdf", "--route", route], line))[0].clone();
    assert_eq!(frames("tensors"), frames("analytic"));
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
        (r#"[{"name":"tool0"},{"name":"tool0","w":[1,2,3],"w":[1,2,3]}]"#, "`frames[1]` has `w` twice"),
        (r#"[{"name":"tool0","name":"tool0"}]"#, "`frames[0]` has `name` twice"),
        (r#"[{"name":"tool0","position":1,"position":2}]"#, "`frames[0]` has `position` twice"),
        (r#"["joint:wrist_4_joint"]"#, "'joint:wrist_1_joint'"),
        (r#"{"name":"tool0"}"#, "not an array"),
        (&format!("[{{{}\"name\":\"tool0\"}}]", "\"axes\":\"local\",".repeat(300)), "has `axes` twice"),
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

/// Many frames of a long chain would take gigabytes, a few do not.
#[test]
fn frames_that_take_too_much_are_a_bad_line() {
    let n = 120;
    let joint = |k: usize| {
        format!(
            "[[joint]]\nname = 'j{k}'\naxis = [0.1, 1.0, 0.2]\nmass = 1.0\ncom = [0.1, 0.1, 0.0]\n\
             placement = {{ xyz = [0.1, 0.2, 0.3] }}\n"
        )
    };
    let robot = (0..n).map(joint).fold(String::from("name = 'chain'\n"), |text, joint| text + &joint);
    let folder = empty_folder("many_frames");
    let states = folder.join("states.jsonl");
    let frame = |w: &str| format!("{{\"name\":\"j119\"{w}}}");
    let line =
        |frames: Vec<String>| format!("{{\"q\":{:?},\"frames\":[{}]}}\n", vec![0.1; n], frames.join(","));
    let weighted = r#","w":[1,2,3]"#;
    let lines = [line(vec![frame(weighted); 256]), line(vec![frame(weighted)]), line(vec![frame(""); 16])];
    std::fs::write(&states, lines.concat()).unwrap();
    let arguments = ["eval", "-", "--states", states.to_str().unwrap(), "--route", "dual"];
    let output = costate(&arguments, robot.as_bytes());
    let answers = json_lines(&output);
    let error = answers[0]["error"].as_str().unwrap();
    assert!(error.contains("256 frames") && error.contains("--force"), "{error}");
    assert_eq!(answers[1]["frames"].as_array().map(Vec::len), Some(1));
    assert_eq!(answers[2]["frames"].as_array().map(Vec::len), Some(16));
}
