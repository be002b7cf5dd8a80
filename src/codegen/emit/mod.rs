//! Source text of a program, in Rust and C.
//!
//! `text` has what both languages share; `runtime` holds the parts of the text that are the same for every
//! program, as files that the tests compile too.

pub(super) mod c;
mod rust;
mod text;

pub use c::{COptions, c_header, c_source};
pub use rust::RustOptions;
pub use text::DEFAULT_LIMIT;
