//! What several test targets share: random robots, reference values, and the automatic differentiation that
//! judges.
//!
//! It is a crate of its own so that all of this is compiled once. Debug builds share instances of generic
//! code between crates: an instance that exists here is not compiled again in the targets that use it.

#![allow(missing_docs, reason = "helpers of tests")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests and their helpers fail by panicking")]

pub mod allocations;
pub mod generic;
pub mod random_part;
pub mod random_position;
pub mod random_robot;
pub mod reach;
pub mod reference;
pub mod robots;
pub mod rounding;
pub mod wrenches;

// Named, though not used, so that rustc takes the instances of generic code that it has compiled.
use costate_comparison as _;
pub use proptest;

use proptest::prelude::{BoxedStrategy, TestCaseError};
use proptest::test_runner::{Config, FileFailurePersistence, TestRunner};
use std::fmt::Debug;

/// Property tests, `cases` random inputs each: as by `proptest!`, but the runner is compiled once for each
/// type of input, not for each test.
///
/// ```text
/// properties! {
///     64;
///
///     #[test]
///     fn name(case in cases(5)) { prop_assert!(..) }
/// }
/// ```
#[macro_export]
macro_rules! properties {
    ($cases:expr; $($(#[$meta:meta])* fn $name:ident($($input:pat in $inputs:expr),+ $(,)?) $body:block)*) => {$(
        $(#[$meta])*
        fn $name() {
            let place = $crate::Place {
                source: file!(),
                test: concat!(module_path!(), "::", stringify!($name)),
            };
            let inputs = $crate::proptest::strategy::Strategy::boxed(($($inputs,)+));
            $crate::property($cases, place, inputs, &|($($input,)+)| {
                let () = $body;
                Ok(())
            });
        }
    )*};
}

/// Where a property stands.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Source file.
    pub source: &'static str,
    /// Path of the test.
    pub test: &'static str,
}

/// Tests a property on `cases` random inputs, or as many as the variable `PROPTEST_CASES` asks for.
///
/// The seed of a failure is kept in `NAME.failures.txt` beside the source file `NAME.rs`, together with the
/// smallest input that fails, and is tried first by every later run.
///
/// With the variable `COSTATE_USED` it prints how much of the bounds of [`rounding`](mod@rounding) was used.
pub fn property<T: Debug>(
    cases: u32,
    place: Place,
    inputs: BoxedStrategy<T>,
    test: &dyn Fn(T) -> Result<(), TestCaseError>,
) {
    let mut runner = TestRunner::new(config(cases, place));
    rounding::take_used();
    if let Err(error) = runner.run(&inputs, test) {
        panic!("{error}\n{runner}");
    }
    let used = rounding::take_used();
    if std::env::var_os("COSTATE_USED").is_some() {
        println!("{}: comparisons above 1/2, 1/4, .. of their bounds, and all: {used:?}", place.test);
    }
}

/// Never called: this crate compiles the runner for random robots here, which all test targets then share.
#[doc(hidden)]
pub fn property_of_robots(
    cases: u32,
    place: Place,
    inputs: BoxedStrategy<(random_robot::Case,)>,
    test: &dyn Fn((random_robot::Case,)) -> Result<(), TestCaseError>,
) {
    property(cases, place, inputs, test);
}

fn config(cases: u32, place: Place) -> Config {
    let default = Config::default(); // reads the variables PROPTEST_*
    let cases = if std::env::var_os("PROPTEST_CASES").is_some() { default.cases } else { cases };
    Config {
        cases,
        failure_persistence: Some(Box::new(FileFailurePersistence::WithSource("failures.txt"))),
        max_global_rejects: default.max_global_rejects.max(cases),
        // What fails is kept once it is as small as it gets: in time also where many cases were asked for.
        max_shrink_iters: default.max_shrink_iters.min(4096),
        source_file: Some(place.source),
        test_name: Some(place.test),
        ..default
    }
}
