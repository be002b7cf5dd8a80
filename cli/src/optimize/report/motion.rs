//! What a report is about.

use costate_control::{Problem, Solution};

/// The contents of a report.
pub struct Motion<'a> {
    pub problem: &'a Problem,
    pub solution: &'a Solution,
    /// The text of the problem file.
    pub source: &'a str,
    pub warnings: &'a [String],
}

/// Number of poses that are computed along a motion.
pub const FRAMES: usize = 133;
