//! A problem file and the saved motion that it names.

use super::saved::Saved;
use costate::robot::LoadOptions;
use costate_control::{Key, Problem, ProblemFile, ProblemFileError, Solution, SolverOptions};
use std::path::Path;

/// The contents of a problem file.
pub struct Task {
    pub problem: Problem,
    pub options: SolverOptions,
    pub start_from: Option<Solution>,
    /// The text of the file.
    pub text: String,
}

impl Task {
    /// Reads a problem file, its robot and its saved motion.
    pub fn read(path: &Path, load: LoadOptions) -> Result<Self, ProblemFileError> {
        let file = ProblemFile::read(path, load)?;
        let joints = file.problem.robot.len();
        let saved = file.start_from.as_ref().map(|saved| Saved::read(saved, joints));
        let start_from = saved.transpose().map_err(|error| file.refuse(Key::START_FROM, error))?;
        let ProblemFile { problem, options, text, .. } = file;
        Ok(Self { problem, options, start_from, text })
    }
}
