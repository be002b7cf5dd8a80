//! What a solver reports while it runs, and how it is stopped.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// What is being solved. Names in files and tables are those of [`Display`](fmt::Display).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Phase {
    /// The problem at a fixed final time.
    #[serde(rename = "fixed time")]
    FixedTime,
    /// The problem with a free final time.
    #[serde(rename = "free time")]
    FreeTime,
    /// A relaxed problem: weak penalties and no bounds.
    #[serde(rename = "without limits")]
    WithoutLimits,
    /// A relaxed problem with an end that is closer to the start.
    #[serde(rename = "nearer end")]
    NearerEnd,
    /// Penalties rise to those of the problem.
    #[serde(rename = "penalties")]
    Penalties,
    /// Bounds tighten to those of the problem.
    #[serde(rename = "bounds")]
    Bounds,
    /// Controls without effort are smoothed less and less.
    #[serde(rename = "smoothing")]
    Smoothing,
    /// Arcs with unknown switching times.
    #[serde(rename = "switches")]
    Switches,
    /// The direct method.
    #[serde(rename = "direct")]
    Direct,
    /// The direct method, on the way back to the limits: what they give is minimised.
    #[serde(rename = "restoration")]
    Restoration,
    /// An extremal from the motion of the direct method.
    #[serde(rename = "polish")]
    Polish,
    /// A branch of solutions ([`Continuation`](crate::Continuation)).
    #[serde(rename = "continuation")]
    Continuation,
}

impl Phase {
    /// "fixed time" and so on.
    pub fn name(self) -> &'static str {
        match self {
            Self::FixedTime => "fixed time",
            Self::FreeTime => "free time",
            Self::WithoutLimits => "without limits",
            Self::NearerEnd => "nearer end",
            Self::Penalties => "penalties",
            Self::Bounds => "bounds",
            Self::Smoothing => "smoothing",
            Self::Switches => "switches",
            Self::Direct => "direct",
            Self::Restoration => "restoration",
            Self::Polish => "polish",
            Self::Continuation => "continuation",
        }
    }
}

impl fmt::Display for Phase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// One step of Newton's method, on an extremal or in the direct method.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Iteration {
    /// What is being solved.
    pub phase: Phase,
    /// Nodes of the mesh.
    pub nodes: usize,
    /// Number of the step on this mesh, from 1.
    pub number: usize,
    /// Root mean square of the full correction, each component relative to its size; in the direct
    /// method, the relative change of the cost that is expected, or the largest violation of a limit.
    pub residual: f64,
    /// Damping in (0, 1]: the part of the correction that was taken.
    pub step: f64,
    /// Final time T (s).
    pub final_time: f64,
    /// Cost so far, penalties included.
    pub cost: f64,
}

/// A handle that stops a [`Solver`](crate::Solver) or a [`Continuation`](crate::Continuation) from another
/// thread or from a signal handler.
///
/// Clones share one flag. The solver looks at it before each Newton step.
///
/// ```
/// use costate_control::Cancel;
/// let cancel = Cancel::new();
/// let other = cancel.clone();
/// std::thread::spawn(move || other.cancel()).join().unwrap();
/// assert!(cancel.is_cancelled());
/// ```
#[derive(Clone, Debug, Default)]
pub struct Cancel(Arc<AtomicBool>);

impl Cancel {
    /// A handle that is not cancelled.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Asks to stop. Async-signal-safe.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether [`cancel`](Self::cancel) was called.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// A callback for each step; [`ControlFlow::Break`] cancels.
pub(crate) type Listener<'a> = Box<dyn FnMut(&Iteration) -> ControlFlow<()> + Send + 'a>;
