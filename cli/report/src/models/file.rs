//! From the name of a mesh in a URDF to its file and its triangles.

use super::mesh::Mesh;
use super::{dae, obj, stl};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// Largest file (bytes).
const MOST_BYTES: u64 = 256 << 20;

/// The path of a mesh.
pub fn find(name: &str, folder: &Path, packages: &[PathBuf]) -> Result<PathBuf, String> {
    let name = name.strip_prefix("file://").unwrap_or(name);
    let Some(rest) = name.strip_prefix("package://").or_else(|| name.strip_prefix("model://")) else {
        return Ok(folder.join(name));
    };
    let (package, path) = rest.split_once('/').unwrap_or((rest, ""));
    let in_folder = |base: &Path| -> Option<PathBuf> {
        let inside = base.join(package).join(path);
        let itself = || base.file_name().is_some_and(|last| last == package).then(|| base.join(path));
        Some(inside).filter(|path| path.is_file()).or_else(itself).filter(|path| path.is_file())
    };
    let folder = folder.canonicalize().unwrap_or_else(|_| folder.to_path_buf());
    let above = folder.ancestors();
    packages.iter().map(PathBuf::as_path).chain(above).find_map(in_folder).ok_or_else(|| {
        format!("package '{package}' with this file was not found; give its folder with --package-path")
    })
}

/// The triangles of a file.
pub fn read(path: &Path) -> Result<Mesh, String> {
    let shown = path.display();
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    let reader: fn(&[u8]) -> Result<Mesh, String> = match extension.as_deref() {
        Some("stl") => stl::read,
        Some("obj") => obj::read,
        Some("dae") => dae::read,
        _ => return Err(format!("{shown}: is not read; convert it to one of STL, OBJ and COLLADA (.dae)")),
    };
    let mut bytes = Vec::new();
    File::open(path)
        .and_then(|file| file.take(MOST_BYTES + 1).read_to_end(&mut bytes))
        .map_err(|error| format!("{shown}: cannot be read ({error}); check the path"))?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(format!("{shown}: has more than {} MiB; give a coarser mesh", MOST_BYTES >> 20));
    }
    reader(&bytes).map_err(|reason| format!("{shown}: {reason}"))
}
