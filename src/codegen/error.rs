//! Why there is no program or no source text.

use crate::error::EvalError;

/// Why a computation was not recorded, evaluated or written down.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum CodegenError {
    /// An expression met a recording that is not its own.
    #[error(
        "an expression was used outside the recording that made it; \
         make every expression from the arguments of the function that is recorded"
    )]
    Foreign,
    /// The recorded function asked for the outcome of a comparison.
    #[error(
        "the recorded function branches on a value (Scalar::all of a comparison), so no straight code has its values; \
         use Scalar::select"
    )]
    Branch,
    /// More operations than the limit.
    #[error(
        "{name} takes {operations} operations, the limit is {limit}: its compilation would be slow. Raise the limit \
         (--limit {operations}), ask for a smaller quantity (y_f_x, y_f_xx_d or --only), or use the generic code or the \
         just-in-time compiler, which need no source text"
    )]
    TooLarge {
        /// The program.
        name: String,
        /// What it takes, [`Program::steps`](super::Program::steps).
        operations: usize,
        /// What is allowed.
        limit: usize,
    },
    /// A recording that was given up.
    #[error(
        "the recording was given up after {limit} operations; ask for a smaller quantity (y_f_x, y_f_xx_d), or use the \
         generic code"
    )]
    LongRecording {
        /// What is allowed.
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
    /// A name that source text cannot hold.
    #[error(
        "'{name}' cannot name {what} of generated code; use letters, digits and _, no keyword of Rust or C, each name once"
    )]
    Name {
        /// What it is the name of.
        what: &'static str,
        /// The name.
        name: String,
    },
    /// A quantity that is not defined in these coordinates.
    #[error("there is no {quantity} in {coordinates} coordinates; there are: {available}")]
    Quantity {
        /// What was asked for.
        quantity: &'static str,
        /// In which coordinates.
        coordinates: &'static str,
        /// What can be asked for.
        available: String,
    },
    /// A formula contains a number of which it is not known whether it depends on a parameter.
    #[error(
        "a constant of a formula is not made of known parameters: this is a mistake in costate, please report it"
    )]
    Constant,
    /// The recorded evaluation failed.
    #[error(transparent)]
    Eval(#[from] EvalError),
}
