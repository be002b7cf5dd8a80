//! A problem file and the saved motion that it names.

use crate::terminal;
use costate::robot::{LoadOptions, Robot, printable};
use costate_control::{Key, Problem, ProblemFile, Resolve, SolverOptions, Trajectory, TrajectoryError};
use std::error::Error;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A problem file with everything that it refers to.
pub struct Task {
    pub problem: Problem,
    pub options: SolverOptions,
    pub start_from: Option<Trajectory>,
    /// The text of the file.
    pub text: String,
    /// The robot file.
    pub robot_path: PathBuf,
    /// The problem file and the files that it names.
    pub inputs: Vec<PathBuf>,
}

impl Task {
    /// Reads a problem file, its robot and its saved motion; whether it also `feeds_back`.
    ///
    /// # Errors
    /// [`ProblemFileError`](costate_control::ProblemFileError), with file, line and key; also for a saved
    /// motion that does not fit the robot.
    pub fn read(path: &Path, load: LoadOptions, feeds_back: bool) -> Result<Self, Box<dyn Error>> {
        let file = ProblemFile::read(path, load)?;
        if feeds_back
            && let Err(error) = Resolve::takes(&file.problem)
            && let Some(key) = error.key()
        {
            let message = "--feedback does not take this; leave one of the two out";
            return Err(file.refuse(key, message).into());
        }
        let start = file.start_from.as_ref().map(|saved| read_start(saved, &file.problem.robot));
        let start_from = start.transpose().map_err(|error| file.refuse(Key::START_FROM, error))?;
        let inputs = [Some(path), Some(&file.robot_path), file.start_from.as_deref()];
        let inputs = inputs.into_iter().flatten().map(Path::to_path_buf).collect();
        let ProblemFile { problem, options, text, robot_path, .. } = file;
        Ok(Self { problem, options, start_from, text, robot_path, inputs })
    }
}

fn read_start(path: &Path, robot: &Robot) -> Result<Trajectory, String> {
    // One byte more than is read from: the library refuses it.
    let mut text = String::new();
    File::open(path)
        .and_then(|file| file.take(Trajectory::MOST_BYTES as u64 + 1).read_to_string(&mut text))
        .map_err(|error| format!("{}: cannot be read ({error}); check the path", path.display()))?;
    let trajectory = Trajectory::from_json(&text, robot).map_err(|error| match error {
        TrajectoryError::NotASolution { .. } | TrajectoryError::NoMotion { .. } => {
            format!("{}: {error}", path.display())
        }
        error => format!("{}: {error}; give a file that `costate optimize --save` wrote", path.display()),
    })?;
    if let Some(name) = Trajectory::saved_robot(&text).filter(|name| name != robot.name()) {
        terminal::warning(format!(
            "{}: a motion of robot '{}', and this is '{}'; their joints have the same names",
            path.display(),
            printable(&name),
            printable(robot.name())
        ));
    }
    Ok(trajectory)
}
