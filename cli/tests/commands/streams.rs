//! Standard streams, signals, output files and names from robot files.

use crate::child::{command, costate, empty_folder, json_lines, root, stderr, stdout};
use std::fs;
use std::process::Stdio;

const STATE: &[u8] = br#"{"q":[0.1,0.2],"p":[0.3,0.4]}"#;

#[test]
fn a_closed_standard_error_is_no_panic() {
    for (arguments, code) in [
        (&["info", "robots/nowhere.urdf"][..], 2),
        (&["count", "robots/puma560.toml"], 0),
        (&["eval", "robots/two_link.toml", "--states", "tests/fixtures/panda.jsonl"], 2),
    ] {
        let mut child = command(arguments).spawn().unwrap();
        drop((child.stderr.take(), child.stdin.take()));
        assert_eq!(child.wait_with_output().unwrap().status.code(), Some(code), "{arguments:?}");
    }
}

#[test]
fn a_closed_standard_output_ends_the_command_quietly() {
    for arguments in [
        &["info", "robots/ur5.urdf"][..],
        &["codegen", "robots/two_link.toml", "--quantity", "f"],
        &["completions", "bash"],
        &["man"],
    ] {
        let mut child = command(arguments).spawn().unwrap();
        drop((child.stdout.take(), child.stdin.take()));
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{arguments:?}: {}", stderr(&output));
    }
}

#[test]
fn a_robot_is_read_from_standard_input() {
    for robot in ["robots/two_link.toml", "robots/ur5.urdf"] {
        let text = fs::read(root().join(robot)).unwrap();
        let from_file = costate(&["info", robot, "--json"], b"");
        assert_eq!(stdout(&costate(&["info", "-", "--json"], &text)), stdout(&from_file), "{robot}");
    }
    let toml = fs::read(root().join("robots/two_link.toml")).unwrap();
    let refused = costate(&["info", "-", "--format", "urdf"], &toml);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).starts_with("error: standard input:"), "{}", stderr(&refused));
    let folder = empty_folder("robot_without_extension");
    let file = folder.join("robot.txt");
    fs::write(&file, &toml).unwrap();
    assert!(costate(&["info", file.to_str().unwrap(), "--format", "toml"], b"").status.success());
    assert!(stderr(&costate(&["info", file.to_str().unwrap()], b"")).contains(".urdf or .toml"));
}

#[test]
fn robot_and_states_do_not_share_standard_input() {
    let folder = empty_folder("states");
    let (toml, states) =
        (fs::read(root().join("robots/two_link.toml")).unwrap(), folder.join("states.jsonl"));
    fs::write(&states, STATE).unwrap();
    let output = costate(&["eval", "-", "--states", states.to_str().unwrap()], &toml);
    let expected = costate(&["eval", "robots/two_link.toml", "--states", "-"], STATE);
    assert!(output.status.success() && expected.status.success());
    assert_eq!(json_lines(&output), json_lines(&expected));
    let refused = costate(&["eval", "-"], &toml);
    assert_eq!(refused.status.code(), Some(2));
    assert!(stderr(&refused).contains("--states FILE"), "{}", stderr(&refused));
}

#[test]
fn outputs_are_checked_before_the_work_and_never_replace_an_input() {
    let folder = empty_folder("outputs");
    let robot = folder.join("robot.toml");
    fs::copy(root().join("robots/two_link.toml"), &robot).unwrap();
    let before = fs::read_to_string(&robot).unwrap();
    let path = robot.to_str().unwrap();
    let output = costate(&["codegen", path, "--quantity", "f", "-o", path], b"");
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("is the input file"), "{}", stderr(&output));
    assert_eq!(fs::read_to_string(&robot).unwrap(), before);
    // A robot that does not exist is not even looked for if the output cannot be written.
    let output = costate(&["codegen", "nowhere.toml", "--quantity", "f", "-o", "nowhere/at/all.rs"], b"");
    assert!(stderr(&output).contains("nowhere/at/all.rs: cannot be written"), "{}", stderr(&output));
    let to_standard_output = costate(&["codegen", path, "--quantity", "f", "-o", "-"], b"");
    assert_eq!(stdout(&to_standard_output), stdout(&costate(&["codegen", path, "--quantity", "f"], b"")));
}

/// The limit on the size of files makes writing fail half-way.
#[cfg(unix)]
#[test]
fn a_write_that_fails_leaves_the_old_file_and_no_other() {
    let folder = empty_folder("failing_write");
    let file = folder.join("text.rs");
    fs::write(&file, "old").unwrap();
    let script = "trap '' XFSZ; ulimit -f 1; exec \"$0\" codegen robots/ur5.urdf --quantity f_x -o \"$1\"";
    let run = std::process::Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_costate"), file.to_str().unwrap()])
        .current_dir(root())
        .output()
        .unwrap();
    assert_eq!(run.status.code(), Some(2), "{}", stderr(&run));
    assert!(stderr(&run).contains("text.rs: cannot be written"), "{}", stderr(&run));
    assert_eq!(fs::read_to_string(&file).unwrap(), "old");
    assert_eq!(fs::read_dir(&folder).unwrap().count(), 1);
}

/// `eval` writes the answers to all lines that it has read, then exits with status 130.
#[cfg(unix)]
#[test]
fn eval_ends_with_130_and_its_answers_when_it_is_interrupted() {
    use std::io::{BufRead, BufReader, Read, Write};
    for signal in ["INT", "TERM"] {
        let mut child = command(&["eval", "robots/two_link.toml"]).spawn().unwrap();
        let mut stdin = child.stdin.take().unwrap();
        let mut out = BufReader::new(child.stdout.take().unwrap());
        stdin.write_all(&[STATE, b"\n"].concat()).unwrap();
        let mut answers = String::new();
        out.read_line(&mut answers).unwrap();
        kill(signal, child.id());
        out.read_to_string(&mut answers).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert_eq!(answers.lines().count(), 1);
        drop(stdin);
    }
}

#[cfg(unix)]
#[test]
fn bench_ends_with_130_when_it_is_interrupted() {
    let arguments = ["bench", "robots/two_link.toml", "--batches", "10000"];
    let mut child = command(&arguments).stdin(Stdio::null()).spawn().unwrap();
    // The signal must not arrive before the handler is there.
    std::thread::sleep(std::time::Duration::from_secs(2));
    assert!(child.try_wait().unwrap().is_none());
    kill("INT", child.id());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stdout.len()), (Some(130), 0));
    assert_eq!(stderr(&output), "error: interrupted\n");
}

#[cfg(unix)]
fn kill(signal: &str, process: u32) {
    let status =
        std::process::Command::new("kill").args([format!("-{signal}"), process.to_string()]).status();
    assert!(status.unwrap().success());
}

#[test]
fn names_are_escaped_and_streams_without_a_terminal_have_no_colours() {
    let name = r"evil\u001b[31m\u202e\n";
    let text =
        format!("name = \"{name}\"\n[[joint]]\nname = \"{name}\"\nmass = 1.0\ncom = [0.1, 0.0, 0.0]\n");
    let table = costate(&["info", "-", "--format", "toml"], text.as_bytes());
    if table.status.success() {
        assert!(!stdout(&table).contains(['\u{1b}', '\u{202e}']), "{}", stdout(&table));
        assert!(stdout(&table).contains(r"evil\u{1b}[31m\u{202e}\n"), "{}", stdout(&table));
    }
    assert!(!stderr(&table).contains(['\u{1b}', '\u{202e}']), "{}", stderr(&table));
    let verdict = costate(&["check", "robots/two_link.toml", "--samples", "1"], b"");
    assert!(stdout(&verdict).contains("PASS: ") && !stdout(&verdict).contains('\u{1b}'));
    let error = costate(&["info", "robots/\u{1b}[31mnowhere.urdf"], b"");
    assert!(stderr(&error).starts_with("error: ") && !stderr(&error).contains('\u{1b}'));
}
