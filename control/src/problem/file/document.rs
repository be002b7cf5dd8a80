//! TOML tables whose values are read with their lines and keys.

use crate::problem::error::ProblemError;
use crate::problem::file::error::{ProblemFileCause, ProblemFileError};
use crate::problem::key::Key;
use costate::robot::printable;
use std::ops::Range;
use std::path::Path;
use std::string::FromUtf8Error;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// An error of the text, without its file.
#[derive(Debug)]
pub(crate) struct Fault {
    pub line: Option<usize>,
    pub key: Option<String>,
    pub cause: Box<ProblemFileCause>,
}

impl Fault {
    pub fn in_file(self, path: Option<&Path>) -> ProblemFileError {
        let Self { line, key, cause } = self;
        ProblemFileError { path: path.map(Path::to_path_buf), line, key, cause }
    }
}

impl From<ProblemFileCause> for Fault {
    fn from(cause: ProblemFileCause) -> Self {
        Self { line: None, key: None, cause: Box::new(cause) }
    }
}

/// The line at which a file stops being UTF-8.
pub(crate) fn not_utf8(error: &FromUtf8Error) -> Fault {
    let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
    Fault { line: Some(line_at(valid, valid.len())), ..ProblemFileCause::NotUtf8.into() }
}

/// Line of a byte, from 1.
fn line_at(text: &[u8], offset: usize) -> usize {
    1 + text.iter().take(offset).filter(|&&byte| byte == b'\n').count()
}

/// A key with the last table header above it.
fn full_key(text: &str, place: Range<usize>) -> String {
    let above = text.get(..place.start).unwrap_or_default();
    let header = above.lines().rev().find_map(|line| line.trim().strip_prefix('[')?.split(']').next());
    let name = text.get(place).unwrap_or_default();
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

/// A table of the document.
pub(crate) struct Table<'d> {
    pub(super) text: &'d str,
    pub(super) path: Option<String>,
    /// Its first byte; lines are counted for errors alone.
    pub(super) start: Option<usize>,
    pub(super) values: &'d DeTable<'d>,
}

impl<'d> Table<'d> {
    /// Refuses keys other than these.
    pub fn only(&self, known: &'static [&'static str]) -> Result<(), Fault> {
        match self.values.iter().find(|(key, _)| !known.contains(&key.get_ref().as_ref())) {
            Some((key, _)) => Err(self.fault(key.get_ref(), ProblemFileCause::UnknownKey { known })),
            None => Ok(()),
        }
    }

    /// Line of a key.
    pub fn line_of(&self, name: &str) -> Option<usize> {
        self.start_of(name).map(|start| self.line_at(start))
    }

    /// First byte of a key.
    pub(super) fn start_of(&self, name: &str) -> Option<usize> {
        let (key, _) = self.values.iter().find(|(key, _)| key.get_ref() == name)?;
        Some(Spanned::span(key).start)
    }

    /// Line of a byte.
    pub(super) fn line_at(&self, offset: usize) -> usize {
        line_at(self.text.as_bytes(), offset)
    }

    /// A key with its table.
    pub(super) fn key(&self, name: &str) -> String {
        self.path.as_ref().map_or_else(|| name.into(), |path| format!("{path}.{name}"))
    }

    /// An error of one key.
    pub fn fault(&self, name: &str, cause: ProblemFileCause) -> Fault {
        let line = self.start_of(name).or(self.start).map(|start| self.line_at(start));
        Fault { line, key: Some(self.key(name)), cause: Box::new(cause) }
    }

    /// The value of a key that must be given.
    pub fn need<T>(&self, name: &str, value: Option<T>) -> Result<T, Fault> {
        value.ok_or_else(|| self.fault(name, ProblemFileCause::MissingKey))
    }

    pub fn table(&self, name: &str) -> Result<Option<Table<'d>>, Fault> {
        let (start, path) = (self.start_of(name), self.key(name));
        self.value(name, "a table", |value| match value {
            DeValue::Table(values) => {
                Some(Table { text: self.text, path: Some(path.clone()), start, values })
            }
            _ => None,
        })
    }

    pub fn number(&self, name: &str) -> Result<Option<f64>, Fault> {
        self.value(name, "a number", number)
    }

    pub fn numbers(&self, name: &str) -> Result<Option<Vec<f64>>, Fault> {
        self.list(name, "a list of numbers", number)
    }

    /// A whole number that is not negative.
    pub fn whole(&self, name: &str) -> Result<Option<u64>, Fault> {
        self.value(name, "a whole number that is not negative", whole)
    }

    pub fn flag(&self, name: &str) -> Result<Option<bool>, Fault> {
        self.value(name, "true or false", |value| match value {
            DeValue::Boolean(flag) => Some(*flag),
            _ => None,
        })
    }

    pub fn string(&self, name: &str) -> Result<Option<String>, Fault> {
        self.value(name, "a string", string)
    }

    /// One of these names.
    pub fn choice<T: Copy>(&self, name: &str, choices: &[(&'static str, T)]) -> Result<Option<T>, Fault> {
        let Some(found) = self.string(name)? else { return Ok(None) };
        match choices.iter().find(|(choice, _)| *choice == found) {
            Some(&(_, value)) => Ok(Some(value)),
            None => {
                let known = choices.iter().map(|&(choice, _)| choice).collect();
                Err(self.fault(name, ProblemFileCause::UnknownValue { found, known }))
            }
        }
    }

    pub fn list<T>(
        &self,
        name: &str,
        expected: &'static str,
        read: impl Fn(&DeValue<'_>) -> Option<T>,
    ) -> Result<Option<Vec<T>>, Fault> {
        let Some(value) = self.values.get(name) else { return Ok(None) };
        let wrong = |found: &DeValue<'_>| {
            self.fault(name, ProblemFileCause::WrongType { expected, found: describe(found) })
        };
        let DeValue::Array(entries) = value.get_ref() else { return Err(wrong(value.get_ref())) };
        let entry =
            |entry: &Spanned<DeValue<'_>>| read(entry.get_ref()).ok_or_else(|| wrong(entry.get_ref()));
        entries.iter().map(entry).collect::<Result<_, _>>().map(Some)
    }

    pub fn value<T>(
        &self,
        name: &str,
        expected: &'static str,
        read: impl Fn(&'d DeValue<'d>) -> Option<T>,
    ) -> Result<Option<T>, Fault> {
        let Some(value) = self.values.get(name) else { return Ok(None) };
        let value = value.get_ref();
        let wrong = || self.fault(name, ProblemFileCause::WrongType { expected, found: describe(value) });
        read(value).map(Some).ok_or_else(wrong)
    }
}

pub(super) fn number(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(whole) => Some(i64::from_str_radix(whole.as_str(), whole.radix()).ok()? as f64),
        _ => None,
    }
}

pub(super) fn whole(value: &DeValue<'_>) -> Option<u64> {
    match value {
        DeValue::Integer(whole) => u64::from_str_radix(whole.as_str(), whole.radix()).ok(),
        _ => None,
    }
}

pub(super) fn string(value: &DeValue<'_>) -> Option<String> {
    match value {
        DeValue::String(text) => Some(text.to_string()),
        _ => None,
    }
}

/// A value in an error.
pub(super) fn describe(value: &DeValue<'_>) -> String {
    match value {
        DeValue::String(text) => format!("the string \"{}\"", printable(text)),
        DeValue::Integer(whole) => printable(&whole.to_string()).to_string(),
        DeValue::Float(float) => printable(&float.to_string()).to_string(),
        DeValue::Boolean(flag) => format!("{flag}"),
        DeValue::Datetime(_) => "a date".into(),
        DeValue::Array(_) => "a list".into(),
        DeValue::Table(_) => "a table".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
