//! TOML tables whose values are read with their lines and keys.

use crate::problem::file::error::ProblemFileCause;
use crate::problem::file::fault::{Fault, line_at};
use costate::robot::printable;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

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

    /// A flag where a table may stand too.
    pub fn flag_or_table(&self, name: &str) -> Result<Option<bool>, Fault> {
        self.value(name, "true, false or a table", |value| match value {
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
        let wrong_entry = |found: &DeValue<'_>| match found {
            DeValue::Array(_) => {
                self.fault(name, ProblemFileCause::WrongType { expected, found: "a list of lists".into() })
            }
            found => wrong(found),
        };
        let entry =
            |entry: &Spanned<DeValue<'_>>| read(entry.get_ref()).ok_or_else(|| wrong_entry(entry.get_ref()));
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
