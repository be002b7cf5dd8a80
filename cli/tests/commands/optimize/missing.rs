//! Problems that must end with an exit status and with words in the message.

use super::{optimize, robot, two_link};
use crate::child::stderr;
use std::process::Output;

/// Exit status of input that is wrong.
pub const WRONG: i32 = 2;
/// Exit status of a task that cannot be done.
pub const IMPOSSIBLE: i32 = 3;

/// What the messages lack.
pub struct Missing {
    /// The folder of the test.
    folder: &'static str,
    found: Vec<String>,
}

impl Missing {
    pub fn new(folder: &'static str) -> Self {
        Self { folder, found: Vec::new() }
    }

    /// Solves a problem that must end like this; with a line, the message begins with it.
    pub fn check(&mut self, text: &str, status: i32, line: Option<usize>, parts: &[&str]) {
        let output: Output = optimize(self.folder, text, &["--json", "--time-limit", "20"]);
        let message = stderr(&output);
        let mut lacks = Vec::new();
        if output.status.code() != Some(status) {
            lacks.push(format!("exit status {status}, not {:?}", output.status.code()));
        }
        let place = line.map(|line| format!("problem.toml:{line}: "));
        let parts = parts.iter().copied().chain(place.as_deref());
        lacks.extend(parts.filter(|part| !message.contains(*part)).map(str::to_owned));
        if !lacks.is_empty() {
            let last = text.lines().rev().take(4).collect::<Vec<_>>().join(" <- ");
            self.found.push(format!("{last}\n  {message}  lacks {lacks:?}\n"));
        }
    }
}

impl Drop for Missing {
    fn drop(&mut self) {
        if !std::thread::panicking() {
            assert!(self.found.is_empty(), "{}", self.found.concat());
        }
    }
}

/// The problem of the two-link arm with a line in place of another one, or with more lines.
pub fn with(from: &str, to: &str) -> String {
    let good = two_link();
    assert!(from.is_empty() || good.contains(from), "{from}");
    if from.is_empty() { format!("{good}{to}\n") } else { good.replace(from, to) }
}

/// The same with a table, whose header is line 10.
pub fn and(table: &str, lines: &str) -> String {
    with("", &format!("[{table}]\n{lines}"))
}

/// The UR5 with more tables; the header of the first one is line 10.
pub fn arm(more: &str) -> String {
    format!(
        "robot = \"{}\"\n[start]\nq = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]\n[end]\n\
         q = [1.5, -1.0, 1.2, -1.5, -1.57, 0.5]\n[time]\nfinal = 1.0\n[cost]\neffort = [1, 1, 1, 1, 1, 1]\n{more}",
        robot("ur5.urdf")
    )
}
