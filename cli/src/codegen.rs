//! `costate codegen`: straight-line source code of a quantity.

use crate::arguments::{coordinates, whole};
use crate::output::{Output, STANDARD};
use crate::{Outcome, RobotArguments};
use clap::ValueEnum;
use costate::codegen::{
    COptions, Coordinates, DEFAULT_LIMIT, Program, ProgramOptions, Quantity, RustOptions, robot_program,
};
use costate::robot::Robot;
use costate_control::{Problem, ProblemFile, ProgramOf, pontryagin_program};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    #[arg(long, value_parser = quantity, value_name = "QUANTITY", help = quantities())]
    quantity: Computed,
    /// For pontryagin: a problem file of the same robot with effort weights, gains, bounds and penalties
    /// [default: 1/2 |u|^2]
    #[arg(long, value_name = "FILE")]
    problem: Option<PathBuf>,
    /// Coordinates of the state
    #[arg(long, value_parser = coordinates(["x = (q, p)", "x = (q, v)"]), default_value = "hamiltonian")]
    coordinates: Coordinates,
    /// Language of the source
    #[arg(long, value_enum, default_value_t = Language::Rust)]
    lang: Language,
    /// The quantity alone, without the results it builds on (f, f_x)
    #[arg(long)]
    only: bool,
    /// Masses, lengths and other constants as an argument, listed at the head of the source
    #[arg(long)]
    parameters: bool,
    /// Rust: path of an existing trait of numbers, such as costate::scalar::Scalar, instead of one in the
    /// source
    #[arg(long, value_name = "PATH")]
    number: Option<String>,
    /// Most steps of the program; recording stops early where there would be more
    #[arg(long, default_value_t = DEFAULT_LIMIT, value_parser = whole)]
    limit: usize,
    /// Output file [default: standard output]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Language {
    Rust,
    C,
}

/// The quantity to write.
#[derive(Clone, Copy)]
enum Computed {
    /// A quantity of the robot alone.
    Model(Quantity),
    /// The extremals of a problem.
    Extremal(ProgramOf),
}

fn quantities() -> String {
    format!("Quantity: {}", names())
}

fn names() -> String {
    let names = Quantity::ALL.into_iter().map(Quantity::name).chain(ProgramOf::ALL.map(ProgramOf::name));
    names.collect::<Vec<_>>().join(", ")
}

fn quantity(name: &str) -> Result<Computed, String> {
    let model = Quantity::ALL.into_iter().find(|quantity| quantity.name() == name).map(Computed::Model);
    let extremal = || ProgramOf::ALL.into_iter().find(|of| of.name() == name).map(Computed::Extremal);
    model.or_else(extremal).ok_or_else(|| format!("unknown quantity; give one of {}", names()))
}

pub fn run(arguments: &Arguments) -> Outcome {
    let inputs: Vec<_> =
        std::iter::once(arguments.robot.path()).chain(arguments.problem.as_deref()).collect();
    let output = Output::prepare(arguments.output.as_deref().unwrap_or(Path::new(STANDARD)), &inputs)?;
    let robot = arguments.robot.load_and_warn()?;
    let program = match arguments.quantity {
        Computed::Model(quantity) => of_model(&robot, quantity, arguments)?,
        Computed::Extremal(of) => of_extremal(robot, of, arguments)?,
    };
    let limit = arguments.limit;
    let text = match arguments.lang {
        Language::Rust => program
            .to_rust(&RustOptions::default().with_number(arguments.number.clone()).with_limit(limit))?,
        Language::C => program.to_c(&COptions::default().with_limit(limit))?,
    };
    output.write(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn of_model(robot: &Robot, quantity: Quantity, arguments: &Arguments) -> Result<Program, Box<dyn Error>> {
    if arguments.problem.is_some() {
        return Err(
            "--problem can only be used with --quantity pontryagin or pontryagin_rate; remove it".into()
        );
    }
    let options = ProgramOptions::default()
        .with_only(arguments.only)
        .with_parameters(arguments.parameters)
        .with_limit(arguments.limit);
    Ok(robot_program(robot, quantity, arguments.coordinates, &options)?)
}

/// The extremals for the running cost of the problem file, or for `1/2 |u|^2`.
fn of_extremal(robot: Robot, of: ProgramOf, arguments: &Arguments) -> Result<Program, Box<dyn Error>> {
    let Arguments { only, parameters, .. } = arguments;
    let lagrangian = arguments.coordinates == Coordinates::Lagrangian;
    let refused =
        [("--only", *only), ("--parameters", *parameters), ("--coordinates lagrangian", lagrangian)];
    if let Some((option, _)) = refused.into_iter().find(|(_, asked)| *asked) {
        return Err(format!("{option} cannot be used with --quantity {}; remove it", of.name()).into());
    }
    let problem = match &arguments.problem {
        None => {
            let zeros = vec![0.0; robot.dof()];
            Problem::rest_to_rest(robot, &zeros, &zeros, 1.0)
        }
        Some(file) => {
            let problem = ProblemFile::read(file, arguments.robot.options())?.problem;
            if problem.robot != robot {
                let (asked, found) = (robot.name(), problem.robot.name());
                let file = file.display();
                return Err(
                    format!("{file}: robot '{found}' is not the robot '{asked}' of the command").into()
                );
            }
            problem
        }
    };
    // Extremals contain these quantities: a robot that is too large is refused here, before all of them are
    // recorded.
    let contained = match of {
        ProgramOf::Rate => Quantity::YFX,
        ProgramOf::Jacobian => Quantity::YFXX,
    };
    let options = ProgramOptions::default().with_limit(arguments.limit);
    robot_program(&problem.robot, contained, Coordinates::Hamiltonian, &options)?;
    Ok(pontryagin_program(&problem, of)?)
}
