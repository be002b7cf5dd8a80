//! The saved motion that a problem file begins at.

#[cfg(feature = "toml")]
use crate::problem::file::{ProblemFile, ProblemFileError};
#[cfg(feature = "toml")]
use crate::problem::key::Key;
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::TrajectoryError;
use costate::robot::{Robot, printable};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// A saved motion.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SavedStart {
    /// The motion.
    pub trajectory: Trajectory,
    /// What is odd about it: the robot that it was saved for has another name.
    pub warning: Option<String>,
}

impl SavedStart {
    /// Reads a solution that was saved for a robot whose joints have the names of these.
    ///
    /// # Errors
    /// A sentence that names the file.
    pub fn read(path: &Path, robot: &Robot) -> Result<Self, String> {
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
        let other = Trajectory::saved_robot(&text).filter(|name| name != robot.name());
        let warning = other.map(|name| {
            format!(
                "{}: a motion of robot '{}', and this is '{}'; their joints have the same names",
                path.display(),
                printable(&name),
                printable(robot.name())
            )
        });
        Ok(Self { trajectory, warning })
    }
}

#[cfg(feature = "toml")]
impl ProblemFile {
    /// The motion of `[start_from]`.
    ///
    /// # Errors
    /// A file that cannot be read, or [is no motion](Trajectory::from_json) of this robot.
    pub fn saved_motion(&self) -> Result<Option<SavedStart>, ProblemFileError> {
        let Some(path) = &self.start_from else { return Ok(None) };
        let read = SavedStart::read(path, &self.problem.robot);
        read.map(Some).map_err(|error| self.refuse(Key::START_FROM, error))
    }
}
