//! Arguments that several commands share.

use crate::edits::EditArguments;
use crate::output::is_standard;
use crate::terminal;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum, ValueHint};
use costate::Coordinates;
use costate::robot::{LoadOptions, Robot, RobotError, RobotFormat};
use std::io::{BufRead, Read};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// The robot and how to read it.
#[derive(Args)]
pub struct RobotArguments {
    /// Robot file (.urdf or .toml), or - for standard input
    #[arg(value_hint = ValueHint::FilePath)]
    robot: PathBuf,
    /// Format of the robot file [default: by its extension; for standard input, URDF if the text starts with
    /// <]
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// Refuse robots with warnings that suggest a mistake (unknown elements or attributes, massless links,
    /// missing or swapped limits, inertias that no rigid body has)
    #[arg(long)]
    strict: bool,
    /// Load <dynamics damping friction> of a URDF as viscous and smooth Coulomb friction
    #[arg(long)]
    friction: bool,
    /// Let the root link of a URDF float: it moves by a floating joint, `root_joint`, with a quaternion
    #[arg(long)]
    floating_base: bool,
    /// Read joints of type `floating` of a URDF as such, with quaternions, not as six joints
    #[arg(long)]
    quaternions: bool,
    #[command(flatten)]
    edits: EditArguments,
}

#[derive(Clone, Copy, ValueEnum)]
enum Format {
    Urdf,
    Toml,
}

impl RobotArguments {
    /// The path, which may be `-`.
    pub fn path(&self) -> &Path {
        &self.robot
    }

    /// How to read the robot.
    pub fn options(&self) -> LoadOptions {
        LoadOptions::default()
            .strict(self.strict)
            .friction(self.friction)
            .floating_base(self.floating_base)
            .quaternions(self.quaternions)
    }

    /// Reads the robot, and changes it as the flags say.
    ///
    /// # Errors
    /// [`RobotError::InFile`] with the path, or `standard input`, and the line where it is known; the errors
    /// of [`Robot::edited`].
    pub fn load(&self) -> Result<Robot, RobotError> {
        let edits = self.edits.edits();
        if edits.is_empty() {
            return self.read(self.options());
        }
        // Changes may mend what strict loading would refuse.
        self.read(self.options().strict(false))?.edited(&edits, self.options())
    }

    fn read(&self, options: LoadOptions) -> Result<Robot, RobotError> {
        let from_input = is_standard(&self.robot);
        if !from_input && self.format.is_none() {
            self.warn_of_flags(RobotFormat::of_path(&self.robot).ok());
            return Robot::from_file_with(&self.robot, options);
        }
        let path = if from_input { PathBuf::from("standard input") } else { self.robot.clone() };
        let in_file = |error| match error {
            RobotError::InFile { line, error, .. } => RobotError::InFile { path: path.clone(), line, error },
            error => RobotError::InFile { path: path.clone(), line: None, error: Box::new(error) },
        };
        let unreadable = |source| in_file(RobotError::Unreadable { source });
        let read = |source: &mut dyn Read, format| Robot::read(source, format, options).map_err(in_file);
        let format = self.format.map(RobotFormat::from);
        if !from_input {
            let mut file = std::fs::File::open(&self.robot).map_err(unreadable)?;
            self.warn_of_flags(format);
            return read(&mut file, format.unwrap_or(RobotFormat::Toml));
        }
        let mut input = std::io::BufReader::new(std::io::stdin().lock());
        let start = input.fill_buf().map_err(unreadable)?;
        let format = format.unwrap_or_else(|| RobotFormat::of_text(&String::from_utf8_lossy(start)));
        self.warn_of_flags(Some(format));
        read(&mut input, format)
    }

    fn warn_of_flags(&self, format: Option<RobotFormat>) {
        warn_of_urdf_flags(format, [self.friction, self.floating_base, self.quaternions]);
    }

    /// Reads a robot of any joints, without constraints, and writes its warnings to standard error.
    ///
    /// # Errors
    /// As [`load`](Self::load); [`RobotError::Constrained`].
    pub fn load_tree_and_warn(&self) -> Result<Robot, RobotError> {
        let robot = self.load_any_and_warn()?;
        match robot.constraints().first() {
            None => Ok(robot),
            Some(constraint) => {
                let constraint = constraint.name.clone();
                Err(RobotError::Constrained { constraint, what: "be taken by this command" })
            }
        }
    }

    /// Reads any robot and writes its warnings to standard error.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn load_any_and_warn(&self) -> Result<Robot, RobotError> {
        let robot = self.load()?;
        terminal::about_robot(&robot);
        Ok(robot)
    }
}

impl From<Format> for RobotFormat {
    fn from(format: Format) -> Self {
        match format {
            Format::Urdf => Self::Urdf,
            Format::Toml => Self::Toml,
        }
    }
}

/// Warns of `--friction`, `--floating-base` and `--quaternions` where they are given for a robot in TOML, on
/// which they have no effect.
pub fn warn_of_urdf_flags(format: Option<RobotFormat>, given: [bool; 3]) {
    let floats = "; give its joint type = \"floating\" there";
    let flags =
        [("friction", ", whose friction always counts"), ("floating-base", floats), ("quaternions", floats)];
    let is_toml = format == Some(RobotFormat::Toml);
    for ((flag, instead), _) in flags.iter().zip(given).filter(|(_, given)| *given && is_toml) {
        terminal::warning(format!("--{flag} has no effect on a robot in TOML{instead}"));
    }
}

/// Parser of arguments that are finite positive numbers.
///
/// # Errors
/// A message that says what is expected.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("must be a finite positive number".into()),
    }
}

/// Parser of arguments that are whole numbers, 0 included.
///
/// # Errors
/// A message that says what is expected.
pub fn whole(text: &str) -> Result<usize, String> {
    text.parse().map_err(|_| format!("must be a whole number from 0 to {}", usize::MAX))
}

/// Parser of arguments that are whole numbers, 1 or more.
///
/// # Errors
/// A message that says what is expected.
pub fn count(text: &str) -> Result<NonZeroUsize, String> {
    text.parse().map_err(|_| "must be a whole number, 1 or more".to_owned())
}

/// Parser of coordinates; `help` says what Hamiltonian and Lagrangian coordinates mean to the command.
pub fn coordinates(help: [&'static str; 2]) -> impl TypedValueParser<Value = Coordinates> {
    let named = |(coordinates, help): (Coordinates, _)| {
        let short = coordinates.short_name();
        PossibleValue::new(coordinates.name()).alias(short).help(format!("or {short}: {help}"))
    };
    PossibleValuesParser::new(Coordinates::ALL.into_iter().zip(help).map(named))
        .try_map(|name| name.parse::<Coordinates>())
}

#[cfg(test)]
mod tests {
    use super::{count, positive, whole};

    #[test]
    fn only_finite_positive_numbers_are_taken() {
        assert_eq!(positive("1e-12"), Ok(1e-12));
        for text in ["0", "-1", "nan", "inf", "1e999", "soon", ""] {
            assert!(positive(text).is_err(), "{text}");
        }
        assert_eq!((whole("3"), whole("0")), (Ok(3), Ok(0)));
        assert_eq!(count("3").map(usize::from), Ok(3));
        for text in ["0", "-1", "1.5", ""] {
            assert!(count(text).is_err_and(|reason| reason.contains("1 or more")), "{text}");
        }
        for text in ["-1", "1.5", "q", ""] {
            assert!(whole(text).is_err_and(|reason| reason.starts_with("must be a whole number")), "{text}");
        }
    }
}
