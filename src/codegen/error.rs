//! Errors of recording and writing programs.

use crate::error::EvalError;

/// Why a computation could not be recorded, evaluated or written as source text.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CodegenError {
    /// An expression was used in a recording that is not its own.
    #[error(
        "an expression was used outside the recording that made it; \
         make every expression from the arguments of the function that is recorded"
    )]
    Foreign,
    /// The recorded function branches on the outcome of a comparison.
    #[error(
        "the recorded function branches on a value (Scalar::all of a comparison), which straight-line code cannot do; \
         use Scalar::select"
    )]
    Branch,
    /// A program that is longer than the limit.
    #[error(
        "{name} has {steps} steps, the limit is {limit}: compiling it would be slow. Raise the limit (--limit {steps}), \
         choose a smaller quantity (y_f_x, y_f_xx_d or --only), or use the generic code or the just-in-time compiler, \
         which need no source text"
    )]
    TooLarge {
        /// The program.
        name: String,
        /// Its length, [`Program::steps`](super::Program::steps).
        steps: usize,
        /// The limit.
        limit: usize,
    },
    /// A recording that was stopped.
    #[error(
        "{name}: the recording was stopped after {operations} operations; the program would be too long, the limit is \
         {limit} steps. Raise the limit (--limit), choose a smaller quantity (f, y_f_x, y_f_xx_d or --only), or use the \
         generic code, which has no limit"
    )]
    LongRecording {
        /// The program.
        name: String,
        /// Operations that were recorded.
        operations: usize,
        /// Most steps of the program.
        limit: usize,
    },
    /// A robot that is too large to record a quantity that contains its mass matrix.
    #[error(
        "{robot} has {joints} joints: its mass matrix alone has {entries} entries, too many for a program of at most \
         {limit} steps. Raise the limit (--limit), or use the generic code, which has no limit"
    )]
    LargeRobot {
        /// The robot.
        robot: String,
        /// Number of its joints.
        joints: usize,
        /// Entries of its mass matrix, each pair of symmetric ones once, without those that are zero for
        /// every robot with this tree.
        entries: usize,
        /// Most steps of the program.
        limit: usize,
    },
    /// A result whose entries do not fill its rows and columns.
    #[error("result {name} has {found} entries, not {rows} x {columns}")]
    Shape {
        /// The result.
        name: String,
        /// Rows it has.
        rows: usize,
        /// Columns it has.
        columns: usize,
        /// Entries it has.
        found: usize,
    },
    /// A name that source text cannot have.
    #[error(
        "'{name}' cannot name {what} of generated code; use letters, digits and _, no keyword of Rust or C, each name once"
    )]
    Name {
        /// The named item.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A quantity that is not defined in these coordinates.
    #[error("there is no {quantity} in {coordinates} coordinates; available: {available}")]
    Quantity {
        /// The quantity.
        quantity: &'static str,
        /// The coordinates.
        coordinates: &'static str,
        /// The quantities that are defined in these coordinates.
        available: String,
    },
    /// A formula contains a number that is neither made of known parameters nor independent of them.
    #[error(
        "a constant of a formula is not made of known parameters: this is a mistake in costate, please report it"
    )]
    Constant,
    /// The recorded evaluation failed.
    #[error(transparent)]
    Eval(#[from] EvalError),
}
