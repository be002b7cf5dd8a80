//! Straight-line code: a computation recorded once, simplified, written down as Rust or C.
//!
//! [`Expr`] is a scalar that records; [`Program`] what was recorded, of any function of numbers or, by [`robot_program`], of
//! a quantity of a robot; [`Program::to_rust`] and [`Program::to_c`] write it down.
//!
//! ```
//! use costate::codegen::{Coordinates, Options, Quantity, RustOptions, robot_program};
//! use costate::robot::Robot;
//!
//! # std::env::set_current_dir(env!("CARGO_MANIFEST_DIR"))?;
//! let robot = Robot::from_file("robots/two_link.toml")?;
//! let program = robot_program(&robot, Quantity::FX, Coordinates::Hamiltonian, &Options::default())?;
//! let source = program.to_rust(&RustOptions::default())?;
//! assert!(source.contains("pub fn two_link_hamiltonian_f_x<T: Number>("));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod arena;
mod c;
mod error;
mod expr;
mod guarded;
mod lower;
mod node;
mod order;
mod parameters;
mod program;
mod quantity;
mod recording;
mod robot;
mod rust;
mod sums;
mod text;
mod value;

pub use c::COptions;
pub use error::CodegenError;
pub use expr::{Expr, ExprMask};
pub use guarded::{REGULAR, guarded_program};
pub use node::{Id, Node};
pub use parameters::{parameter_names, parameter_values};
pub use program::{Argument, Outcome, Program, RecordedResult};
pub use quantity::{Coordinates, Quantity};
pub use robot::{Options, robot_program};
pub use rust::RustOptions;
pub use text::DEFAULT_LIMIT;
pub use text::name_from;
