//! Solutions as JSON: keys, continuations, warm starts.

use super::{folder, json, optimize, robot, two_link};
use crate::child::{costate, root, stderr, stdout};
use serde_json::Value;

#[test]
fn json_has_the_documented_keys_and_the_cost_of_the_swing_up() {
    let output = costate(&["optimize", "examples/problems/pendulum_swing_up.toml", "--json"], b"");
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stdout(&output).lines().count(), 1);
    let solution = json(&output);
    let keys: Vec<_> = solution.as_object().unwrap().keys().map(String::as_str).collect();
    let expected = [
        "certificate",
        "conditioning",
        "conjugate_multiplicity",
        "conjugate_time",
        "cost",
        "cost_error",
        "costate",
        "costate_start",
        "duality_gap",
        "end_defect",
        "final_time",
        "finer_mesh",
        "format",
        "hamiltonian",
        "hamiltonian_drift",
        "joints",
        "limits",
        "newton_decrement",
        "newton_iterations",
        "nodes",
        "options",
        "penalty_cost",
        "polish",
        "robot",
        "shooting_defect",
        "smoothing",
        "smoothing_bound",
        "solve_cpu_time",
        "solve_time",
        "starts",
        "stationarity",
        "status",
        "switches",
        "trajectory",
        "units",
        "verification",
        "verified",
        "warnings",
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
    // The times of solving are printed, not saved.
    let mut printed = json(&first);
    for key in ["solve_time", "solve_cpu_time"] {
        assert!(printed.as_object_mut().unwrap().remove(key).unwrap().as_f64().unwrap() > 0.0);
    }
    assert_eq!(serde_json::from_str::<Value>(&std::fs::read_to_string(&saved).unwrap()).unwrap(), printed);
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

#[test]
fn exceeded_limits_of_the_robot_are_warnings() {
    let text = two_link();
    let output = optimize("limits", &text, &["--json"]);
    assert_eq!(json(&output)["status"], "converged", "{}", stderr(&output));
    assert!(stderr(&output).contains("warning: effort of joint 'shoulder'"), "{}", stderr(&output));
    assert!(stderr(&output).contains(" N m; its limits"), "{}", stderr(&output));
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
        // The direct method estimates H* only.
        let keys: &[&str] = match solution["options"]["method"] == "direct" {
            true => &["end_defect"],
            false => &["hamiltonian_drift", "end_defect"],
        };
        // Limits that depend on the motion bend the torques between nodes: integrated, such motions end less
        // accurately, within what verification allows.
        let curved = ["task", "torque_speed", "power"].iter().any(|kind| !solution["limits"][kind].is_null());
        let phases = !solution["via_times"].is_null();
        // Kinks of a stiff penalty where torques are at their limits are resolved in part: a motion is
        // verified to 0.3 times the root of the tolerance, of the largest rate, 5.2 rad/s.
        let stiff = solution["penalty_cost"].as_f64().unwrap() > 0.0;
        let least = if stiff {
            0.3 * 1e-5_f64.sqrt() * 5.2
        } else if curved || phases {
            0.3 * 1e-6_f64.sqrt()
        } else {
            1e-6
        };
        // Errors grow along motions of light wrists: where the whole does not lead there, its parts do.
        let by_parts = phases && solution["shooting_defect"].as_f64().is_some_and(|defect| defect < least);
        for &key in keys {
            let is_small = solution[key].as_f64().unwrap() < least || (key == "end_defect" && by_parts);
            assert!(is_small, "{}: {key} {}", file.display(), solution[key]);
        }
    }
}

#[test]
fn hard_limits_are_kept_or_the_one_that_is_not_is_named() {
    let text = two_link() + "[limits]\nfrom_robot = false\nv_max = [inf, 0.7]\n";
    let output = optimize("hard_limits", &text, &["--json"]);
    let solution = json(&output);
    assert_eq!(solution["status"], "converged", "{}", stderr(&output));
    assert!(solution["solve_time"].as_f64().unwrap() > 0.0);
    assert_eq!(solution["limits"]["rate"]["active"][0]["joint"], "elbow");
    let shown = optimize("hard_limits", &text, &[]);
    assert!(stdout(&shown).contains("limits kept") && stdout(&shown).contains("beyond rate limits"));
    // Half a radian in a second at less than half a radian a second.
    let slow = text.replace("0.7]", "0.4]");
    let output = optimize("hard_limits", &slow, &["--json"]);
    assert_eq!(output.status.code(), Some(3), "{}", stderr(&output));
    assert_eq!(json(&output)["status"], "infeasible");
    let found = &json(&output)["limits"]["infeasible"]["limits"][0];
    assert_eq!((&found["kind"], &found["joint"]), (&"rate".into(), &"elbow".into()));
    assert!(
        stderr(&output).contains("no motion keeps all limits: joint 'elbow' needs"),
        "{}",
        stderr(&output)
    );
    // A limit of the robot or of the file that the start exceeds.
    let outside = text.replace("v_max = [inf, 0.7]", "q_min = [0.1, -inf]");
    let output = optimize("hard_limits", &outside, &[]);
    assert_eq!(output.status.code(), Some(2));
    assert!(
        stderr(&output).contains("start.q") && stderr(&output).contains("shoulder"),
        "{}",
        stderr(&output)
    );
}

#[test]
fn solving_again_and_again_tells_the_least_time_of_the_same_solution() {
    let text = two_link() + "[limits]\nfrom_robot = false\nv_max = [inf, 0.7]\n";
    let once = json(&optimize("repeat", &text, &["--json"]));
    let often = json(&optimize("repeat", &text, &["--json", "--repeat", "5"]));
    for key in ["status", "cost", "newton_iterations", "nodes"] {
        assert_eq!(once[key], often[key], "{key}");
    }
    assert!(often["solve_time"].as_f64().unwrap() > 0.0);
    assert!(often["stage_times"].is_null());
    let timed = json(&optimize("repeat", &text, &["--json", "--repeat", "2", "--times"]));
    let times = timed["stage_times"].as_object().unwrap();
    let total: f64 = times.values().map(|time| time.as_f64().unwrap()).sum();
    assert!(times["points"].as_f64() > Some(0.0) && total <= timed["solve_time"].as_f64().unwrap());
    let printed = stdout(&optimize("repeat", &text, &["--times"]));
    assert!(times.keys().all(|stage| printed.contains(stage)), "{printed}");
    for more in [&["--repeat", "0"][..], &["--repeat", "2", "--continue", "final_time=1:2"]] {
        assert_eq!(optimize("repeat", &text, more).status.code(), Some(2), "{more:?}");
    }
}
