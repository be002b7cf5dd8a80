//! Samples of a motion.

use super::arrays::matrix;
use crate::errors::argument;
use costate_control::Samples;
use numpy::PyArray1;
use pyo3::prelude::*;

/// Samples of a motion, and the names of the joints.
#[pyclass(frozen, name = "_Samples", module = "costate._costate")]
pub struct SamplesCore {
    samples: Samples,
    joints: Vec<String>,
}

impl SamplesCore {
    /// Of joints with these names.
    pub fn new(samples: Samples, joints: Vec<String>) -> Self {
        Self { samples, joints }
    }

    /// The names of the entries of q: those of the joints without quaternions.
    fn names(&self) -> &[String] {
        if self.samples.positions.is_empty() { &self.joints } else { &self.samples.positions }
    }
}

#[pymethods]
impl SamplesCore {
    /// Of arrays: times, then rows of q, v, a, tau and u, the phases, and the names of the entries of q and
    /// of the joints.
    #[staticmethod]
    fn of(
        t: Vec<f64>,
        rows: [Vec<Vec<f64>>; 5],
        phase: Vec<usize>,
        positions: Vec<String>,
        joints: Vec<String>,
    ) -> PyResult<Self> {
        let mut samples = Samples::default();
        (samples.rate, samples.t, samples.phase) = (f64::NAN, t, phase);
        let fit = |rows: &[Vec<f64>], columns: usize| {
            rows.len() == samples.t.len() && rows.iter().all(|row| row.len() == columns)
        };
        if !(fit(&rows[0], positions.len()) && rows[1..].iter().all(|rows| fit(rows, joints.len()))) {
            return Err(super::raise::motion("arrays of samples whose shapes do not fit each other"));
        }
        if positions != joints {
            samples.positions = positions;
        }
        [samples.q, samples.v, samples.a, samples.tau, samples.u] = rows;
        Ok(Self { samples, joints })
    }

    /// One of t, q, v, a, tau, u and phase.
    fn array<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Samples { t, q, v, a, tau, u, phase, .. } = &self.samples;
        let rows = match name {
            "t" => return Ok(PyArray1::from_slice(py, t).into_any()),
            "phase" => {
                let phase = phase.iter().map(|&phase| phase as i64);
                return Ok(PyArray1::from_iter(py, phase).into_any());
            }
            "q" => q,
            "v" => v,
            "a" => a,
            "tau" => tau,
            "u" => u,
            _ => return Err(argument(py, "name", format!("there is no array '{name}'"))),
        };
        let names = if name == "q" { self.names() } else { &self.joints };
        Ok(matrix(py, rows, names.len())?.into_any())
    }

    /// The names of the entries of q.
    fn positions(&self) -> Vec<String> {
        self.names().to_vec()
    }

    /// The table in CSV.
    fn csv(&self) -> String {
        self.samples.to_csv(&self.joints)
    }
}
