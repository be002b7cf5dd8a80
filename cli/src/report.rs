//! Tables and phrases of reports.

pub use costate_report::numbers::{fixed, scientific};

use costate::robot::{Robot, escape_hidden, printable};

/// Widest cell of a table (characters).
const WIDEST: usize = 40;

/// Widest line of a cell that goes on in the next line (characters).
const WIDEST_LINE: usize = 58;

/// `1 joint`, `6 joints`.
pub fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// The number of joints, as `6 joints`, or `3 joints with 8 degrees of freedom`.
pub fn joints(robot: &Robot) -> String {
    let free = robot.free_joints();
    if free.is_empty() {
        return counted(robot.dof(), "joint");
    }
    let all = robot.dof() + free.len() - free.iter().map(|free| free.kind.dof()).sum::<usize>();
    format!("{} with {} degrees of freedom", counted(all, "joint"), robot.dof())
}

/// The name of the robot and the number of its joints, to start a report.
pub fn title(robot: &Robot) -> String {
    let mimics = robot.joints().len() - robot.dof();
    let mimics = if mimics > 0 { format!(" and {}", counted(mimics, "mimic joint")) } else { String::new() };
    format!("{}, {}{mimics}", printable(robot.name()), joints(robot))
}

/// A component of an axis: whole numbers without decimals.
pub fn component(x: f64) -> String {
    fixed(x, if x == x.round() { 0 } else { 3 })
}

/// A table with a header and columns as wide as their widest cell. The first columns hold text, the others
/// numbers. Hidden characters in cells are escaped, and cells of more than 40 characters end in an ellipsis,
/// but for those of the last column of a table that [wraps](Self::wrapping) them.
pub struct Table {
    text_columns: usize,
    wraps: bool,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with this header. The first `text_columns` columns are left-aligned, the others right-aligned.
    pub fn new(header: &[&str], text_columns: usize) -> Self {
        Self { text_columns, wraps: false, rows: vec![header.iter().map(ToString::to_string).collect()] }
    }

    /// The same table, where long cells of the last column go on in the next line.
    #[must_use]
    pub fn wrapping(self) -> Self {
        Self { wraps: true, ..self }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: Vec<String>) {
        let mut shown: Vec<String> = cells.iter().map(|cell| cut(&escape_hidden(cell), WIDEST)).collect();
        let (true, Some(last)) = (self.wraps, cells.last()) else { return self.rows.push(shown) };
        let blank = vec![String::new(); cells.len()];
        for line in lines(&escape_hidden(last)) {
            if let Some(last) = shown.last_mut() {
                *last = line;
            }
            self.rows.push(std::mem::replace(&mut shown, blank.clone()));
        }
    }
}

/// At least one line, broken at blanks, each of at most [`WIDEST_LINE`] characters.
fn lines(cell: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in cell.split_whitespace().map(|word| cut(word, WIDEST_LINE)) {
        let Some(line) = lines.last_mut() else { break };
        if line.is_empty() {
            *line = word;
        } else if line.chars().count() + 1 + word.chars().count() <= WIDEST_LINE {
            *line += " ";
            *line += &word;
        } else {
            lines.push(word);
        }
    }
    lines
}

/// At most so many characters, the last an ellipsis where some are left out.
fn cut(cell: &str, widest: usize) -> String {
    match cell.char_indices().nth(widest) {
        None => cell.to_owned(),
        Some(_) => cell.chars().take(widest - 1).chain(['\u{2026}']).collect(),
    }
}

impl std::fmt::Display for Table {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |c: usize| {
            self.rows.iter().filter_map(|r| r.get(c)).map(|s| s.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for (index, row) in self.rows.iter().enumerate() {
            let mut line = String::from(" ");
            for (c, cell) in row.iter().enumerate() {
                let width = widths[c];
                let gap = if c == 0 { " " } else { "  " };
                line += &match c < self.text_columns {
                    true => format!("{gap}{cell:<width$}"),
                    false => format!("{gap}{cell:>width$}"),
                };
            }
            writeln!(f, "{}", line.trim_end())?;
            if index == 0 {
                writeln!(f, "  {}", "-".repeat(widths.iter().sum::<usize>() + 2 * (columns.max(1) - 1)))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Table, counted};

    #[test]
    fn numbers_and_nouns() {
        assert_eq!((counted(1, "joint"), counted(2, "joint")), ("1 joint".into(), "2 joints".into()));
    }

    #[test]
    fn columns_line_up() {
        let mut table = Table::new(&["a", "value"], 1);
        table.row(vec!["longer".into(), "1".into()]);
        assert_eq!(table.to_string(), "  a       value\n  -------------\n  longer      1\n");
    }

    #[test]
    fn the_last_column_of_a_wrapping_table_is_not_cut() {
        let mut table = Table::new(&["a", "b"], 2).wrapping();
        let reason = format!("{} end", "word ".repeat(13));
        table.row(vec!["long".into(), reason.clone()]);
        let text = table.to_string();
        let rows: Vec<&str> = text.lines().skip(2).collect();
        assert_eq!(rows.len(), 2, "{text}");
        assert!(rows[1].starts_with("        word word end"), "{text}");
        let words: Vec<&str> = rows.iter().flat_map(|row| row.split_whitespace()).skip(1).collect();
        assert_eq!(words, reason.split_whitespace().collect::<Vec<_>>());
    }

    /// The formatter panics beyond 65 535 columns.
    #[test]
    fn long_cells_end_in_an_ellipsis() {
        let mut table = Table::new(&["name", "value"], 1);
        table.row(vec!["\u{e9}".repeat(70_000), "1".into()]);
        let row = format!("  {}\u{2026}      1\n", "\u{e9}".repeat(39));
        assert!(table.to_string().ends_with(&row), "{table}");
    }
}
