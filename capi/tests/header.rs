//! `include/costate.h` is what cbindgen makes of the sources.
//!
//! `COSTATE_WRITE=1 cargo test -p costate-capi --test header` writes it.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

use cbindgen::{Bindings, Builder, Config};
use std::collections::BTreeSet;
use std::path::Path;
use std::{env, fs};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// What cbindgen finds in `src/lib.rs` and its modules.
fn bindings() -> Bindings {
    let config = Config::from_file(root().join("cbindgen.toml")).unwrap();
    Builder::new().with_config(config).with_src(root().join("src/lib.rs")).generate().unwrap()
}

fn header() -> String {
    let mut text = Vec::new();
    bindings().write(&mut text);
    String::from_utf8(text).unwrap()
}

#[test]
fn the_header_is_that_of_the_sources() {
    let (file, made) = (root().join("include/costate.h"), header());
    if env::var_os("COSTATE_WRITE").is_some() {
        fs::write(&file, &made).unwrap();
    }
    let found = fs::read_to_string(&file).unwrap_or_default();
    let line = made.lines().zip(found.lines()).take_while(|(made, found)| made == found).count() + 1;
    assert!(
        made == found,
        "include/costate.h differs from the sources in line {line}; this writes it: \
         COSTATE_WRITE=1 cargo test -p costate-capi --test header"
    );
}

/// cbindgen leaves out what it cannot express in C.
#[test]
fn everything_exported_is_in_the_header() {
    let made = header();
    let (mut functions, mut enums) = (BTreeSet::new(), 0);
    for file in fs::read_dir(root().join("src")).unwrap() {
        let text = fs::read_to_string(file.unwrap().path()).unwrap();
        let before = functions.len();
        let exported = text.split("extern \"C\" fn ").skip(1);
        functions.extend(exported.map(|part| part[..part.find('(').unwrap()].to_owned()));
        assert_eq!(functions.len() - before, text.matches("#[unsafe(no_mangle)]").count());
        for part in text.split("#[repr(C)]").skip(1) {
            let name = part.split("pub enum ").nth(1).unwrap();
            let name = &name[..name.find(' ').unwrap()];
            assert!(made.contains(&format!("}} {name};")), "add {name} to cbindgen.toml");
            enums += 1;
        }
    }
    assert!(functions.len() > 25 && enums == 5);
    let bindings = bindings();
    let declared: BTreeSet<_> = bindings.dynamic_symbols_names().map(str::to_owned).collect();
    assert_eq!(functions, declared);
}
