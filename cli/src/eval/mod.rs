//! `costate eval`: states in, derivatives out, as JSON lines.

mod cost;
mod entries;
mod frames;
mod hamiltonian;
mod input;
mod keys;
mod lagrangian;
mod line;
#[cfg(feature = "jit")]
mod machine;
mod request;
mod route;
mod units;

use crate::arguments::{RobotArguments, coordinates};
use crate::interrupt::{EXIT_CODE, Interrupt};
use crate::output::is_standard;
use crate::work::Order;
use crate::{Outcome, terminal};
use clap::ValueHint;
use cost::Cost;
use costate::Coordinates;
use costate::robot::Robot;
use frames::Frames;
use input::{Input, Lines};
use line::{Answer, State};
use route::{Evaluator, Route};
use serde_json::json;
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use units::UnitCheck;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// File of states, one JSON object per line, or - for standard input [default: standard input]
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    states: Option<PathBuf>,
    /// Method for the derivatives; tensors and jit are about dynamics: frames are then answered by analytic,
    /// as are those of robots with quaternions by every method
    #[arg(long, value_enum, default_value = "analytic")]
    route: Route,
    /// State variables
    #[arg(long, value_parser = coordinates(COORDINATES), default_value = "hamiltonian")]
    coordinates: Coordinates,
    /// Evaluate long chains even if that takes minutes or gigabytes
    #[arg(long)]
    force: bool,
}

/// What is computed in Hamiltonian and in Lagrangian coordinates.
const COORDINATES: [&str; 2] =
    ["x = (q, p): f, f_x, y_f_xx", "x = (q, v): qdd, qdd_z, yv_qdd_zz with z = (q, v, u)"];

/// The workspaces of the coordinates and the method; an error if the method does not offer the coordinates.
fn evaluator(robot: &Robot, arguments: &Arguments) -> Result<Box<dyn Evaluator>, String> {
    Ok(match arguments.coordinates {
        Coordinates::Hamiltonian => Box::new(hamiltonian::Hamiltonian::new(robot, arguments.route)?),
        Coordinates::Lagrangian => Box::new(lagrangian::Lagrangian::new(robot, arguments.route)?),
    })
}

pub fn run(arguments: &Arguments) -> Outcome {
    let states = arguments.states.as_deref().filter(|path| !is_standard(path));
    if states.is_none() && is_standard(arguments.robot.path()) {
        return Err("the robot is read from standard input; give the states by --states FILE".into());
    }
    let robot = arguments.robot.load_tree_and_warn()?;
    let cost = Cost::new(&robot, arguments.route, arguments.coordinates, arguments.force);
    cost.refuse_derivatives(Order::First)?;
    // Refused at the first state that asks for them.
    let second_order = cost.refuse_derivatives(Order::Second);
    let mut evaluator = evaluator(&robot, arguments)?;
    let lines = match states {
        Some(path) => Lines::of_file(path)?,
        None => Lines::of_standard_input(),
    };
    let interrupt = Interrupt::listen()?;
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut frames = Frames::new(&robot, arguments.route);
    let mut units = UnitCheck::new(&robot);
    let (mut number, mut bad) = (0, 0);
    loop {
        let line = match lines.next(&interrupt) {
            Input::Line(line) => line.map_err(|error| error.to_string())?,
            Input::End => break,
            Input::Interrupted => {
                out.flush()?;
                return Ok(ExitCode::from(EXIT_CODE));
            }
        };
        number += 1;
        if line.iter().all(u8::is_ascii_whitespace) {
            continue;
        }
        let state = State::parse(&line, &robot, arguments.coordinates);
        if let (Ok(State { y: Some(_), .. }), Err(reason)) = (&state, &second_order) {
            out.flush()?;
            return Err(reason.clone().into());
        }
        let answer = state.and_then(|state| {
            units.check(number, &state.q);
            cost.refuse_frames(&state)?;
            let mut answer = match &state.motion {
                Some(motion) => evaluator.answer(&state, motion).map_err(|error| error.to_string())?,
                None => Answer::of_position(&state.q),
            };
            if let Some(requests) = &state.frames {
                frames.answer(&state.q, requests, &mut answer).map_err(|error| error.to_string())?;
            }
            answer.finite()
        });
        match answer {
            Ok(answer) => writeln!(out, "{answer}")?,
            Err(error) => {
                bad += 1;
                let separator = if error.starts_with("column ") { "," } else { ":" };
                terminal::error(format!("line {number}{separator} {error}"));
                writeln!(out, "{}", json!({ "line": number, "error": error }))?;
            }
        }
        if states.is_none() {
            out.flush()?;
        }
    }
    out.flush()?;
    Ok(if bad == 0 { ExitCode::SUCCESS } else { ExitCode::from(2) })
}
