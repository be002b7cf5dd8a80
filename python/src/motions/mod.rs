//! Optimal motions: what `costate._problem`, `costate._solution` and `costate._resolve` are made of.
//!
//! A problem is the text of a problem file and a robot. A run solves it on a thread of its own, so that the
//! thread that waits for it can be interrupted; nothing of Python is called from there.

pub mod arrays;
pub mod feedback;
mod limits;
pub mod problem;
pub mod program;
pub mod raise;
pub mod resolve;
pub mod run;
pub mod samples;
pub mod solution;
pub mod steps;
