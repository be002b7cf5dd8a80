//! `costate check`: compares all methods for derivatives with each other.

mod arguments;
mod findings;
#[cfg(feature = "jit")]
mod machine_code;
mod report;
mod sample;

use crate::work::refuse_excessive;
use crate::{Outcome, terminal};
pub use arguments::Arguments;
use costate::EvalError;
use costate::derivative::{DerivativeError, StateReport};
use costate::hamiltonian::Hamiltonian;
use costate::robot::Robot;
use costate::step::StepError;
use costate_comparison::{Routes, StepRoutes};
use fastrand::Rng;
use findings::Findings;
use report::{Report, error_as_json};
use sample::{Sample, random_sample};
use std::io::Write;
use std::process::ExitCode;

/// Duration of the steps that are checked (s).
const STEP: f64 = 1e-3;

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_tree_and_warn()?;
    refuse_excessive(&robot, arguments.force)?;
    let findings = compare_all(&robot, arguments)?;
    if let Some(first) = findings.singular.first() {
        let (count, samples) = (findings.singular.len(), arguments.samples + 1);
        terminal::warning(format!("{count} of {samples} states are left out: {first}"));
    }
    if let Some(reason) = findings.nothing_compared() {
        if arguments.json {
            writeln!(terminal::stdout(), "{}", error_as_json(&robot, arguments, reason))?;
        }
        return Err(reason.into());
    }
    let failures = findings.failures(arguments.tolerance);
    let report = Report { robot: &robot, arguments, findings: &findings, failures: &failures };
    let mut out = terminal::stdout();
    if arguments.json {
        writeln!(out, "{}", report.as_json())?;
    } else {
        report.print(&mut out)?;
    }
    Ok(if failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// Compares at q = 0, or the neutral configuration, and at random states.
fn compare_all(robot: &Robot, arguments: &Arguments) -> Result<Findings, Box<dyn std::error::Error>> {
    let mut rng = Rng::with_seed(arguments.seed);
    let routes = Routes::new(robot).with_tolerance(arguments.tolerance);
    #[cfg(feature = "jit")]
    let routes = machine_code::routes(robot)?.into_iter().fold(routes, Routes::with_route);
    let mut routes = routes;
    let mut steps = StepRoutes::new(robot).with_tolerance(arguments.tolerance);
    let mut hamiltonian = Hamiltonian::new(robot);
    let bar = terminal::progress_bar(arguments.samples as u64 + 1, "states");
    let mut findings =
        Findings { zero: None, random: None, singular: Vec::new(), nearly_singular: 0, steps_unsolved: 0 };
    for k in 0..=arguments.samples {
        let sample = random_sample(robot, &mut hamiltonian, &mut rng, k == 0)?;
        match compare(&mut routes, &mut steps, &sample) {
            Ok((report, unsolved)) => {
                findings.steps_unsolved += usize::from(unsolved);
                findings.nearly_singular += usize::from(report.is_nearly_singular());
                let worst = if k == 0 { &mut findings.zero } else { &mut findings.random };
                *worst = Some(match worst.take() {
                    Some(worst) => worst.with_worse_of(&report),
                    None => report,
                });
            }
            Err(Left::Out(reason)) => findings.singular.push(reason),
            Err(Left::Failed(error)) => return Err(error),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    Ok(findings)
}

/// Why a state gives no figures.
enum Left {
    /// It is singular.
    Out(String),
    Failed(Box<dyn std::error::Error>),
}

impl From<EvalError> for Left {
    fn from(error: EvalError) -> Self {
        match error {
            EvalError::SingularMassMatrix { .. } => Self::Out(error.to_string()),
            _ => Self::Failed(error.into()),
        }
    }
}

/// All figures at one state, and whether those of steps are missing: near a singular M they may have no
/// solution.
fn compare(
    routes: &mut Routes,
    steps: &mut StepRoutes,
    sample: &Sample,
) -> Result<(StateReport, bool), Left> {
    let Sample { x, u, y } = sample;
    let mut report = routes.compare(x, u, y).map_err(|error| match error {
        DerivativeError::Function(error) => error.into(),
        error => Left::Failed(error.into()),
    })?;
    match steps.compare(x, u, STEP, y, &mut report.figures) {
        Ok(()) => Ok((report, false)),
        Err(
            StepError::NotConverged { .. }
            | StepError::Inaccurate { .. }
            | StepError::Dynamics(EvalError::SingularMassMatrix { .. }),
        ) => Ok((report, true)),
        Err(error) => Err(Left::Failed(error.into())),
    }
}
