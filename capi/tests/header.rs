//! `include/costate.h` declares what the library exports: the same functions, arguments and codes.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

/// Result and arguments of a function, as C writes them: type and name of each argument.
type Signature = (String, Vec<(String, String)>);

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A type of Rust in C; handles are `costate_` and the rest of their name in small letters.
fn c_type(rust: &str) -> String {
    if let Some(rest) = rust.strip_prefix("*const ") {
        return pointer(&c_type(rest), true);
    }
    if let Some(rest) = rust.strip_prefix("*mut ") {
        return pointer(&c_type(rest), false);
    }
    match rust {
        "f64" => "double".into(),
        "usize" => "size_t".into(),
        "c_int" => "int".into(),
        "c_uint" => "unsigned int".into(),
        "c_char" => "char".into(),
        handle if handle.starts_with("Costate") => handle.replacen("Costate", "costate_", 1).to_lowercase(),
        other => panic!("{other} has no counterpart in C"),
    }
}

/// A pointer to this type; the second star of a pointer to a pointer has no blank before it.
fn pointer(to: &str, constant: bool) -> String {
    let star = if to.ends_with('*') { "*" } else { " *" };
    if constant && !to.ends_with('*') { format!("const {to}{star}") } else { format!("{to}{star}") }
}

/// The text between the parenthesis at the start and its partner.
fn in_parentheses(text: &str) -> &str {
    let end = text.find(')').unwrap();
    &text[1..end]
}

fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn exported() -> BTreeMap<String, Signature> {
    let mut all = BTreeMap::new();
    for file in fs::read_dir(root().join("src")).unwrap() {
        let text = fs::read_to_string(file.unwrap().path()).unwrap();
        let exports = text.matches("#[unsafe(no_mangle)]").count();
        let before = all.len();
        for part in text.split("extern \"C\" fn ").skip(1) {
            let open = part.find('(').unwrap();
            let inside = in_parentheses(&part[open..]);
            let rest = &part[open + inside.len() + 2..];
            let result = rest[..rest.find('{').unwrap()].trim().trim_start_matches("->").trim();
            let result = if result.is_empty() { "void".into() } else { c_type(result) };
            let arguments = inside.split(',').map(words).filter(|argument| !argument.is_empty());
            let arguments = arguments.map(|argument| {
                let (name, kind) = argument.split_once(": ").unwrap();
                (c_type(kind), name.to_owned())
            });
            all.insert(part[..open].to_owned(), (result, arguments.collect()));
        }
        assert_eq!(all.len() - before, exports, "every function that is exported was found");
    }
    all
}

fn declared() -> BTreeMap<String, Signature> {
    let text = fs::read_to_string(root().join("include/costate.h")).unwrap();
    let mut plain = String::new();
    let mut rest = text.as_str();
    while let Some(start) = rest.find("/*") {
        plain += &rest[..start];
        rest = &rest[start..][rest[start..].find("*/").unwrap() + 2..];
    }
    plain += rest;
    let plain: Vec<&str> = plain.lines().filter(|line| !line.starts_with('#')).collect();
    let split = |declaration: &str| {
        let name = declaration.rfind([' ', '*']).unwrap() + 1;
        (declaration[..name].trim_end().to_owned(), declaration[name..].to_owned())
    };
    let functions = plain.join("\n");
    let functions = functions.split(';').filter(|text| text.contains('(') && !text.contains("typedef"));
    let signature = |text: &str| {
        let text = words(text.rsplit('{').next().unwrap());
        let open = text.find('(').unwrap();
        let (result, name) = split(&text[..open]);
        let inside = in_parentheses(&text[open..]);
        let arguments = inside.split(", ").filter(|argument| *argument != "void").map(split);
        (name, (result, arguments.collect()))
    };
    functions.map(signature).collect()
}

#[test]
fn the_header_declares_what_is_exported() {
    let (exported, declared) = (exported(), declared());
    assert!(exported.len() > 25);
    assert_eq!(exported, declared);
}

#[test]
fn codes_are_those_of_the_header() {
    let header = fs::read_to_string(root().join("include/costate.h")).unwrap();
    let source = fs::read_to_string(root().join("src/status.rs")).unwrap();
    let body = source.split("pub enum Status {").nth(1).unwrap();
    let body = &body[..body.find('}').unwrap()];
    let mut count = 0;
    for line in body.lines().filter_map(|line| line.trim().strip_suffix(',')) {
        let (name, value) = line.split_once(" = ").unwrap();
        let spelled: String = name
            .chars()
            .enumerate()
            .flat_map(|(k, c)| (k > 0 && c.is_uppercase()).then_some('_').into_iter().chain(c.to_uppercase()))
            .collect();
        assert!(header.contains(&format!("COSTATE_{spelled} = {value}")), "{name}");
        count += 1;
    }
    assert_eq!(count, 11);
}
