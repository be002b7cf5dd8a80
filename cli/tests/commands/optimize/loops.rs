//! Robots with constraints: rows that depend on others, ends at which loops are open.

use super::missing::WRONG;
use super::{empty_folder, json, optimize};
use crate::child::{root, stderr, stdout};

const PROBLEM: &str = "robot = \"linkage.toml\"\n[start]\nq = [1.0, -0.5917379187, -2.058615394]\n\
    [end]\nq = [1.2, -1.2, -1.6]\nq_free = [\"coupler\", \"rocker\"]\nv_free = [\"coupler\", \"rocker\"]\n\
    [time]\nfinal = 1.0\n[cost]\neffort = [1.0, 0.0, 0.0]\n[limits]\ntorque_max = [30.0, 0.0, 0.0]\n";

/// The four-bar linkage, with its constraint in these words.
fn linkage(test: &str, from: &str, to: &str) {
    let file = std::fs::read_to_string(root().join("robots/four_bar.toml")).unwrap();
    assert!(file.contains(from));
    std::fs::write(empty_folder(test).join("linkage.toml"), file.replace(from, to)).unwrap();
}

#[test]
fn redundant_rows_are_in_the_table_and_in_json() {
    linkage("redundant", "rows = [\"x\", \"y\"]", "rows = [\"x\", \"y\"]");
    let whole = optimize("redundant", PROBLEM, &[]);
    assert!(whole.status.success() && !stdout(&whole).contains("redundant"), "{}", stdout(&whole));
    assert!(json(&optimize("redundant", PROBLEM, &["--json"]))["constraints"][0].get("redundant").is_none());
    linkage("redundant", "rows = [\"x\", \"y\"]", "type = \"pinned\"");
    let table = stdout(&optimize("redundant", PROBLEM, &[]));
    let line = table.lines().find(|line| line.contains("redundant rows")).unwrap();
    assert!(line.contains("1 of 3, left out, their forces zero: 'rocker_pivot' z"), "{table}");
    let solution = json(&optimize("redundant", PROBLEM, &["--json"]));
    assert_eq!(solution["constraints"][0]["redundant"], serde_json::json!([2]));
}

#[test]
fn a_start_with_open_loops_is_told_with_a_position_that_closes_them() {
    linkage("open", "name = \"four_bar\"", "name = \"linkage\"");
    let open = PROBLEM.replace("-2.058615394", "-2.0");
    let output = optimize("open", &open, &[]);
    assert_eq!(output.status.code(), Some(WRONG));
    let message = stderr(&output);
    let (miss, closed) = ("start.q: constraint 'rocker_pivot' is missed by 0.0", "close at q = [1, -0.59173");
    assert!(message.contains(miss) && message.contains(closed), "{message}");
    let other = "[[constraint]]\nname = \"other\"\nframe = \"rocker_tip\"\nto = \"pivot\"\n\
        to_placement = { xyz = [0.1, 0, 0] }\nrows = [\"x\"]\n[[constraint]]";
    linkage("open", "[[constraint]]", other);
    let message = stderr(&optimize("open", PROBLEM, &[]));
    assert!(message.contains("contradicts those before it"), "{message}");
}
