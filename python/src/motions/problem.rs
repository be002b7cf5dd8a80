//! A problem: the text of a problem file, and the robot.

use super::program::ProgramCore;
use super::raise;
use super::resolve::ResolveCore;
use super::run::{Range, Run, Work};
use super::solution::SolutionCore;
use crate::errors;
use crate::notes::note;
use crate::recipe::{Recipe, is_rebuilding, named};
use crate::robot::Robot;
use costate::robot::LoadOptions;
use costate_control::{
    Parameter, Problem, ProblemFile, Resolve, RobotNames, SavedStart, Solution, Solver, SolverOptions,
    Trajectory, UnknownParameter,
};
use pyo3::prelude::*;
use pyo3::types::{PyTuple, PyType};
use std::ffi::CString;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::sync::Arc;

/// A problem with the options of its solver.
#[pyclass(frozen, name = "_Problem", module = "costate._costate")]
pub struct ProblemCore {
    problem: Arc<Problem>,
    options: SolverOptions,
    start: Option<Arc<Trajectory>>,
    /// The robot before the changes of the problem.
    robot: Robot,
    text: String,
    /// What changed since it was read.
    changes: Vec<(Parameter, f64)>,
}

/// How a robot file is read: friction, strict, floating_base, quaternions.
type Load = [bool; 4];

fn options_of([friction, strict, floating_base, quaternions]: Load) -> LoadOptions {
    let options = LoadOptions::default().friction(friction).strict(strict);
    options.floating_base(floating_base).quaternions(quaternions)
}

/// Where a solve begins: a solution, or a file that holds one.
#[derive(FromPyObject)]
pub enum Start<'py> {
    Solution(Bound<'py, SolutionCore>),
    File(PathBuf),
}

impl ProblemCore {
    /// The problem of the library.
    pub fn problem(&self) -> &Arc<Problem> {
        &self.problem
    }

    fn new(py: Python<'_>, file: ProblemFile, robot: Robot, start: Option<Trajectory>) -> PyResult<Self> {
        let saved = match &start {
            None => file.saved_motion().map_err(|error| raise::file(py, &error))?,
            Some(_) => None,
        };
        if let Some(warning) = saved.as_ref().and_then(|saved| saved.warning.as_ref()) {
            warn(py, warning)?;
        }
        for warning in file.problem.warnings() {
            let text = warning.to_string();
            match warning.is_note() {
                true if is_rebuilding() => {}
                true => note(py, &text)?,
                false => warn(py, &text)?,
            }
        }
        let start = start.or(saved.map(|saved| saved.trajectory)).map(Arc::new);
        let ProblemFile { problem, options, text, .. } = file;
        Ok(Self { problem: Arc::new(problem), options, start, robot, text, changes: Vec::new() })
    }

    /// The options, with those of a text.
    fn options(&self, py: Python<'_>, text: &str) -> PyResult<SolverOptions> {
        let options = self.options.clone().with_text(text);
        options.map_err(|error| raise::file(py, &error))
    }

    fn start(&self, py: Python<'_>, given: Option<Start<'_>>) -> PyResult<Option<Trajectory>> {
        Ok(match given {
            None => self.start.as_deref().cloned(),
            Some(Start::Solution(solution)) => Some(solution.get().solution().trajectory.clone()),
            Some(Start::File(path)) => {
                let saved = SavedStart::read(&path, &self.problem.robot);
                let saved = saved.map_err(|message| errors::argument(py, "start_from", message))?;
                if let Some(warning) = &saved.warning {
                    warn(py, warning)?;
                }
                Some(saved.trajectory)
            }
        })
    }
}

/// A parameter by its name.
fn parameter(py: Python<'_>, name: &str) -> PyResult<Parameter> {
    name.parse().map_err(|error: UnknownParameter| errors::argument(py, "parameter", error.to_string()))
}

/// Warns of what is odd, unless it was said when the problem was made first.
fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    if is_rebuilding() {
        return Ok(());
    }
    let text = CString::new(text.replace('\0', " "))?;
    PyErr::warn(py, &py.get_type::<raise::ProblemWarning>(), &text, 2)
}

#[pymethods]
impl ProblemCore {
    /// Of this robot; `start` is a saved motion as JSON.
    #[staticmethod]
    #[pyo3(signature = (robot, text, folder = PathBuf::new(), start = None))]
    fn of_robot(
        py: Python<'_>,
        robot: Robot,
        text: &str,
        folder: PathBuf,
        start: Option<&str>,
    ) -> PyResult<Self> {
        let urdf = robot.look.as_ref().map(|look| look.urdf());
        let file = ProblemFile::for_robot_of_urdf(text, robot.model(), urdf, folder);
        let file = file.map_err(|error| raise::file(py, &error))?;
        let start = start.map(|start| Trajectory::from_json(start, &file.problem.robot)).transpose();
        Self::new(py, file, robot, start.map_err(raise::motion)?)
    }

    /// Reads a problem file, its robot and its saved motion.
    #[classmethod]
    fn from_file(class: &Bound<'_, PyType>, path: PathBuf, load: Load) -> PyResult<Self> {
        let py = class.py();
        let file = py.detach(|| ProblemFile::read(&path, options_of(load)));
        Self::with_its_robot(py, file.map_err(|error| raise::file(py, &error))?)
    }

    /// The same of a text, whose paths are relative to a folder.
    #[classmethod]
    fn from_text(class: &Bound<'_, PyType>, text: &str, folder: PathBuf, load: Load) -> PyResult<Self> {
        let py = class.py();
        let file = py.detach(|| ProblemFile::from_text(text, folder, options_of(load)));
        Self::with_its_robot(py, file.map_err(|error| raise::file(py, &error))?)
    }

    /// The text of the problem file.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// What is odd about it, and what was done to pose it.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.problem.warnings().iter().map(ToString::to_string).collect()
    }

    /// The robot that moves, with the changes of the problem.
    pub fn robot(slf: &Bound<'_, Self>) -> PyResult<Robot> {
        let (py, this) = (slf.py(), slf.get());
        if *this.robot.model() == this.problem.robot {
            return Ok(this.robot.clone());
        }
        let problem = slf.clone();
        let recipe = Recipe::default().then(py, "_of_problem", named!(py, problem));
        let known = this.problem.robot.warnings().to_vec();
        let robot = Robot::warned(py, this.problem.robot.clone(), recipe, &known)?;
        Ok(robot.looking_like(this.robot.look.clone()))
    }

    /// Whether limits of the robot are left out since nothing is said about limits.
    fn leaves_out_limits(&self) -> bool {
        self.problem.leaves_out_robot_limits()
    }

    /// The options of the solver as JSON.
    fn options_json(&self) -> PyResult<String> {
        serde_json::to_string(&self.options).map_err(raise::motion)
    }

    /// Checks the problem and the options, and begins to solve it.
    #[pyo3(signature = (options, start_from, *, collect, times))]
    fn begin(
        &self,
        py: Python<'_>,
        options: &str,
        start_from: Option<Start<'_>>,
        collect: bool,
        times: bool,
    ) -> PyResult<Run> {
        let options = self.options(py, options)?;
        let start = self.start(py, start_from)?;
        let solver = Solver::new(&self.problem, options.clone());
        let solver = solver.map_err(|error| raise::problem(py, &error))?;
        if let Some(start) = &start {
            let checked = solver.with_start(start);
            drop(checked.map_err(|error| errors::argument(py, "start_from", error.to_string()))?);
        }
        Run::begin(self.problem.clone(), options, start, Work::Solve { times }, collect)
    }

    /// The problem with this value of a parameter.
    fn with_parameter(&self, py: Python<'_>, name: &str, value: f64) -> PyResult<Self> {
        let parameter = parameter(py, name)?;
        let problem = parameter.apply(&self.problem, value).map_err(|error| raise::problem(py, &error))?;
        let changes = self.changes.iter().copied().chain([(parameter, value)]).collect();
        let (options, start, text) = (self.options.clone(), self.start.clone(), self.text.clone());
        Ok(Self { problem: Arc::new(problem), options, start, robot: self.robot.clone(), text, changes })
    }

    /// Checks the problem and the options, and begins to follow its solutions while a parameter changes.
    #[pyo3(signature = (name, first, last, options, start_from, *, collect))]
    fn follow(
        &self,
        py: Python<'_>,
        name: &str,
        first: f64,
        last: f64,
        options: &str,
        start_from: Option<Start<'_>>,
        collect: bool,
    ) -> PyResult<Run> {
        let options = self.options(py, options)?;
        let start = self.start(py, start_from)?;
        let range = Range { parameter: parameter(py, name)?, first, last };
        let follower = range.continuation(&self.problem, options.clone());
        let follower = follower.map_err(|error| raise::problem(py, &error))?;
        if let Some(start) = &start {
            let checked = follower.with_start(start);
            drop(checked.map_err(|error| errors::argument(py, "start_from", error.to_string()))?);
        }
        Run::begin(self.problem.clone(), options, start, Work::Follow(range), collect)
    }

    /// Prepares the problem for being solved again and again, near a solution if there is one.
    fn resolve(
        &self,
        py: Python<'_>,
        options: &str,
        near: Option<Bound<'_, SolutionCore>>,
    ) -> PyResult<ResolveCore> {
        let options = self.options(py, options)?;
        let near = near.as_ref().map(|near| near.get().solution());
        let made = py.detach(|| match near {
            Some(near) => Resolve::near(&self.problem, options, &near.trajectory),
            None => Resolve::new(&self.problem, options),
        });
        Ok(ResolveCore::new(made.map_err(|error| raise::problem(py, &error))?))
    }

    /// The nonlinear program on the first mesh.
    fn nlp(&self, py: Python<'_>, options: &str) -> PyResult<ProgramCore> {
        let options = self.options(py, options)?;
        let made = py.detach(|| self.problem.nlp(&options));
        Ok(ProgramCore::new(made.map_err(|error| raise::problem(py, &error))?))
    }

    /// Reads what `_Solution.json` wrote, or, with all that it leaves out, `_Solution.complete`.
    fn solution(&self, text: &str, complete: bool, seconds: f64) -> PyResult<SolutionCore> {
        let read = match complete {
            true => Solution::from_complete_json(text),
            false => Solution::from_json(text),
        };
        let solution: Solution = read.map_err(raise::motion)?;
        solution.check_robot(&self.problem.robot).map_err(raise::motion)?;
        let names = [&solution.robot.robot[..], self.problem.robot.name()];
        if names[0] != names[1] {
            let [of, this] = names.map(|name| costate::robot::printable(name).to_string());
            return Err(raise::motion(format!(
                "the solution is one of robot '{of}'; the robot of the problem is '{this}'"
            )));
        }
        Ok(SolutionCore::new(self.problem.clone(), Arc::new(solution), seconds))
    }

    /// A solution that is one of this problem.
    fn adopt(&self, solution: &SolutionCore) -> SolutionCore {
        solution.of_problem(self.problem.clone())
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.problem == other.problem && self.options == other.options && self.start == other.start
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.robot.__hash__().hash(&mut hasher);
        self.problem.start.q.len().hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let (py, this) = (slf.py(), slf.get());
        let names = RobotNames::of(&this.problem.robot);
        let start = this.start.as_ref().map(|start| start.to_json(&names));
        let start = start.transpose().map_err(raise::motion)?;
        let (robot, text) = (Bound::new(py, this.robot.clone())?, &this.text);
        let mut recipe = Recipe::default().then(py, "of_robot", named!(py, robot, text, start));
        for (parameter, value) in &this.changes {
            let name = parameter.name();
            recipe.push("with_parameter", named!(py, name, value));
        }
        recipe.reduce(slf.get_type())
    }
}

impl ProblemCore {
    /// With the robot of a file, whose text goes into pickles.
    fn with_its_robot(py: Python<'_>, file: ProblemFile) -> PyResult<Self> {
        let LoadOptions { friction, floating_base, quaternions, .. } = file.load;
        let path = file.robot_path.clone().unwrap_or_default();
        let robot = Robot::from_file(py, path, friction, false, floating_base, quaternions)?;
        Self::new(py, file, robot, None)
    }
}
