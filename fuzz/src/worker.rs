//! Runs inputs in a process of its own and survives what they do to it.

use crate::kind::Kind;
use crate::memory;
use crate::source::{Inputs, Source};
use crate::table::{Outcome, Report};
use crate::target;
use std::io::{BufRead, BufReader};
use std::panic::catch_unwind;
use std::process::{Child, Command, Stdio};
use std::sync::Mutex;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::{Duration, Instant};

/// How long a worker may be silent.
const LONGEST_SILENCE: Duration = Duration::from_secs(60);

/// Where the last panic was.
static PANIC: Mutex<String> = Mutex::new(String::new());

/// What the worker does: inputs `first..end`; a line before each and one after it.
pub fn work(kind: Kind, source: Source, first: usize, end: usize) {
    std::panic::set_hook(Box::new(|info| {
        if let Ok(mut message) = PANIC.lock() {
            *message = info.to_string().replace('\n', " ");
        }
    }));
    let inputs = Inputs::new(kind, source);
    for index in first..end {
        let input = inputs.input(index);
        println!("start {index}");
        let before = memory::used();
        memory::restart_peak();
        let clock = Instant::now();
        let result = catch_unwind(|| target::run(kind, &input));
        let time = clock.elapsed();
        let bytes = memory::restart_peak().saturating_sub(before);
        let outcome = match result {
            Ok(Ok(true)) => "accepted".into(),
            Ok(Ok(false)) => "refused".into(),
            Ok(Err(message)) => format!("message {}", message.replace('\n', " ")),
            Err(_) => format!("panic {}", PANIC.lock().map(|message| message.clone()).unwrap_or_default()),
        };
        println!("end {index} {bytes} {} {outcome}", time.as_nanos());
    }
}

/// Runs inputs `0..count` in workers.
pub fn run(kind: Kind, source: Source, count: usize, report: &mut Report) -> std::io::Result<()> {
    let inputs = Inputs::new(kind, source);
    let mut first = 0;
    while first < count {
        first = supervise(&inputs, (kind, source), first, count, report)?;
    }
    Ok(())
}

/// Runs one worker until it ends; the first input that is left.
fn supervise(
    inputs: &Inputs,
    of: (Kind, Source),
    first: usize,
    end: usize,
    report: &mut Report,
) -> std::io::Result<usize> {
    let (mut child, lines) = spawn(of, first, end)?;
    let mut at = first;
    loop {
        match lines.recv_timeout(LONGEST_SILENCE) {
            Ok(line) => {
                if let Some(mut outcome) = parse(&line) {
                    if outcome.is_slow() {
                        // Other processes may have slowed it down: once more.
                        outcome.time = outcome.time.min(again(of, at)?);
                    }
                    report.add(of.0.name(), &outcome, || (inputs.name(at), inputs.input(at)));
                    at += 1;
                }
            }
            Err(RecvTimeoutError::Disconnected) => {
                let status = child.wait()?;
                if at < end {
                    let outcome = Outcome::dead(format!("the process ended: {status}"));
                    report.add(of.0.name(), &outcome, || (inputs.name(at), inputs.input(at)));
                    at += 1;
                }
                return Ok(at);
            }
            Err(RecvTimeoutError::Timeout) => {
                child.kill()?;
                child.wait()?;
                let outcome = Outcome::dead(format!("no end after {} s", LONGEST_SILENCE.as_secs()));
                report.add(of.0.name(), &outcome, || (inputs.name(at), inputs.input(at)));
                return Ok(at + 1);
            }
        }
    }
}

/// Time of one input alone.
fn again(of: (Kind, Source), index: usize) -> std::io::Result<Duration> {
    let (mut child, lines) = spawn(of, index, index + 1)?;
    let mut time = Duration::MAX;
    while let Ok(line) = lines.recv_timeout(LONGEST_SILENCE) {
        time = parse(&line).map_or(time, |outcome| outcome.time);
    }
    child.kill().ok();
    child.wait()?;
    Ok(time)
}

fn spawn(
    (kind, source): (Kind, Source),
    first: usize,
    end: usize,
) -> std::io::Result<(Child, Receiver<String>)> {
    let mut child = Command::new(std::env::current_exe()?)
        .args(["--worker", kind.name()])
        .args(source.words())
        .args([first.to_string(), end.to_string()])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()?;
    let (sender, receiver) = channel();
    if let Some(out) = child.stdout.take() {
        std::thread::spawn(move || {
            let lines = BufReader::new(out).lines().map_while(Result::ok);
            // The receiver is gone when the worker is killed.
            lines.map_while(|line| sender.send(line).ok()).for_each(drop);
        });
    }
    Ok((child, receiver))
}

/// The line after an input.
fn parse(line: &str) -> Option<Outcome> {
    let mut words = line.strip_prefix("end ")?.splitn(4, ' ').skip(1);
    let bytes = words.next()?.parse().ok()?;
    let time = Duration::from_nanos(words.next()?.parse().ok()?);
    let outcome = words.next()?;
    let (name, message) = outcome.split_once(' ').unwrap_or((outcome, ""));
    let fault = match name {
        "accepted" | "refused" => None,
        _ => Some(outcome.to_owned()),
    };
    Some(Outcome {
        accepted: name == "accepted",
        panicked: name == "panic",
        bytes,
        time,
        fault: fault.filter(|_| !message.is_empty()),
    })
}
