//! A program by the C compiler.

use crate::candidate::Candidate;
use costate::codegen::{COptions, Program};
use libloading::{Library, Symbol};
use std::fmt::Write;
use std::process::Command;

type Entry = unsafe extern "C" fn(*const f64, *mut f64);

/// Compiles the C source by `cc -O3 -march=native -ffp-contract=fast`.
pub fn compile(program: &Program) -> Candidate {
    let mut source = program.to_c(&COptions::default().with_limit(usize::MAX)).unwrap();
    let mut parts = Vec::new();
    let mut at = 0;
    for argument in program.arguments() {
        parts.push(format!("x + {at}"));
        at += argument.entries;
    }
    at = 0;
    for result in program.results() {
        parts.push(format!("y + {at}"));
        at += result.entries.len();
    }
    writeln!(source, "void run(const double *x, double *y) {{ {}({}); }}", program.name(), parts.join(", "))
        .unwrap();
    let folder = std::env::temp_dir().join(format!("costate-jit-compare-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let (file, library) = (folder.join("program.c"), folder.join(format!("{}.so", program.name())));
    std::fs::write(&file, source).unwrap();
    let status = Command::new("cc")
        .args(["-O3", "-march=native", "-ffp-contract=fast", "-shared", "-fPIC", "-o"])
        .args([&library, &file])
        .arg("-lm")
        .status();
    assert!(status.unwrap().success(), "cc failed");
    // SAFETY: the library was just made; it has no initialisers, and a function `run` of this type.
    let library = unsafe { Library::new(&library) }.unwrap();
    let symbol: Symbol<Entry> = unsafe { library.get(b"run") }.unwrap();
    let function = *symbol;
    std::fs::remove_dir_all(&folder).unwrap();
    let (inputs, outputs) = (program.inputs(), program.outputs());
    Candidate::new(0, move |x, y| {
        let _keep = &library;
        assert!(x.len() == inputs && y.len() == outputs);
        // SAFETY: the lengths are those of the program.
        unsafe { function(x.as_ptr(), y.as_mut_ptr()) }
    })
}
