//! Tables into a document.

use std::path::Path;

pub const BEGIN: &str = "<!-- tables: begin, written by costate-robustness --write -->";
pub const END: &str = "<!-- tables: end -->";

/// Puts the tables between the marks of a document.
pub fn put(path: &Path, tables: &str) -> Result<(), String> {
    let named = |error: std::io::Error| format!("{}: {error}", path.display());
    let old = std::fs::read_to_string(path).map_err(named)?;
    let (before, rest) = old.split_once(BEGIN).ok_or(format!("{}: no line {BEGIN}", path.display()))?;
    let (_, after) = rest.split_once(END).ok_or(format!("{}: no line {END}", path.display()))?;
    std::fs::write(path, format!("{before}{BEGIN}\n\n{tables}\n{END}{after}")).map_err(named)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Results;
    use crate::tables::tables;

    #[test]
    fn the_page_holds_the_tables_of_the_results() {
        let folder = Path::new(crate::FOLDER);
        let page = std::fs::read_to_string(folder.join("../../docs/robustness.md")).unwrap();
        let results = Results::open(&folder.join("results.jsonl")).unwrap();
        let expected = format!("{BEGIN}\n\n{}\n{END}", tables(&results.records).unwrap());
        assert!(page.contains(&expected), "run cargo run --release -p costate-robustness -- --write");
    }
}
