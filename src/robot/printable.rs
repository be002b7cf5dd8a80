//! Text from files, made safe to print: on a terminal, in a log, in a message.

use std::borrow::Cow;
use std::fmt::{self, Display, Write};

/// Longest part of a name that messages quote (characters).
const LONGEST_NAME: usize = 80;
/// Longest part of a sentence that quotes a file (characters).
const LONGEST_SENTENCE: usize = 1000;
/// Names that a message lists before it counts the rest.
const LISTED_NAMES: usize = 10;

/// A name as a message shows it: without anything that could change the terminal or hide what is meant.
///
/// Control characters (among them ESC, NUL and line ends), marks that change the direction of the text, and
/// invisible characters appear as escapes such as `\n` or `\u{202e}`. A name of more than 80 characters is
/// cut, with its length.
///
/// ```
/// use costate::robot::printable;
/// assert_eq!(printable("elbow").to_string(), "elbow");
/// assert_eq!(printable("red\u{1b}[31m\nline").to_string(), r"red\u{1b}[31m\nline");
/// assert!(printable(&"x".repeat(5000)).to_string().ends_with("... (5000 characters)"));
/// ```
pub fn printable(name: &str) -> Printable<'_> {
    Printable { text: name, longest: LONGEST_NAME }
}

/// Text of any length with the characters escaped that [`printable`] escapes; nothing is cut.
///
/// ```
/// use costate::robot::escape_hidden;
/// assert_eq!(escape_hidden("elbow"), "elbow");
/// assert_eq!(escape_hidden("a\u{1b}[2J\u{202e}b"), r"a\u{1b}[2J\u{202e}b");
/// ```
pub fn escape_hidden(text: &str) -> Cow<'_, str> {
    if !text.contains(is_hidden) {
        return text.into();
    }
    Printable { text, longest: usize::MAX }.to_string().into()
}

/// A number as a message shows it: with an exponent from a million on and below 1e-4.
///
/// ```
/// use costate::robot::printable_number;
/// assert_eq!([0.5, -2.0, 1e308, 2.5e-7].map(printable_number), ["0.5", "-2", "1e308", "2.5e-7"]);
/// ```
pub fn printable_number(number: f64) -> String {
    let size = number.abs();
    let is_short = size == 0.0 || !size.is_finite() || (1e-4..1e6).contains(&size);
    if is_short { number.to_string() } else { format!("{number:e}") }
}

/// A whole message that quotes a file.
pub(crate) fn sentence(text: &str) -> Printable<'_> {
    Printable { text, longest: LONGEST_SENTENCE }
}

/// What [`printable`] returns; its `Display` is the safe text.
#[derive(Clone, Copy, Debug)]
pub struct Printable<'a> {
    text: &'a str,
    longest: usize,
}

impl Display for Printable<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_cut = self.text.chars().nth(self.longest).is_some();
        for c in self.text.chars().take(self.longest) {
            if is_hidden(c) { write!(f, "{}", c.escape_default())? } else { f.write_char(c)? }
        }
        if is_cut { write!(f, "... ({} characters)", self.text.chars().count()) } else { Ok(()) }
    }
}

/// Control characters, separators of lines, marks of direction, and characters without a glyph.
fn is_hidden(c: char) -> bool {
    c.is_control()
        || matches!(
            c,
            '\u{ad}' | '\u{61c}' | '\u{180e}' | '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}'
                | '\u{2060}'..='\u{206f}' | '\u{feff}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}'
        )
}

/// The names, separated by `separator`; of many only the first few and the number of the others.
pub(crate) fn list<S: AsRef<str>>(names: &[S], separator: &str) -> String {
    let shown = names.iter().take(LISTED_NAMES).map(|name| printable(name.as_ref()).to_string());
    let mut text = shown.collect::<Vec<_>>().join(separator);
    if let Some(others) = names.len().checked_sub(LISTED_NAMES).filter(|&others| others > 0) {
        text += &format!("{separator}... ({others} more)");
    }
    text
}

/// `joint a` or `joints a, b`.
pub(crate) fn joints<S: AsRef<str>>(names: &[S]) -> String {
    format!("{} {}", if names.len() == 1 { "joint" } else { "joints" }, list(names, ", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hidden_characters_are_escaped_and_letters_of_any_script_are_not() {
        let hidden = "a\u{1b}[2J\0\n\r\t\u{7f}\u{9b}\u{202e}\u{2066}\u{200f}\u{feff}\u{2028}\u{ad}";
        let shown = printable(hidden).to_string();
        assert!(shown.chars().all(|c| !is_hidden(c)), "{shown}");
        assert!(shown.starts_with(r"a\u{1b}[2J\u{0}\n\r\t\u{7f}\u{9b}\u{202e}"), "{shown}");
        for plain in ["elbow", "\u{e9}paule", "\u{80a9}", "\u{5db}\u{5ea}\u{5e3}", "a'b\"c\\d"] {
            assert_eq!(printable(plain).to_string(), plain);
        }
    }

    #[test]
    fn lists_are_cut() {
        let names: Vec<String> = (0..25).map(|k| format!("j{k}")).collect();
        assert_eq!(joints(&names[..1]), "joint j0");
        assert_eq!(joints(&names[..2]), "joints j0, j1");
        assert!(list(&names, " -> ").ends_with("j9 -> ... (15 more)"));
    }
}
