//! `costate`: exact derivatives of robot dynamics from a robot file.

mod bench;
mod check;
mod codegen;
mod count;
mod eval;
mod info;
mod optimize;
mod report;

use clap::{Args, Parser, Subcommand};
use costate::robot::{LoadOptions, Robot, RobotError};
use std::path::PathBuf;
use std::process::ExitCode;

/// Exact first and second derivatives of robot dynamics.
#[derive(Parser)]
#[command(name = "costate", version, about, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// List the joints, masses and warnings of a robot
    Info(info::Arguments),
    /// Evaluate states: JSON lines in, JSON lines out
    ///
    /// In, one object a line: `q` and `p` or `v` (n numbers each), optional `u` (n, zeros) and
    /// `y` (2n, the costate). Out: `q`, `v`, `M`, `energy`; in Hamiltonian coordinates `p`, `f`, `f_x`, and `y_f_xx` where `y`
    /// was given; in Lagrangian ones `qdd`, `qdd_z` and `yv_qdd_zz`, z = (q, v, u), for the last n of `y`. Where both
    /// `p` and `v` stand, `p` wins in Hamiltonian, `v` in Lagrangian coordinates.
    /// A bad line gives `{"line":k,"error":…}` in its place and exit status 2 at the end.
    Eval(eval::Arguments),
    /// Set every route to the derivatives beside every other
    ///
    /// Exit status 1 where a figure exceeds its tolerance.
    Check(check::Arguments),
    /// Count the operations of each quantity by each route
    Count(count::Arguments),
    /// Time each quantity by each route on this machine
    Bench(bench::Arguments),
    /// Write straight-line source of one quantity, in Rust or C
    ///
    /// The text depends on nothing but the robot and what is asked for; its head says what arguments and results are.
    Codegen(codegen::Arguments),
    /// Find an optimal motion, by the maximum principle
    ///
    /// The problem file names a robot and says where to start, where to end, how long, and what it costs:
    /// docs/optimize.md. Exit status 3 where it was not solved; what is written then is the best iterate.
    Optimize(optimize::Arguments),
}

/// The robot, and how to read it.
#[derive(Args)]
struct RobotArguments {
    /// Robot file: .urdf or .toml
    robot: PathBuf,
    /// Refuse robots that are not physical (massless links, violated triangle inequality)
    #[arg(long)]
    strict: bool,
    /// Load `<dynamics damping friction>` of a URDF as viscous and smooth Coulomb friction
    #[arg(long)]
    friction: bool,
}

impl RobotArguments {
    fn options(&self) -> LoadOptions {
        LoadOptions::default().strict(self.strict).friction(self.friction)
    }

    fn load(&self) -> Result<Robot, RobotError> {
        Robot::from_file_with(&self.robot, self.options())
    }

    /// Loads the robot and says on stderr what is odd about it.
    fn load_and_warn(&self) -> Result<Robot, RobotError> {
        let robot = self.load()?;
        robot.warnings().iter().for_each(|warning| eprintln!("warning: {warning}"));
        Ok(robot)
    }
}

/// Exit status of a command that ran but has bad news.
type Outcome = Result<ExitCode, Box<dyn std::error::Error>>;

fn main() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Info(arguments) => info::run(&arguments),
        Command::Eval(arguments) => eval::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Count(arguments) => count::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Codegen(arguments) => codegen::run(&arguments),
        Command::Optimize(arguments) => optimize::run(&arguments),
    };
    match outcome {
        Ok(code) => code,
        Err(error) if is_broken_pipe(error.as_ref()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error}");
            ExitCode::from(2)
        }
    }
}

/// The reader of our output went away, which is its right.
fn is_broken_pipe(error: &(dyn std::error::Error + 'static)) -> bool {
    error.downcast_ref::<std::io::Error>().is_some_and(|e| e.kind() == std::io::ErrorKind::BrokenPipe)
}
