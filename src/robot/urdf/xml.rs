//! From the text of a URDF to its XML elements.
//!
//! Published files have blank lines before the XML declaration, `--` inside comments and undeclared namespace
//! prefixes. XML forbids these, the usual readers of URDF accept them, and so does this one. What could make
//! a small text expensive is refused first: document types, long texts, thousands of attributes or
//! namespaces.

use crate::robot::error::RobotError;
use crate::robot::format::RobotFormat;
use roxmltree::{Document, Error, Node, ParsingOptions};

/// Most elements and texts of a document, about 70 bytes of memory each; 10 000 joints need 300 000.
const MOST_NODES: u32 = 500_000;
/// Most attributes of one element: the parser compares each of them with every other.
const MOST_ATTRIBUTES: usize = 256;
/// Most attributes of all elements, about 60 bytes of memory each.
const MOST_ATTRIBUTES_IN_ALL: usize = 1_000_000;
/// Most characters `<` outside comments: the parser reserves the memory of an element for each.
const MOST_OPENINGS: usize = 1_000_000;
/// Most characters `=` outside comments: the parser reserves the memory of an attribute for each.
const MOST_EQUAL_SIGNS: usize = 1_000_000;
/// Most namespace declarations: the parser copies those of an element to its children.
const MOST_NAMESPACES: usize = 256;
/// Most undeclared prefixes that are declared for the file.
const MOST_PREFIXES: usize = 64;

/// Where the lines of a text begin (bytes); finding a line here does not read the text again.
pub(super) struct Lines(Vec<u32>);

impl Lines {
    pub(super) fn of(text: &str) -> Self {
        let ends = || text.match_indices('\n').map(|(end, _)| end as u32 + 1);
        let mut starts = Vec::with_capacity(1 + ends().count());
        starts.push(0);
        starts.extend(ends());
        Self(starts)
    }

    /// Number of lines.
    fn count(&self) -> usize {
        self.0.len()
    }

    /// Line, from 1, of a byte of the text.
    fn at(&self, byte: usize) -> usize {
        self.0.partition_point(|&start| start as usize <= byte)
    }

    /// Line, from 1, on which the element begins.
    pub(super) fn line(&self, node: Node<'_, '_>) -> usize {
        self.at(node.range().start)
    }
}

/// A text that [`parse`] accepts, with the lines of the original.
pub(super) fn prepared(text: &str) -> Result<String, RobotError> {
    let most = RobotFormat::Urdf.most_bytes();
    if text.len() > most {
        return Err(RobotError::TooLong { most });
    }
    RobotFormat::Urdf.check_text(text)?;
    let text = without_comments(text);
    check_size(&text)?;
    Ok(with_prefixes_declared(text))
}

/// The document of a text.
pub(super) fn parse<'a>(text: &'a str, lines: &Lines) -> Result<Document<'a>, RobotError> {
    parse_xml(text).map_err(|error| refusal(error, text, lines))
}

fn parse_xml(text: &str) -> Result<Document<'_>, Error> {
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options)
}

fn refusal(error: Error, text: &str, lines: &Lines) -> RobotError {
    let (line, message) = match &error {
        Error::DtdDetected => {
            return RobotError::DocumentType.at(text.find("<!DOCTYPE").map(|byte| lines.at(byte)));
        }
        Error::UnclosedRootNode | Error::UnexpectedEndOfStream => {
            (lines.count(), "the text ends inside an element; complete the file".into())
        }
        Error::NodesLimitReached => {
            (1, format!("the file has more than {MOST_NODES} elements and texts; remove visual models"))
        }
        error => {
            let (at, whole) = (error.pos(), error.to_string());
            let problem = whole.strip_suffix(&format!(" at {at}")).unwrap_or(&whole);
            (at.row as usize, format!("not well-formed XML: {problem} (column {}); correct it", at.col))
        }
    };
    RobotError::Malformed { message, source: Some(Box::new(error)) }.at(line)
}

/// Refuses elements with very many attributes and texts with very many namespaces.
fn check_size(text: &str) -> Result<(), RobotError> {
    let refused = |byte: usize, message: String| {
        let line = 1 + text.bytes().take(byte).filter(|&byte| byte == b'\n').count();
        Err(RobotError::malformed(message).at(line))
    };
    if let Some((byte, _)) = text.match_indices("xmlns").nth(MOST_NAMESPACES) {
        return refused(byte, format!("the file declares more than {MOST_NAMESPACES} namespaces"));
    }
    for (character, most) in [('<', MOST_OPENINGS), ('=', MOST_EQUAL_SIGNS)] {
        if let Some((byte, _)) = text.match_indices(character).nth(most) {
            let message =
                format!("the file has more than {most} characters `{character}`; remove visual models");
            return refused(byte, message);
        }
    }
    let (mut is_tag, mut quote) = (false, None);
    let (mut element, mut values, mut all) = (0, 0, 0);
    for (byte, c) in text.bytes().enumerate() {
        match (c, quote) {
            // No attribute value may contain `<`, so a new element ends whatever was left open.
            (b'<', _) => (is_tag, quote, element, values) = (true, None, byte, 0),
            _ if !is_tag => {}
            (b'!' | b'?', None) if byte == element + 1 => is_tag = false,
            (b'"' | b'\'', None) => (quote, values, all) = (Some(c), values + 1, all + 1),
            (b'>', None) => is_tag = false,
            (c, Some(open)) if c == open => quote = None,
            _ => {}
        }
        if values > MOST_ATTRIBUTES {
            return refused(element, format!("an element has more than {MOST_ATTRIBUTES} attributes"));
        }
        if all > MOST_ATTRIBUTES_IN_ALL {
            return refused(element, format!("the file has more than {MOST_ATTRIBUTES_IN_ALL} attributes"));
        }
    }
    Ok(())
}

/// The text with undeclared namespace prefixes declared in `<robot>`, on the same line.
fn with_prefixes_declared(mut text: String) -> String {
    if !matches!(parse_xml(&text), Err(Error::UnknownNamespace(..))) {
        return text;
    }
    let mut prefixes: Vec<&str> = Vec::new();
    for (colon, _) in text.match_indices(':') {
        let is_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | '.');
        let start = text[..colon]
            .rfind(|c| !is_name(c))
            .map_or(0, |before| before + text[before..].chars().next().map_or(1, char::len_utf8));
        let (prefix, before) = (&text[start..colon], text[..start].chars().next_back());
        let is_prefix = before.is_some_and(|c| matches!(c, '<' | '/') || c.is_whitespace())
            && prefix.starts_with(|c: char| c.is_alphabetic() || c == '_')
            && !["xml", "xmlns"].contains(&prefix);
        if is_prefix && !prefixes.contains(&prefix) && prefixes.len() < MOST_PREFIXES {
            prefixes.push(prefix);
        }
    }
    prefixes.retain(|prefix| !text.contains(&format!("xmlns:{prefix}")));
    let declarations: String =
        prefixes.iter().map(|prefix| format!(" xmlns:{prefix}=\"undeclared:{prefix}\"")).collect();
    if let Some(root) = text.find("<robot") {
        text.insert_str(root + "<robot".len(), &declarations);
    }
    text
}

/// The text without byte order mark, XML declaration and comments. Lines stay where they are.
fn without_comments(text: &str) -> String {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    let start = text.len() - text.trim_start().len();
    if text[start..].starts_with("<?xml") {
        let end = text.find("?>").map_or(text.len(), |end| end + 2);
        blank(&text[..end], &mut out);
        rest = &text[end..];
    }
    while let Some(at) = rest.find("<!") {
        let (before, from) = rest.split_at(at);
        out += before;
        let (is_comment, end) = match (from.starts_with("<!--"), from.starts_with("<![CDATA[")) {
            (true, _) => (true, from[4..].find("-->").map(|end| end + 7)),
            (_, true) => (false, from.find("]]>").map(|end| end + 3)),
            _ => (false, Some(2)),
        };
        let Some(end) = end else {
            rest = from;
            break;
        };
        if is_comment {
            blank(&from[..end], &mut out)
        } else {
            out += &from[..end]
        }
        rest = &from[end..];
    }
    out + rest
}

/// As many lines, with nothing on them.
fn blank(text: &str, out: &mut String) {
    out.extend(text.chars().filter(|&c| c == '\n'));
}

#[cfg(test)]
mod tests {
    use super::{Lines, prepared};

    #[test]
    fn what_would_take_hundreds_of_megabytes_is_refused_before_it_is_parsed() {
        for (text, character) in [("<", '<'), ("<!", '<'), ("=", '=')] {
            let message = prepared(&text.repeat(1_000_001)).err().map(|error| error.to_string());
            let expected = format!("more than 1000000 characters `{character}`");
            assert!(message.as_ref().is_some_and(|message| message.contains(&expected)), "{message:?}");
        }
        assert!(prepared(&"<!-- = -->\n".repeat(1_000_001)).is_ok());
    }

    #[test]
    fn a_byte_has_its_line() {
        let lines = Lines::of("a\n\nb\n");
        assert_eq!((lines.count(), [0, 1, 2, 3, 4].map(|byte| lines.at(byte))), (4, [1, 1, 2, 3, 3]));
    }
}
