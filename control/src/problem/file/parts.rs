//! Parts of a problem file by themselves: options of a solver, obstacles, references, orientations.

use super::document::Document;
use super::error::ProblemFileError;
use super::fault::Fault;
use super::table::Table;
use super::{obstacles, references, solver, tools};
use crate::options::SolverOptions;
use crate::problem::{Obstacle, Reference, ToolOrientation};

/// Reads the text of a table by itself; keys in errors have its name.
fn read<T>(
    text: &str,
    name: &str,
    read: impl FnOnce(&Table<'_>) -> Result<T, Fault>,
) -> Result<T, ProblemFileError> {
    let parse = || {
        let document = Document::parse(text)?;
        let mut root = document.root();
        root.path = Some(name.into());
        read(&root)
    };
    parse().map_err(|fault: Fault| fault.in_file(None))
}

impl SolverOptions {
    /// These options, with those that the text of a table `[solver]` gives. Another method has its own most
    /// steps.
    ///
    /// # Errors
    /// [`ProblemFileError`]: text that is not TOML, an unknown key, a value of the wrong type or out of
    /// range.
    ///
    /// ```
    /// use costate_control::{Method, SolverOptions};
    /// let options = SolverOptions::default().with_starts(3);
    /// let options = options.with_text("method = \"shooting\"\ntolerance = 1e-8")?;
    /// assert_eq!((options.method, options.starts), (Method::Shooting, Some(3)));
    /// # Ok::<(), costate_control::ProblemFileError>(())
    /// ```
    pub fn with_text(self, text: &str) -> Result<Self, ProblemFileError> {
        let options = read(text, "solver", |table| {
            table.only(solver::KEYS)?;
            solver::read(table, self)
        })?;
        options.check().map_err(|error| ProblemFileError::of_problem(None, error))?;
        Ok(options)
    }
}

impl Obstacle {
    /// An obstacle from the text of a table `[[obstacle]]`.
    ///
    /// # Errors
    /// [`ProblemFileError`]: text that is not TOML, an unknown or missing key, a value of the wrong type.
    pub fn from_text(text: &str) -> Result<Self, ProblemFileError> {
        read(text, "obstacle", |table| obstacles::obstacle(table, 0))
    }
}

impl Reference {
    /// A reference from the text of a table `[[cost.reference]]`.
    ///
    /// # Errors
    /// As [`Obstacle::from_text`].
    pub fn from_text(text: &str) -> Result<Self, ProblemFileError> {
        read(text, "cost.reference", references::reference)
    }
}

impl ToolOrientation {
    /// The orientation of a tool from the text of its keys: `rpy`, `rotation`, `quaternion`, `along` with
    /// `axis`, or `yaw`.
    ///
    /// # Errors
    /// As [`Obstacle::from_text`].
    ///
    /// ```
    /// use costate_control::ToolOrientation;
    /// let down = ToolOrientation::from_text("along = [0, 0, -1]")?;
    /// assert_eq!(down, ToolOrientation::Axis { axis: [0.0, 0.0, 1.0], along: [0.0, 0.0, -1.0] });
    /// # Ok::<(), costate_control::ProblemFileError>(())
    /// ```
    pub fn from_text(text: &str) -> Result<Self, ProblemFileError> {
        read(text, "tool", |table| {
            table.only(tools::ORIENTATION)?;
            table.need("rpy", tools::orientation(table)?)
        })
    }
}
