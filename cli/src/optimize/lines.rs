//! Where a key stands in a TOML text.

use std::ops::Range;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// Line of a byte of the text, from 1.
pub fn line_at(text: &str, offset: usize) -> usize {
    1 + text.bytes().take(offset).filter(|&byte| byte == b'\n').count()
}

/// Line of `table.key`, or of the table where the key is missing; `None` where both are.
pub fn line_of(text: &str, path: &str) -> Option<usize> {
    let document = DeTable::parse(text).ok()?;
    let mut table = document.get_ref();
    let mut line = None;
    for name in path.split('.') {
        let Some((key, value)) = table.iter().find(|(key, _)| key.get_ref() == name) else { break };
        line = Some(line_at(text, Spanned::span(key).start));
        let DeValue::Table(inner) = value.get_ref() else { break };
        table = inner;
    }
    line
}

/// The key, tables before it, to which a part of the text belongs; `None` where the text is no TOML, or the part is that of
/// several keys.
pub fn key_at(text: &str, part: &Range<usize>) -> Option<String> {
    let document = DeTable::parse(text).ok()?;
    innermost(document.get_ref(), part)
}

fn innermost(table: &DeTable<'_>, part: &Range<usize>) -> Option<String> {
    table.iter().find_map(|(key, value)| {
        let name = key.get_ref();
        let inner = match value.get_ref() {
            DeValue::Table(inner) => innermost(inner, part).map(|inner| format!("{name}.{inner}")),
            _ => None,
        };
        let holds = |span: Range<usize>| span.start <= part.start && part.end <= span.end;
        let here = || holds(Spanned::span(key)) || holds(Spanned::span(value));
        inner.or_else(|| here().then(|| name.to_string()))
    })
}

#[cfg(test)]
mod tests {
    use super::{key_at, line_of};

    #[test]
    fn the_key_at_a_place_has_its_tables_before_it() {
        let text = "robot = \"a\"\n[start]\nq = [1, 2]\ntime = { free = true }\n";
        for (place, key) in
            [("robot", "robot"), ("\"a\"", "robot"), ("2]", "start.q"), ("true", "start.time.free")]
        {
            let start = text.find(place).unwrap();
            assert_eq!(key_at(text, &(start..start + 1)).as_deref(), Some(key), "{place}");
        }
        assert_eq!(key_at(text, &(0..text.len())), None);
        assert_eq!(key_at("q = [", &(4..5)), None);
    }

    #[test]
    fn keys_are_found_in_tables_of_either_form() {
        let text = "robot = \"a\"\n\n[start]\nq = [\n  1.0,\n]\n[end]\nq = [1]\n";
        for (path, line) in [("robot", 1), ("start.q", 4), ("end.q", 8), ("end.v", 7)] {
            assert_eq!(line_of(text, path), Some(line), "{path}");
        }
        assert_eq!(line_of("time = { free = true }", "time.guess"), Some(1));
        assert_eq!(line_of(text, "bounds.u_min"), None);
    }
}
