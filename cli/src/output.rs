//! Output files that are written whole or not at all.
//!
//! [`Output::prepare`] checks a path before the work starts, [`Output::write`] writes the text to a temporary
//! file in the same folder and renames it. A failure on the way leaves an existing file as it was.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Stands for standard input or standard output where a path is expected.
pub const STANDARD: &str = "-";

/// Whether a path stands for standard input or standard output.
pub fn is_standard(path: &Path) -> bool {
    path == Path::new(STANDARD)
}

/// A file, or standard output, that was checked to be writable.
#[derive(Debug)]
pub struct Output {
    /// As the user wrote it, for messages.
    name: PathBuf,
    target: Target,
}

#[derive(Debug)]
enum Target {
    StandardOutput,
    /// A device or a pipe, which a rename would replace.
    Direct(PathBuf),
    /// An ordinary file, behind all symbolic links.
    File(PathBuf),
}

impl Output {
    /// Checks that `path` can be written and is none of the `inputs`; `-` is standard output.
    ///
    /// # Errors
    /// A message that names the path: it is a folder, an input or read-only, or its folder is missing or not
    /// writable.
    pub fn prepare(path: &Path, inputs: &[&Path]) -> Result<Self, String> {
        let name = path.to_owned();
        if is_standard(path) {
            return Ok(Self { name, target: Target::StandardOutput });
        }
        if let Some(input) = inputs.iter().find(|input| is_same_file(path, input)) {
            return Err(format!(
                "{}: is the input file {}; choose another output file",
                path.display(),
                input.display()
            ));
        }
        let failed = |error: io::Error| unwritable(path, &error);
        let target = match fs::metadata(path) {
            Ok(found) if found.is_dir() => {
                return Err(format!("{}: is a folder; give a file", path.display()));
            }
            Ok(found) if !found.is_file() => Target::Direct(path.to_owned()),
            Ok(_) => {
                OpenOptions::new().append(true).open(path).map_err(failed)?;
                Target::File(fs::canonicalize(path).map_err(failed)?)
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => Target::File(path.to_owned()),
            Err(error) => return Err(failed(error)),
        };
        if let Target::File(file) = &target {
            let temporary = Temporary::beside(file).map_err(failed)?;
            drop(temporary);
        }
        Ok(Self { name, target })
    }

    /// Writes the whole text.
    ///
    /// # Errors [`io::Error`] of standard output as it is, so that a closed pipe can be told from other
    /// errors; a message with the path for files.
    pub fn write(&self, text: &str) -> Result<(), Box<dyn std::error::Error>> {
        let failed = |error: io::Error| unwritable(&self.name, &error);
        match &self.target {
            Target::StandardOutput => {
                let mut out = io::stdout().lock();
                out.write_all(text.as_bytes())?;
                out.flush()?;
            }
            Target::Direct(device) => fs::write(device, text).map_err(failed)?,
            Target::File(file) => Temporary::beside(file)
                .and_then(|temporary| temporary.replace(file, text.as_bytes()))
                .map_err(failed)?,
        }
        Ok(())
    }
}

/// A folder of output files.
#[derive(Debug)]
pub struct OutputFolder(PathBuf);

impl OutputFolder {
    /// Creates the folder where it is missing and checks that files can be created in it.
    ///
    /// # Errors
    /// A message that names the folder.
    pub fn prepare(path: &Path) -> Result<Self, String> {
        let failed = |error: io::Error| unwritable(path, &error);
        if path.is_file() {
            return Err(format!("{}: is a file; give a folder", path.display()));
        }
        fs::create_dir_all(path).map_err(failed)?;
        let temporary = Temporary::beside(&path.join("costate")).map_err(failed)?;
        drop(temporary);
        Ok(Self(path.to_owned()))
    }

    /// A file of the folder, which must be none of the `inputs`.
    ///
    /// # Errors
    /// As [`Output::prepare`].
    pub fn file(&self, name: &str, inputs: &[&Path]) -> Result<Output, String> {
        Output::prepare(&self.0.join(name), inputs)
    }
}

/// The message for a path that cannot be written.
fn unwritable(path: &Path, error: &io::Error) -> String {
    format!("{}: cannot be written ({error}); check the path and the permissions", path.display())
}

/// Whether both paths lead to one existing file, through links of either kind.
fn is_same_file(a: &Path, b: &Path) -> bool {
    if let (Ok(a), Ok(b)) = (fs::canonicalize(a), fs::canonicalize(b)) {
        return a == b || have_same_inode(&a, &b);
    }
    false
}

#[cfg(unix)]
fn have_same_inode(a: &Path, b: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let inode = |path| fs::metadata(path).map(|found| (found.dev(), found.ino())).ok();
    inode(a).is_some_and(|a| Some(a) == inode(b))
}

#[cfg(not(unix))]
fn have_same_inode(_: &Path, _: &Path) -> bool {
    false
}

/// A new file, removed when it is dropped unless it replaced another one.
struct Temporary {
    file: File,
    /// `None` once it was renamed.
    path: Option<PathBuf>,
}

impl Temporary {
    /// Most names that are tried.
    const ATTEMPTS: u32 = 100;

    /// Creates `.NAME.PID-K.tmp` in the folder of `target`.
    fn beside(target: &Path) -> io::Result<Self> {
        let name = target.file_name().ok_or(io::ErrorKind::InvalidInput)?;
        let mut last = io::ErrorKind::AlreadyExists.into();
        for attempt in 0..Self::ATTEMPTS {
            let mut temporary = std::ffi::OsString::from(".");
            temporary.push(name);
            temporary.push(format!(".{}-{attempt}.tmp", std::process::id()));
            let path = target.with_file_name(temporary);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok(Self { file, path: Some(path) }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => last = error,
                Err(error) => return Err(error),
            }
        }
        Err(last)
    }

    /// Writes the text and takes the place of `target`, with its permissions.
    fn replace(mut self, target: &Path, text: &[u8]) -> io::Result<()> {
        self.file.write_all(text)?;
        if let Ok(old) = fs::metadata(target) {
            self.file.set_permissions(old.permissions())?;
        }
        self.file.sync_all()?;
        if let Some(path) = &self.path {
            fs::rename(path, target)?;
        }
        self.path = None;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(path) = &self.path {
            let _ = fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Output, OutputFolder, Temporary};
    use std::fs;
    use std::path::PathBuf;

    /// An empty folder for one test.
    fn folder(test: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("costate-output-{}-{test}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    #[test]
    fn preparing_leaves_no_trace_and_writing_replaces_the_whole_file() {
        let folder = folder("whole");
        let file = folder.join("a.txt");
        let output = Output::prepare(&file, &[]).unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        output.write("a long first text").unwrap();
        output.write("short").unwrap();
        assert_eq!(fs::read_to_string(&file).unwrap(), "short");
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_temporary_file_that_replaced_nothing_is_removed() {
        let folder = folder("dropped");
        let temporary = Temporary::beside(&folder.join("a.txt")).unwrap();
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
        drop(temporary);
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 0);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn folders_missing_folders_and_inputs_are_refused() {
        let folder = folder("refused");
        let input = folder.join("input.toml");
        fs::write(&input, "x = 1").unwrap();
        let refused = |path: PathBuf| Output::prepare(&path, &[&input]).unwrap_err();
        assert!(refused(folder.clone()).contains("is a folder; give a file"));
        assert!(refused(folder.join("none/a.txt")).contains("cannot be written"));
        assert!(
            refused(folder.join("../").join(folder.file_name().unwrap()).join("input.toml"))
                .contains("input")
        );
        assert!(OutputFolder::prepare(&input).unwrap_err().ends_with("input.toml: is a file; give a folder"));
        let inside = OutputFolder::prepare(&folder.join("new/inside")).unwrap();
        inside.file("b.txt", &[&input]).unwrap().write("b").unwrap();
        assert_eq!(fs::read_to_string(folder.join("new/inside/b.txt")).unwrap(), "b");
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn links_to_inputs_are_refused_and_other_links_are_followed() {
        let folder = folder("links");
        let [input, hard, soft, other, link] =
            ["input", "hard", "soft", "other", "link"].map(|name| folder.join(name));
        fs::write(&input, "1").unwrap();
        fs::write(&other, "2").unwrap();
        fs::hard_link(&input, &hard).unwrap();
        std::os::unix::fs::symlink(&input, &soft).unwrap();
        std::os::unix::fs::symlink(&other, &link).unwrap();
        for path in [&hard, &soft] {
            assert!(Output::prepare(path, &[&input]).unwrap_err().contains("is the input file"));
        }
        Output::prepare(&link, &[&input]).unwrap().write("new").unwrap();
        assert!(link.is_symlink() && fs::read_to_string(&other).unwrap() == "new");
        fs::remove_dir_all(folder).unwrap();
    }
}
