//! A solution with its problem.

use super::arrays::{matrix, numbers};
use super::raise;
use super::samples::SamplesCore;
use super::steps::{Step, step};
use crate::errors::{argument, robot, unreadable};
use crate::look::Look;
use crate::robot::Robot;
use crate::words::in_python;
use costate::robot::{RobotFormat, printable};
use costate_control::{CostDerivative, Gains, Problem, Solution, Trajectory, cost_by_parameters};
use costate_report::models::LinkModel;
use costate_report::{ReportOptions, report, stage_json};
use numpy::PyArray1;
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A solution, the problem that it solves, and how long that took (s).
#[pyclass(frozen, name = "_Solution", module = "costate._costate")]
pub struct SolutionCore {
    problem: Arc<Problem>,
    solution: Arc<Solution>,
    seconds: f64,
}

impl SolutionCore {
    pub fn new(problem: Arc<Problem>, solution: Arc<Solution>, seconds: f64) -> Self {
        Self { problem, solution, seconds }
    }

    /// The same as one of another problem.
    pub fn of_problem(&self, problem: Arc<Problem>) -> Self {
        Self { problem, solution: self.solution.clone(), seconds: self.seconds }
    }

    /// The solution of the library.
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// How links look: as a URDF says, or else that of the robot; and what is missing of it.
    fn options(
        py: Python<'_>,
        of: &Robot,
        urdf: Option<PathBuf>,
        packages: &[PathBuf],
    ) -> PyResult<(ReportOptions, Vec<String>)> {
        let found = match (urdf, &of.look) {
            (Some(path), _) => {
                let content = std::fs::read_to_string(&path).map_err(|error| unreadable(&path, &error))?;
                let look = Look::new(&content, RobotFormat::Urdf, Some(&path));
                let found = look.map(|look| look.models(packages)).transpose();
                let found = found.map_err(|error| robot(py, &error))?.unwrap_or_default();
                let unknown = |model: &LinkModel| of.model().frame(&model.link).is_err();
                if !found.links.is_empty() && found.links.iter().all(unknown) {
                    let (path, name) = (path.display(), printable(of.model().name()));
                    let message = format!(
                        "{path} has no visual model of a link of '{name}'; give a URDF of this robot"
                    );
                    return Err(argument(py, "urdf", message));
                }
                Some(found)
            }
            // The robot was read: what is wrong with its models alone is no error.
            (None, Some(look)) => match look.models(packages) {
                Ok(found) => Some(found),
                Err(error) => {
                    return Ok((
                        ReportOptions::default(),
                        vec![format!("visual models are left out: {error}")],
                    ));
                }
            },
            (None, None) => None,
        };
        let found = found.unwrap_or_default();
        let missing = found.warnings.iter().map(|warning| in_python(warning)).collect();
        Ok((ReportOptions::default().with_models(found.links), missing))
    }
}

#[pymethods]
impl SolutionCore {
    /// How long solving took (s).
    #[getter]
    fn seconds(&self) -> f64 {
        self.seconds
    }

    /// Name of the status.
    #[getter]
    fn status(&self) -> &str {
        self.solution.motion.status.name()
    }

    /// The status in words; what helps, or would have to give, where the problem is not solved.
    #[getter]
    fn message(&self) -> String {
        in_python(&self.solution.message(&self.problem))
    }

    /// The report of the motion as HTML, with the visual models of a URDF or of the robot, and what is
    /// missing of these.
    fn html(
        &self,
        py: Python<'_>,
        robot: &Robot,
        urdf: Option<PathBuf>,
        packages: Vec<PathBuf>,
    ) -> PyResult<(String, Vec<String>)> {
        let (options, warnings) = Self::options(py, robot, urdf, &packages)?;
        Ok((in_python(&report(&self.problem, &self.solution, &options)), warnings))
    }

    /// What the stage of the report shows, as JSON, and what is missing.
    fn stage(
        &self,
        py: Python<'_>,
        robot: &Robot,
        urdf: Option<PathBuf>,
        packages: Vec<PathBuf>,
    ) -> PyResult<(String, Vec<String>)> {
        let (options, warnings) = Self::options(py, robot, urdf, &packages)?;
        Ok((stage_json(&self.problem, &self.solution, &options), warnings))
    }

    /// Whether the motion is a solution of the problem, or of its smoothed form: no remark is an error.
    #[getter]
    fn solved(&self) -> bool {
        self.solution.check(&self.problem).is_ok()
    }

    /// J.
    #[getter]
    fn cost(&self) -> f64 {
        self.solution.motion.cost
    }

    /// T (s).
    #[getter]
    fn final_time(&self) -> f64 {
        self.solution.motion.final_time
    }

    /// The JSON object without the motion itself.
    fn figures_json(&self) -> PyResult<String> {
        let mut figures = (*self.solution).clone();
        let mut motion = Trajectory::default();
        motion.via_times = std::mem::take(&mut figures.trajectory.via_times);
        figures.trajectory = motion;
        figures.to_json().map_err(raise::motion)
    }

    /// The JSON object of the command line, without what it prints only.
    fn json(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.solution.to_json_with_remarks(&self.problem)).map_err(raise::motion)
    }

    /// The solution with all that it leaves out, for pickles.
    fn complete(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.solution.to_complete_json()).map_err(raise::motion)
    }

    /// Numbers at the nodes: t, q, v, p, u, y_q, y_p, hamiltonian.
    fn array<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let (trajectory, robot) = (&self.solution.trajectory, &self.problem.robot);
        let rows = match name {
            "t" => return Ok(PyArray1::from_slice(py, &trajectory.t).into_any()),
            "hamiltonian" => return Ok(PyArray1::from_slice(py, &trajectory.hamiltonian).into_any()),
            "q" => &trajectory.q,
            "v" => &trajectory.v,
            "p" => &trajectory.p,
            "u" => &trajectory.u,
            "y_q" => &trajectory.y_q,
            "y_p" => &trajectory.y_p,
            _ => return Err(argument(py, "name", format!("there is no array '{name}'"))),
        };
        Ok(matrix(py, rows, if name == "q" { robot.nq() } else { robot.dof() })?.into_any())
    }

    /// Accelerations at the nodes.
    fn accelerations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rows = py.detach(|| self.solution.accelerations(&self.problem));
        let rows = rows.map_err(|error| raise::sample(py, error))?;
        Ok(matrix(py, &rows, self.problem.robot.dof())?.into_any())
    }

    /// tau = gain u: the factors.
    fn gain<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.problem.gain)
    }

    /// Estimated errors: of the cost, or of each component.
    fn errors<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.solution.motion.errors)
    }

    /// The Newton steps.
    fn iterations(&self) -> Vec<Step> {
        self.solution.motion.iterations.iter().map(step).collect()
    }

    /// Seconds of the stages of the direct method, if they were taken.
    fn stage_times(&self) -> Option<Vec<(&'static str, f64)>> {
        Some(self.solution.stage_times?.named().to_vec())
    }

    /// What there is to say about the motion, as a list of JSON objects.
    fn remarks_json(&self) -> PyResult<String> {
        let mut remarks = self.solution.remarks(&self.problem);
        remarks.iter_mut().for_each(|remark| remark.text = in_python(&remark.text));
        serde_json::to_string(&remarks).map_err(raise::motion)
    }

    /// At a rate (Hz).
    fn sample(&self, py: Python<'_>, rate: f64) -> PyResult<SamplesCore> {
        let samples = py.detach(|| self.solution.sample(&self.problem, rate));
        let samples = samples.map_err(|error| raise::sample(py, error))?;
        Ok(SamplesCore::new(samples, self.solution.robot.joints.clone()))
    }

    /// At times (s).
    fn sample_at(&self, py: Python<'_>, times: &Bound<'_, PyAny>) -> PyResult<SamplesCore> {
        let times = numbers(times, "times", None)?;
        if let [start, .., end] = self.solution.trajectory.t[..] {
            let rounding = 1e-9 * (end - start);
            let on = |t: &f64| (start - rounding..=end + rounding).contains(t);
            if let Some(t) = times.iter().find(|t| !on(t)) {
                let message = format!("the time {t} s is not on the motion, from {start} to {end} s");
                return Err(argument(py, "times", message));
            }
        }
        let samples = py.detach(|| self.solution.sample_at(&self.problem, &times));
        let samples = samples.map_err(|error| raise::sample(py, error))?;
        Ok(SamplesCore::new(samples, self.solution.robot.joints.clone()))
    }

    /// The optimal feedback as JSON, at a rate (Hz) or at the points of the motion.
    fn gains_json(&self, py: Python<'_>, rate: Option<f64>) -> PyResult<String> {
        let gains = py.detach(|| Gains::new(&self.problem, &self.solution, rate));
        let gains = gains.map_err(|error| raise::gains(py, error))?;
        serde_json::to_string(&gains).map_err(raise::motion)
    }

    /// Name, value and derivative of the cost, for each parameter of the robot.
    fn sensitivities(&self, py: Python<'_>) -> PyResult<Vec<(String, f64, f64)>> {
        let set = self.problem.parameters();
        let found = py.detach(|| cost_by_parameters(&self.problem, &self.solution, &set));
        let found = found.map_err(|error| raise::sensitivity(py, error))?;
        let row = |of: CostDerivative| (of.name, of.value, of.derivative);
        Ok(found.into_iter().map(row).collect())
    }
}
