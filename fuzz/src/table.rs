//! What happened, by kind.

use crate::files::folder;
use std::fmt;
use std::time::Duration;

/// Most heap memory that reading an input may take (bytes).
pub const MOST_BYTES: usize = 256_000_000;

/// Longest time that an input may take.
pub const LONGEST: Duration = Duration::from_secs(5);

/// What an input did.
pub struct Outcome {
    pub accepted: bool,
    pub panicked: bool,
    pub bytes: usize,
    pub time: Duration,
    /// What should not have happened.
    pub fault: Option<String>,
}

impl Outcome {
    /// Its process ended.
    pub fn dead(message: String) -> Self {
        Self { accepted: false, panicked: true, bytes: 0, time: Duration::ZERO, fault: Some(message) }
    }

    /// The same, without its fault.
    pub fn copy(&self) -> Self {
        Self { fault: None, ..*self }
    }

    /// Whether it took too long.
    pub fn is_slow(&self) -> bool {
        self.time > LONGEST
    }
}

#[derive(Default)]
struct Row {
    kind: &'static str,
    inputs: usize,
    accepted: usize,
    panics: usize,
    bytes: usize,
    largest: String,
    time: Duration,
    longest: String,
}

/// The table and the violations.
#[derive(Default)]
pub struct Report {
    rows: Vec<Row>,
    violations: Vec<String>,
}

impl Report {
    /// Adds an input; `input` gives its name and its bytes.
    pub fn add(&mut self, kind: &'static str, outcome: &Outcome, input: impl FnOnce() -> (String, Vec<u8>)) {
        if !self.rows.iter().any(|row| row.kind == kind) {
            self.rows.push(Row { kind, ..Row::default() });
        }
        let Some(row) = self.rows.iter_mut().find(|row| row.kind == kind) else { return };
        row.inputs += 1;
        row.accepted += usize::from(outcome.accepted);
        row.panics += usize::from(outcome.panicked);
        let fault = match &outcome.fault {
            Some(fault) => Some(fault.clone()),
            None if outcome.bytes > MOST_BYTES => Some(format!("{} MB", outcome.bytes / 1_000_000)),
            None if outcome.is_slow() => Some(format!("{:.1} s", outcome.time.as_secs_f64())),
            None => None,
        };
        if fault.is_none() && outcome.bytes <= row.bytes && outcome.time <= row.time {
            return;
        }
        let (name, bytes) = input();
        if outcome.bytes > row.bytes {
            (row.bytes, row.largest) = (outcome.bytes, name.clone());
        }
        if outcome.time > row.time {
            (row.time, row.longest) = (outcome.time, name.clone());
        }
        if let Some(fault) = fault {
            self.violate(kind, &format!("{name}: {fault}"), &bytes);
        }
    }

    /// Adds a violation, and keeps its input.
    pub fn violate(&mut self, kind: &str, violation: &str, bytes: &[u8]) {
        let saved = self.save(kind, bytes);
        self.violations.push(format!("{violation} ({saved})"));
    }

    /// Keeps the input.
    fn save(&self, kind: &str, bytes: &[u8]) -> String {
        let file = folder().join("failures").join(format!("{kind}-{}", self.violations.len()));
        let written =
            std::fs::create_dir_all(folder().join("failures")).and_then(|()| std::fs::write(&file, bytes));
        written
            .map_or_else(|error| format!("not saved: {error}"), |()| format!("saved as {}", file.display()))
    }

    /// Whether nothing happened that should not.
    pub fn is_good(&self) -> bool {
        self.violations.is_empty()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:<9} {:>7} {:>9} {:>8} {:>7} {:>11} {:>10}",
            "kind", "inputs", "accepted", "refused", "panics", "memory (MB)", "time (s)"
        )?;
        for row in &self.rows {
            let (refused, megabytes) = (row.inputs - row.accepted - row.panics, row.bytes as f64 / 1e6);
            let Row { kind, inputs, accepted, panics, .. } = row;
            let seconds = row.time.as_secs_f64();
            writeln!(
                f,
                "{kind:<9} {inputs:>7} {accepted:>9} {refused:>8} {panics:>7} {megabytes:>11.1} {seconds:>10.2}"
            )?;
        }
        writeln!(f)?;
        for row in &self.rows {
            writeln!(f, "{}: most memory {}, longest time {}", row.kind, row.largest, row.longest)?;
        }
        let count = self.violations.len();
        writeln!(
            f,
            "\n{count} violations (panic, abort, more than 256 MB, more than 5 s, unprintable message)"
        )?;
        self.violations.iter().try_for_each(|violation| writeln!(f, "  {violation}"))
    }
}
