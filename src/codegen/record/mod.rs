//! Recording: a scalar whose operations become nodes.
//!
//! [`Expr`] is the scalar, `scalar` its operations; `recording` is the recording that runs on a thread,
//! `arena` its nodes, each distinct one once; `labels` are constants of a robot that are replaced by
//! parameters.

mod arena;
mod expr;
mod labels;
mod node;
mod recording;
mod scalar;
mod value;

pub(super) use arena::Arena;
pub use expr::{Expr, ExprMask};
pub use node::{Id, Node};
pub use recording::OPERATIONS_PER_STEP;
pub(super) use recording::{RecordingLimit, record, replace_labels};
pub(super) use value::{Signed, Value};
