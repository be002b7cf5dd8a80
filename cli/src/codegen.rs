//! `costate codegen`: straight-line source of a quantity.

use crate::{Outcome, RobotArguments};
use clap::ValueEnum;
use costate::codegen::{COptions, Coordinates, DEFAULT_LIMIT, Options, Quantity, RustOptions, robot_program};
use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    #[arg(long, value_parser = quantity, value_name = "QUANTITY", help = quantities())]
    quantity: Quantity,
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

fn quantities() -> String {
    let names: Vec<_> = Quantity::ALL.into_iter().map(Quantity::name).collect();
    format!("What is computed: {}", names.join(", "))
}

fn quantity(name: &str) -> Result<Quantity, String> {
    let found = Quantity::ALL.into_iter().find(|quantity| quantity.name() == name);
    found.ok_or_else(quantities)
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_and_warn()?;
    let coordinates = match arguments.coordinates {
        CoordinatesArgument::Hamiltonian => Coordinates::Hamiltonian,
        CoordinatesArgument::Lagrangian => Coordinates::Lagrangian,
    };
    let options = Options { only: arguments.only, parameters: arguments.parameters };
    let program = robot_program(&robot, arguments.quantity, coordinates, &options)?;
    let limit = arguments.limit;
    let text = match arguments.lang {
        Language::Rust => program.to_rust(&RustOptions { number: arguments.number.clone(), limit })?,
        Language::C => program.to_c(&COptions { limit })?,
    };
    match &arguments.output {
        Some(file) => {
            std::fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))?;
        }
        None => std::io::stdout().lock().write_all(text.as_bytes())?,
    }
    Ok(ExitCode::SUCCESS)
}
