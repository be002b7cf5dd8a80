//! What is wrong with a TOML text, in the words of its author instead of those of the parser.

use crate::robot::error::RobotError;
use crate::robot::printable::{printable, sentence};

/// Line, from 1, of a byte of the text.
pub(super) fn line(text: &str, byte: usize) -> usize {
    1 + text.bytes().take(byte).filter(|&byte| byte == b'\n').count()
}

/// The parser's error with line, key and remedy.
pub(super) fn refusal(error: toml::de::Error, text: &str) -> RobotError {
    let at = error.span().map(|span| span.start);
    let found = at.map(|at| line(text, at));
    let message = error.message().trim_end();
    let message = if message.starts_with("duplicate key") {
        duplicate(text, error.span())
    } else if let Some((found, expected)) = mismatch(message) {
        let key = at.and_then(|at| key_before(text, at));
        let subject = key.map_or("the value".into(), |key| format!("`{}`", printable(key)));
        format!("{subject} is {found}; give {}", in_plain_words(expected))
    } else if message.contains("recurs") {
        "arrays or tables are nested too deeply; a robot needs four levels at most".into()
    } else if let Some(key) = message.strip_prefix("missing field ") {
        format!("missing key {key}; add it")
    } else if let Some(rest) = message.strip_prefix("unknown field `") {
        format!("unknown key {}", unknown(rest))
    } else if let Some(rest) = message.strip_prefix("unknown variant `") {
        format!("unknown value {}", unknown(rest))
    } else {
        message.into()
    };
    RobotError::Malformed { message, source: Some(Box::new(error)) }.at(found)
}

/// "name`, expected ..." with the name made printable.
fn unknown(rest: &str) -> String {
    match rest.rsplit_once("`, expected ") {
        Some((name, expected)) => format!("`{}`; expected {expected}", printable(name)),
        None => format!("`{}", sentence(rest)),
    }
}

/// What was found and what was expected.
fn mismatch(message: &str) -> Option<(String, &str)> {
    let rest = ["invalid type: ", "invalid value: ", "invalid length "]
        .iter()
        .find_map(|start| message.strip_prefix(start).map(|rest| (*start, rest)));
    let (start, rest) = rest?;
    let (found, expected) = rest.rsplit_once(", expected ")?;
    let found = match found {
        "map" => "a table".into(),
        "sequence" => "an array".into(),
        _ if start == "invalid length " => match found {
            "1" => "an array of one entry".into(),
            _ => format!("an array of {found} entries"),
        },
        found => format!("the {}", printable(found)).replace('`', ""),
    };
    Some((found, expected))
}

/// What the parser expects, without names of types.
fn in_plain_words(expected: &str) -> String {
    match expected {
        "f64" => "a number such as 0.25".into(),
        "a string" => "a text in quotes".into(),
        "a sequence" => "an array in brackets".into(),
        expected => match expected.strip_prefix("an array of length ") {
            Some(length) => format!("an array of {length} numbers"),
            None => expected.into(),
        },
    }
}

/// The key whose value begins at that byte: what is before `=` on the same line.
fn key_before(text: &str, at: usize) -> Option<&str> {
    let before = text.get(..at)?.trim_end().strip_suffix('=')?.trim_end();
    let is_bare = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-');
    let start = before.rfind(|c| !is_bare(c)).map_or(0, |end| end + 1);
    before.get(start..).filter(|key| !key.is_empty())
}

/// A key that is given twice, with the line of the first one where the same table shows it.
fn duplicate(text: &str, span: Option<std::ops::Range<usize>>) -> String {
    let Some(key) = span.clone().and_then(|span| text.get(span)) else {
        return "a key is given twice; keep one of them".into();
    };
    let start = span.map_or(0, |span| span.start);
    let above: Vec<&str> = text.get(..start).unwrap_or_default().lines().collect();
    let is_same = |line: &str| {
        line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='))
    };
    let is_header = |line: &str| line.trim_start().starts_with('[');
    let table = above.iter().rposition(|line| is_header(line)).unwrap_or(0);
    let first = above.iter().skip(table).position(|line| is_same(line)).map(|line| table + line + 1);
    match first {
        Some(first) => {
            format!("the key `{}` is given twice, first in line {first}; keep one", printable(key))
        }
        None => format!("the key `{}` is given twice; keep one", printable(key)),
    }
}
