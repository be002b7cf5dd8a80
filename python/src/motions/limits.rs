//! Limits of a motion that is solved again: other values, and derivatives by them and by masses.

use super::arrays::matrix;
use super::raise;
use super::resolve::ResolveCore;
use crate::errors::argument;
use costate::robot::LinkInertia;
use costate_control::{MotionParameter, Payload};
use pyo3::prelude::*;

/// Derivatives of cost, T, states (points, 2n) and torques (points, n).
type Derivative<'py> = (f64, f64, Bound<'py, PyAny>, Bound<'py, PyAny>);

/// A limit of a joint, by its number.
type OfJoint = fn(usize) -> MotionParameter;

/// Limits of one joint, by their keys.
const LIMITS: [(&str, OfJoint); 8] = [
    ("q_min", MotionParameter::PositionMin),
    ("q_max", MotionParameter::PositionMax),
    ("v_max", MotionParameter::VelocityMax),
    ("a_max", MotionParameter::AccelerationMax),
    ("torque_max", MotionParameter::TorqueMax),
    ("power_max", MotionParameter::PowerMax),
    ("jerk_max", MotionParameter::JerkMax),
    ("torque_rate_max", MotionParameter::TorqueRateMax),
];

/// The limit of all joints.
const TOTAL: &str = "total_power_max";

/// A limit by its key, of a joint from 0 or of all.
fn parameter(py: Python<'_>, limit: &str, joint: Option<usize>) -> PyResult<MotionParameter> {
    match (LIMITS.iter().find(|(name, _)| *name == limit), joint) {
        (Some((_, of)), Some(joint)) => Ok(of(joint)),
        (None, None) if limit == TOTAL => Ok(MotionParameter::TotalPowerMax),
        (Some(_), None) => Err(argument(py, "joint", format!("{limit} belongs to a joint; name it"))),
        (None, Some(_)) if limit == TOTAL => {
            Err(argument(py, "joint", format!("{TOTAL} belongs to all joints; leave the joint out")))
        }
        (None, _) => {
            let all = LIMITS.map(|(name, _)| name).join(", ");
            Err(argument(py, "limit", format!("there is no limit '{limit}'; give one of {all}, {TOTAL}")))
        }
    }
}

#[pymethods]
impl ResolveCore {
    /// Another value of a limit of a joint, or of all.
    fn set_limit(&self, py: Python<'_>, limit: &str, joint: Option<usize>, value: f64) -> PyResult<()> {
        let limit = parameter(py, limit, joint)?;
        self.set(py, |motion| motion.set_limit(&limit, value))
    }

    /// Derivatives by a limit of a joint, or of all: of cost, T, states (points, 2n) and torques (points, n).
    fn derivative_by_limit<'py>(
        &self,
        py: Python<'py>,
        limit: &str,
        joint: Option<usize>,
    ) -> PyResult<Option<Derivative<'py>>> {
        self.derivative_by(py, &parameter(py, limit, joint)?)
    }

    /// The same by the mass of a body that a frame carries: its mass, centre and six entries of inertia.
    fn derivative_by_mass<'py>(
        &self,
        py: Python<'py>,
        frame: &str,
        mass: f64,
        com: [f64; 3],
        inertia: [f64; 6],
    ) -> PyResult<Option<Derivative<'py>>> {
        let payload = Payload::new(frame, LinkInertia::from_entries(mass, com, inertia));
        self.derivative_by(py, &MotionParameter::PayloadMass(payload))
    }
}

impl ResolveCore {
    fn derivative_by<'py>(
        &self,
        py: Python<'py>,
        parameter: &MotionParameter,
    ) -> PyResult<Option<Derivative<'py>>> {
        let found = self.with(py, |motion| motion.derivative_by(parameter))?;
        let Some(found) = found.map_err(|error| raise::resolve(py, error))? else { return Ok(None) };
        let n = self.dof();
        let rows = |numbers: &[f64], columns: usize| {
            let rows: Vec<Vec<f64>> = numbers.chunks_exact(columns).map(<[f64]>::to_vec).collect();
            PyResult::Ok(matrix(py, &rows, columns)?.into_any())
        };
        let state = n * found.states.len() / found.torques.len();
        let (states, torques) = (rows(&found.states, state)?, rows(&found.torques, n)?);
        Ok(Some((found.cost, found.final_time, states, torques)))
    }
}
