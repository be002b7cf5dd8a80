//! Optimal motions against values known in closed form or published.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use costate::robot::{JointSpec, LinkInertia, Robot};

mod bounded;
mod branch;
mod direct;
mod dynamics;
mod equations;
mod extremals;
mod free_start;
mod known;
mod lagrangian;
mod linear_algebra;
mod one_state;
mod problem_file;
mod problems;
mod second_variation;
mod shooting;
mod source;
mod stopping;
mod task_file;
mod user_terms;

/// A mass of 1 kg that slides along x.
fn sledge() -> Robot {
    let joint = JointSpec::prismatic("x").axis([1.0, 0.0, 0.0]).carrying(LinkInertia::point(1.0, [0.0; 3]));
    Robot::builder("sledge").joint(joint).build().unwrap()
}
