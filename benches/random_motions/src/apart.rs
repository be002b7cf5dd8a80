//! A motion in a process of its own, so that one without an end is a line of the results too.

use crate::record::Record;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// What a motion may take beyond its time limits, those of two solves, in s.
const BEYOND: Duration = Duration::from_secs(20);

/// Judges a problem file with this command; the record has the status `no end` where it took longer than its
/// time limit allows, and `died` where the process did.
pub fn judge(path: &Path, limit: Duration) -> Result<Record, String> {
    let own = std::env::current_exe().map_err(|error| error.to_string())?;
    let mut child = Command::new(own)
        .arg("--judge")
        .arg(path)
        .args(["--time-limit", &limit.as_secs_f64().to_string()])
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|error| error.to_string())?;
    let (sender, receiver) = mpsc::channel();
    if let Some(output) = child.stdout.take() {
        std::thread::spawn(move || {
            for line in BufReader::new(output).lines().map_while(Result::ok) {
                if sender.send(line).is_err() {
                    return;
                }
            }
        });
    }
    let end = Instant::now() + 2 * limit + BEYOND;
    let (mut last, mut lines): (Option<Record>, usize) = (None, 0);
    let late = loop {
        match receiver.recv_timeout(end.saturating_duration_since(Instant::now())) {
            Ok(line) => {
                last = Some(serde_json::from_str(&line).map_err(|error| format!("{line}: {error}"))?);
                lines += 1;
            }
            Err(mpsc::RecvTimeoutError::Disconnected) => break false,
            Err(mpsc::RecvTimeoutError::Timeout) => break true,
        }
    };
    if late {
        let _ = child.kill();
    }
    let _ = child.wait();
    let why = if late { "no end" } else { "died" };
    let mut record = last.unwrap_or_else(|| Record { status: why.into(), ..Record::default() });
    // The first of two lines is the one before the judgement.
    if lines == 1 && record.is_converged() {
        record.not_judged.push(why.into());
    }
    Ok(record)
}
