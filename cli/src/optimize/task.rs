//! A problem file and the saved motion that it names.

use crate::terminal;
use costate::robot::LoadOptions;
use costate_control::{Payload, Problem, ProblemFile, SolverOptions, Trajectory};
use std::error::Error;
use std::path::{Path, PathBuf};

/// A problem file with everything that it refers to.
pub struct Task {
    pub problem: Problem,
    pub options: SolverOptions,
    pub start_from: Option<Trajectory>,
    /// What the robot carries by the problem file.
    pub payloads: Vec<Payload>,
    /// The text of the file.
    pub text: String,
    /// The robot file.
    pub robot_path: Option<PathBuf>,
    /// The problem file and the files that it names.
    pub inputs: Vec<PathBuf>,
}

impl Task {
    /// Reads a problem file, its robot and its saved motion.
    ///
    /// # Errors
    /// [`ProblemFileError`](costate_control::ProblemFileError), with file, line and key; also for a saved
    /// motion that does not fit the robot.
    pub fn read(path: &Path, load: LoadOptions) -> Result<Self, Box<dyn Error>> {
        let file = ProblemFile::read(path, load)?;
        let saved = file.saved_motion()?;
        saved.iter().flat_map(|saved| &saved.warning).for_each(terminal::warning);
        let start_from = saved.map(|saved| saved.trajectory);
        let inputs = [Some(path), file.robot_path.as_deref(), file.start_from.as_deref()];
        let inputs = inputs.into_iter().flatten().map(Path::to_path_buf).collect();
        let ProblemFile { problem, options, payloads, text, robot_path, .. } = file;
        Ok(Self { problem, options, start_from, payloads, text, robot_path, inputs })
    }
}
