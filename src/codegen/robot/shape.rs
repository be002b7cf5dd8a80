//! Name and size of an argument or result.

/// An argument or a result: `rows` times `columns` numbers, row by row; vectors have one column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shape {
    /// Its name, as in the table of [`Quantity`](super::Quantity).
    pub name: &'static str,
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
}

impl Shape {
    pub(super) fn vector(name: &'static str, rows: usize) -> Self {
        Self { name, rows, columns: 1 }
    }

    pub(super) fn matrix(name: &'static str, rows: usize, columns: usize) -> Self {
        Self { name, rows, columns }
    }

    /// Number of entries.
    pub fn entries(&self) -> usize {
        self.rows * self.columns
    }
}
