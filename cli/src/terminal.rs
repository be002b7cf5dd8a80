//! Everything printed for people: warnings, errors, colours and progress.
//!
//! Nothing in here panics when standard output or standard error is closed. Colours appear on terminals only,
//! and not where the environment variable `NO_COLOR` is set.

use anstream::AutoStream;
use anstyle::{AnsiColor, Style};
use costate::robot::{Robot, escape_hidden};
use indicatif::{ProgressBar, ProgressStyle};
use std::fmt::Display;
use std::io::{StdoutLock, Write};

const GREEN: Style = AnsiColor::Green.on_default().bold();
const RED: Style = AnsiColor::Red.on_default().bold();
const YELLOW: Style = AnsiColor::Yellow.on_default().bold();
const CYAN: Style = AnsiColor::Cyan.on_default().bold();

/// Standard output for reports: keeps colours on a terminal and removes them elsewhere.
pub fn stdout() -> AutoStream<StdoutLock<'static>> {
    anstream::stdout().lock()
}

/// A good verdict (`PASS`) in green, to be written to [`stdout`].
pub fn good(verdict: &str) -> impl Display {
    format!("{GREEN}{verdict}{GREEN:#}")
}

/// A bad verdict (`FAIL`) in red, to be written to [`stdout`].
pub fn bad(verdict: &str) -> impl Display {
    format!("{RED}{verdict}{RED:#}")
}

/// Writes `error: message` to standard error.
pub fn error(message: impl Display) {
    labelled(RED, "error", message);
}

/// Writes `warning: message` to standard error.
pub fn warning(message: impl Display) {
    labelled(YELLOW, "warning", message);
}

/// Writes `note: message` to standard error.
pub fn note(message: impl Display) {
    labelled(CYAN, "note", message);
}

/// Writes what is unusual about a robot to standard error: warnings, and notes on what was done.
pub fn about_robot(robot: &Robot) {
    for warning in robot.warnings() {
        if warning.is_note() { note(warning) } else { self::warning(warning) }
    }
}

/// If standard error is closed, there is nobody to tell: the failure to write is ignored.
fn labelled(style: Style, label: &str, message: impl Display) {
    let _ = writeln!(anstream::stderr().lock(), "{style}{label}:{style:#} {}", one_line(message));
}

/// The message on one line: a name in it may hold line ends and other hidden characters, which become
/// escapes.
pub fn one_line(message: impl Display) -> String {
    escape_hidden(&message.to_string()).into_owned()
}

/// A progress bar on standard error, counting `unit`s; shown only if standard error is a terminal.
pub fn progress_bar(length: u64, unit: &str) -> ProgressBar {
    let template = format!("{{bar:40}} {{pos}}/{{len}} {unit}, {{eta}} left");
    let bar = ProgressBar::new(length);
    match ProgressStyle::with_template(&template) {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

#[cfg(test)]
mod tests {
    use super::one_line;

    #[test]
    fn messages_have_one_line_whatever_the_names_in_them_hold() {
        assert_eq!(one_line("joint 'e\0l\nbow' \u{202e}"), r"joint 'e\u{0}l\nbow' \u{202e}");
    }
}
