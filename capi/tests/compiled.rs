//! The header and the examples in C and C++, compiled by the compilers of the system, and what docs/capi.md
//! has of them.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folder of the library, which cargo builds for this test.
fn libraries() -> PathBuf {
    env::current_exe().unwrap().parent().unwrap().to_owned()
}

/// A compiler with all its warnings as errors; none where the system has no such compiler.
fn compiler(name: &str, standard: &str) -> Option<Command> {
    if Command::new(name).arg("--version").output().is_err() {
        println!("{name} is not installed: nothing is compiled with it here");
        return None;
    }
    let mut compiler = Command::new(name);
    compiler.args([standard, "-O1", "-Wall", "-Wextra", "-pedantic", "-Werror", "-I"]);
    compiler.arg(root().join("include"));
    Some(compiler)
}

fn succeed(mut command: Command) -> String {
    let done = command.output().unwrap();
    assert!(done.status.success(), "{command:?}: {}", String::from_utf8_lossy(&done.stderr));
    String::from_utf8(done.stdout).unwrap()
}

/// Compiles an example and runs it in the folder of the repository: what it prints.
fn run(name: &str, standard: &str, file: &str, arguments: &[&str]) -> Option<String> {
    let (mut compile, folder) = (compiler(name, standard)?, libraries());
    assert!(folder.join("libcostate_c.so").exists() || !cfg!(target_os = "linux"));
    let program = folder.join(format!("{}_by_{name}", file.replace('.', "_")));
    // An example in C is one in C++ too.
    compile.args(["-pthread", "-x", if name == "cc" { "c" } else { "c++" }]);
    compile.arg(root().join("examples").join(file)).args(["-x", "none", "-o"]).arg(&program);
    compile.arg("-L").arg(&folder).arg(format!("-Wl,-rpath,{}", folder.display()));
    compile.args(["-lcostate_c", "-lm"]);
    succeed(compile);
    let mut example = Command::new(&program);
    example.args(arguments).current_dir(root().join(".."));
    Some(succeed(example))
}

#[test]
fn the_header_is_c_and_cpp_of_any_age() {
    for (name, language, standards) in [
        ("cc", "c", ["-std=c89", "-std=c99", "-std=c11"]),
        ("c++", "c++", ["-std=c++98", "-std=c++11", "-std=c++17"]),
    ] {
        for standard in standards {
            let Some(mut compile) = compiler(name, standard) else { continue };
            // cbindgen writes a comma after the last value of an enum: an extension of the oldest standards.
            compile.args(["-std=c89", "-std=c++98"].contains(&standard).then_some("-Wno-pedantic"));
            compile.args(["-fsyntax-only", "-x", language]).arg(root().join("include/costate.h"));
            succeed(compile);
        }
    }
}

#[test]
fn the_example_in_c_finds_closed_forms_and_typed_errors() {
    for text in [run("cc", "-std=c99", "pendulum.c", &[]), run("c++", "-std=c++17", "pendulum.c", &[])] {
        assert!(text.is_none_or(|text| text.contains("all is as expected")));
    }
}

#[test]
fn the_examples_in_cpp_compute_on_one_thread_and_on_two() {
    let text = run("c++", "-std=c++17", "derivatives.cpp", &[]);
    assert!(text.is_none_or(|text| text.lines().count() == 7));
    run("c++", "-std=c++17", "threads.cpp", &["robots/ur5.urdf"]);
}

/// The page of this interface.
fn page() -> String {
    fs::read_to_string(root().join("../docs/capi.md")).unwrap()
}

/// Words, and numbers with their values.
fn parts(text: &str) -> (Vec<&str>, Vec<f64>) {
    let number = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
    let words = text.split(number).map(str::trim).filter(|word| !word.is_empty()).collect();
    let numbers = text.split(|c| !number(c)).filter_map(|part| part.parse().ok()).collect();
    (words, numbers)
}

#[test]
fn the_page_has_what_its_programs_write() {
    let page = page();
    let quoted = page.split("```text\n").nth(1).unwrap();
    let quoted = &quoted[..quoted.find("```").unwrap()];
    let picture = fs::read_to_string(root().join("../docs/capi.svg")).unwrap();
    let written = [
        (run("cc", "-std=c99", "derivatives.c", &[]), quoted, 2e-3),
        (run("c++", "-std=c++17", "derivatives.c", &[]), quoted, 2e-3),
        // Tenths of a pixel, percents.
        (run("c++", "-std=c++17", "covariance.cpp", &[]), &picture, 1.0),
    ];
    for (text, expected, tolerance) in written {
        let Some(text) = text else { continue };
        let ((words, numbers), (expected_words, expected)) = (parts(&text), parts(expected));
        assert_eq!(words, expected_words, "bash docs/update capi writes it");
        assert!(numbers.len() == expected.len() && numbers.len() > 5);
        assert!(numbers.iter().zip(&expected).all(|(a, b)| (a - b).abs() <= tolerance), "{text}");
    }
}

fn plain(text: &str) -> String {
    text.split_whitespace().collect()
}

#[test]
fn programs_on_the_page_are_the_examples() {
    let page = page();
    for (language, files) in [("c", &["derivatives.c"][..]), ("cpp", &["derivatives.cpp", "covariance.cpp"])]
    {
        let example = |file| fs::read_to_string(root().join("examples").join(file)).unwrap();
        let examples: Vec<String> = files.iter().map(|file| plain(&example(file))).collect();
        let fence = format!("```{language}\n");
        let blocks = page.split(&fence).skip(1);
        let blocks: Vec<String> = blocks.map(|block| plain(&block[..block.find("```").unwrap()])).collect();
        // The first is a whole program.
        assert_eq!(blocks[0], examples[0]);
        assert!(blocks.iter().all(|block| examples.iter().any(|example| example.contains(block))));
    }
}
