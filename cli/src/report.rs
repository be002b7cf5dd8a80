//! Tables for people.

use costate::robot::Robot;

/// `1 joint`, `6 joints`.
pub fn joints(robot: &Robot) -> String {
    format!("{} joint{}", robot.dof(), if robot.dof() == 1 { "" } else { "s" })
}

/// A table with a header and columns as wide as their widest cell: the first few hold text, the others numbers.
pub struct Table {
    text_columns: usize,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with this header, whose first `text_columns` columns are set to the left, the others to the right.
    pub fn new(header: &[&str], text_columns: usize) -> Self {
        Self { text_columns, rows: vec![header.iter().map(ToString::to_string).collect()] }
    }

    /// Adds a row.
    pub fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
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
    use super::Table;

    #[test]
    fn columns_line_up() {
        let mut table = Table::new(&["a", "value"], 1);
        table.row(vec!["longer".into(), "1".into()]);
        assert_eq!(table.to_string(), "  a       value\n  -------------\n  longer      1\n");
    }
}
