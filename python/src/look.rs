//! What a robot looks like and touches with: the models of the URDF that it was read from.

use costate::robot::{RobotError, RobotFormat};
use costate_report::models::{Models, of_urdf};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The text of a URDF, and the folder in which relative paths of meshes begin.
pub struct Look {
    text: String,
    folder: PathBuf,
}

impl Look {
    /// That of a description; `None` for one that is no URDF.
    pub fn new(text: &str, format: RobotFormat, path: Option<&Path>) -> Option<Arc<Self>> {
        if format != RobotFormat::Urdf {
            return None;
        }
        // Absolute: the process may change its folder.
        let path = path.map(|path| std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf()));
        let folder = path.as_deref().and_then(Path::parent).unwrap_or(Path::new("")).to_path_buf();
        Some(Arc::new(Self { text: text.to_owned(), folder }))
    }

    /// The text of the URDF.
    pub fn urdf(&self) -> &str {
        &self.text
    }

    /// The models, with a sentence for each mesh that cannot be read.
    pub fn models(&self, packages: &[PathBuf]) -> Result<Models, RobotError> {
        of_urdf(&self.text, &self.folder, packages)
    }
}
