//! Arguments and results of programs.

use super::error::CodegenError;
use super::record::{Expr, Id};

/// One argument of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramArgument {
    /// Its name, an identifier.
    pub name: String,
    /// Number of its entries.
    pub entries: usize,
    /// Its meaning, with units; one line, may be empty.
    pub meaning: String,
}

/// One result of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramResult {
    /// Its name, an identifier.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// The nodes that hold its entries, row by row, or column by column where
    /// [`Program::is_column_major`](super::Program::is_column_major).
    pub entries: Vec<Id>,
    /// Its meaning, with units; one line, may be empty.
    pub meaning: String,
}

/// A result as a recorded function returns it.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct RecordedResult {
    /// Its name, an identifier.
    pub name: String,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Its entries, row by row.
    pub entries: Vec<Expr>,
}

impl RecordedResult {
    /// A column with these entries.
    pub fn vector(name: impl Into<String>, entries: Vec<Expr>) -> Self {
        Self { name: name.into(), rows: entries.len(), columns: 1, entries }
    }

    /// A matrix with these entries, row by row.
    pub fn matrix(name: impl Into<String>, rows: usize, columns: usize, entries: Vec<Expr>) -> Self {
        Self { name: name.into(), rows, columns, entries }
    }
}

impl ProgramArgument {
    pub(super) fn new(name: &str, entries: usize) -> Self {
        Self { name: name.into(), entries, meaning: String::new() }
    }
}

/// The entries of each argument.
pub(super) fn split(entries: &[Expr], arguments: &[(&str, usize)]) -> Vec<Vec<Expr>> {
    let mut rest = entries;
    let part = |&(_, entries): &(&str, usize)| {
        let (part, more) = rest.split_at(entries);
        rest = more;
        part.to_vec()
    };
    arguments.iter().map(part).collect()
}

/// Results whose entries are in these nodes, one result after the other.
pub(super) fn shaped(results: Vec<RecordedResult>, ids: Vec<Id>) -> Result<Vec<ProgramResult>, CodegenError> {
    let mut ids = ids.into_iter();
    let shaped = results.into_iter().map(|RecordedResult { name, rows, columns, entries }| {
        let found = entries.len();
        if found != rows * columns {
            return Err(CodegenError::Shape { name, rows, columns, found });
        }
        let entries = ids.by_ref().take(found).collect();
        Ok(ProgramResult { name, rows, columns, entries, meaning: String::new() })
    });
    shaped.collect()
}
