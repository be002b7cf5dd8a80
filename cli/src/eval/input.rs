//! Lines of the input, read by a thread of its own so that a signal is noticed while no line arrives.

use crate::interrupt::Interrupt;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

/// Lines that are read ahead.
const AHEAD: usize = 4;

/// Longest line (bytes): an output line of 200 joints with all derivatives has 7 MB.
const MOST_BYTES: usize = 8 << 20;

/// How often the flag of the signals is polled while no line arrives.
const POLL: Duration = Duration::from_millis(50);

pub struct Lines(Receiver<io::Result<Vec<u8>>>);

fn too_long() -> io::Error {
    let message = format!("a line of states has more than {MOST_BYTES} bytes; give one state in each line");
    io::Error::new(io::ErrorKind::InvalidData, message)
}

/// What comes next.
pub enum Input {
    Line(io::Result<Vec<u8>>),
    End,
    Interrupted,
}

impl Lines {
    /// Opens a file.
    ///
    /// # Errors
    /// A message that names the file.
    pub fn of_file(path: &Path) -> Result<Self, String> {
        let unreadable = |error| format!("{}: cannot be read ({error}); check the path", path.display());
        let file = File::open(path).map_err(unreadable)?;
        if path.is_dir() {
            return Err(unreadable(io::ErrorKind::IsADirectory.into()));
        }
        Ok(Self::of(file))
    }

    pub fn of_standard_input() -> Self {
        Self::of(io::stdin())
    }

    fn of(input: impl Read + Send + 'static) -> Self {
        let (sender, receiver) = sync_channel(AHEAD);
        std::thread::spawn(move || {
            let mut input = BufReader::new(input);
            loop {
                let mut line = Vec::new();
                let read = match input.by_ref().take(MOST_BYTES as u64).read_until(b'\n', &mut line) {
                    Ok(0) => break,
                    Ok(_) if line.len() == MOST_BYTES && line.last() != Some(&b'\n') => Err(too_long()),
                    read => read,
                };
                let failed = read.is_err();
                if sender.send(read.map(|_| line)).is_err() || failed {
                    break;
                }
            }
        });
        Self(receiver)
    }

    /// Waits for the next line, the end or a signal.
    pub fn next(&self, interrupt: &Interrupt) -> Input {
        while !interrupt.is_requested() {
            match self.0.recv_timeout(POLL) {
                Ok(line) => return Input::Line(line),
                Err(RecvTimeoutError::Disconnected) => return Input::End,
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
        Input::Interrupted
    }
}
