//! Samples as a table in CSV.

use super::samples::Samples;
use std::fmt::Write;

impl Samples {
    /// A table in CSV: one line for each sample after a line of names: t, then q, v, a, tau and u of each of
    /// these joints (q of its [`positions`](Samples::positions), where they have names of their own); with
    /// vias the phase, from 1. Numbers have all their digits.
    pub fn to_csv(&self, joints: &[String]) -> String {
        let lists = [("q", &self.q), ("v", &self.v), ("a", &self.a), ("tau", &self.tau), ("u", &self.u)];
        let mut text = String::from("t");
        for (name, _) in &lists {
            let has_quaternions = *name == "q" && !self.positions.is_empty();
            let names = if has_quaternions { &self.positions[..] } else { joints };
            names.iter().for_each(|joint| text += &format!(",{}", field(&format!("{name}_{joint}"))));
        }
        text += if self.phase.is_empty() { "\n" } else { ",phase\n" };
        for (k, t) in self.t.iter().enumerate() {
            // Writing to a string cannot fail.
            let _ = write!(text, "{t:?}");
            for value in lists.iter().flat_map(|(_, rows)| &rows[k]) {
                let _ = write!(text, ",{value:?}");
            }
            if let Some(phase) = self.phase.get(k) {
                let _ = write!(text, ",{phase}");
            }
            text.push('\n');
        }
        text
    }
}

/// A field of a table, in quotation marks where its characters ask for them (RFC 4180).
fn field(text: &str) -> String {
    match text.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::field;

    #[test]
    fn names_with_commas_are_quoted() {
        assert_eq!(field("q_waist"), "q_waist");
        assert_eq!(field("q_a,\"b\""), "\"q_a,\"\"b\"\"\"");
    }
}
