//! `costate codegen`: straight-line source code of a quantity.

use crate::arguments::{coordinates, whole};
use crate::output::{Output, STANDARD};
use crate::{Outcome, RobotArguments};
use clap::ValueEnum;
use costate::codegen::{
    COptions, Coordinates, DEFAULT_LIMIT, Program, ProgramOptions, Quantity, RustOptions, StepOrder,
    StepSpec, acados_source, c_header, c_source, casadi_source, robot_program, step_program,
};
use costate::robot::{Robot, RobotError};
use costate_control::{Problem, ProblemFile, ProgramOf, pontryagin_program};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    #[arg(long, value_parser = quantity, value_name = "QUANTITY", help = quantities(), required_unless_present = "abi")]
    quantity: Vec<Computed>,
    /// C functions that a program loads by name, instead of quantities: ROBOT_fd, ROBOT_id and, with
    /// --scheme, ROBOT_step for casadi.external; the functions of a model of acados
    #[arg(long, value_enum, conflicts_with_all = ["quantity", "lang", "only", "parameters", "number", "header"])]
    abi: Option<Abi>,
    /// For step, step_z, y_step_zz and --abi: the scheme of a time step
    #[arg(long, value_enum, requires = "dt")]
    scheme: Option<Scheme>,
    /// For --scheme: the duration of a step (s)
    #[arg(long, value_name = "SECONDS", requires = "scheme", value_parser = duration)]
    dt: Option<f64>,
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
    /// Matrices among the results column by column
    #[arg(long, conflicts_with = "abi")]
    column_major: bool,
    /// C: declarations of the functions, to this file
    #[arg(long, value_name = "FILE")]
    header: Option<PathBuf>,
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

#[derive(Clone, Copy, ValueEnum)]
enum Abi {
    Casadi,
    Acados,
}

#[derive(Clone, Copy, ValueEnum)]
enum Scheme {
    Rk4,
    SemiImplicitEuler,
}

fn duration(text: &str) -> Result<f64, String> {
    let seconds = text.parse::<f64>().ok().filter(|seconds| seconds.is_finite());
    seconds.ok_or_else(|| "give a finite number of seconds".into())
}

/// The quantity to write.
#[derive(Clone, Copy)]
enum Computed {
    /// A quantity of the robot alone.
    Model(Quantity),
    /// A time step.
    Step(StepOrder),
    /// The extremals of a problem.
    Extremal(ProgramOf),
}

fn quantities() -> String {
    format!("Quantity: {}", names())
}

/// Names of time steps.
const STEPS: [(&str, StepOrder); 3] =
    [("step", StepOrder::Value), ("step_z", StepOrder::First), ("y_step_zz", StepOrder::Second)];

fn names() -> String {
    let names = Quantity::ALL.into_iter().map(Quantity::name).chain(STEPS.map(|(name, _)| name));
    names.chain(ProgramOf::ALL.map(ProgramOf::name)).collect::<Vec<_>>().join(", ")
}

fn quantity(name: &str) -> Result<Computed, String> {
    let model = Quantity::ALL.into_iter().find(|quantity| quantity.name() == name).map(Computed::Model);
    let step = || STEPS.into_iter().find(|(known, _)| *known == name).map(|(_, order)| Computed::Step(order));
    let extremal = || ProgramOf::ALL.into_iter().find(|of| of.name() == name).map(Computed::Extremal);
    model.or_else(step).or_else(extremal).ok_or_else(|| format!("unknown quantity; give one of {}", names()))
}

pub fn run(arguments: &Arguments) -> Outcome {
    let inputs: Vec<_> =
        std::iter::once(arguments.robot.path()).chain(arguments.problem.as_deref()).collect();
    let output = Output::prepare(arguments.output.as_deref().unwrap_or(Path::new(STANDARD)), &inputs)?;
    let robot = arguments.robot.load_tree_and_warn()?;
    refuse_free_joints(&robot, arguments)?;
    let (limit, step) = (arguments.limit, step_of(arguments));
    let c = COptions::default().with_limit(limit);
    let text = match arguments.abi {
        Some(Abi::Casadi) => casadi_source(&robot, step, &c)?,
        Some(Abi::Acados) => acados_source(&robot, step, &c)?,
        None => {
            let programs = programs(&robot, arguments, step)?;
            if let Some(file) = &arguments.header {
                if matches!(arguments.lang, Language::Rust) {
                    return Err("--header needs --lang c".into());
                }
                Output::prepare(file, &inputs)?.write(&c_header(&programs)?)?;
            }
            match (arguments.lang, programs.as_slice()) {
                (Language::C, programs) => c_source(programs, &c)?,
                (Language::Rust, [program]) => {
                    let options = RustOptions::default().with_number(arguments.number.clone());
                    program.to_rust(&options.with_limit(limit))?
                }
                (Language::Rust, _) => return Err("several quantities in one file need --lang c".into()),
            }
        }
    };
    output.write(&text)?;
    Ok(ExitCode::SUCCESS)
}

/// Refuses floating and spherical joints where generated code takes none.
///
/// # Errors
/// [`RobotError::FreeJoint`] with the first of them.
fn refuse_free_joints(robot: &Robot, arguments: &Arguments) -> Result<(), RobotError> {
    let Some(free) = robot.free_joints().first() else { return Ok(()) };
    let has = |is_one: fn(&Computed) -> bool| arguments.quantity.iter().any(is_one);
    let refused = [
        (arguments.abi.is_some(), "be taken by --abi"),
        (arguments.parameters, "be taken by --parameters"),
        (has(|one| matches!(one, Computed::Step(_))), "be taken by --quantity step, step_z and y_step_zz"),
        (
            has(|one| matches!(one, Computed::Extremal(_))),
            "be taken by --quantity pontryagin and pontryagin_rate",
        ),
    ];
    match refused.into_iter().find(|(is_asked, _)| *is_asked) {
        None => Ok(()),
        Some((_, what)) => {
            Err(RobotError::FreeJoint { joint: free.name.clone(), kind: free.kind.name(), what })
        }
    }
}

/// The time step of the command.
fn step_of(arguments: &Arguments) -> Option<StepSpec> {
    let dt = arguments.dt?;
    Some(match arguments.scheme? {
        Scheme::Rk4 => StepSpec::RungeKutta4 {
            dt,
            // CasADi and acados are given x = (q, v).
            coordinates: if arguments.abi.is_some() {
                Coordinates::Lagrangian
            } else {
                arguments.coordinates
            },
        },
        Scheme::SemiImplicitEuler => StepSpec::SemiImplicitEuler { dt },
    })
}

/// The programs of all quantities.
fn programs(
    robot: &Robot,
    arguments: &Arguments,
    step: Option<StepSpec>,
) -> Result<Vec<Program>, Box<dyn Error>> {
    let has_step = arguments.quantity.iter().any(|quantity| matches!(quantity, Computed::Step(_)));
    if step.is_some() && !has_step {
        return Err(
            "--scheme can only be used with --quantity step, step_z, y_step_zz or with --abi; remove it"
                .into(),
        );
    }
    let mut programs = Vec::new();
    for &quantity in &arguments.quantity {
        let program = match quantity {
            Computed::Model(quantity) => of_model(robot, quantity, arguments)?,
            Computed::Step(order) => of_step(robot, order, step, arguments)?,
            Computed::Extremal(of) => of_extremal(robot.clone(), of, arguments)?,
        };
        programs.push(if arguments.column_major { program.column_major() } else { program });
    }
    Ok(programs)
}

fn of_step(
    robot: &Robot,
    order: StepOrder,
    step: Option<StepSpec>,
    arguments: &Arguments,
) -> Result<Program, Box<dyn Error>> {
    let step = step.ok_or("a step needs --scheme and --dt, such as --scheme rk4 --dt 0.01")?;
    let wrong = match step {
        StepSpec::SemiImplicitEuler { .. } => arguments.coordinates != Coordinates::Lagrangian,
        _ => false,
    };
    if wrong {
        return Err("--scheme semi-implicit-euler needs --coordinates lagrangian".into());
    }
    if arguments.parameters || arguments.problem.is_some() {
        return Err("--parameters and --problem cannot be used with a step; remove them".into());
    }
    let options = ProgramOptions::default().with_only(arguments.only).with_limit(arguments.limit);
    Ok(step_program(robot, step, order, &options)?)
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
