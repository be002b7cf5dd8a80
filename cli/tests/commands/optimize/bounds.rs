//! Bounds that allow no motion.

use super::{empty_folder, json, names, optimize};
use crate::child::{costate, root, stderr, stdout};

/// A quarter of the force that any motion between these ends in this time needs.
fn infeasible() -> String {
    let file = root().join("examples/problems/double_integrator_min_time.toml");
    let text = std::fs::read_to_string(file).unwrap();
    text.replace("[solver]\n", "[solver]\nmethod = \"collocation\"\n")
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
    assert_eq!(solution["status"], "bounds_not_reached");
    let needed = &solution["bounds"];
    assert_eq!(needed["joint"], "slide");
    let number = |key: &str| needed[key].as_f64().unwrap();
    assert!(number("factor") > 3.9 && number("u").abs() > 3.9 && number("bound").abs() == 1.0, "{needed}");
    assert!((0.0..=1.0).contains(&number("time")), "{needed}");
    assert!(solution["cost"].is_null() && solution["final_time"].is_null(), "{solution}");
    for list in [&solution["trajectory"]["t"], &solution["switches"], &solution["costate_start"]["y_q"]] {
        assert!(list.as_array().unwrap().is_empty(), "{list}");
    }
    let totals = solution["starts"].as_array().unwrap().iter().map(|start| &start["total"]);
    assert!(totals.clone().count() == 1 && totals.into_iter().all(serde_json::Value::is_null));
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
