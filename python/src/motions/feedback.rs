//! The optimal feedback of a motion that is solved again.

use super::arrays::{matrices, numbers};
use crate::errors::argument;
use costate_control::Feedback;
use numpy::PyArray1;
use pyo3::prelude::*;

/// Derivatives of a motion by its ends.
#[pyclass(frozen, name = "_Feedback", module = "costate._costate")]
pub struct FeedbackCore(pub Feedback);

#[pymethods]
impl FeedbackCore {
    /// Numbers by their name.
    fn array<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let Self(feedback) = self;
        let (n, m) = (feedback.dof(), feedback.state());
        let all = |part: &dyn Fn(usize) -> Vec<f64>| -> Vec<f64> {
            (0..feedback.points()).flat_map(part).collect()
        };
        let vector = |numbers: &[f64]| Ok(PyArray1::from_slice(py, numbers).into_any());
        let (numbers, shape) = match name {
            "t" => return vector(&all(&|point| vec![feedback.time(point)])),
            "final_time_by_start" => return vector(feedback.time_by_start()),
            "final_time_by_end" => return vector(feedback.time_by_end()),
            "cost_gradient" => return vector(feedback.cost_gradient()),
            "cost_hessian" => (feedback.cost_hessian().to_vec(), [m, m]),
            "states_by_start" => (all(&|point| feedback.states_by_start(point).to_vec()), [m, m]),
            "states_by_end" => (all(&|point| feedback.states_by_end(point).to_vec()), [m, m]),
            "torques_by_start" => (all(&|point| feedback.torques_by_start(point).to_vec()), [n, m]),
            "torques_by_end" => (all(&|point| feedback.torques_by_end(point).to_vec()), [n, m]),
            _ => return Err(argument(py, "name", format!("there is no array '{name}'"))),
        };
        Ok(matrices(py, numbers, shape)?.into_any())
    }

    /// All numbers, from which `of` makes the same.
    fn numbers<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_vec(py, self.0.to_numbers())
    }

    /// Number of joints.
    #[getter]
    fn n(&self) -> usize {
        self.0.dof()
    }

    /// Of n joints, with these numbers.
    #[staticmethod]
    fn of(n: usize, given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let found = Feedback::from_numbers(n, &numbers(given, "numbers", None)?);
        let refused = || argument(given.py(), "numbers", "these are not the numbers of a feedback".into());
        found.map(Self).ok_or_else(refused)
    }

    /// K at times (s); None where accelerations are continuous.
    fn gain<'py>(&self, py: Python<'py>, times: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let (n, m) = (self.0.dof(), self.0.state());
        let times = numbers(times, "times", None)?;
        let mut all = vec![0.0; n * m * times.len()];
        for (&t, gain) in times.iter().zip(all.chunks_exact_mut(n * m)) {
            if !self.0.gain(t, gain) {
                return Ok(None);
            }
        }
        Ok(Some(matrices(py, all, [n, m])?.into_any()))
    }
}
