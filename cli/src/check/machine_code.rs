//! Machine code as one more method.

use costate::codegen::{CodegenError, Coordinates, ProgramOptions, Quantity, robot_program};
use costate::derivative::{ComparedDerivative, OtherRoute};
use costate::robot::Robot;
use costate_jit::{Backend, JitQuantity};

/// What is compared.
const QUANTITIES: [(Quantity, Coordinates, ComparedDerivative); 6] = [
    (Quantity::FX, Coordinates::Hamiltonian, ComparedDerivative::FX),
    (Quantity::YFXX, Coordinates::Hamiltonian, ComparedDerivative::YFXX),
    (Quantity::FX, Coordinates::Lagrangian, ComparedDerivative::AZ),
    (Quantity::YFXX, Coordinates::Lagrangian, ComparedDerivative::YAZZ),
    (Quantity::TauZ, Coordinates::Lagrangian, ComparedDerivative::TauZ),
    (Quantity::YTauZZ, Coordinates::Lagrangian, ComparedDerivative::WTauZZ),
];

/// Derivatives by machine code, where there is any. Their rounding errors are those of the recorded programs.
pub(super) fn routes(robot: &Robot) -> Result<Vec<OtherRoute>, CodegenError> {
    let mut routes = Vec::new();
    for (quantity, coordinates, derivative) in QUANTITIES {
        let mut machine = JitQuantity::new(robot, quantity, coordinates)?;
        if matches!(machine.backend(), Backend::Generic { .. }) {
            continue;
        }
        let program = robot_program(robot, quantity, coordinates, &ProgramOptions::default())?;
        let evaluate = Box::new(move |inputs: &[f64], outputs: &mut [f64]| machine.evaluate(inputs, outputs));
        let mut work = Vec::new();
        let rounded = Box::new(move |inputs: &[_], outputs: &mut [_]| {
            match program.evaluate(inputs, outputs, &mut work) {
                Err(CodegenError::Eval(error)) => Err(error),
                _ => Ok(()),
            }
        });
        routes.push(OtherRoute::new(derivative, "machine code", evaluate, rounded));
    }
    Ok(routes)
}
