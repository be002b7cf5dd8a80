//! Engines of the quantities of a robot: machine code for one state and for four.

use crate::cores::{Core, Lanes};
use crate::engine::Engine;
use crate::words::in_python;
use costate::Coordinates;
use costate::codegen::{CodegenError, Quantity};
use costate::robot::Robot;
use costate_jit::{Backend, JitLanes, JitQuantity};
use std::sync::{Arc, OnceLock};

/// Machine code with fewer steps takes a few microseconds at most.
const SHORT: usize = 20_000;

/// The engine of a quantity, and what evaluates it, in words.
///
/// # Errors
/// A quantity that is not defined in these coordinates.
pub fn engine_of(
    robot: Arc<Robot>,
    quantity: Quantity,
    coordinates: Coordinates,
) -> Result<(Engine, String), CodegenError> {
    let code = JitQuantity::new(&robot, quantity, coordinates)?;
    let backend = in_python(&code.backend().to_string());
    let short = matches!(code.backend(), Backend::Compiled { steps, .. } if steps < SHORT);
    let compiled = OnceLock::new();
    let compile =
        move || JitLanes::new(&robot, quantity, coordinates).ok().and_then(Result::ok).map(Arc::new);
    let lanes = move || {
        let code: &Option<Arc<JitLanes>> = compiled.get_or_init(&compile);
        code.clone().map(|code| Box::new(code) as Box<dyn Lanes>)
    };
    let core = move || Box::new(code.clone()) as Box<dyn Core>;
    Ok((Engine::new(core).with_lanes(lanes).short(short), backend))
}
