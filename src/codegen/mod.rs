//! Straight-line code: a computation recorded once, simplified, and written as Rust or C.
//!
//! [`Expr`] is a scalar that records. A [`Program`] is a recorded function of numbers or, by
//! [`robot_program`], a quantity of a robot. [`Program::to_rust`] and [`Program::to_c`] write it as source
//! text.
//!
//! The flow, by folder: `record` turns a function into nodes, `simplify` turns nodes into the steps of a
//! [`Program`], `emit` writes them as text; `robot` records the quantities of a robot, `abi` functions that
//! CasADi and acados load.
//!
//! ```
//! use costate::codegen::{Coordinates, ProgramOptions, Quantity, RustOptions, robot_program};
//! use costate::robot::Robot;
//!
//! # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
//! let robot = Robot::from_file("robots/two_link.toml")?;
//! let program = robot_program(&robot, Quantity::FX, Coordinates::Hamiltonian, &ProgramOptions::default())?;
//! let source = program.to_rust(&RustOptions::default())?;
//! assert!(source.contains("pub fn two_link_hamiltonian_f_x<T: Number>("));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod abi;
mod emit;
mod error;
mod interpret;
mod names;
mod program;
mod program_ends;
mod record;
mod robot;
mod simplify;

pub use abi::{
    ExternalPorts, Interface, Port, StepOrder, StepSpec, Variable, acados_source, casadi_source, step_program,
};
pub use emit::{COptions, DEFAULT_LIMIT, RustOptions, c_header, c_source};
pub use error::CodegenError;
pub use names::name_from;
pub use program::Program;
pub use program_ends::{ProgramArgument, ProgramResult, RecordedResult};
pub use record::{Expr, ExprMask, Id, Node, OPERATIONS_PER_STEP};
pub use robot::{
    Coordinates, ProgramOptions, Quantity, REGULAR, RobotQuantity, Shape, guarded_program, parameter_names,
    parameter_values, robot_program,
};
