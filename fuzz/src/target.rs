//! What is done with an input: it is read, and if it is accepted, used.

use crate::files::project;
use crate::kind::Kind;
use crate::saved::robots;
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::Lagrangian;
use costate::robot::urdf::visuals;
use costate::robot::{LoadOptions, Robot, RobotFormat, Tree};
use costate_control::{ProblemFile, Solution, Solver, Trajectory};
use std::error::Error;

/// Most joints of a robot that is evaluated.
const MOST_JOINTS: usize = 30;

/// Longest message that a user is shown (bytes).
const LONGEST_MESSAGE: usize = 20_000;

/// Whether the input is accepted.
///
/// # Errors
/// A message for users that is too long or would change a terminal.
///
/// # Panics
/// If a reader does: that is what is looked for.
pub fn run(kind: Kind, input: &[u8]) -> Result<bool, String> {
    let mut messages = Vec::new();
    let accepted = match kind {
        Kind::Urdf => robot(input, RobotFormat::Urdf, &mut messages),
        Kind::Toml => robot(input, RobotFormat::Toml, &mut messages),
        Kind::Problem => problem(input, &mut messages),
        Kind::Solution => solution(input, &mut messages),
        // These are given to the command line.
        Kind::Eval => false,
    };
    if let Some(message) = messages.iter().find(|message| message.len() > LONGEST_MESSAGE) {
        return Err(format!("a message of {} bytes", message.len()));
    }
    let changes_terminals = |c: char| c.is_control() && c != '\n' || matches!(c, '\u{202a}'..='\u{202e}');
    match messages.iter().find(|message| message.contains(changes_terminals)) {
        Some(message) => Err(format!("not printable: {message:?}")),
        None => Ok(accepted),
    }
}

fn robot(input: &[u8], format: RobotFormat, messages: &mut Vec<String>) -> bool {
    let strict = LoadOptions::default().strict(true).friction(true);
    match Robot::read(input, format, strict) {
        Ok(robot) => messages.extend(robot.warnings().iter().map(ToString::to_string)),
        Err(error) => messages.push(error.to_string()),
    }
    if let (RobotFormat::Urdf, Ok(text)) = (format, std::str::from_utf8(input)) {
        messages.extend(visuals(text).err().map(|error| error.to_string()));
    }
    match Robot::read(input, format, LoadOptions::default()) {
        Ok(robot) => {
            messages.extend(robot.warnings().iter().map(ToString::to_string));
            evaluate(&robot, messages);
            true
        }
        Err(error) => {
            messages.push(error.to_string());
            false
        }
    }
}

/// One evaluation of everything at q = 0.
fn evaluate(robot: &Robot, messages: &mut Vec<String>) {
    let tree = Tree::from(robot);
    let n = robot.dof();
    if robot.joints().len() > MOST_JOINTS {
        return;
    }
    let (zeros, ones) = (vec![0.0; n], vec![1.0; 2 * n]);
    let mut hamiltonian = Hamiltonian::<f64>::from_tree(tree);
    let evaluated = hamiltonian.evaluate(&zeros, &ones[..n], &zeros).map(drop);
    let linearised = hamiltonian.linearise(&zeros, &ones[..n], &zeros).map(drop);
    let mut second = HamiltonianSecondOrder::<f64>::new(robot);
    let contracted = second.contract(&zeros, &ones[..n], &zeros, &ones).map(drop);
    let accelerated = Lagrangian::<f64>::new(robot).evaluate(&zeros, &ones[..n], &zeros).map(drop);
    let errors = [evaluated, linearised, contracted, accelerated].into_iter().filter_map(Result::err);
    messages.extend(errors.map(|error| error.to_string()));
}

fn problem(input: &[u8], messages: &mut Vec<String>) -> bool {
    let folder = project().join("examples/problems");
    let read = match std::str::from_utf8(input) {
        Ok(text) => ProblemFile::from_text(text, &folder, LoadOptions::default()),
        Err(_) => {
            let path = std::env::temp_dir().join(format!("costate-fuzz-{}.toml", std::process::id()));
            if std::fs::write(&path, input).is_err() {
                return false;
            }
            let read = ProblemFile::read(&path, LoadOptions::default());
            // A file that is left behind does no harm.
            std::fs::remove_file(&path).ok();
            read
        }
    };
    match read {
        Ok(file) => {
            let checked = file.problem.check().map(drop);
            let ready = Solver::new(&file.problem, file.options.clone()).map(drop);
            messages.extend([checked, ready].into_iter().filter_map(Result::err).map(|e| e.to_string()));
            true
        }
        Err(error) => {
            messages.push(error.to_string());
            messages.extend(error.source().map(ToString::to_string));
            false
        }
    }
}

fn solution(input: &[u8], messages: &mut Vec<String>) -> bool {
    let Ok(text) = std::str::from_utf8(input) else { return false };
    let mut accepted = false;
    for robot in robots() {
        match Trajectory::from_json(text, robot) {
            Ok(trajectory) => {
                accepted = true;
                let (first, last) = (trajectory.t.first().copied(), trajectory.t.last().copied());
                for t in [first.unwrap_or(0.0), last.unwrap_or(0.0), 0.3, -1.0, 1e308, f64::NAN] {
                    trajectory.at(t);
                }
                messages.extend(trajectory.check(robot).err().map(|error| error.to_string()));
            }
            Err(error) => messages.push(error.to_string()),
        }
    }
    // An error has the words of `serde_json`, which quotes what it finds.
    if let Ok(solution) = serde_json::from_str::<Solution>(text) {
        solution.costate_start();
        solution.trajectory.at(0.5);
        messages.push(solution.motion.status.to_string());
        // What cannot be written is not what is looked for here.
        serde_json::to_string(&solution).ok();
    }
    accepted
}
