//! The constants that steer the search, all in one place.
//!
//! Numbers that decide *whether and how* something is tried stand here, grouped by the part that uses
//! them. Lengths of Newton corrections and errors are relative: component `i` in units of the largest
//! value that it takes along the motion. Times are in s where nothing else is said. Most of them change
//! how soon, and from which of several local minima, a solution is found. What a converged solution is
//! depends on `NEGLIGIBLE_CHANGE` and `SMOOTHED_TOLERANCE`, which define `ConvergedSmoothed`; in the
//! direct method on `VERIFIED` and the names that begin with `VIOLATION`; and which of two motions is
//! shown on the slack of the polish.

pub(crate) mod checks;
pub(crate) mod differences;
pub(crate) mod direct;
pub(crate) mod dry_friction;
pub(crate) mod elastic;
mod extremals;
pub(crate) mod free_motions;
pub(crate) mod guesses;
pub(crate) mod saddle;
pub(crate) mod states;
pub(crate) mod task;
pub(crate) mod waiting;

pub(crate) use extremals::{arcs, attempts, branch, free_time, homotopy, newton, refinement, shooting};

/// Extremals from motions of the direct method ([`crate::polish`]).
pub(crate) mod polish {
    /// A polish may take this many times the work of the direct method: the nodes of all its Newton steps, ..
    pub const SHARE: usize = 10;
    /// .. and so many more, which take as long as guess, checks and verification, ..
    pub const BESIDE_STEPS: usize = 150;
    /// .. where a node of a polish counts as so many of them: with two to seven joints it takes three to six
    /// times as long.
    pub const NODE: usize = 5;
    /// Tolerance of the direct method before a polish ..
    pub const ROUGH: f64 = 1e-4;
    /// .. and where torques are limited: when they reach their limits must be seen.
    pub const ROUGH_BOUNDED: f64 = 1e-6;
    /// A polish has a tolerance that is this part of the one that is asked for ..
    pub const SHARPER: f64 = 0.01;
    /// .. if it is no smaller than this, or asked for.
    pub const SHARP_ENOUGH: f64 = 1e-8;
    /// Points of the direct method in an interval of its mesh: that mesh is the first one of the polish.
    pub const STRIDE: usize = 4;
    /// How much more than the motion of the direct method an extremal may cost, in parts of the tolerance:
    /// the error of that cost is of this size.
    pub const SLACK: f64 = 10.0;
    /// The same in parts of the cost, where the direct method did not converge.
    pub const SLACK_UNSOLVED: f64 = 0.01;
    /// Relative smoothing from which controls without effort are sharpened if the arcs of the motion are not
    /// those of an extremal.
    pub const SMOOTHING: f64 = 0.01;
    /// Places in an interval at which limits are checked.
    pub const PLACES: [f64; 3] = [0.25, 0.5, 0.75];
}

/// Disturbances of first guesses ([`crate::cubics`]).
pub(crate) mod cubics {
    /// Amplitude of the disturbances of further starts, besides the distance from start to end (rad, m).
    pub const AMPLITUDE: f64 = 1.5;
    /// Share of the disturbances with one wave; the others have two.
    pub const ONE_WAVE: f64 = 0.7;
}

/// Times that joints need at least ([`crate::problem::least_time`]).
pub(crate) mod least_time {
    /// A joint has too little time if it needs more by this part of it: less may be rounding.
    pub const ROUNDING_OF_TIMES: f64 = 1e-9;
    /// A way that differs from that of a single acceleration by less than this part of both, and of what
    /// stopping from the rates takes, is one.
    pub const ROUNDING_OF_WAYS: f64 = 1e-12;
}

/// Machine code for the points of the direct method (`direct::points::programs`).
#[cfg(feature = "jit")]
pub(crate) mod programs {
    /// Robots whose programs are kept for later problems.
    pub const ROBOTS: usize = 4;
    /// Points for each joint whose second derivatives the generic code computes before their program is
    /// compiled, unless [`MachineCode`](crate::MachineCode) says otherwise: they take about half of the time
    /// of compiling. A solve from a good guess needs no more.
    pub const HESSIANS: usize = 120;
    /// The same for points whose torques alone are computed.
    pub const TORQUES: usize = 300;
    /// Longest programs, in steps; longer ones take longer to compile than they save in one solve.
    pub const STEPS: usize = 16_000;
    /// Most joints, so that no robot is recorded for long in vain.
    pub const JOINTS: usize = 14;
}
