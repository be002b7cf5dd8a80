//! The text of a problem file as a TOML document.

use crate::problem::error::ProblemError;
use crate::problem::file::error::ProblemFileCause;
use crate::problem::file::fault::{Fault, line_at};
use crate::problem::file::table::Table;
use crate::problem::key::Key;
use std::ops::Range;
use toml::Spanned;
use toml::de::DeTable;

/// A key with the last table header above it.
fn full_key(text: &str, place: Range<usize>) -> String {
    let above = text.get(..place.start).unwrap_or_default();
    let name = text.get(place).unwrap_or_default();
    let in_header = |line: &str| {
        line.trim_start().starts_with('[').then(|| line.trim().trim_matches(['[', ']', ' ']).to_owned())
    };
    // The name may be a part of a header itself.
    if let Some(begun) = above.rsplit('\n').next().and_then(in_header) {
        return format!("{begun}{}", name.trim_matches(['[', ']', ' ']));
    }
    let header = above.lines().rev().find_map(|line| in_header(line.split(']').next()?));
    header.map_or_else(|| name.into(), |table| format!("{table}.{name}"))
}

/// What to do where the robot is a file and a table.
const ROBOT_IS_A_NAME: &str = "names a file further up, and further keys of the robot need a table; write [robot] with \
                               file = \"...\" in the place of robot = \"...\", before [[robot.payload]] and the \
                               others";

/// Whether a key or header here belongs to the table of the robot, which the text names as a file before.
fn extends_robot(text: &str, at: usize) -> bool {
    let above = text.get(..at).unwrap_or_default();
    let name = |line: &str| line.trim_start().trim_start_matches('[').trim_start().to_owned();
    let line = above.rfind('\n').map_or(0, |end| end + 1);
    let here = name(text.get(line..).and_then(|rest| rest.lines().next()).unwrap_or_default());
    let is_inner = here.strip_prefix("robot").is_some_and(|rest| rest.trim_start().starts_with(['.', ']']));
    let is_file = |line: &str| {
        let value =
            line.trim_start().strip_prefix("robot").and_then(|rest| rest.trim_start().strip_prefix('='));
        value.is_some_and(|value| value.trim_start().starts_with(['"', '\'']))
    };
    is_inner && above.lines().any(is_file)
}

/// The message of an error of the syntax; a number without a digit beside its point with what to write.
fn explained(text: &str, error: &toml::de::Error) -> String {
    let message = error.message().trim_end().to_owned();
    let Some(span) = error.span() else { return message };
    let ends = |c: char| c.is_whitespace() || "=,[]{}#".contains(c);
    let (before, after) =
        (text.get(..span.start).unwrap_or_default(), text.get(span.start..).unwrap_or_default());
    let first =
        before.rfind(ends).map_or(0, |end| end + before[end..].chars().next().map_or(1, char::len_utf8));
    let token = [&before[first..], after.split(ends).next().unwrap_or_default()].concat();
    let sign = token.get(..1).filter(|sign| ["+", "-"].contains(sign)).unwrap_or_default();
    let Some((whole, fraction)) = token[sign.len()..].split_once('.') else { return message };
    let exponent = fraction.find(['e', 'E']).unwrap_or(fraction.len());
    let (fraction, exponent) = fraction.split_at(exponent);
    let is_number = |digits: &str| digits.chars().all(|c| c.is_ascii_digit() || c == '_');
    if !is_number(whole) || !is_number(fraction) || (whole.is_empty() == fraction.is_empty()) {
        return message;
    }
    let filled = |digits: &str| if digits.is_empty() { "0".to_owned() } else { digits.to_owned() };
    let (sign, number) = (if sign == "-" { sign } else { "" }, [filled(whole), filled(fraction)].join("."));
    format!(
        "numbers need a digit on either side of the point: write {sign}{number}{exponent}, not {}",
        costate::robot::printable(&token)
    )
}

/// Longest text (bytes). Reading one takes up to a hundred times as much memory; ten lists of 10 000 numbers
/// fit.
pub(crate) const MOST_BYTES: usize = 1 << 20;

/// The whole text.
pub(crate) struct Document<'t> {
    text: &'t str,
    root: Spanned<DeTable<'t>>,
}

impl<'t> Document<'t> {
    pub fn parse(text: &'t str) -> Result<Self, Fault> {
        if text.len() > MOST_BYTES {
            return Err(ProblemFileCause::TooLong { most: MOST_BYTES }.into());
        }
        let root = DeTable::parse(text).map_err(|error| {
            let line = error.span().map(|span| line_at(text.as_bytes(), span.start));
            match error.span() {
                Some(span) if extends_robot(text, span.start) => Fault {
                    line,
                    key: Some("robot".into()),
                    cause: Box::new(ProblemFileCause::Conflict(ROBOT_IS_A_NAME)),
                },
                Some(span) if error.message() == "duplicate key" => Fault {
                    line,
                    key: Some(full_key(text, span)),
                    cause: Box::new(ProblemFileCause::DuplicateKey),
                },
                _ => Fault { line, ..ProblemFileCause::Syntax(explained(text, &error)).into() },
            }
        })?;
        Ok(Self { text, root })
    }

    pub fn root(&self) -> Table<'_> {
        Table { text: self.text, path: None, start: None, values: self.root.get_ref() }
    }

    /// Line of a key, or of its table where the key is missing.
    pub fn line_of(&self, key: Key) -> Option<usize> {
        let mut table = self.root();
        for name in key.table().split('.') {
            let Some(inner) = table.inner(name, key.number()) else { return table.line_of(name) };
            table = inner;
        }
        table.line_of(key.name()).or(table.start.map(|start| table.line_at(start)))
    }

    pub fn fault_of(&self, error: ProblemError) -> Fault {
        let key = error.key();
        Fault {
            line: key.and_then(|key| self.line_of(key)),
            key: key.map(|key| key.to_string()),
            cause: Box::new(ProblemFileCause::Problem(error)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::file::fault::not_utf8;

    #[test]
    fn a_key_has_its_line_in_tables_of_either_form() {
        let text = "robot = \"a\"\n\n[start]\nq = [\n  1.0,\n]\n[end]\nq = [1]\n";
        let document = Document::parse(text).unwrap_or_else(|fault| panic!("{fault:?}"));
        assert_eq!(document.line_of(Key::START_Q), Some(4));
        assert_eq!(document.line_of(Key::END_Q), Some(8));
        assert_eq!(document.line_of(Key::END_V), Some(7));
        assert_eq!(document.line_of(Key::U_MIN), None);
        let dotted = Document::parse("a = 1\nstart.q = [0]\nend = { q = [1] }\n");
        let dotted = dotted.unwrap_or_else(|fault| panic!("{fault:?}"));
        assert_eq!((dotted.line_of(Key::START_Q), dotted.line_of(Key::END_Q)), (Some(2), Some(3)));
    }

    #[test]
    fn errors_of_the_text_name_line_and_key() {
        let message = |text: &str| match Document::parse(text) {
            Ok(_) => String::new(),
            Err(fault) => fault.in_file(None).to_string(),
        };
        assert_eq!(
            message("[time]\nfinal = 1\nfinal = 2\n"),
            "problem:3: time.final: duplicate key; remove one of the two"
        );
        assert!(message("a = 1\nq = [\n").starts_with("problem:"), "{}", message("a = 1\nq = [\n"));
        let bytes = b"robot = 1\n# \xff\n".to_vec();
        let fault = not_utf8(&String::from_utf8(bytes).unwrap_err());
        assert_eq!(
            fault.in_file(None).to_string(),
            "problem:2: the text is not UTF-8; save the file as UTF-8"
        );
    }

    #[test]
    fn numbers_without_a_digit_and_a_robot_that_is_file_and_table_say_what_to_write() {
        let message = |text: &str| match Document::parse(text) {
            Ok(_) => String::new(),
            Err(fault) => fault.in_file(None).to_string(),
        };
        let cases =
            [(".5", "0.5"), ("5.", "5.0"), ("-.25e3", "-0.25e3"), ("-7.", "-7.0"), ("1.e-3", "1.0e-3")];
        for (given, expected) in cases {
            for text in [format!("[time]\nfinal = {given}\n"), format!("[a]\nq = [1.0, {given}, 2]")] {
                let found = message(&text);
                let write = format!(
                    "problem:2: not TOML: numbers need a digit on either side of the point: write \
                                     {expected}, not {given}"
                );
                assert_eq!(found, write, "{text}");
            }
        }
        for text in ["a = 1..2", "a = .", "a = ..5", "a = x.5", "a = .5.5"] {
            assert!(
                !message(text).is_empty() && !message(text).contains("write"),
                "{text}: {}",
                message(text)
            );
        }
        for more in
            ["[[robot.payload]]\nmass = 1", "[robot]\ngravity = [0, 0, 0]", "robot.gravity = [0, 0, 0]"]
        {
            let found = message(&format!("robot = \"arm.urdf\"\n\n{more}\n"));
            assert!(found.starts_with("problem:3: robot: names a file further up"), "{found}");
            assert!(found.contains("write [robot] with file = "), "{found}");
        }
        let other = message("robot = \"arm.urdf\"\nrobotic = 1\nrobotic.a = 2\n");
        assert!(other.contains("not TOML") && !other.contains("[robot]"), "{other}");
    }

    #[test]
    fn long_texts_are_refused_and_long_or_hidden_values_are_cut() {
        let message = |text: &str| match Document::parse(text) {
            Ok(document) => document.root().number("a").err().map(|fault| fault.in_file(None).to_string()),
            Err(fault) => Some(fault.in_file(None).to_string()),
        };
        let long = message(&" ".repeat(MOST_BYTES + 1));
        assert!(long.as_ref().is_some_and(|message| message.contains("more than 1048576 bytes")), "{long:?}");
        assert_eq!(message(&" ".repeat(MOST_BYTES)), None);
        let found = message("a = \"\\u001b\\u202e\"\n").unwrap();
        assert_eq!(found, r#"problem:1: a: give a number, not the string "\u{1b}\u{202e}""#);
        assert!(message(&format!("a = \"{}\"\n", "x".repeat(5000))).unwrap().len() < 200);
        assert!(message(&format!("{0} = 1\n{0} = 2\n", "x".repeat(5000))).unwrap().len() < 200);
    }
}
