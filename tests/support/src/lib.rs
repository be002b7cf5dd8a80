//! What several test targets share: random robots, reference values, and the automatic differentiation that
//! judges.
//!
//! It is a crate of its own so that all of this is compiled once. Debug builds share instances of generic
//! code between crates: an instance that exists here is not compiled again in the targets that use it.

#![allow(missing_docs, reason = "helpers of tests")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests and their helpers fail by panicking")]

pub mod allocations;
pub mod generic;
pub mod random_robot;
pub mod reference;
pub mod robots;

use proptest::test_runner::{Config, FileFailurePersistence};

/// Settings of a property test: `cases` random inputs, or as many as the variable `PROPTEST_CASES` asks for.
///
/// The seed of a failure is kept in `NAME.failures.txt` beside the source file `NAME.rs`, together with the
/// smallest robot that fails, and is tried first by every later run.
pub fn config(cases: u32) -> Config {
    let default = Config::default(); // reads the variables PROPTEST_*
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() { default.cases } else { cases };
    Config {
        cases,
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("failures.txt"))),
        max_global_rejects: default.max_global_rejects.max(cases),
        ..default
    }
}
