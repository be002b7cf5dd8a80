//! The corpus, large inputs and a few hundred mutated ones are read without panic, within bounds of memory
//! and time.

#![expect(clippy::unwrap_used, reason = "tests fail by panicking")]

use std::process::Command;

fn fuzz(arguments: &[&str]) {
    let output = Command::new(env!("CARGO_BIN_EXE_costate-fuzz")).args(arguments).output().unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    println!("{text}");
    assert!(output.status.success(), "{text}{}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn the_corpus_large_inputs_and_mutated_ones_are_read_within_bounds() {
    fuzz(&["--replay"]);
    fuzz(&["--inputs", "500", "--seed", "14"]);
}
