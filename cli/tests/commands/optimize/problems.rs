//! Problem files: what is refused, and what is taken from them.

use super::{json, optimize, two_link};
use crate::child::{costate, stderr};

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
        (with("final = 1.0", "free = true"), Some(7), &["time.free", "cost.time"]),
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
        (and("[penalty]\nweight = -1.0\nv_max = [1.0, 1.0]"), Some(11), &["penalty.weight", "negative"]),
        (and("[penalty]\nweight = 1.0\nv_max = [1.0]"), Some(12), &["penalty.v_max", "1", "2"]),
        (and("[actuation]\ngain = [1.0, 0.0]"), Some(11), &["actuation.gain", "elbow"]),
        (and("[solver]\nnodes = 1"), Some(11), &["solver.nodes", "1"]),
        (and("[solver]\ntolerance = 0"), Some(11), &["solver.tolerance"]),
        (and("[solver]\nstarts = 0"), Some(11), &["solver.starts"]),
        (and("[solver]\njacobian = \"none\""), Some(11), &["solver.jacobian", "`none`", "`without_hessian`"]),
        (and("[solver]\nverify = \"some\""), Some(11), &["solver.verify", "`some`", "`factors`"]),
        (
            and("[solver]\npolish = \"often\""),
            Some(11),
            &["solver.polish", "true, false or \"auto\"", "often"],
        ),
        (and("[solver]\ntime_limit = -1"), Some(11), &["solver.time_limit", "positive", "seconds", "-1"]),
        (and("[solver]\ntime_limit = 0"), Some(11), &["solver.time_limit", "positive", "seconds"]),
        (and("[solver]\ntime_limit = nan"), Some(11), &["solver.time_limit", "positive", "seconds"]),
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
