//! Where files are.

/// Where the crate lies.
pub const FOLDER: &str = env!("CARGO_MANIFEST_DIR");
