//! Tables, and where they go in BENCHMARKS.md.

use crate::fit::Power;
use std::path::Path;

/// Three digits and a unit.
pub fn duration(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "-".into();
    }
    let (scale, unit) = match seconds {
        s if s >= 1.0 => (1.0, "s"),
        s if s >= 1e-3 => (1e3, "ms"),
        s if s >= 1e-6 => (1e6, "\u{b5}s"),
        _ => (1e9, "ns"),
    };
    let value = scale * seconds;
    let digits = if value < 10.0 {
        2
    } else if value < 100.0 {
        1
    } else {
        0
    };
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} {unit}")
}

/// "1.02 ± 0.01", the standard error behind.
pub fn exponent(power: Option<Power>) -> String {
    power.map_or_else(|| "-".into(), |power| format!("{:.2} \u{b1} {:.2}", power.exponent, power.error))
}

/// A table of Markdown.
pub fn markdown(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|cell| (*cell).to_owned()).collect();
    let rows: String = rows.iter().map(|row| line(row)).collect();
    format!("{}|{}\n{rows}", line(&head), "---|".repeat(head.len()))
}

/// Puts a text between the marks of its name.
pub fn put(path: &Path, name: &str, text: &str) -> Result<(), String> {
    let named = |error: std::io::Error| format!("{}: {error}", path.display());
    let begin = format!("<!-- {name}: begin (written by costate-motions --write) -->\n");
    let end = format!("<!-- {name}: end -->");
    let old = std::fs::read_to_string(path).map_err(named)?;
    let missing = || format!("{} has no marks for {name}", path.display());
    let (before, rest) = old.split_once(&begin).ok_or_else(missing)?;
    let (_, after) = rest.split_once(&end).ok_or_else(missing)?;
    std::fs::write(path, format!("{before}{begin}{text}{end}{after}")).map_err(named)
}

#[cfg(test)]
mod tests {
    use super::duration;

    #[test]
    fn durations_have_three_digits() {
        let texts =
            [(1.234, "1.23 s"), (0.1, "100 ms"), (0.01, "10 ms"), (1.5e-5, "15 \u{b5}s"), (2e-9, "2 ns")];
        for (seconds, text) in texts {
            assert_eq!(duration(seconds), text);
        }
        assert_eq!(duration(f64::NAN), "-");
    }
}
