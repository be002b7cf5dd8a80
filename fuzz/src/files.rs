//! Folders and files of the project.

use std::path::{Path, PathBuf};

/// The root of the project.
pub fn project() -> PathBuf {
    folder().join("..")
}

/// The folder of this package.
pub fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// Files of a folder, sorted; of any extension if it is empty.
pub fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
    let has =
        |path: &PathBuf| extension.is_empty() || path.extension().is_some_and(|found| found == extension);
    let mut files: Vec<PathBuf> = entries.filter(|path| path.is_file() && has(path)).collect();
    files.sort();
    files
}
