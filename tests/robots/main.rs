//! Descriptions of robots: URDF, TOML, tables; and the numbers of real robots.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests and their helpers fail by panicking")]

mod constraints;
mod descriptions;
mod edits;
mod free_joints;
mod free_pinocchio;
mod gripper;
mod inertias;
mod known_kinematics;
mod known_robots;
mod mimics;
mod parameters;
mod texts;
mod toml_contents;
mod toml_files;
mod units;
mod urdf;
mod urdf_loops;
mod urdf_loops_refused;
mod urdf_refused;
mod urdf_stress;
mod urdf_text;
