//! Optimal motions against values known in closed form or published.

#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail by panicking")]

use costate::robot::{JointSpec, LinkInertia, Robot};
use costate_control::SolverOptions;

mod between;
mod bounded;
mod branch;
mod cost_errors;
mod direct;
mod direct_refused;
mod documents;
mod dormand_prince;
mod double_support;
mod double_support_in_space;
mod double_support_soles;
mod dynamics;
mod equations;
mod extremals;
mod fast_joints;
mod finer_mesh;
mod free_joints;
mod free_joints_refused;
mod free_start;
mod gait_integrated;
mod gaits;
mod gripper;
mod guessed_times;
mod guesses;
mod in_space;
mod independent;
mod infeasible;
mod known;
mod lagrangian;
mod linear_algebra;
mod long_motions;
mod loops;
#[cfg(feature = "jit")]
mod machine_code;
mod narrow;
mod obstacle_file;
mod one_state;
mod open_loops;
mod payload_bodies;
mod plane_twins;
mod polish;
mod power;
mod power_refused;
mod problem_file;
mod problems;
mod program;
mod rabbit_on_one_foot;
mod rates;
mod reduced;
mod references;
mod refused;
mod reorientation;
mod resumed;
mod samples;
mod second_order;
mod second_variation;
mod shooting;
mod soles;
mod source;
mod space_speed;
mod space_walk;
mod states;
mod stopping;
mod task_file;
mod tasks;
mod tool_acceleration;
mod trotting;
mod unactuated;
mod uneven_robots;
mod urdf_bodies;
mod user_terms;
mod users_inputs;
mod verdict;
mod verification;
mod via_file;
mod vias;
mod walking;
mod walking_refused;

/// A mass of 1 kg that slides along x.
fn sledge() -> Robot {
    let joint = JointSpec::prismatic("x").axis([1.0, 0.0, 0.0]).carrying(LinkInertia::point(1.0, [0.0; 3]));
    Robot::builder("sledge").joint(joint).build().unwrap()
}

/// Default options with the tolerance that values of nine digits need.
fn sharp() -> SolverOptions {
    SolverOptions::default().with_tolerance(1e-9)
}
