//! `costate optimize`.

use crate::child::{costate, root, stderr, stdout};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A folder for the files of one test.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("optimize").join(test);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn robot(name: &str) -> String {
    root().join("robots").join(name).canonicalize().unwrap().to_str().unwrap().replace('\\', "/")
}

/// A whole problem for the two-link arm, a key a line.
fn two_link() -> String {
    format!(
        "robot = \"{}\"\n[start]\nq = [0.0, 0.0]\n[end]\nq = [1.0, 0.5]\n[time]\nfinal = 1.0\n[cost]\neffort = [1.0, 1.0]\n",
        robot("two_link.toml")
    )
}

/// Runs the command on a problem with this text.
fn optimize(test: &str, text: &str, more: &[&str]) -> std::process::Output {
    let file = folder(test).join("problem.toml");
    std::fs::write(&file, text).unwrap();
    costate(&[&["optimize", file.to_str().unwrap()], more].concat(), b"")
}

fn json(output: &std::process::Output) -> Value {
    serde_json::from_str(&stdout(output)).unwrap()
}

#[test]
fn bad_problems_are_refused_with_file_line_and_key() {
    let good = two_link();
    let with = |from: &str, to: &str| {
        assert!(good.contains(from), "{from}");
        good.replace(from, to)
    };
    let and = |more: &str| format!("{good}{more}");
    let missing =
        |key: &str| good.lines().filter(|line| !line.starts_with(key)).collect::<Vec<_>>().join("\n");
    for (text, line, parts) in [
        (
            with("two_link.toml", "no_such_robot.toml"),
            Some(1),
            &["robot", "no_such_robot.toml", "check the path"][..],
        ),
        (missing("robot"), None, &["robot", "missing"]),
        (with("q = [0.0, 0.0]", "q = [0.0]"), Some(3), &["start.q", "1", "2"]),
        (with("q = [1.0, 0.5]", "q = [1.0, 0.5, 0.0]"), Some(5), &["end.q", "3", "2"]),
        (with("q = [1.0, 0.5]", "q = [1.0, nan]"), Some(5), &["end.q", "elbow", "finite"]),
        (with("q = [1.0, 0.5]", "q = [1.0, 0.5]\nv = [1.0]"), Some(6), &["end.v", "1", "2"]),
        (with("q = [0.0, 0.0]", "p = [0.0, 0.0]"), Some(3), &["start.p", "unknown", "`q`"]),
        (with("[start]", "[begin]"), Some(2), &["begin", "unknown", "`start`"]),
        (with("final = 1.0", "final = 0.0"), Some(7), &["time.final", "positive"]),
        (with("final = 1.0", "final = -1"), Some(7), &["time.final", "positive"]),
        (with("final = 1.0", "final = \"soon\""), Some(7), &["time.final", "a number", "soon"]),
        (with("final = 1.0", "free = true"), Some(6), &["time.guess", "missing"]),
        (
            with("final = 1.0", "free = true\nguess = 1.0\nfinal = 2.0"),
            Some(9),
            &["time.final", "free = true"],
        ),
        (with("final = 1.0", "final = 2.0\nguess = 1.0"), Some(8), &["time.guess", "free = true"]),
        (with("final = 1.0", ""), Some(6), &["time.final", "missing"]),
        (with("final = 1.0", "free = true\nguess = 1.0"), Some(7), &["time.free", "cost.time"]),
        (with("effort = [1.0, 1.0]", "effort = [1.0, 0.0]"), Some(9), &["cost.effort", "elbow", "bounds"]),
        (with("effort = [1.0, 1.0]", "effort = [1.0, -1.0]"), Some(9), &["cost.effort", "elbow", "negative"]),
        (with("effort = [1.0, 1.0]", "effort = [1.0]"), Some(9), &["cost.effort", "1", "2"]),
        (missing("effort"), Some(8), &["cost.effort", "shoulder"]),
        (
            and("[bounds]\nu_min = [-1.0, 2.0]\nu_max = [1.0, 2.0]"),
            Some(11),
            &["bounds.u_min", "elbow", "bounds.u_max"],
        ),
        (and("[bounds]\nu_min = [-1.0]\nu_max = [1.0, 2.0]"), Some(11), &["bounds.u_min", "1", "2"]),
        (
            and("[bounds]\nu_min = [-1.0, nan]\nu_max = [1.0, 2.0]"),
            Some(11),
            &["bounds.u_min", "elbow", "not a number"],
        ),
        (
            with("effort = [1.0, 1.0]", "effort = [1.0, 0.0]\n[bounds]\nu_min = [-1, -1]\nu_max = [1, inf]"),
            Some(9),
            &["cost.effort", "elbow", "both sides", "bounds.u_max"],
        ),
        (and("[bounds]\nu_max = [1.0, 2.0]"), Some(10), &["bounds.u_min", "missing", "add it"]),
        (and("[penalty]\nweight = -1.0"), Some(11), &["penalty.weight", "negative"]),
        (and("[penalty]\nweight = 1.0\nv_max = [1.0]"), Some(12), &["penalty.v_max", "1", "2"]),
        (and("[actuation]\ngain = [1.0, 0.0]"), Some(11), &["actuation.gain", "elbow"]),
        (and("[solver]\nnodes = 1"), Some(11), &["solver.nodes", "1"]),
        (and("[solver]\ntolerance = 0"), Some(11), &["solver.tolerance"]),
        (and("[solver]\nstarts = 0"), Some(11), &["solver.starts"]),
        (and("[solver]\njacobian = \"none\""), Some(11), &["solver.jacobian", "`none`", "`without_hessian`"]),
        (and("[solver]\nspeed = 1"), Some(11), &["solver.speed", "`tolerance`"]),
        (
            and("[start_from]\nfile = \"no.json\""),
            Some(11),
            &["start_from.file", "no.json", "check the path"],
        ),
        (with("q = [0.0, 0.0]", "q = [0.0, 0.0]\nq_free = [2]"), Some(4), &["start.q_free", "2", "0 to 1"]),
        (
            with("q = [0.0, 0.0]", "q = [0.0, 0.0]\nv_free = [\"wrist\"]"),
            Some(4),
            &["start.v_free", "wrist", "shoulder, elbow"],
        ),
        (with("q = [1.0, 0.5]", "q = [1.0, 0.5]\nq_free = [2]"), Some(6), &["end.q_free", "2", "0 to 1"]),
        (
            with("q = [1.0, 0.5]", "q = [1.0, 0.5]\nq_free = [0.5]"),
            Some(6),
            &["end.q_free", "0.5", "joints, by name"],
        ),
        (
            with("q = [1.0, 0.5]", "q = [1.0, 0.5]\nv_free = [\"wrist\"]"),
            Some(6),
            &["end.v_free", "wrist", "shoulder, elbow"],
        ),
        (with("final = 1.0", "final = 1.0\nfinal = 2.0"), Some(8), &["time.final", "duplicate key"]),
        (with("q = [1.0, 0.5]", "q = [1.0, \"a\"]"), Some(5), &["end.q", "a list of numbers", "\"a\""]),
    ] {
        let output = optimize("bad", &text, &["--json"]);
        let message = stderr(&output);
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{text}\n{message}");
        let place = line.map_or("problem.toml:".into(), |line: usize| format!("problem.toml:{line}: "));
        assert!(message.contains(&place), "{place}\n{text}\n{message}");
        parts.iter().for_each(|part| assert!(message.contains(part), "{part}\n{text}\n{message}"));
    }
    let output = costate(&["optimize", "no/such/problem.toml"], b"");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("no/such/problem.toml"), "{}", stderr(&output));
}

#[test]
fn json_has_the_promised_keys_and_the_cost_of_the_swing_up() {
    let output = costate(&["optimize", "examples/problems/pendulum_swing_up.toml", "--json"], b"");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stdout(&output).lines().count(), 1);
    let solution = json(&output);
    let keys: Vec<_> = solution.as_object().unwrap().keys().map(String::as_str).collect();
    let expected = [
        "conjugate_time",
        "cost",
        "costate_start",
        "end_defect",
        "final_time",
        "hamiltonian",
        "hamiltonian_drift",
        "newton_iterations",
        "nodes",
        "shooting_defect",
        "status",
        "trajectory",
    ];
    assert_eq!(keys, expected);
    assert_eq!(solution["status"], "converged");
    assert!(solution["conjugate_time"].is_null());
    let number = |value: &Value| value.as_f64().unwrap();
    assert!((number(&solution["cost"]) - 74.061_659_220_2).abs() < 1e-6);
    let start = &solution["costate_start"];
    assert!((number(&start["y_q"][0]) + 13.035_958_540_5).abs() < 1e-5);
    assert!((number(&start["y_p"][0]) - 18.071_734_530_7).abs() < 1e-5);
    for key in ["hamiltonian_drift", "end_defect", "shooting_defect"] {
        assert!(number(&solution[key]) < 1e-6, "{key} {}", solution[key]);
    }
    let nodes = solution["nodes"].as_u64().unwrap() as usize;
    let trajectory = solution["trajectory"].as_object().unwrap();
    let keys: Vec<_> = trajectory.keys().map(String::as_str).collect();
    assert_eq!(keys, ["p", "q", "t", "u", "v", "y"]);
    for (key, width) in [("q", 1), ("v", 1), ("p", 1), ("u", 1), ("y", 2)] {
        let rows = trajectory[key].as_array().unwrap();
        assert!(
            rows.len() == nodes && rows.iter().all(|row| row.as_array().unwrap().len() == width),
            "{key}"
        );
    }
    let ends = [0, nodes - 1].map(|node| number(&trajectory["t"][node]));
    assert!(ends[0] == 0.0 && (ends[1] - 1.0).abs() < 1e-12, "{ends:?}");
}

#[test]
fn a_continuation_is_told_point_by_point() {
    let text = two_link();
    let output = optimize("continue", &text, &["--json", "--continue", "final_time=1:1.5"]);
    let found = json(&output);
    let way = &found["continuation"];
    assert_eq!((&way["parameter"], &way["end"]), (&Value::from("final_time"), &Value::from("reached")));
    let points = way["points"].as_array().unwrap();
    let cost = |i: usize| points[i]["cost"].as_f64().unwrap();
    let last = points.len() - 1;
    assert!(last > 1 && (cost(last) * 1.5_f64.powi(3) - cost(0)).abs() < 1e-8 * cost(0));
    assert!((found["final_time"].as_f64().unwrap() - 1.5).abs() < 1e-12, "{}", found["final_time"]);
    assert!(
        stdout(&optimize("continue", &text, &["--continue", "final_time=1:1.5"])).contains("was reached")
    );
    for (way, told) in [("mass=0:1", "final_time"), ("gravity=0", "FROM:TO"), ("bounds=1:2", "[bounds]")] {
        let output = optimize("continue", &text, &["--continue", way]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(told), "{}", stderr(&output));
    }
}

#[test]
fn a_saved_solution_starts_the_next_solve_where_it_ended() {
    let folder = folder("start_from");
    let saved = folder.join("solution.json");
    let text = std::fs::read_to_string(root().join("examples/problems/pendulum_swing_up.toml")).unwrap();
    let text = text.replace("../../robots/pendulum.toml", &robot("pendulum.toml"));
    let first = optimize("start_from", &text, &["--json", "--save", saved.to_str().unwrap()]);
    assert_eq!(first.status.code(), Some(0), "{}", stderr(&first));
    assert_eq!(std::fs::read_to_string(&saved).unwrap().trim(), stdout(&first).trim());
    let again =
        optimize("start_from", &format!("{text}[start_from]\nfile = \"solution.json\"\n"), &["--json"]);
    let (first, again) = (json(&first), json(&again));
    assert_eq!(again["status"], "converged");
    assert!((again["cost"].as_f64().unwrap() - first["cost"].as_f64().unwrap()).abs() < 1e-6);
    assert!(again["newton_iterations"].as_u64() < first["newton_iterations"].as_u64(), "{again}");
    let other =
        optimize("start_from", &format!("{}[start_from]\nfile = \"solution.json\"\n", two_link()), &[]);
    assert_eq!(other.status.code(), Some(2));
    assert!(stderr(&other).contains(":11: start_from.file"), "{}", stderr(&other));
}

#[test]
fn what_is_not_solved_ends_with_status_3_and_the_best_iterate() {
    // A quarter of the force that any motion between these ends in this time needs.
    let text =
        std::fs::read_to_string(root().join("examples/problems/double_integrator_min_time.toml")).unwrap();
    let text = text
        .replace("free = true\nguess = 3.0", "final = 1.0")
        .replace("time = 1.0", "effort = [1.0]")
        .replace("robots/mass.toml", mass().as_str());
    let output = optimize("unsolved", &text, &["--json"]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    let solution = json(&output);
    assert_ne!(solution["status"], "converged");
    assert!(!solution["trajectory"]["t"].as_array().unwrap().is_empty());
    let output = optimize("unsolved", &text, &[]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stdout(&output).contains("best iterate"), "{}", stdout(&output));
}

fn mass() -> String {
    root()
        .join("examples/problems/robots/mass.toml")
        .canonicalize()
        .unwrap()
        .to_str()
        .unwrap()
        .replace('\\', "/")
}

#[test]
fn limits_of_the_robot_are_not_enforced_but_said() {
    let text = two_link();
    let output = optimize("limits", &text, &["--json"]);
    assert_eq!(json(&output)["status"], "converged", "{}", stderr(&output));
    assert!(stderr(&output).contains("warning: effort of joint 'shoulder'"), "{}", stderr(&output));
}

#[test]
fn the_report_is_one_file_and_the_pictures_are_well_formed() {
    let folder = folder("report");
    let (page, pictures) = (folder.join("report.html"), folder.join("pictures"));
    let arguments = ["optimize", "examples/problems/puma560_pick_and_place.toml"];
    let more = ["-o", page.to_str().unwrap(), "--svg", pictures.to_str().unwrap(), "--iterations"];
    let output = costate(&[&arguments[..], &more].concat(), b"");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(
        stdout(&output).contains("converged") && stdout(&output).contains("iteration  residual"),
        "{}",
        stdout(&output)
    );
    let text = std::fs::read_to_string(&page).unwrap();
    for banned in ["http://", "https://", "src=", "@import", "<link", "NaN", "inf "] {
        let name_space = text.replace("http://www.w3.org/2000/svg", "");
        assert!(!name_space.contains(banned), "{banned}");
    }
    for part in [
        "Joint angles",
        "Joint rates",
        "Momenta",
        "Torque waist",
        "Costates of the momenta",
        "H* less its mean",
    ] {
        assert!(text.contains(part), "{part}");
    }
    assert!(text.contains("from the side") && text.contains("from above"));
    let data = text.split("id=\"data\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: Value = serde_json::from_str(data).unwrap();
    assert_eq!(data["joints"].as_array().unwrap().len(), 6);
    let mut names = Vec::new();
    for entry in std::fs::read_dir(&pictures).unwrap() {
        let file = entry.unwrap().path();
        let picture = std::fs::read_to_string(&file).unwrap();
        let document = roxmltree::Document::parse(&picture).unwrap();
        assert_eq!(document.root_element().tag_name().name(), "svg");
        names.push(file.file_name().unwrap().to_str().unwrap().to_owned());
    }
    names.sort();
    let expected =
        ["control_1.svg", "control_6.svg", "costates_p.svg", "costates_q.svg", "hamiltonian.svg", "mesh.svg"];
    expected.iter().for_each(|name| assert!(names.iter().any(|other| other == name), "{name}: {names:?}"));
    assert!(
        names.ends_with(&["residuals.svg".into(), "strobe_xy.svg".into(), "strobe_xz.svg".into()]),
        "{names:?}"
    );
}

#[test]
fn every_example_is_solved() {
    for entry in std::fs::read_dir(root().join("examples/problems")).unwrap() {
        let file = entry.unwrap().path();
        if file.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        let output = costate(&["optimize", file.to_str().unwrap(), "--json"], b"");
        assert_eq!(output.status.code(), Some(0), "{}: {}", file.display(), stderr(&output));
        let solution = json(&output);
        for key in ["hamiltonian_drift", "end_defect"] {
            assert!(solution[key].as_f64().unwrap() < 1e-6, "{}: {key} {}", file.display(), solution[key]);
        }
    }
}

#[test]
fn a_free_start_and_bounds_on_one_joint_are_taken_from_the_file() {
    let given = json(&optimize("given", &two_link(), &["--json"]));
    let text = two_link().replace("q = [0.0, 0.0]", "q = [0.0, 0.0]\nv_free = [\"elbow\"]");
    let limits =
        "[bounds]\nu_min = [-inf, -0.5]\nu_max = [inf, 0.5]\n[penalty]\nweight = 10\nv_max = [inf, 1]\n";
    for (text, cheaper) in [(text, true), (format!("{}{limits}", two_link()), false)] {
        let found = json(&optimize("found", &text, &["--json"]));
        assert_eq!((&found["status"], &given["status"]), (&"converged".into(), &"converged".into()));
        let costs = [&found, &given].map(|solution| solution["cost"].as_f64().unwrap());
        assert_eq!(costs[0] < 0.999 * costs[1], cheaper, "{costs:?}");
    }
}
