//! The compiled module of the Python package `costate`: robots, dynamics and time steps on NumPy arrays.
//!
//! A call passes through these modules: `arrays` reads the arguments with their leading `axes`, `results`
//! makes the arrays of results or takes those of the caller, `function` evaluates all states on threads until
//! one of the `signals` comes, `call` those of one thread on lanes, `plan` says where arguments and results
//! lie, `cores` computes one state and four; `xla` takes the arrays of JAX instead. `quantities` lists what
//! is computed of the dynamics, `configuration` of q (+) d, `kinematics` of frames, `schemes` of time steps,
//! `constraints` of robots with loops. `robot` with `edits`, `builder` and its `recipe`, `dynamics`,
//! `constrained`, `frame` and `time_step` are the classes that Python sees, `look` their visual models;
//! `words` says in Python what messages advise on the command line, `notes` logs what is no warning.
//! `motions` is what its classes for optimal motions are made of, `casadi` exports functions to CasADi.

#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]

mod argument;
mod arrays;
mod axes;
mod builder;
mod call;
mod casadi;
mod check;
mod codegen;
mod configuration;
mod configuration_verbs;
mod constrained;
mod constrained_verbs;
mod constraint_edits;
mod constraints;
mod contacts;
mod cores;
mod descriptions;
mod dynamics;
mod dynamics_verbs;
mod edits;
mod engine;
mod engines;
mod errors;
mod failures;
mod fours;
mod frame;
mod free_steps;
mod function;
mod kinematics;
mod look;
mod methods;
mod motions;
mod notes;
mod plan;
mod properties;
mod quantities;
mod recipe;
mod refusals;
mod results;
mod robot;
mod schemes;
mod shared_engines;
mod signals;
mod table;
mod time_step;
#[cfg(feature = "timing")]
mod timing;
mod words;
mod workspace;
mod xla;

use pyo3::prelude::*;

// Nothing here relies on the lock of the interpreter: free-threaded interpreters keep running without it.
#[pymodule(gil_used = false)]
mod _costate {
    #[pymodule_export]
    use crate::builder::RobotBuilder;
    #[pymodule_export]
    use crate::casadi::{_CasadiSlot, _casadi_calls, _casadi_refusal, _casadi_slots};
    #[pymodule_export]
    use crate::check::_compare;
    #[pymodule_export]
    use crate::codegen::codegen;
    #[pymodule_export]
    use crate::constrained::ConstrainedDynamics;
    #[pymodule_export]
    use crate::dynamics::Dynamics;
    #[pymodule_export]
    use crate::frame::Frame;
    #[pymodule_export]
    use crate::motions::feedback::FeedbackCore;
    #[pymodule_export]
    use crate::motions::problem::ProblemCore;
    #[pymodule_export]
    use crate::motions::program::ProgramCore;
    #[pymodule_export]
    use crate::motions::resolve::ResolveCore;
    #[pymodule_export]
    use crate::motions::run::Run;
    #[pymodule_export]
    use crate::motions::samples::SamplesCore;
    #[pymodule_export]
    use crate::motions::solution::SolutionCore;
    #[pymodule_export]
    use crate::recipe::_rebuild;
    #[pymodule_export]
    use crate::robot::Robot;
    #[pymodule_export]
    use crate::time_step::Step;
    #[pymodule_export]
    use crate::xla::{_xla_calls, _xla_handler};
    #[pymodule_export]
    #[expect(non_upper_case_globals, reason = "its name in Python")]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
