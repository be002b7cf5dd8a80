//! `costate info`: masses, inertias and limits.

use crate::child::{costate, flat, root, stderr, stdout};
use serde_json::{Value, json};

const ROBOT: &str = "name = 'arm'\ngravity = [0.0, 0.0, -0.0]\n[[joint]]\nname = 'slide'\ntype = 'prismatic'\n\
    mass = 2.0\ncom = [0.1, 0.2, 0.3]\ninertia = { xx = 1.0, yy = 2.0, zz = 2.5, xy = 0.5 }\narmature = 0.25\n";

fn json_of(robot: &str, text: &str) -> Value {
    serde_json::from_str(&stdout(&costate(&["info", robot, "--json"], text.as_bytes()))).unwrap()
}

#[test]
fn json_holds_masses_inertias_limits_armature_and_gravity() {
    let info = json_of("-", ROBOT);
    assert_eq!((flat(&info["gravity"]), &info["mass"]), (vec![0.0, 0.0, 0.0], &json!(2.0)));
    let joint = &info["joints"][0];
    assert_eq!(
        (&joint["index"], &joint["name"], &joint["link"]),
        (&json!(0), &json!("slide"), &json!("slide"))
    );
    assert_eq!((flat(&joint["com"]), &joint["mass"]), (vec![0.1, 0.2, 0.3], &json!(2.0)));
    assert_eq!(joint["armature"], json!(0.25));
    let inertia = flat(&joint["inertia"]);
    assert_eq!((inertia.len(), inertia[1], inertia[3]), (9, inertia[3], inertia[1]));
    assert_eq!(joint["limits"], json!({ "lower": null, "upper": null, "velocity": null, "effort": null }));
    assert_eq!(info["armature_couplings"], json!([]));
    let limits = &json_of("robots/ur5.urdf", "")["joints"][0]["limits"];
    assert!(limits["upper"].as_f64().unwrap() > 6.0 && limits["effort"].as_f64().unwrap() > 0.0);
}

/// As in problem files; and one joint is a singular.
#[test]
fn joints_are_numbered_from_zero() {
    let table = stdout(&costate(&["info", "robots/ur5.urdf"], b""));
    let row = |word: &str| table.lines().find(|line| line.contains(word)).unwrap().trim_start().to_owned();
    assert!(row("shoulder_pan_joint").starts_with("0 ") && row("wrist_3_joint").starts_with("5 "), "{table}");
    // Limits of positions, rates and efforts; a joint without any has dashes.
    let limits = table.lines().skip_while(|line| !line.contains("rate limit")).nth(2).unwrap();
    let cells: Vec<&str> = limits.split_whitespace().collect();
    assert_eq!(cells, ["0", "shoulder_pan_joint", "-6.283", "6.283", "3.142", "150.000"], "{table}");
    let table = stdout(&costate(&["info", "-"], ROBOT.as_bytes()));
    assert!(
        table.lines().any(|line| line.split_whitespace().eq(["0", "slide", "-", "-", "-", "-"])),
        "{table}"
    );
    assert!(table.starts_with("arm, 1 joint, moving mass 2.0000 kg, gravity (0, 0, 0) m/s^2"), "{table}");
}

/// Indices are those of q; what mimics another joint has none.
#[test]
fn mimic_joints_are_shown_with_what_they_follow() {
    let table = stdout(&costate(&["info", "tests/fixtures/mimic_hand.urdf"], b""));
    assert!(table.starts_with("mimic_hand, 3 joints and 4 mimic joints, moving mass"), "{table}");
    assert!(table.contains("'right_knuckle' mimics 'knuckle': q = -1 q_knuckle + 0"), "{table}");
    let info = json_of("tests/fixtures/mimic_hand.urdf", "");
    assert_eq!((&info["n"], info["joints"].as_array().unwrap().len()), (&json!(3), 7));
    let of =
        |name: &str| info["joints"].as_array().unwrap().iter().find(|joint| joint["name"] == name).unwrap();
    assert_eq!((&of("knuckle")["index"], &of("knuckle")["mimic"]), (&json!(2), &Value::Null));
    assert_eq!(of("slide")["mimic"], json!({ "joint": "wrist", "ratio": 0.02, "offset": 0.01 }));
    assert_eq!(of("slide")["index"], Value::Null);
}

/// Flags change the robot; what cannot be is an error that names joint or frame.
#[test]
fn flags_lock_joints_and_attach_payloads() {
    let arm = "robots/ur5.urdf";
    let locked = ["--lock", "wrist_1_joint=0.5", "--lock", "wrist_2_joint=-0.5", "--gravity", "0,0,-1.62"];
    let changed = ["--payload", "tool0=2,0,0,0.1", "--armature", "elbow_joint=0.25", "--json"];
    let info = |flags: &[&str]| costate(&[&["info", arm], flags].concat(), b"");
    let whole: Value = serde_json::from_str(&stdout(&info(&["--json"]))).unwrap();
    let part: Value = serde_json::from_str(&stdout(&info(&[&locked[..], &changed].concat()))).unwrap();
    assert_eq!((&part["n"], flat(&part["gravity"])), (&json!(4), vec![0.0, 0.0, -1.62]));
    let gained = part["mass"].as_f64().unwrap() - whole["mass"].as_f64().unwrap();
    assert!((gained - 2.0).abs() < 1e-12, "{gained}");
    assert_eq!(part["joints"][2]["armature"], json!(0.25));
    let figures =
        ["--joint-limits", "elbow_joint=-1,,2.5", "--joint-friction", "elbow_joint=0.3,0.2", "--json"];
    let figures: Value = serde_json::from_str(&stdout(&info(&figures))).unwrap();
    let (elbow, before) = (&figures["joints"][2], &whole["joints"][2]);
    let (new, old) = (&elbow["limits"], &before["limits"]);
    assert_eq!((&new["lower"], &new["velocity"]), (&json!(-1.0), &json!(2.5)));
    assert_eq!((&new["upper"], &new["effort"]), (&old["upper"], &old["effort"]));
    assert_eq!((&elbow["friction"]["viscous"], &elbow["friction"]["coulomb"]), (&json!(0.3), &json!(0.2)));
    let reduced: Value =
        serde_json::from_str(&stdout(&info(&["--reduced-to", "elbow_joint,wrist_3_joint", "--json"])))
            .unwrap();
    assert_eq!(reduced["joints"][1]["name"], json!("wrist_3_joint"));
    for (flags, words) in [
        (&["--lock", "wrist_4_joint=0"][..], &["'wrist_4_joint'", "did you mean 'wrist_1_joint'"][..]),
        (&["--lock", "elbow_joint=nan"], &["elbow_joint", "finite"]),
        (&["--lock", "elbow_joint"], &["--lock", "a name, =, and a value"]),
        (&["--payload", "tol0=1"], &["'tol0'", "'tool0'"]),
        (&["--joint-limits", "elbow_joint=2,1"], &["elbow_joint", "must not exceed the upper limit"]),
        (&["--joint-limits", "elbow_joint=2"], &["--joint-limits", "2, 3 or 4 entries"]),
        (&["--joint-limits", "elbow_joint=,"], &["--joint-limits", "changes no limit"]),
        (&["--joint-friction", "elbow_joint=-1"], &["elbow_joint", "viscous friction"]),
        (&["--payload", "tool0=-1"], &["the payload of frame 'tool0'", "-1 kg"]),
        (&["--payload", "tool0=1,2"], &["--payload", "1, 4, 7 or 10 numbers"]),
        (&["--reduced-to", "knee"], &["'knee'"]),
        (&["--reduced-to", "elbow_joint,elbow_joint"], &["'elbow_joint'", "named twice"]),
        (&["--lock", "elbow_joint=0", "--reduced-to", "elbow_joint"], &["'elbow_joint'", "locked"]),
        (&["--gravity", "0,0"], &["--gravity", "3 numbers"]),
        (&["--strict", "--lock", "elbow_joint=9"], &["elbow_joint", "outside its limits"]),
    ] {
        let output = info(flags);
        assert_eq!(output.status.code(), Some(2), "{flags:?}");
        let message = stderr(&output);
        assert!(words.iter().all(|word| message.contains(word)), "{flags:?}: {message}");
    }
}

/// Frames and wrenches of flags are those of a robot file.
#[test]
fn flags_add_frames_and_wrenches() {
    let file = std::fs::read_to_string(root().join("robots/two_link.toml")).unwrap();
    let rows = "[[frame]]\nname = 'tip'\nparent = 'elbow'\nplacement = { xyz = [0.4, 0.0, 0.1], rpy = [0.0, 0.3, 0.0] }\n\
                [[frame]]\nname = 'far'\nparent = 'tip'\nplacement = { xyz = [0.0, 0.0, 1.0] }\n\
                [[wrench]]\nframe = 'far'\nforce = [1.0, 2.0, -3.0]\nmoment = [0.0, 0.5, 0.0]\naxes = 'aligned'\n";
    let expected = costate(&["info", "-", "--frames", "--json"], format!("{file}\n{rows}").as_bytes());
    let info = |flags: &[&str]| {
        costate(&[&["info", "robots/two_link.toml", "--frames", "--json"], flags].concat(), b"")
    };
    let tip = ["--frame", "tip=joint:elbow:0.4,0,0.1,0,0.3,0"];
    let far = ["--frame", "far=tip:0,0,1", "--wrench", "far=1,2,-3,0,0.5,0,aligned"];
    assert_eq!(stdout(&info(&[tip, [far[0], far[1]], [far[2], far[3]]].concat())), stdout(&expected));
    assert!(stdout(&expected).contains("aligned"));
    for (flags, words) in [
        (&["--frame", "tip=elbwo:0,0,1"][..], &["'elbwo'", "did you mean 'elbow'"][..]),
        (&["--frame", "elbow=elbow:0,0,1"], &["two frames are called 'elbow'"]),
        (&["--frame", "tip=elbow:0,0"], &["--frame", "3 or 6 numbers, not 2"]),
        (&["--frame", "tip=elbow"], &["--frame", "a name, =, a frame, :, and 3 or 6 numbers"]),
        (&["--frame", "tip=elbow:0,0,inf"], &["frame 'tip'", "finite"]),
        (&["--wrench", "elbo=1,2,3"], &["'elbo'", "did you mean 'elbow'"]),
        (&["--wrench", "elbow=1,2,nan"], &["frame 'elbow'", "finite"]),
        (&["--wrench", "elbow=1,2,3,world"], &["--wrench", "'world'", "local or aligned"]),
    ] {
        let output = info(flags);
        let message = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{flags:?}");
        assert!(words.iter().all(|word| message.contains(word)), "{flags:?}: {message}");
    }
}

/// Warnings go where those of all commands go; names of any length fit the table.
#[test]
fn long_names_are_cut_and_warnings_go_to_standard_error() {
    let limits = "limits = { lower = -180.0 }\n[[joint]]\n";
    let robot = ROBOT.replace("slide", &"x".repeat(70_000)).replace("prismatic", "revolute") + limits;
    let robot = robot + "name = 'last'\nmass = 1.0\ncom = [1.0, 0.0, 0.0]\n";
    let info = costate(&["info", "-"], robot.as_bytes());
    assert!(info.status.success(), "{}", stderr(&info));
    assert!(stdout(&info).contains("xxx\u{2026}") && stdout(&info).len() < 2000, "{}", stdout(&info));
    assert!(
        !stdout(&info).contains("warning") && stderr(&info).starts_with("warning: position limits beyond")
    );
}

#[test]
fn frames_are_listed_on_request() {
    let table = stdout(&costate(&["info", "robots/ur5.urdf", "--frames"], b""));
    let row = table.lines().find(|line| line.contains("tool0")).unwrap();
    assert!(row.contains("link") && row.contains("wrist_3_joint"), "{table}");
    assert!(!stdout(&costate(&["info", "robots/ur5.urdf"], b"")).contains("tool0"));
    let text = stdout(&costate(&["info", "robots/ur5.urdf", "--frames", "--json"], b""));
    let info: Value = serde_json::from_str(&text).unwrap();
    let frames = info["frames"].as_array().unwrap();
    assert_eq!((&frames[0]["kind"], &frames[0]["joint"]), (&json!("world"), &Value::Null));
    assert_eq!(frames[1]["name"], json!("shoulder_pan_joint"));
    assert!(frames.iter().any(|frame| frame["name"] == "tool0" && frame["joint"] == "wrist_3_joint"));
    assert!(json_of("robots/ur5.urdf", "").get("frames").is_none());
    let table = stdout(&costate(&["info", "tests/fixtures/pulled_arm.toml", "--frames"], b""));
    let row = table.lines().find(|line| line.contains("aligned") && line.contains("-12")).unwrap();
    assert!(row.contains("branch") && row.contains("(0.500, -0.200, 0)"), "{table}");
    let text = stdout(&costate(&["info", "tests/fixtures/pulled_arm.toml", "--frames", "--json"], b""));
    let info: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(
        (&info["wrenches"][0]["frame"], &info["wrenches"][1]["axes"]),
        (&json!("tip"), &json!("aligned"))
    );
}

/// A loop of a URDF is a constraint: five rows of a revolute joint.
#[test]
fn loops_of_a_urdf_are_constraints() {
    let info = json_of("robots/four_bar.urdf", "");
    assert_eq!(info["constraints"], json!([{ "name": "rocker_pivot", "rows": 5 }]));
    assert_eq!((&info["n"], &info["warnings"]), (&json!(3), &json!([])));
    let refused = costate(&["check", "robots/four_bar.urdf"], b"");
    assert!(stderr(&refused).contains("'rocker_pivot'"), "{}", stderr(&refused));
}

/// A floating joint is one joint of seven entries of q and six of v, and so in a URDF.
#[test]
fn floating_and_spherical_joints_are_shown_as_one_joint_each() {
    let table = stdout(&costate(&["info", "tests/fixtures/free_tree.toml"], b""));
    assert!(table.starts_with("free tree, 5 joints with 17 degrees of freedom, moving mass 10.5"), "{table}");
    let cells = |name: &str| {
        let rows = table.lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
        rows.filter(|row| row.get(2) == Some(&name)).collect::<Vec<_>>()
    };
    let of = |name: &str| cells(name)[0][..6].to_vec();
    assert_eq!(of("root"), ["0..7", "0..6", "root", "floating", "world", "-"]);
    assert_eq!(of("hip"), ["7..11", "6..9", "hip", "spherical", "root", "-"]);
    assert_eq!(of("knee"), ["11", "9", "knee", "revolute", "hip", "(0,"]);
    assert_eq!(of("load"), ["13..20", "11..17", "load", "floating", "mast", "-"]);
    // Once in the table of joints, once in that of limits; no joint of a chain in either.
    assert_eq!((cells("root").len(), cells("root_x").len(), cells("load_ry").len()), (2, 0, 0));
    let info = json_of("tests/fixtures/free_tree.toml", "");
    assert_eq!((&info["n"], &info["nq"]), (&json!(17), &json!(20)));
    assert_eq!(
        info["free_joints"][1],
        json!({ "name": "hip", "floating": false, "position": 7, "coordinate": 6 })
    );
    let joints = info["joints"].as_array().unwrap();
    let names: Vec<&str> = joints.iter().map(|joint| joint["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["root", "hip", "knee", "mast", "load"]);
    let [root, load] = [&joints[0], &joints[4]];
    assert_eq!((&root["type"], &root["q"], &root["v"]), (&json!("floating"), &json!([0, 7]), &json!([0, 6])));
    assert_eq!((&root["index"], &root["axis"], &root["mass"]), (&json!(0), &Value::Null, &json!(6.0)));
    assert_eq!(flat(&root["placement"]["xyz"]), [0.1, -0.2, 0.3]);
    assert_eq!((&load["parent"], &load["index"], &load["q"]), (&json!("mast"), &json!(11), &json!([13, 20])));
    assert_eq!(joints[2]["q"], json!([11, 12]));
    // Without such joints both have the same entries.
    let info = json_of("tests/fixtures/mimic_hand.urdf", "");
    assert_eq!((&info["nq"], &info["free_joints"]), (&json!(3), &json!([])));
    let slide = info["joints"].as_array().unwrap().iter().find(|joint| joint["name"] == "slide").unwrap();
    assert_eq!((&slide["q"], &slide["v"]), (&Value::Null, &Value::Null));
}

/// Loops that cannot be closed are told, and are no error.
#[test]
fn constraints_that_no_position_satisfies_are_told() {
    for robot in ["robots/four_bar.toml", "robots/delta.toml", "robots/gripper.toml"] {
        let table = stdout(&costate(&["info", robot], b""));
        assert!(table.contains(" row") && !table.contains("No position near"), "{table}");
        assert!(json_of(robot, "").get("unsatisfied").is_none());
    }
    let file = std::fs::read_to_string(root().join("robots/four_bar.toml")).unwrap();
    let far = file.replace("[1.3, 0.0, 0.0]", "[3.0, 0.0, 0.0]");
    let output = costate(&["info", "-"], far.as_bytes());
    let table = stdout(&output);
    assert!(output.status.success(), "{}", stderr(&output));
    let line =
        "No position near q = 0 was found that satisfies the constraints: constraint 'rocker_pivot' cannot";
    assert!(table.contains(line), "{table}");
    let info = json_of("-", &far);
    assert_eq!(info["unsatisfied"]["contradiction"], json!(false));
    // The rods are 2.6 m long.
    assert!((info["unsatisfied"]["miss"].as_f64().unwrap() - 0.4).abs() < 1e-2, "{info}");
    let twice = format!(
        "{file}\n[[constraint]]\nname = \"other\"\nframe = \"rocker_tip\"\nto = \"pivot\"\nrows = [\"x\"]\n\
         to_placement = {{ xyz = [0.1, 0.0, 0.0] }}\n"
    );
    let table = stdout(&costate(&["info", "-"], twice.as_bytes()));
    assert!(table.contains("constraint 'other' contradicts those before it"), "{table}");
}
