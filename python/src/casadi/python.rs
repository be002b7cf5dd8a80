//! What `costate.casadi` calls.

use super::family::Family;
use super::layout::PARTS;
use super::models::{Kind, Spec};
use super::slots::{self, SLOTS};
use crate::dynamics::coordinates_of;
use crate::errors::{CostateError, argument, robot as robot_error};
use crate::refusals::refuse_free_joints;
use crate::robot::Robot;
use crate::schemes::scheme_of;
use pyo3::prelude::*;
use std::ffi::{CStr, CString};

/// What a function computes, as `costate.casadi` gives it: its kind, the robot, the coordinates, the name of
/// a scheme or a frame, and the duration of a step.
type Given<'py> = (String, Robot, String, String, f64);

fn spec_of(py: Python<'_>, (kind, robot, letters, name, dt): Given<'_>) -> PyResult<Spec> {
    let coordinates = coordinates_of(py, &letters)?;
    if matches!(kind.as_str(), "dynamics" | "inverse_dynamics" | "step") {
        robot.refuse_constraints(py, "be a function of CasADi")?;
    }
    refuse_free_joints(py, robot.model(), "be a function of CasADi")?;
    let kind = match kind.as_str() {
        "dynamics" => Kind::Dynamics,
        "inverse_dynamics" => Kind::InverseDynamics,
        "step" => Kind::Step { scheme: scheme_of(py, &name, dt, coordinates)?, dt, coordinates },
        "frame" | "twist" => {
            let frame = robot.model().frame_index(&name).map_err(|error| robot_error(py, &error))?;
            if kind == "frame" { Kind::Frame(frame) } else { Kind::Twist(frame) }
        }
        "centre_of_mass" => Kind::CentreOfMass,
        _ => return Err(argument(py, "kind", format!("unknown function '{kind}'"))),
    };
    Ok(Spec { robot: robot.shared(), kind })
}

/// The function that a text describes, in a process with a Python interpreter.
pub fn read(text: &CStr) -> Option<Spec> {
    Python::try_attach(|py| {
        let module = py.import("costate.casadi").ok()?;
        let given = module.getattr("_read").ok()?.call1((text.to_str().ok()?,)).ok()?;
        spec_of(py, given.extract().ok()?).ok()
    })?
}

/// Holds a slot until CasADi has loaded its function.
#[pyclass(frozen, module = "costate._costate")]
pub struct _CasadiSlot {
    slot: usize,
}

#[pymethods]
impl _CasadiSlot {
    #[new]
    fn new(py: Python<'_>, given: Given<'_>, text: &str) -> PyResult<Self> {
        let spec = spec_of(py, given)?;
        let slot = slots::hold(spec, CString::new(text)?).ok_or_else(|| {
            CostateError::new_err(format!(
                "all {SLOTS} functions that CasADi can refer to at once are in use; delete some, with the \
                 functions and solvers that were made from them, or use one for several problems"
            ))
        })?;
        Ok(Self { slot })
    }

    /// The name of the function in the library.
    #[getter]
    fn name(&self) -> String {
        format!("costate_{}", self.slot)
    }
}

impl Drop for _CasadiSlot {
    fn drop(&mut self) {
        slots::remove_holder(self.slot);
    }
}

/// How often CasADi has evaluated a function, its Jacobian, its adjoint, the Jacobian of that, and of the
/// Jacobian.
#[pyfunction]
pub fn _casadi_calls(py: Python<'_>, name: &str) -> PyResult<[u64; PARTS]> {
    of_slot(py, name, Family::calls)
}

/// Why the last state that a function refused was refused.
#[pyfunction]
pub fn _casadi_refusal(py: Python<'_>, name: &str) -> PyResult<Option<String>> {
    of_slot(py, name, Family::refusal)
}

fn of_slot<R>(py: Python<'_>, name: &str, what: fn(&Family) -> R) -> PyResult<R> {
    let slot = name.rsplit_once("costate_").and_then(|(_, slot)| slot.parse().ok());
    let found = slot.filter(|slot| *slot < SLOTS).and_then(|slot| slots::look(slot, what));
    found.ok_or_else(|| argument(py, "function", format!("'{name}' is no function of costate.casadi")))
}

/// How many functions are in use, and how many can be.
#[pyfunction]
pub fn _casadi_slots() -> (usize, usize) {
    (slots::used(), SLOTS)
}
