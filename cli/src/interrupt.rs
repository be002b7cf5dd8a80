//! Interruption by SIGINT (Ctrl-C) and SIGTERM.

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit status of an interrupted command.
pub const EXIT_CODE: u8 = 130;

/// A flag that the first signal sets and that long computations poll. A second signal ends the process at
/// once.
#[derive(Clone)]
pub struct Interrupt(Arc<AtomicBool>);

impl Interrupt {
    /// Handles signals from here on; until then they end the process at once.
    ///
    /// # Errors
    /// Those of the operating system.
    pub fn listen() -> Result<Self, String> {
        let failed = |error| format!("signals cannot be handled ({error})");
        let requested = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // Handlers run in this order: the first signal finds the flag unset and sets it, the second one
            // exits.
            flag::register_conditional_shutdown(signal, i32::from(EXIT_CODE), requested.clone())
                .map_err(failed)?;
            flag::register(signal, requested.clone()).map_err(failed)?;
        }
        Ok(Self(requested))
    }

    /// Whether a signal has arrived.
    pub fn is_requested(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }

    /// Goes on until a signal has arrived.
    pub fn control_flow(&self) -> ControlFlow<()> {
        if self.is_requested() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// An error once a signal has arrived, to leave a computation by `?`.
    ///
    /// # Errors
    /// [`Interrupted`].
    pub fn check(&self) -> Result<(), Interrupted> {
        if self.is_requested() { Err(Interrupted) } else { Ok(()) }
    }
}

/// The command was interrupted; it exits with status [`EXIT_CODE`].
#[derive(Debug)]
pub struct Interrupted;

impl std::fmt::Display for Interrupted {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("interrupted")
    }
}

impl std::error::Error for Interrupted {}
