//! Engines that all methods of an object share.

use crate::engine::Engine;
use crate::engines::engine_of;
use crate::errors::{CodegenError, unusable};
use crate::robot::Robot;
use crate::words::in_python;
use costate::codegen::{CodegenError as NoQuantity, Quantity};
use costate::{Coordinates, EvalError};
use pyo3::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// A quantity in its coordinates.
pub type Computed = (Quantity, Coordinates);

/// What computes a quantity, and the words about it.
#[derive(Clone)]
pub struct Known {
    of: Computed,
    pub engine: Arc<Engine>,
    pub backend: String,
}

/// The engines of the quantities that were asked for.
#[derive(Default)]
pub struct SharedEngines(Mutex<Vec<Known>>);

impl SharedEngines {
    /// The engine of a quantity of a robot, always the same one. It is compiled without the interpreter's
    /// lock.
    pub fn get(&self, py: Python<'_>, robot: &Robot, of: Computed) -> PyResult<Known> {
        py.detach(|| self.compiled(robot, of)).map_err(|error| match error {
            NoQuantity::Eval(refused @ EvalError::FreeJointAndWrench { .. }) => unusable(py, &refused),
            error => CodegenError::new_err(in_python(&error.to_string())),
        })
    }

    fn compiled(&self, robot: &Robot, of: Computed) -> Result<Known, NoQuantity> {
        let mut engines = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(known) = engines.iter().find(|known| known.of == of) {
            return Ok(known.clone());
        }
        let (engine, backend) = engine_of(robot.shared(), of.0, of.1)?;
        let known = Known { of, engine: Arc::new(engine), backend };
        engines.push(known.clone());
        Ok(known)
    }
}
