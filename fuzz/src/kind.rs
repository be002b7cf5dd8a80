//! The kinds of inputs and where their seeds are.

use crate::files::{files, folder, project};
use crate::saved::saved_solutions;
use std::path::PathBuf;

/// What an input is read as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A robot in URDF.
    Urdf,
    /// A robot in TOML.
    Toml,
    /// A problem file.
    Problem,
    /// A saved solution.
    Solution,
    /// Lines for `costate eval`.
    Eval,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 5] = [Self::Urdf, Self::Toml, Self::Problem, Self::Solution, Self::Eval];

    /// Its name: a column of the table, a folder of the corpus.
    pub fn name(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Toml => "toml",
            Self::Problem => "problem",
            Self::Solution => "solution",
            Self::Eval => "eval",
        }
    }

    /// The kind of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Extension of its files.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Urdf => "urdf",
            Self::Toml | Self::Problem => "toml",
            Self::Solution => "json",
            Self::Eval => "jsonl",
        }
    }

    /// Its files in the project that mutations begin with. Saved solutions are made when they are needed.
    pub fn seeds(self) -> Vec<Vec<u8>> {
        let folders: &[&str] = match self {
            Self::Urdf | Self::Toml => &["robots", "tests/fixtures"],
            Self::Problem => &["examples/problems"],
            Self::Solution => return saved_solutions(),
            Self::Eval => return states(),
        };
        let files = folders.iter().flat_map(|folder| files(&project().join(folder), self.extension()));
        files.filter_map(|file| std::fs::read(file).ok()).collect()
    }

    /// Its files in the corpus.
    pub fn corpus(self) -> Vec<PathBuf> {
        files(&folder().join("corpus").join(self.name()), "")
    }
}

/// Frames that are asked for, of the robots that evaluate the states and of others.
const FRAMES: &str = r#", "frames": ["elbow", "world", {"name": "pole", "axes": "local", "w": [0.2, -1, 3]}, {"name": "shoulder"}]}"#;

/// States of robots of two joints: only those keys that are read, a line each, and a whole line of results.
fn states() -> Vec<Vec<u8>> {
    let read =
        |name| std::fs::read_to_string(project().join("tests/fixtures").join(name)).unwrap_or_default();
    let texts = ["two_link.jsonl", "cart_pole.jsonl"].map(read);
    let lines: Vec<&str> = texts.iter().flat_map(|text| text.lines()).collect();
    let inputs = lines.iter().filter_map(|line| Some(format!("{}}}", line.split(", \"M\":").next()?)));
    let framed = |line: String| line.replace("}", FRAMES);
    let with_frames = inputs.clone().take(2).map(framed);
    inputs
        .chain(with_frames)
        .chain(lines.first().map(|line| (*line).to_owned()))
        .map(String::into_bytes)
        .collect()
}
