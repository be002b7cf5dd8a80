//! Problem files that documents show, and those of the examples, are read and checked as they stand.

use costate::robot::LoadOptions;
use costate_control::ProblemFile;
use std::fs;
use std::path::{Path, PathBuf};

/// Where the robots of snippets are, as `../../robots`.
const FOLDER: &str = "../examples/problems";

/// What a part of a problem file lacks, for the arm of the documents: each table with its text.
const UR5: [(&str, &str); 5] = [
    ("robot", "robot = \"../../robots/ur5.urdf\"\n"),
    ("start", "[start]\nq = [0.0, -1.6, 1.8, -1.8, -1.57, 0.0]\n"),
    ("end", "[end]\nq = [1.5, -1.0, 1.2, -1.5, -1.57, 0.5]\n"),
    ("time", "[time]\nfinal = 1.0\n"),
    ("cost", "[cost]\neffort = [1, 1, 1, 1, 1, 1]\n"),
];

/// The same for an arm with two joints.
const TWO_LINK: [(&str, &str); 5] = [
    ("robot", "robot = \"../../robots/two_link.toml\"\n"),
    ("start", "[start]\nq = [0.0, 0.0]\n"),
    ("end", "[end]\nq = [1.0, 0.5]\n"),
    ("time", "[time]\nfinal = 1.0\n"),
    ("cost", "[cost]\neffort = [1.0, 1.0]\n"),
];

/// A piece of code in a document.
struct Snippet {
    /// File and line.
    place: String,
    language: String,
    text: String,
}

/// All documents of the project.
fn documents() -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![PathBuf::from("..")];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
            let (path, name) = (entry.path(), entry.file_name());
            let hidden = name.to_str().is_none_or(|name| name.starts_with('.') || name == "target");
            match entry.file_type().unwrap() {
                _ if hidden => {}
                kind if kind.is_dir() => folders.push(path),
                _ if path.extension().is_some_and(|extension| extension == "md") => found.push(path),
                _ => {}
            }
        }
    }
    found
}

/// The code between the fences of a document.
fn snippets(path: &Path) -> Vec<Snippet> {
    let text = fs::read_to_string(path).unwrap();
    let (mut found, mut open) = (Vec::new(), None::<Snippet>);
    for (number, line) in text.lines().enumerate() {
        let place = format!("{}:{}", path.display(), number + 1);
        let fence = line.trim_start().strip_prefix("```");
        assert!(fence.is_some() || !line.contains("```"), "{place}: a fence stands alone on its line");
        open = match (open, fence) {
            (None, None) => None,
            (None, Some(language)) => {
                Some(Snippet { place, language: language.trim().into(), text: String::new() })
            }
            (Some(snippet), Some(rest)) => {
                assert_eq!(rest.trim(), "", "{place}: the code of {} is not closed", snippet.place);
                found.push(snippet);
                None
            }
            (Some(snippet), None) => Some(Snippet { text: snippet.text + line + "\n", ..snippet }),
        };
    }
    assert!(open.is_none(), "{}: a fence is not closed", path.display());
    found
}

/// Whether the text has a table or a key of this name at its top.
fn has(text: &str, name: &str) -> bool {
    let starts = |line: &str| {
        let rest = line.trim_start_matches('[').strip_prefix(name);
        rest.is_some_and(|rest| rest.starts_with([']', '.', ' ', '=']))
    };
    let header = text.lines().take_while(|line| !line.starts_with('[')).any(starts);
    header || text.lines().filter(|line| line.starts_with('[')).any(starts)
}

/// The text with what it lacks: keys without a table first. Periodic motions and gaits have no end.
fn completed(text: &str, lacking: &[(&str, &str)]) -> String {
    let lacks =
        |name: &str| !(has(text, name) || name == "end" && (has(text, "periodic") || has(text, "gait")));
    let added = lacking.iter().filter(|(name, _)| lacks(name)).map(|(_, lines)| *lines);
    let (keys, tables): (Vec<&str>, Vec<&str>) = added.partition(|lines| !lines.starts_with('['));
    format!("{}{text}{}", keys.concat(), tables.concat())
}

#[test]
fn motions_whose_end_follows_their_start_get_none() {
    let end = [("end", "[end]\n")];
    for text in ["[gait]\nlength = 0.4\n", "[periodic]\n", "[end]\nq = [1.0]\n"] {
        assert_eq!(completed(text, &end), text);
    }
    assert_eq!(completed("[time]\n", &end), "[time]\n[end]\n");
}

fn read(text: &str) -> Result<ProblemFile, String> {
    ProblemFile::from_text(text, FOLDER, LoadOptions::default()).map_err(|error| error.to_string())
}

/// A whole problem is valid as it stands; a part of one is valid with the other tables of one of the arms.
#[test]
fn problem_files_in_documents_are_valid() {
    let (mut whole, mut parts) = (0, 0);
    for path in documents() {
        for Snippet { place, language, text } in snippets(&path) {
            // Manifests of cargo are TOML too.
            if language != "toml" || has(&text, "dependencies") || has(&text, "build-dependencies") {
                continue;
            }
            if has(&text, "robot") && has(&text, "time") {
                let read = read(&text);
                assert!(read.is_ok(), "{place}: {}", read.unwrap_err());
                whole += 1;
                continue;
            }
            let errors: Vec<String> =
                [UR5, TWO_LINK].iter().map_while(|arm| read(&completed(&text, arm)).err()).collect();
            assert!(errors.len() < 2, "{place}: {}", errors.join("\n"));
            parts += 1;
        }
    }
    assert!(whole >= 1 && parts >= 4, "{whole} whole problems and {parts} parts in documents");
}

#[test]
fn all_examples_are_valid() {
    let mut count = 0;
    for entry in fs::read_dir(FOLDER).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            let read = ProblemFile::read(&path, LoadOptions::default());
            assert!(read.is_ok(), "{}", read.unwrap_err());
            count += 1;
        }
    }
    assert!(count > 15, "{count} problems");
}
