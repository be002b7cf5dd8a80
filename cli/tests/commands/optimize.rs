//! `costate optimize`.

use crate::child::{command, costate, root, stderr, stdout};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A folder for the files of one test.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("optimize").join(test);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The same, empty.
fn empty_folder(test: &str) -> PathBuf {
    let folder = folder(test);
    std::fs::remove_dir_all(&folder).unwrap();
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

fn robot(name: &str) -> String {
    root().join("robots").join(name).canonicalize().unwrap().to_str().unwrap().replace('\\', "/")
}

/// A complete problem for the two-link arm, one key per line.
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
    let mut wrong = Vec::new();
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
        (and("[solver]\ntime_limit = -1"), Some(11), &["solver.time_limit", "positive", "seconds", "-1"]),
        (and("[solver]\ntime_limit = 0"), Some(11), &["solver.time_limit", "positive", "seconds"]),
        (and("[solver]\ntime_limit = inf"), Some(11), &["solver.time_limit", "positive", "seconds"]),
        (and("[solver]\ntime_limit = \"1 s\""), Some(11), &["solver.time_limit", "a number", "1 s"]),
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
        if !message.contains(&place) {
            wrong.push(format!("{place}: {message}"));
        }
        let absent = parts.iter().filter(|part| !message.contains(**part));
        wrong.extend(absent.map(|part| format!("{part}: {message}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.concat());
    let output = costate(&["optimize", "no/such/problem.toml"], b"");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("no/such/problem.toml"), "{}", stderr(&output));
}

#[test]
fn json_has_the_documented_keys_and_the_cost_of_the_swing_up() {
    let output = costate(&["optimize", "examples/problems/pendulum_swing_up.toml", "--json"], b"");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stdout(&output).lines().count(), 1);
    let solution = json(&output);
    let keys: Vec<_> = solution.as_object().unwrap().keys().map(String::as_str).collect();
    let expected = [
        "certificate",
        "conjugate_multiplicity",
        "conjugate_time",
        "cost",
        "costate",
        "costate_start",
        "end_defect",
        "final_time",
        "format",
        "hamiltonian",
        "hamiltonian_drift",
        "joints",
        "newton_iterations",
        "nodes",
        "options",
        "penalty_cost",
        "robot",
        "shooting_defect",
        "smoothing",
        "starts",
        "status",
        "switches",
        "trajectory",
        "units",
    ];
    assert_eq!(keys, expected);
    assert_eq!(solution["status"], "converged");
    assert!(solution["conjugate_time"].is_null() && solution["options"]["time_limit"].is_null());
    assert_eq!(
        (&solution["certificate"], &solution["conjugate_multiplicity"]),
        (&"local_minimum".into(), &0.into())
    );
    assert_eq!((&solution["format"], &solution["robot"]), (&1.into(), &"pendulum".into()));
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
fn a_continuation_lists_its_points() {
    let text = two_link();
    let output = optimize("continue", &text, &["--json", "--continue", "final_time=1:1.5"]);
    let found = json(&output);
    let branch = &found["continuation"];
    assert_eq!((&branch["parameter"], &branch["end"]), (&Value::from("final_time"), &Value::from("reached")));
    let points = branch["points"].as_array().unwrap();
    let cost = |i: usize| points[i]["cost"].as_f64().unwrap();
    let last = points.len() - 1;
    assert!(last > 1 && (cost(last) * 1.5_f64.powi(3) - cost(0)).abs() < 1e-8 * cost(0));
    assert!((found["final_time"].as_f64().unwrap() - 1.5).abs() < 1e-12, "{}", found["final_time"]);
    assert!(
        stdout(&optimize("continue", &text, &["--continue", "final_time=1:1.5"]))
            .contains("the last value was reached")
    );
    for (range, part) in [("mass=0:1", "final_time"), ("gravity=0", "FROM:TO"), ("bounds=1:2", "[bounds]")] {
        let output = optimize("continue", &text, &["--continue", range]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).contains(part), "{}", stderr(&output));
    }
}

#[test]
fn a_saved_solution_is_a_warm_start_for_the_same_robot_only() {
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
    for part in [":11: start_from.file", "solution.json", "robot 'pendulum'", "'shoulder', 'elbow'", "--save"]
    {
        assert!(stderr(&other).contains(part), "{part}: {}", stderr(&other));
    }
    let file = folder.join("problem.toml");
    std::fs::write(&file, format!("{text}[start_from]\nfile = \"solution.json\"\n")).unwrap();
    let saved = saved.to_str().unwrap();
    let same = costate(&["optimize", file.to_str().unwrap(), "--save", saved], b"");
    assert_eq!(same.status.code(), Some(2));
    assert!(stderr(&same).contains("is the input file"), "{}", stderr(&same));
}

/// A quarter of the force that any motion between these ends in this time needs.
fn infeasible() -> String {
    let file = root().join("examples/problems/double_integrator_min_time.toml");
    std::fs::read_to_string(file)
        .unwrap()
        .replace("free = true\nguess = 3.0", "final = 1.0")
        .replace("time = 1.0", "effort = [1.0]")
        .replace("robots/mass.toml", mass().as_str())
}

#[test]
fn bounds_that_allow_no_motion_are_named_and_give_no_motion() {
    let folder = empty_folder("infeasible");
    let (page, figures) = (folder.join("report.html"), folder.join("figures"));
    let files = ["-o", page.to_str().unwrap(), "--svg", figures.to_str().unwrap()];
    let solved = costate(&[&["optimize", "examples/problems/two_link.toml"], &files[..]].concat(), b"");
    assert_eq!(solved.status.code(), Some(0), "{}", stderr(&solved));
    // These are no figures of an earlier run.
    std::fs::write(figures.join("notes.svg"), std::fs::read(figures.join("mesh.svg")).unwrap()).unwrap();
    std::fs::write(figures.join("rates.svg"), "<svg/>").unwrap();

    let output = optimize("infeasible", &infeasible(), &files);
    let text = stdout(&output);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    for part in ["bounds not reached", "No motion within the bounds", "joint 'slide'", "times as wide"] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert!(!text.contains("actuation bounded") && !text.contains("final time  "), "{text}");
    let report = std::fs::read_to_string(&page).unwrap();
    assert!(report.contains("There is no motion to show") && report.contains("joint &#39;slide&#39;"));
    assert!(!report.contains("<script") && !report.contains("NaN") && !report.contains("actuation bounded"));
    assert_eq!(names(&figures), ["notes.svg", "rates.svg", "residuals.svg"]);

    let output = optimize("infeasible", &infeasible(), &["--json"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stderr(&output).contains("warning: no motion within the bounds"), "{}", stderr(&output));
    let solution = json(&output);
    assert!(solution["status"].as_str().unwrap().starts_with("bounds_not_reached"), "{solution}");
    assert!(solution["trajectory"]["t"].as_array().unwrap().is_empty());
}

/// Names of the files of a folder, sorted.
fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_str().unwrap().to_owned()).collect();
    names.sort();
    names
}

#[test]
fn a_time_limit_keeps_the_best_iterate_and_exits_with_3() {
    let in_file = format!("{}[solver]\ntime_limit = 1e-6\n", two_link());
    for (text, more) in [(two_link(), &["--json", "--time-limit", "1e-6"][..]), (in_file, &["--json"])] {
        let output = optimize("time_limit", &text, more);
        assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
        assert!(stderr(&output).contains("time limit was reached"), "{}", stderr(&output));
        let solution = json(&output);
        assert_eq!(
            (&solution["status"], &solution["options"]["time_limit"]),
            (&"time_limit".into(), &1e-6.into())
        );
    }
    let overridden = format!("{}[solver]\ntime_limit = 1e-6\n", two_link());
    let output = optimize("time_limit", &overridden, &["--time-limit", "600"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let output = optimize("time_limit", &two_link(), &["--time-limit", "-1"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("positive number"), "{}", stderr(&output));
    let output =
        optimize("time_limit", &two_link(), &["--time-limit", "1e-6", "--continue", "final_time=1:2"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(stdout(&output).contains("0 points: stopped by the time limit"), "{}", stdout(&output));
}

#[test]
fn outputs_are_checked_before_the_problem_is_solved() {
    let folder = empty_folder("outputs");
    let (file, arm) = (folder.join("problem.toml"), folder.join("arm.toml"));
    std::fs::copy(robot("two_link.toml"), &arm).unwrap();
    // It would take hours.
    let text = two_link().replace(&robot("two_link.toml"), "arm.toml") + "[solver]\nstarts = 100000000\n";
    std::fs::write(&file, &text).unwrap();
    let (page, nowhere) = (folder.join("report.html"), folder.join("nowhere/report.html"));
    let [problem, arm, page, nowhere] = [&file, &arm, &page, &nowhere].map(|path| path.to_str().unwrap());
    for (more, part) in [
        (&["-o", problem][..], "is the input file"),
        (&["--save", arm], "is the input file"),
        (&["-o", nowhere], "cannot be written"),
        (&["--save", folder.to_str().unwrap()], "cannot be written"),
        (&["--svg", arm], "cannot be written"),
        (&["-o", page, "--save", page], "both -o and --save"),
        (&["--json", "-o", "-"], "standard output"),
    ] {
        let output = costate(&[&["optimize", problem], more].concat(), b"");
        assert_eq!((output.status.code(), output.stdout.len()), (Some(2), 0), "{more:?}");
        assert!(stderr(&output).contains(part), "{part}: {}", stderr(&output));
    }
    assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
    assert_eq!(names(&folder), ["arm.toml", "problem.toml"]);
    let output = costate(&["optimize", "examples/problems/two_link.toml", "--save", "-"], b"");
    assert_eq!(json(&output)["status"], "converged");
}

/// The first signal keeps the best motion and the points so far.
#[cfg(unix)]
#[test]
fn a_signal_saves_and_draws_the_best_motion_and_exits_with_130() {
    let folder = empty_folder("signal");
    let endless = folder.join("endless.toml");
    std::fs::write(&endless, format!("{}[solver]\nstarts = 100000000\n", two_link())).unwrap();
    let bounded = root().join("examples/problems/two_link_bounded.toml");
    for (problem, more, signal) in [
        (&endless, &[][..], "INT"),
        (&endless, &[], "TERM"),
        (&bounded, &["--continue", "bounds=1:0.01"], "INT"),
    ] {
        let (saved, page) = (folder.join("saved.json"), folder.join("report.html"));
        let files = ["--save", saved.to_str().unwrap(), "-o", page.to_str().unwrap(), "--json"];
        let child =
            command(&[&["optimize", problem.to_str().unwrap()], more, &files].concat()).spawn().unwrap();
        // The signal must not arrive before the handler is there, nor before the first points.
        std::thread::sleep(std::time::Duration::from_secs(3));
        let signal = [format!("-{signal}"), child.id().to_string()];
        assert!(std::process::Command::new("kill").args(signal).status().unwrap().success());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
        assert!(stderr(&output).contains("note: interrupted"), "{}", stderr(&output));
        let read: Value = serde_json::from_str(&std::fs::read_to_string(&saved).unwrap()).unwrap();
        assert!(read["trajectory"]["t"].as_array().unwrap().len() > 2);
        assert!(std::fs::read_to_string(&page).unwrap().contains("id=\"play\""));
        if more.is_empty() {
            assert!(stderr(&output).contains("of 100000000"), "{}", stderr(&output));
        } else {
            let branch = &json(&output)["continuation"];
            assert_eq!(branch["end"], "interrupted");
            assert!(branch["points"].as_array().unwrap().len() > 2, "{branch}");
        }
        std::fs::remove_file(&saved).unwrap();
        std::fs::remove_file(&page).unwrap();
    }
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
fn exceeded_limits_of_the_robot_are_warnings() {
    let text = two_link();
    let output = optimize("limits", &text, &["--json"]);
    assert_eq!(json(&output)["status"], "converged", "{}", stderr(&output));
    assert!(stderr(&output).contains("warning: effort of joint 'shoulder'"), "{}", stderr(&output));
    assert!(stderr(&output).contains(" N m; its limits"), "{}", stderr(&output));
}

#[test]
fn the_report_is_one_file_and_the_figures_are_well_formed() {
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
        "H* minus its mean",
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
    let expected = [
        "control_elbow.svg",
        "control_waist.svg",
        "costates_p.svg",
        "costates_q.svg",
        "hamiltonian.svg",
        "mesh.svg",
    ];
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
