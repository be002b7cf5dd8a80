//! `costate`: exact derivatives of robot dynamics from a robot file.

// `println!` and `eprintln!` panic when the stream is closed; the module `terminal` does not.
#![deny(clippy::print_stderr, clippy::print_stdout)]

mod arguments;
mod bench;
mod check;
mod codegen;
mod count;
mod edits;
mod eval;
mod generate;
mod info;
mod interrupt;
mod optimize;
mod outcome;
mod output;
mod report;
mod terminal;
mod work;

use arguments::RobotArguments;
use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};
use interrupt::Interrupted;
use outcome::Outcome;
use std::error::Error;
use std::ffi::{OsStr, OsString};
use std::io::ErrorKind;
use std::process::ExitCode;

/// Exact first and second derivatives of robot dynamics, and optimal motions
///
/// Begin with `costate info ROBOT` for the joints and limits of a robot, `costate eval ROBOT` for its
/// dynamics at given states, `costate optimize PROBLEM.toml` for a motion.
///
/// Units are rad, m, kg, s, N and N m. Joints are numbered from 0, in the order of `costate info`.
#[derive(Parser)]
#[command(name = "costate", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

/// The last lines of every help text.
const EXIT_CODES: &str = "\
Exit status:
  0    success
  1    `check`: a difference exceeds its bound
  2    bad arguments or bad input
  3    `optimize`: the problem was not solved
  130  interrupted by SIGINT (Ctrl-C) or SIGTERM";

#[derive(Subcommand)]
enum Command {
    /// List the joints of a robot: types, masses, limits, warnings
    ///
    /// The limits are those of positions, rates and efforts (torques or forces). `--json` adds centres of
    /// mass, inertia matrices, springs and friction. `com` and `inertia` (about the centre of mass) are given
    /// in the joint frame; `placement` is the joint frame in the parent's joint frame at q = 0. A limit that
    /// does not exist is null.
    Info(info::Arguments),
    /// Evaluate the dynamics and their derivatives at states, from JSON lines to JSON lines
    ///
    /// Each input line is an object with the joint positions `q` and either the n momenta `p` or the n
    /// velocities `v`. `q` has n numbers, and one more for each quaternion: (x, y, z, qx, qy, qz, qw) of a
    /// floating joint, (qx, qy, qz, qw) of a spherical one; derivatives by it have n columns, those of the
    /// tangent space. Optional: the n joint forces `u` (zeros by default) and the costate `y` (2n numbers),
    /// which asks for second derivatives. If a line has both `p` and `v`, Hamiltonian coordinates use `p` and
    /// Lagrangian ones `v`.
    ///
    /// Each output line is an object with `q`, `v`, the mass matrix `M` and `energy` (kinetic, potential).
    /// Hamiltonian coordinates add `p`, `f`, `f_x` and, for a given `y`, `y_f_xx`. Lagrangian coordinates add
    /// `qdd`, `qdd_z` and, for a given `y`, `yv_qdd_zz`; here z = (q, v, u), and the last n numbers of `y`
    /// are used.
    ///
    /// `frames` asks for links, joints or other frames of the robot (`costate info --frames`): an array of
    /// names, or of objects with a `name` and, optionally, `axes` and three weights `w`. The answer `frames`
    /// has an object for each with its `position` and `rotation` in the world and its `jacobian`, 6 x n, the
    /// angular rows first: in axes of the world at the origin of the frame (`axes` = "aligned", the default),
    /// in those of the frame ("local"), or at the origin of the world ("world"). For given weights, `w_x_qq`
    /// is the second derivative of w . position in q. A line with `q` and `frames` alone is answered without
    /// the dynamics.
    ///
    /// A result line can serve as an input line: its results are ignored. All other keys are
    /// errors.
    ///
    /// For a bad line the output is {"line": K, "error": "..."}. The other lines are still evaluated, and the
    /// exit status is 2.
    Eval(eval::Arguments),
    /// Compare all derivative methods with each other at random states
    ///
    /// The analytic derivatives of this robot are compared with those by dual and hyper-dual numbers and by
    /// tensors; bounds are those of rounding errors. For each quantity and method, prints the block whose
    /// difference is closest to its bound. The exit status is 1 if a difference exceeds its bound times
    /// `--tolerance`. docs/check.md explains the columns.
    Check(check::Arguments),
    /// Count the arithmetic operations of each quantity by each method
    ///
    /// F is the time derivative of the state x = (q, p), F_x its Jacobian, y'F_xx its second derivative
    /// contracted with a costate y. With floating and spherical joints derivatives are those in the tangent
    /// space, and methods that take no such joints are left out.
    Count(count::Arguments),
    /// Measure the time of each quantity by each method on this machine
    ///
    /// F is the time derivative of the state x = (q, p), F_x its Jacobian, y'F_xx its second derivative
    /// contracted with a costate y. One thread unless a row says otherwise. With floating and spherical
    /// joints derivatives are those in the tangent space, and methods that take no such joints are left out.
    Bench(bench::Arguments),
    /// Generate straight-line source code of one quantity, in Rust or C
    ///
    /// The header of the generated text documents its arguments and results.
    ///
    /// With floating and spherical joints q has a quaternion (x, y, z, w) for each of them, and derivatives
    /// by q are those in the tangent space. `--abi`, `--parameters`, steps and extremals take no such joints.
    Codegen(codegen::Arguments),
    /// Find the cheapest motion from a start to an end that keeps all limits
    ///
    /// The problem file is TOML: robot, start, end, duration, cost and what is limited. A small one, for a
    /// robot with two joints:
    ///
    ///     robot = "two_link.toml"       # a robot file, relative to this file
    ///     start.q = [0.0, 0.0]          # rad or m, one for each joint of `costate info`
    ///     end.q = [1.0, 0.5]
    ///     time.final = 4.0              # s
    ///     cost.effort = [1.0, 1.0]      # weights of the squared torques
    ///     limits.from_robot = true      # the limits of the robot file are kept
    ///
    /// docs/optimize.md describes all keys, also those of limits, tools, obstacles and vias. The folder
    /// examples/problems has whole files. The direct method is the default: an interior-point method for
    /// motions that are piecewise polynomials. Where nothing but torques is limited, its motion is then
    /// polished by the maximum principle.
    ///
    /// The table has the cost, the checks and the limits. If the problem is not solved, the best motion so
    /// far is printed and written all the same, with the reason, and the exit status is 3.
    #[command(verbatim_doc_comment)]
    Optimize(optimize::Arguments),
    /// Print the completion script of a shell
    Completions(generate::CompletionArguments),
    /// Print the manual page, or write the pages of all commands to a folder
    Man(generate::ManArguments),
}

/// All commands and their arguments.
fn command() -> clap::Command {
    // Without this, `--tolerance -1` would be an unknown argument instead of a number out of range.
    let with_negative_numbers = |argument: clap::Arg| {
        let takes_value = !argument.is_positional() && argument.get_action().takes_values();
        if takes_value { argument.allow_negative_numbers(true) } else { argument }
    };
    Cli::command()
        .after_help(EXIT_CODES)
        .mut_subcommands(|command| command.after_help(EXIT_CODES).mut_args(with_negative_numbers))
}

/// The arguments with `--polish WHEN` as `--polish=WHEN`. Its value may be left out, so clap would take one
/// that follows a blank for a file.
fn joined(arguments: impl Iterator<Item = OsString>) -> Vec<OsString> {
    let mut joined: Vec<OsString> = Vec::new();
    for argument in arguments {
        let is_value = ["true", "false", "auto"].iter().any(|value| argument == *value);
        match joined.last_mut().filter(|last| is_value && last.as_os_str() == OsStr::new("--polish")) {
            Some(polish) => {
                polish.push("=");
                polish.push(argument);
            }
            None => joined.push(argument),
        }
    }
    joined
}

fn main() -> ExitCode {
    let given = command().get_matches_from(joined(std::env::args_os()));
    let cli = Cli::from_arg_matches(&given).unwrap_or_else(|error| error.exit());
    let outcome = match cli.command {
        Command::Info(arguments) => info::run(&arguments),
        Command::Eval(arguments) => eval::run(&arguments),
        Command::Check(arguments) => check::run(&arguments),
        Command::Count(arguments) => count::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Codegen(arguments) => codegen::run(&arguments),
        Command::Optimize(arguments) => optimize::run(&arguments),
        Command::Completions(arguments) => generate::completions(command(), &arguments),
        Command::Man(arguments) => generate::man(command(), &arguments),
    };
    match outcome {
        Ok(code) => code,
        Err(error) if is_broken_pipe(error.as_ref()) => ExitCode::SUCCESS,
        Err(error) => {
            match error.downcast_ref::<std::io::Error>() {
                // Inputs and files have messages of their own.
                Some(error) => terminal::error(format!("standard output cannot be written ({error})")),
                None => terminal::error(&error),
            }
            ExitCode::from(if error.is::<Interrupted>() { interrupt::EXIT_CODE } else { 2 })
        }
    }
}

/// Whether the reader of standard output closed it, as `head` does; that is no error.
fn is_broken_pipe(error: &(dyn Error + 'static)) -> bool {
    error.downcast_ref::<std::io::Error>().is_some_and(|error| error.kind() == ErrorKind::BrokenPipe)
}
