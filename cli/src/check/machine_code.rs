//! Machine code as one more method.

use costate::codegen::{CodegenError, Coordinates, Quantity};
use costate::derivative::RecordedRoute;
use costate::robot::Robot;
use costate_jit::{Backend, JitQuantity};

/// What is compared.
const QUANTITIES: [(Quantity, Coordinates); 6] = [
    (Quantity::FX, Coordinates::Hamiltonian),
    (Quantity::YFXX, Coordinates::Hamiltonian),
    (Quantity::FX, Coordinates::Lagrangian),
    (Quantity::YFXX, Coordinates::Lagrangian),
    (Quantity::TauZ, Coordinates::Lagrangian),
    (Quantity::YTauZZ, Coordinates::Lagrangian),
];

/// Derivatives by machine code, where there is any.
pub(super) fn routes(robot: &Robot) -> Result<Vec<RecordedRoute>, CodegenError> {
    let mut routes = Vec::new();
    for (quantity, coordinates) in QUANTITIES {
        let mut machine = JitQuantity::new(robot, quantity, coordinates)?;
        if matches!(machine.backend(), Backend::Generic { .. }) {
            continue;
        }
        let evaluate = Box::new(move |inputs: &[f64], outputs: &mut [f64]| machine.evaluate(inputs, outputs));
        routes.push(RecordedRoute::new(robot, quantity, coordinates, "machine code", evaluate)?);
    }
    Ok(routes)
}
