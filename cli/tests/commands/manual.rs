//! Help texts, shell completions and man pages, and arguments that are refused.

use crate::child::{costate, empty_folder, stderr, stdout};
use std::fs;

const COMMANDS: [&str; 9] =
    ["info", "eval", "check", "count", "bench", "codegen", "optimize", "completions", "man"];

#[test]
fn every_help_text_lists_the_exit_statuses() {
    for arguments in COMMANDS.map(|command| vec![command, "--help"]).into_iter().chain([vec!["--help"]]) {
        let help = costate(&arguments, b"");
        assert!(help.status.success());
        let text = stdout(&help);
        assert!(text.contains("Exit status:") && text.contains("130"), "{text}");
        assert!(text.lines().all(|line| line.chars().count() <= 120), "{text}");
    }
}

#[test]
fn completions_name_the_commands() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = costate(&["completions", shell], b"");
        assert!(script.status.success() && script.stderr.is_empty(), "{shell}");
        for word in ["optimize", "codegen", "tolerance"] {
            assert!(stdout(&script).contains(word), "{shell}: {word}");
        }
    }
    assert_eq!(costate(&["completions", "cmd"], b"").status.code(), Some(2));
}

#[test]
fn man_pages_are_written_for_all_commands() {
    let page = costate(&["man"], b"");
    assert!(stdout(&page).contains(".TH costate 1") && stdout(&page).contains("Exit status"));
    let folder = empty_folder("man").join("man1");
    assert!(costate(&["man", folder.to_str().unwrap()], b"").status.success());
    assert_eq!(fs::read_to_string(folder.join("costate.1")).unwrap(), stdout(&page));
    for command in COMMANDS {
        let page = fs::read_to_string(folder.join(format!("costate-{command}.1"))).unwrap();
        assert!(page.contains(&format!(".TH costate-{command} 1")), "{page}");
    }
    assert_eq!(fs::read_dir(&folder).unwrap().count(), COMMANDS.len() + 1);
}

#[test]
fn numbers_out_of_range_are_refused_as_numbers() {
    for (command, flag, number) in [
        ("check", "--tolerance", "-1"),
        ("check", "--tolerance", "0"),
        ("check", "--tolerance", "nan"),
        ("check", "--tolerance", "inf"),
        ("check", "--samples", "-1"),
        ("bench", "--batches", "-3"),
        ("bench", "--seed", "-1"),
    ] {
        let output = costate(&[command, "robots/two_link.toml", flag, number], b"");
        assert_eq!(output.status.code(), Some(2), "{command} {flag} {number}");
        let message = stderr(&output);
        assert!(message.contains(&format!("invalid value '{number}' for '{flag}")), "{message}");
    }
}
