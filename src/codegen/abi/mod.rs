//! Functions that other programs load by name: those of CasADi, and those of acados, which are alike.
//!
//! `external` writes the text around straight-line code, `interface` lists what CasADi asks for of a function
//! and its derivatives, `casadi` and `acados` record the code.

mod acados;
mod casadi;
mod external;
mod interface;
mod step;

pub use acados::acados_source;
pub use casadi::casadi_source;
pub use interface::{ExternalPorts, Interface, Port, Variable};
pub use step::{StepOrder, StepSpec, step_program};
