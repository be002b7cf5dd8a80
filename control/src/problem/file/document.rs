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
                Some(span) if error.message() == "duplicate key" => Fault {
                    line,
                    key: Some(full_key(text, span)),
                    cause: Box::new(ProblemFileCause::DuplicateKey),
                },
                _ => Fault { line, ..ProblemFileCause::Syntax(error.message().trim_end().into()).into() },
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
