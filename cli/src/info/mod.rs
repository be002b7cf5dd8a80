//! `costate info`: the robot that was read from a file.

mod closing;
mod frames;
mod json;
mod rows;
mod table;

use crate::arguments::RobotArguments;
use crate::{Outcome, terminal};
use std::io::Write;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Print one JSON object instead of a table
    #[arg(long)]
    json: bool,
    /// List the frames too: links, joints and others that `costate eval` knows by name; and wrenches at them
    #[arg(long)]
    frames: bool,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_any_and_warn()?;
    if arguments.json {
        writeln!(std::io::stdout().lock(), "{}", json::of(&robot, arguments.frames))?;
    } else {
        table::print(&robot, &mut terminal::stdout())?;
        if arguments.frames {
            frames::print(&robot, &mut terminal::stdout())?;
        }
    }
    Ok(ExitCode::SUCCESS)
}
