//! Problem files in TOML; `docs/optimize.md` describes the format.

pub(crate) mod document;
pub(crate) mod error;
mod fault;
mod gait;
mod given;
mod joints;
mod nested;
mod obstacles;
mod parts;
mod payloads;
mod per_joint;
mod phases;
mod references;
mod robot;
mod solver;
mod table;
mod tables;
mod task;
mod tools;

pub use error::{ProblemFileCause, ProblemFileError};

use crate::options::SolverOptions;
use crate::problem::file::document::{Document, MOST_BYTES};
use crate::problem::file::fault::Fault;
use crate::problem::file::robot::Source;
use crate::problem::key::Key;
use crate::problem::{Payload, Problem};
use costate::robot::{LoadOptions, Robot, RobotFormat, RobotText};
use std::error::Error;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// A problem file and the robot that it names.
///
/// ```
/// use costate_control::{ProblemFile, Solver};
/// use costate::robot::LoadOptions;
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let file = ProblemFile::read("examples/problems/pendulum_swing_up.toml", LoadOptions::default())?;
/// let solution = Solver::new(&file.problem, file.options.clone())?.solve();
/// assert!(solution.motion.status.is_converged());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct ProblemFile {
    /// The problem; it is [valid](Problem::check).
    pub problem: Problem,
    /// The options of the table `[solver]`, in range.
    pub options: SolverOptions,
    /// The robot file, relative paths resolved; `None` for a robot of the caller.
    pub robot_path: Option<PathBuf>,
    /// How the robot file was read: as the caller asks for, unless the keys `robot.friction`,
    /// `robot.floating_base` and `robot.quaternions` say otherwise.
    pub load: LoadOptions,
    /// The saved motion of `[start_from]`, relative paths resolved.
    pub start_from: Option<PathBuf>,
    /// What `[[robot.payload]]` adds to the robot, which is a part of [`Problem::robot`] already: bodies by
    /// whose masses a motion may be differentiated ([`Gains::with_payloads`](crate::Gains::with_payloads)).
    pub payloads: Vec<Payload>,
    /// The text of the file.
    pub text: String,
    path: Option<PathBuf>,
}

/// What a text does not say.
enum Given<'a> {
    /// How the robot file is loaded.
    Options(LoadOptions),
    /// The robot, and the text of its URDF.
    Robot(&'a Robot, Option<&'a str>),
}

impl ProblemFile {
    /// Reads a problem file and the robot that it names. Paths in the file are relative to its folder.
    ///
    /// # Errors
    /// A file that cannot be read, text of more than 1 MiB, text that is not TOML, an unknown or missing key,
    /// a value of the wrong type, an invalid robot or problem.
    pub fn read(path: impl AsRef<Path>, load: LoadOptions) -> Result<Self, ProblemFileError> {
        let path = path.as_ref();
        let at = |fault: Fault| fault.in_file(Some(path));
        let mut bytes = Vec::new();
        File::open(path)
            .and_then(|file| file.take(MOST_BYTES as u64 + 1).read_to_end(&mut bytes))
            .map_err(|error| at(ProblemFileCause::Unreadable(error).into()))?;
        if bytes.len() > MOST_BYTES {
            return Err(at(ProblemFileCause::TooLong { most: MOST_BYTES }.into()));
        }
        let text = String::from_utf8(bytes).map_err(|error| at(fault::not_utf8(&error)))?;
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(&text, folder, Given::Options(load), Some(path)).map_err(at)
    }

    /// Reads a problem from the text of a problem file. Paths in the text are relative to `folder`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn from_text(
        text: &str,
        folder: impl AsRef<Path>,
        load: LoadOptions,
    ) -> Result<Self, ProblemFileError> {
        Self::parse(text, folder.as_ref(), Given::Options(load), None).map_err(|fault| fault.in_file(None))
    }

    /// Reads a problem of this robot from the text of a problem file. The text need not name a robot file,
    /// and one that it names is not read; changes in `[robot]` are made to the robot. Other paths are
    /// relative to `folder`.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    ///
    /// ```
    /// use costate_control::ProblemFile;
    /// use costate::robot::Robot;
    /// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
    /// let robot = Robot::from_file("robots/pendulum.toml")?;
    /// let text = "start.q = [0.0]\nend.q = [3.0]\ntime.final = 1.0\ncost.effort = [1.0]";
    /// let file = ProblemFile::for_robot(text, &robot, "")?;
    /// assert_eq!(file.problem.robot, robot);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn for_robot(text: &str, robot: &Robot, folder: impl AsRef<Path>) -> Result<Self, ProblemFileError> {
        Self::for_robot_of_urdf(text, robot, None, folder)
    }

    /// The same for a robot that was read from the text of a URDF: that of its bodies where
    /// `collision.capsules = "urdf"` asks for them.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn for_robot_of_urdf(
        text: &str,
        robot: &Robot,
        urdf: Option<&str>,
        folder: impl AsRef<Path>,
    ) -> Result<Self, ProblemFileError> {
        let given = Given::Robot(robot, urdf);
        Self::parse(text, folder.as_ref(), given, None).map_err(|fault| fault.in_file(None))
    }

    fn parse(text: &str, folder: &Path, given: Given<'_>, path: Option<&Path>) -> Result<Self, Fault> {
        let document = Document::parse(text)?;
        let root = document.root();
        let source = if matches!(given, Given::Robot(..)) { Source::Caller } else { Source::File };
        let mut tables = tables::read(&root, source)?;
        let robot_path = tables.robot.file.as_ref().map(|file| folder.join(file));
        let path_of_robot = robot_path.as_deref().unwrap_or(Path::new(""));
        let load = match given {
            Given::Options(load) => tables.robot.options(load),
            Given::Robot(..) => LoadOptions::default(),
        };
        let robot = match given {
            Given::Options(_) => tables.robot.load(&root, path_of_robot, load)?,
            Given::Robot(robot, _) => tables.robot.changed(&root, robot, LoadOptions::default())?,
        };
        if obstacles::asks_for_urdf(&root)? {
            let read = match given {
                Given::Options(_) => Some(tables.robot.text(&root, path_of_robot)?),
                Given::Robot(..) => None,
            };
            let of_file = read.as_ref().filter(|read| read.format() == RobotFormat::Urdf);
            let urdf = if let Given::Robot(_, urdf) = given { urdf } else { of_file.map(RobotText::as_str) };
            obstacles::add_urdf(&root, urdf, &mut tables.task)?;
        }
        tables.task.payloads = tables.robot.payloads().to_vec();
        let in_document = |error| document.fault_of(error);
        let problem = tables.problem(robot).map_err(in_document)?;
        problem.check_for(tables.options.method).map_err(in_document)?;
        tables.options.check().map_err(in_document)?;
        Ok(Self {
            problem,
            options: tables.options,
            robot_path,
            load,
            payloads: tables.robot.payloads().to_vec(),
            start_from: tables.start_from.map(|file| folder.join(file)),
            text: text.into(),
            path: path.map(Path::to_path_buf),
        })
    }

    /// The error of a key whose value turned out to be wrong after reading, with file and line. For
    /// [`Key::START_FROM`], whose file is not read here.
    pub fn refuse(&self, key: Key, cause: impl Into<Box<dyn Error + Send + Sync>>) -> ProblemFileError {
        let line = Document::parse(&self.text).ok().and_then(|document| document.line_of(key));
        let cause = ProblemFileCause::Other(cause.into());
        Fault { line, key: Some(key.to_string()), cause: Box::new(cause) }.in_file(self.path.as_deref())
    }
}
