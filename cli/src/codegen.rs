//! `costate codegen`: straight-line source of a quantity.

use crate::optimize::Task;
use crate::output::{Output, STANDARD};
use crate::{Outcome, RobotArguments};
use clap::ValueEnum;
use costate::codegen::{
    COptions, Coordinates, DEFAULT_LIMIT, Options, Program, Quantity, RustOptions, robot_program,
};
use costate::robot::Robot;
use costate_control::{Problem, ProgramOf, pontryagin_program};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    #[arg(long, value_parser = quantity, value_name = "QUANTITY", help = quantities())]
    quantity: Computed,
    /// pontryagin: problem file of the same robot, whose criterion holds: effort, gain, bounds, penalties; 1/2 |u|^2 without one
    #[arg(long, value_name = "FILE")]
    problem: Option<PathBuf>,
    /// In which coordinates
    #[arg(long, value_enum, default_value_t = CoordinatesArgument::Hamiltonian)]
    coordinates: CoordinatesArgument,
    /// In which language
    #[arg(long, value_enum, default_value_t = Language::Rust)]
    lang: Language,
    /// The quantity alone, without f and f_x where they are not asked for
    #[arg(long)]
    only: bool,
    /// Masses, lengths and other constants as one more argument, listed in the head of the text
    #[arg(long)]
    parameters: bool,
    /// Rust: an existing trait of numbers instead of one in the text, such as costate::scalar::Scalar
    #[arg(long, value_name = "PATH")]
    number: Option<String>,
    /// Most steps that are written down
    #[arg(long, default_value_t = DEFAULT_LIMIT)]
    limit: usize,
    /// Where to write, instead of to standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum CoordinatesArgument {
    Hamiltonian,
    Lagrangian,
}

#[derive(Clone, Copy, ValueEnum)]
enum Language {
    Rust,
    C,
}

/// What a text computes.
#[derive(Clone, Copy)]
enum Computed {
    /// A quantity of the robot alone.
    Model(Quantity),
    /// The extremals of a problem.
    Extremal(ProgramOf),
}

fn quantities() -> String {
    let names = Quantity::ALL.into_iter().map(Quantity::name).chain(ProgramOf::ALL.map(ProgramOf::name));
    format!("What is computed: {}", names.collect::<Vec<_>>().join(", "))
}

fn quantity(name: &str) -> Result<Computed, String> {
    let model = Quantity::ALL.into_iter().find(|quantity| quantity.name() == name).map(Computed::Model);
    let extremal = || ProgramOf::ALL.into_iter().find(|of| of.name() == name).map(Computed::Extremal);
    model.or_else(extremal).ok_or_else(quantities)
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
        Language::Rust => program.to_rust(&RustOptions { number: arguments.number.clone(), limit })?,
        Language::C => program.to_c(&COptions { limit })?,
    };
    output.write(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn of_model(robot: &Robot, quantity: Quantity, arguments: &Arguments) -> Result<Program, Box<dyn Error>> {
    if arguments.problem.is_some() {
        return Err("--problem goes with --quantity pontryagin or pontryagin_rate; remove it".into());
    }
    let coordinates = match arguments.coordinates {
        CoordinatesArgument::Hamiltonian => Coordinates::Hamiltonian,
        CoordinatesArgument::Lagrangian => Coordinates::Lagrangian,
    };
    let options = Options { only: arguments.only, parameters: arguments.parameters };
    Ok(robot_program(robot, quantity, coordinates, &options)?)
}

/// With the criterion of the problem file, or `1/2 |u|^2`.
fn of_extremal(robot: Robot, of: ProgramOf, arguments: &Arguments) -> Result<Program, Box<dyn Error>> {
    let Arguments { only, parameters, .. } = arguments;
    let lagrangian = matches!(arguments.coordinates, CoordinatesArgument::Lagrangian);
    let refused =
        [("--only", *only), ("--parameters", *parameters), ("--coordinates lagrangian", lagrangian)];
    if let Some((option, _)) = refused.into_iter().find(|(_, asked)| *asked) {
        return Err(format!("{option} does not go with --quantity {}; remove it", of.name()).into());
    }
    let problem = match &arguments.problem {
        None => {
            let zeros = vec![0.0; robot.len()];
            Problem::rest_to_rest(robot, &zeros, &zeros, 1.0)
        }
        Some(file) => {
            let problem = Task::read(file, arguments.robot.options())?.problem;
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
    Ok(pontryagin_program(&problem, of)?)
}
