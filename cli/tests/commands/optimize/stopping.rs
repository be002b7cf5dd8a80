//! Time limits and signals.

use super::{empty_folder, json, optimize, two_link};
use crate::child::{command, root, stderr, stdout};
use serde_json::Value;
use std::path::Path;
use std::time::Duration;

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

/// The first signal keeps the best motion and the points so far.
#[cfg(unix)]
#[test]
fn a_signal_saves_and_draws_the_best_motion_and_exits_with_130() {
    let folder = empty_folder("signal");
    let endless = folder.join("endless.toml");
    std::fs::write(&endless, format!("{}[solver]\nstarts = 1000000\n", two_link())).unwrap();
    let bounded = root().join("examples/problems/two_link_bounded.toml");
    for (problem, more, signal) in [
        (&endless, &[][..], "INT"),
        (&endless, &[], "TERM"),
        (&bounded, &["--continue", "bounds=1:0.01"], "INT"),
    ] {
        // The signal must not arrive before the handler is there, nor before the first points: a busy machine
        // gets more time.
        let waits = [3, 10, 30, 90].map(Duration::from_secs);
        assert!(waits.into_iter().any(|wait| is_interrupted(&folder, problem, more, signal, wait)));
    }
}

/// Interrupts a search after some time; what it has by then must be saved. Whether it had begun.
#[cfg(unix)]
fn is_interrupted(folder: &Path, problem: &Path, more: &[&str], signal: &str, wait: Duration) -> bool {
    let (saved, page) = (folder.join("saved.json"), folder.join("report.html"));
    let files = ["--save", saved.to_str().unwrap(), "-o", page.to_str().unwrap(), "--json"];
    let child = command(&[&["optimize", problem.to_str().unwrap()], more, &files].concat()).spawn().unwrap();
    std::thread::sleep(wait);
    let signal = [format!("-{signal}"), child.id().to_string()];
    assert!(std::process::Command::new("kill").args(signal).status().unwrap().success());
    let output = child.wait_with_output().unwrap();
    if output.status.code().is_none() {
        return false;
    }
    assert_eq!(output.status.code(), Some(130), "{}", stderr(&output));
    assert!(stderr(&output).contains("note: interrupted"), "{}", stderr(&output));
    let read: Value = serde_json::from_str(&std::fs::read_to_string(&saved).unwrap()).unwrap();
    assert!(read["trajectory"]["t"].as_array().unwrap().len() > 2);
    assert!(std::fs::read_to_string(&page).unwrap().contains("id=\"play\""));
    std::fs::remove_file(&saved).unwrap();
    std::fs::remove_file(&page).unwrap();
    if more.is_empty() {
        assert!(stderr(&output).contains("of 1000000"), "{}", stderr(&output));
        return true;
    }
    let branch = &json(&output)["continuation"];
    assert_eq!(branch["end"], "interrupted");
    branch["points"].as_array().unwrap().len() > 2
}
