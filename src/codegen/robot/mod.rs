//! Programs of the quantities of a robot.
//!
//! `quantity` lists what there is with its arguments and results; `evaluator` computes it for any scalar;
//! `program` records that, with the constants of the robot as numbers or, by `parameters`, as arguments;
//! `guarded` adds the check of the mass matrix; `size` refuses robots that are too large before anything is
//! recorded; `symmetry` tells which joints of a robot with two equal sides correspond.

mod evaluator;
mod guarded;
mod labels;
mod options;
mod parameters;
mod passed;
mod program;
mod quantity;
mod shape;
mod size;
mod symmetry;
mod wrenches;

pub use evaluator::RobotQuantity;
pub use guarded::{REGULAR, guarded_program};
pub use options::ProgramOptions;
pub use parameters::{parameter_names, parameter_values};
pub use program::robot_program;
pub use quantity::{Coordinates, Quantity};
pub use shape::Shape;
