//! `costate eval`: states in, derivatives out, as JSON lines.

mod hamiltonian;
mod lagrangian;
mod line;
#[cfg(feature = "jit")]
mod machine;

use crate::{Outcome, RobotArguments};
use costate::robot::Robot;
use line::{Answer, State};
use serde_json::Value;
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// File of states, one JSON object a line [default: standard input]
    #[arg(long)]
    states: Option<PathBuf>,
    /// How the derivatives are computed
    #[arg(long, value_enum, default_value = "analytic")]
    route: Route,
    /// State variables
    #[arg(long, value_enum, default_value = "hamiltonian")]
    coordinates: Coordinates,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Route {
    /// Hand-derived Jacobian; contracted Hessian by one dual pass through hand-derived derivatives
    Analytic,
    /// Dual numbers through the state equation; dual numbers in dual numbers
    Dual,
    /// Hyper-dual numbers through the state equation
    Hyperdual,
    /// Christoffel coefficients; contracted Hessian by one dual pass through them (Hamiltonian coordinates only)
    Tensors,
    /// Machine code, compiled when it is first needed; where there can be none the generic code, with a note on stderr
    #[cfg(feature = "jit")]
    Jit,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Coordinates {
    /// x = (q, p): f, f_x, y_f_xx
    Hamiltonian,
    /// x = (q, v): qdd, qdd_z, yv_qdd_zz with z = (q, v, u)
    Lagrangian,
}

/// What computes the answers: one pair of coordinates and route.
trait Evaluator {
    /// The answer to a state of the right lengths.
    fn answer(&mut self, state: &State) -> Result<Answer, Box<dyn std::error::Error>>;
}

/// The workspaces of a pair of coordinates and route; an error where it does not exist.
fn evaluator(robot: &Robot, arguments: &Arguments) -> Result<Box<dyn Evaluator>, String> {
    Ok(match arguments.coordinates {
        Coordinates::Hamiltonian => Box::new(hamiltonian::Hamiltonian::new(robot, arguments.route)),
        Coordinates::Lagrangian => Box::new(lagrangian::Lagrangian::new(robot, arguments.route)?),
    })
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_and_warn()?;
    let mut evaluator = evaluator(&robot, arguments)?;
    let mut input: Box<dyn BufRead> = match &arguments.states {
        Some(path) => {
            let unreadable = |error| format!("{}: cannot be read ({error}); check the path", path.display());
            let file = File::open(path).map_err(unreadable)?;
            if path.is_dir() {
                return Err(unreadable(std::io::ErrorKind::IsADirectory.into()).into());
            }
            Box::new(BufReader::new(file))
        }
        None => Box::new(std::io::stdin().lock()),
    };
    let mut out = BufWriter::new(std::io::stdout().lock());
    let (mut line, mut number, mut bad) = (Vec::new(), 0, 0);
    while {
        line.clear();
        input.read_until(b'\n', &mut line)? > 0
    } {
        number += 1;
        if line.iter().all(u8::is_ascii_whitespace) {
            continue;
        }
        match answer(evaluator.as_mut(), &line, robot.dof(), arguments.coordinates) {
            Ok(answer) => writeln!(out, "{answer}")?,
            Err(error) => {
                bad += 1;
                eprintln!("error: line {number}: {error}");
                writeln!(out, "{}", serde_json::json!({ "line": number, "error": error }))?;
            }
        }
        if arguments.states.is_none() {
            out.flush()?;
        }
    }
    out.flush()?;
    Ok(if bad == 0 { ExitCode::SUCCESS } else { ExitCode::from(2) })
}

/// The answer to one line, or what is wrong with it.
fn answer(
    evaluator: &mut dyn Evaluator,
    line: &[u8],
    n: usize,
    coordinates: Coordinates,
) -> Result<Value, String> {
    let state = State::parse(line, n, coordinates)?;
    let answer = evaluator.answer(&state).map_err(|error| error.to_string())?;
    answer.finite()
}
