//! The examples in C and C++, compiled by the compilers of the system and linked with the library.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folder of the library, which cargo builds for this test.
fn libraries() -> PathBuf {
    env::current_exe().unwrap().parent().unwrap().to_owned()
}

/// Compiles an example and runs it; nothing where the system has no such compiler.
fn run(compiler: &str, standard: &str, file: &str, arguments: &[&Path]) {
    if Command::new(compiler).arg("--version").output().is_err() {
        println!("{compiler} is not installed: {file} is not compiled here");
        return;
    }
    let folder = libraries();
    assert!(folder.join("libcostate_c.so").exists() || !cfg!(target_os = "linux"));
    let program = folder.join(file.replace('.', "_"));
    let mut compile = Command::new(compiler);
    compile
        .args([standard, "-O1", "-Wall", "-Wextra", "-Werror", "-pthread", "-I"])
        .arg(root().join("include"));
    compile.arg(root().join("examples").join(file)).arg("-o").arg(&program);
    compile
        .arg("-L")
        .arg(&folder)
        .arg(format!("-Wl,-rpath,{}", folder.display()))
        .args(["-lcostate_c", "-lm"]);
    let done = compile.output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let done = Command::new(&program).args(arguments).output().unwrap();
    let text = String::from_utf8_lossy(&done.stdout).into_owned() + &String::from_utf8_lossy(&done.stderr);
    assert!(done.status.success(), "{text}");
    println!("{text}");
}

#[test]
fn the_example_in_c_finds_closed_forms_and_typed_errors() {
    run("cc", "-std=c99", "pendulum.c", &[]);
}

#[test]
fn the_example_in_cpp_computes_on_two_threads() {
    run("c++", "-std=c++17", "threads.cpp", &[&root().join("../robots/ur5.urdf")]);
}
