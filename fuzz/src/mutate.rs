//! Mutations of texts, deterministic by seed.

use fastrand::Rng;
use std::ops::Range;

const NUMBERS: [&str; 18] = [
    "NaN",
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "-0",
    "-0.0",
    "1e-320",
    "1e999",
    "99999999999999999999999",
    "-9223372036854775808",
    "18446744073709551615",
    "0",
    "1e17",
    "0x7f",
    "1_000",
    "0.1,0.2",
];

const VALUES: [&str; 14] = [
    "\"text\"",
    "true",
    "null",
    "[]",
    "{}",
    "[[]]",
    "1979-05-27T07:32:00Z",
    "\"\"",
    "'",
    "[1, \"a\"]",
    "{a = 1}",
    "{\"a\":1}",
    "-1",
    "\"${x}\"",
];

const MARKS: [&str; 13] = [
    "\u{0}",
    "\u{1b}[31m",
    "\u{202e}",
    "\u{2066}",
    "\u{feff}",
    "\r",
    "\u{7f}",
    "\u{85}",
    "\u{2028}",
    "\u{200b}",
    "\u{e0041}",
    "\\u0000",
    "&#27;",
];

const BYTES: [&[u8]; 6] =
    [b"\xff", b"\xc3\x28", b"\xed\xa0\x80", b"\xf4\x90\x80\x80", b"\xff\xfe<\0", b"\xc0\x80"];

const MARKUP: [&str; 16] = [
    "<!--",
    "-->",
    "<![CDATA[",
    "]]>",
    "<!DOCTYPE a [<!ENTITY b \"bbbb\">]>",
    "&b;",
    "<?xml version=\"1.0\"?>",
    "</robot>",
    "<a:b/>",
    "xmlns:a=\"b\"",
    "\"\"\"",
    "[[joint]]",
    "[joint]",
    "[[frame]]",
    "[[wrench]]",
    "# ",
];

/// The input with one to four mutations.
pub fn mutated(seeds: &[Vec<u8>], rng: &mut Rng) -> Vec<u8> {
    let Some(seed) = rng.choice(seeds) else { return Vec::new() };
    let mut text = seed.clone();
    for _ in 0..rng.usize(1..=4) {
        once(&mut text, seeds, rng);
    }
    text
}

fn once(text: &mut Vec<u8>, seeds: &[Vec<u8>], rng: &mut Rng) {
    match rng.u8(0..20) {
        0 => flip(text, rng),
        1 => text.truncate(rng.usize(0..=text.len())),
        2 => duplicate(text, line(text, rng), rng),
        3 => drop(text.drain(line(text, rng))),
        4 => duplicate(text, element(text, rng), rng),
        5 => drop(text.drain(element(text, rng))),
        6 | 7 => replace(text, number(text, rng), choice(&NUMBERS, rng).as_bytes()),
        8 => replace(text, number(text, rng), choice(&VALUES, rng).as_bytes()),
        9 => replace(text, quoted(text, rng), choice(&VALUES, rng).as_bytes()),
        10 => nest(text, rng),
        11 => {
            let name = choice(&["x", "\u{e9}", "ab ", "\u{202e}", "\n"], rng).repeat(1 << rng.u32(4..17));
            replace(text, word(text, rng), name.as_bytes());
        }
        12 => insert(text, choice(&MARKS, rng).as_bytes(), rng),
        13 => insert(text, BYTES[rng.usize(0..BYTES.len())], rng),
        14 => insert(text, choice(&MARKUP, rng).as_bytes(), rng),
        15 => misspell(text, rng),
        16 => {
            // A name that is used elsewhere: duplicates, loops, unknown joints.
            let other = text[word(text, rng)].to_vec();
            replace(text, word(text, rng), &other);
        }
        17 => {
            let from = rng.choice(seeds).map_or(&[][..], Vec::as_slice);
            let part = from[rng.usize(0..=from.len())..].to_vec();
            text.truncate(rng.usize(0..=text.len()));
            text.extend(part);
        }
        18 => {
            let part = text[element(text, rng)].to_vec();
            if part.len() < 10_000 {
                insert(text, &part.repeat(rng.usize(2..60)), rng);
            }
        }
        _ => {
            let (a, b) = (line(text, rng), line(text, rng));
            let moved = text[a.clone()].to_vec();
            replace(text, b, &moved);
        }
    }
}

fn choice<'a>(of: &[&'a str], rng: &mut Rng) -> &'a str {
    of[rng.usize(0..of.len())]
}

fn flip(text: &mut [u8], rng: &mut Rng) {
    for _ in 0..rng.usize(1..8) {
        if !text.is_empty() {
            text[rng.usize(0..text.len())] ^= 1 << rng.u8(0..8);
        }
    }
}

fn replace(text: &mut Vec<u8>, range: Range<usize>, by: &[u8]) {
    text.splice(range, by.iter().copied());
}

fn insert(text: &mut Vec<u8>, part: &[u8], rng: &mut Rng) {
    let at = rng.usize(0..=text.len());
    replace(text, at..at, part);
}

fn duplicate(text: &mut Vec<u8>, range: Range<usize>, rng: &mut Rng) {
    let part = text[range.clone()].to_vec();
    // Beside the original, or anywhere.
    if rng.bool() { replace(text, range.end..range.end, &part) } else { insert(text, &part, rng) }
}

/// Openings without an end, or with one, around a part of the text.
fn nest(text: &mut Vec<u8>, rng: &mut Rng) {
    let pairs = [
        ("<link>", "</link>"),
        ("[", "]"),
        ("{\"q\":", "}"),
        ("{a=", "}"),
        ("a.", ""),
        ("(", ")"),
        ("<visual>", ""),
    ];
    let (open, close) = pairs[rng.usize(0..pairs.len())];
    let depth = 1 << rng.u32(1..14);
    let range = if rng.bool() { number(text, rng) } else { word(text, rng) };
    let mut nested = open.repeat(depth).into_bytes();
    nested.extend_from_slice(&text[range.clone()]);
    nested.extend(close.repeat(depth).bytes());
    replace(text, range, &nested);
}

fn misspell(text: &mut Vec<u8>, rng: &mut Rng) {
    let Range { start, end } = word(text, rng);
    if end - start < 2 {
        return;
    }
    let at = rng.usize(start..end - 1);
    match rng.u8(0..3) {
        0 => text.swap(at, at + 1),
        1 => drop(text.remove(at)),
        _ => text.insert(at, text[at]),
    }
}

/// A line with its end.
fn line(text: &[u8], rng: &mut Rng) -> Range<usize> {
    let at = rng.usize(0..=text.len());
    let start = text[..at].iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let end = text[at..].iter().position(|&byte| byte == b'\n').map_or(text.len(), |end| at + end + 1);
    start..end
}

/// What is between two delimiters: an XML tag, an entry of a list, a key with its value.
fn element(text: &[u8], rng: &mut Rng) -> Range<usize> {
    let at = rng.usize(0..=text.len());
    let pairs: [(&[u8], &[u8]); 4] = [(b"<", b">"), (b",[{", b",]}"), (b"[", b"]"), (b" \n", b" \n")];
    let (opening, closing) = pairs[rng.usize(0..pairs.len())];
    let start = text[..at].iter().rposition(|byte| opening.contains(byte)).unwrap_or(0);
    let end =
        text[at..].iter().position(|byte| closing.contains(byte)).map_or(text.len(), |end| at + end + 1);
    start..end
}

/// The next stretch of such bytes after a random place; empty where there is none.
fn stretch(text: &[u8], rng: &mut Rng, belongs: impl Fn(u8) -> bool) -> Range<usize> {
    let at = rng.usize(0..=text.len());
    let Some(start) = text[at..].iter().position(|&byte| belongs(byte)).map(|start| at + start) else {
        return text.len()..text.len();
    };
    let end = text[start..].iter().position(|&byte| !belongs(byte)).map_or(text.len(), |end| start + end);
    start..end
}

fn number(text: &[u8], rng: &mut Rng) -> Range<usize> {
    stretch(text, rng, |byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'-'))
}

fn word(text: &[u8], rng: &mut Rng) -> Range<usize> {
    stretch(text, rng, |byte| byte.is_ascii_alphabetic() || byte == b'_')
}

fn quoted(text: &[u8], rng: &mut Rng) -> Range<usize> {
    let Range { start, end } = stretch(text, rng, |byte| !matches!(byte, b'"' | b'\n'));
    start.saturating_sub(1)..(end + 1).min(text.len())
}
