//! `costate check`: compares all methods for derivatives with each other.

use crate::arguments::positive;
use crate::report::{Table, counted, title};
use crate::terminal::{bad, good};
use crate::work::{Method, Work};
use crate::{Outcome, RobotArguments, terminal};
use costate::EvalError;
use costate::derivative::{DerivativeError, Figure, StateReport, Verdict, worse};
use costate::hamiltonian::Hamiltonian;
use costate::robot::{Joint, JointKind, Robot};
use costate::step::StepError;
use costate_comparison::{Routes, StepRoutes};
use fastrand::Rng;
use serde_json::{Value, json};
use std::io::Write;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Number of random states, besides q = 0
    #[arg(long, default_value_t = 100)]
    samples: usize,
    /// Seed of the random states
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Largest difference allowed, in units of the rounding error bound of its entry
    #[arg(long, default_value = "1", value_parser = positive)]
    tolerance: f64,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
    /// Start even if the work exceeds the limits
    #[arg(long)]
    force: bool,
}

/// Most operations for all states together that are started without `--force`: some minutes.
const MOST_OPERATIONS: f64 = 3e11;

/// Duration of the steps that are checked (s).
const STEP: f64 = 1e-3;

/// A state, what acts on it, and the costate to contract with.
struct Sample {
    x: Vec<f64>,
    u: Vec<f64>,
    y: Vec<f64>,
}

/// What was found.
struct Findings {
    /// At q = 0, if M is regular there.
    zero: Option<StateReport>,
    /// The worst of each figure over all random states.
    random: Option<StateReport>,
    /// Why states were left out, one message for each.
    singular: Vec<String>,
    /// States in which rounding leaves too few digits for some comparison.
    nearly_singular: usize,
    /// States in which an implicit step was not solved.
    steps_unsolved: usize,
}

/// One row of the report: a quantity by one method.
struct Row<'a> {
    named: &'a Figure,
    zero: Option<&'a Figure>,
    random: Option<&'a Figure>,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_and_warn()?;
    if !arguments.force {
        refuse_excessive(&robot, arguments.samples)?;
    }
    let findings = compare_all(&robot, arguments)?;
    if let Some(first) = findings.singular.first() {
        let (count, samples) = (findings.singular.len(), arguments.samples + 1);
        terminal::warning(format!("{count} of {samples} states are left out: {first}"));
        if count == samples {
            return Err("no state could be evaluated".into());
        }
    }
    let failures = findings.failures(arguments.tolerance);
    let mut out = terminal::stdout();
    if arguments.json {
        writeln!(out, "{}", as_json(&robot, arguments, &findings, &failures))?;
    } else {
        print(&robot, arguments, &findings, &failures, &mut out)?;
    }
    Ok(if failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE })
}

/// The reference, hyper-dual numbers, takes work that grows with the fourth to fifth power of the number of joints.
fn refuse_excessive(robot: &Robot, samples: usize) -> Result<(), String> {
    let second = Work::lagrangian(robot, Method::HyperDual);
    let all = [
        second,
        Work::lagrangian(robot, Method::Nested),
        Work::hamiltonian(robot, Method::HyperDual),
        Work::hamiltonian(robot, Method::Nested),
    ];
    let n = counted(robot.len(), "joint");
    if all.iter().any(Work::is_excessive) {
        return Err(format!(
            "automatic second derivatives of {n} take {second}; check a part of the robot, or use --force"
        ));
    }
    let states = samples.saturating_add(1);
    let operations = all.iter().map(Work::operations).sum::<f64>() * states as f64;
    if operations > MOST_OPERATIONS {
        let affordable = (MOST_OPERATIONS / operations * states as f64) as usize;
        return Err(format!(
            "{} of {n} take about {operations:.0e} operations (the limit is {MOST_OPERATIONS:.0e}); use --samples {} or \
             fewer, or --force",
            counted(states, "state"),
            affordable.saturating_sub(1),
        ));
    }
    Ok(())
}

/// Compares at q = 0 and at random states.
fn compare_all(robot: &Robot, arguments: &Arguments) -> Result<Findings, Box<dyn std::error::Error>> {
    let mut rng = Rng::with_seed(arguments.seed);
    let mut routes = Routes::new(robot);
    let mut steps = StepRoutes::new(robot);
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

/// All figures at one state, and whether those of steps are missing: near a singular M they may have no solution.
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
        Err(StepError::NotConverged { .. }) => Ok((report, true)),
        Err(StepError::Dynamics(error)) => Err(error.into()),
        Err(error) => Err(Left::Failed(error.into())),
    }
}

/// q uniform over its range; v, u and y uniform in +-1.
fn random_sample(
    robot: &Robot,
    hamiltonian: &mut Hamiltonian<f64>,
    rng: &mut Rng,
    zero: bool,
) -> Result<Sample, EvalError> {
    let n = robot.len();
    let mut within = |low: f64, high: f64| low + (high - low) * rng.f64();
    let mut q = Vec::with_capacity(2 * n);
    for joint in robot.joints() {
        let (low, high) = range(joint);
        let position = within(low, high);
        q.push(if zero { 0.0 } else { position });
    }
    let mut uniform = |count: usize| (0..count).map(|_| within(-1.0, 1.0)).collect::<Vec<_>>();
    let (v, u, y) = (uniform(n), uniform(n), uniform(2 * n));
    let p = hamiltonian.momentum(&q, &v)?;
    q.extend_from_slice(p);
    Ok(Sample { x: q, u, y })
}

impl Findings {
    /// Every quantity by every method.
    fn rows(&self) -> Vec<Row<'_>> {
        let reports = self.zero.iter().chain(&self.random);
        let fullest = reports.max_by_key(|report| report.figures.len());
        let figures = fullest.into_iter().flat_map(|report| report.figures.iter().enumerate());
        figures
            .map(|(k, named)| Row {
                named,
                zero: self.zero.as_ref().and_then(|report| report.figures.get(k)),
                random: self.random.as_ref().and_then(|report| report.figures.get(k)),
            })
            .collect()
    }

    /// The figures that do not agree.
    fn failures(&self, tolerance: f64) -> Vec<Figure> {
        let worst = self.rows().iter().filter_map(Row::worst).collect::<Vec<_>>();
        worst.into_iter().filter(|figure| figure.verdict(tolerance) == Verdict::Differs).collect()
    }

    /// The largest condition number of M.
    fn condition(&self) -> f64 {
        self.zero.iter().chain(&self.random).map(|report| report.condition).fold(0.0, worse)
    }
}

impl Row<'_> {
    /// The worse of both columns.
    fn worst(&self) -> Option<Figure> {
        match (self.zero, self.random) {
            (Some(zero), Some(random)) => Some(zero.or_worse(random)),
            (one, other) => one.or(other).copied(),
        }
    }
}

fn as_json(robot: &Robot, arguments: &Arguments, findings: &Findings, failures: &[Figure]) -> Value {
    let figure = |figure: &Figure| {
        json!({
            "difference": figure.difference, "bound": figure.bound, "ratio": figure.ratio(),
            "verdict": match figure.verdict(arguments.tolerance) {
                Verdict::Agrees => "agrees",
                Verdict::NotComparable => "not comparable",
                Verdict::Differs => "differs",
            },
        })
    };
    let row = |row: &Row<'_>| {
        json!({
            "quantity": row.named.quantity, "route": row.named.route,
            "zero": row.zero.map(figure), "random": row.random.map(figure),
        })
    };
    json!({
        "robot": robot.name(),
        "n": robot.len(),
        "samples": arguments.samples,
        "seed": arguments.seed,
        "tolerance": arguments.tolerance,
        "pass": failures.is_empty(),
        "condition": findings.condition(),
        "states_singular": findings.singular.len(),
        "states_nearly_singular": findings.nearly_singular,
        "states_without_steps": findings.steps_unsolved,
        "rows": findings.rows().iter().map(row).collect::<Vec<_>>(),
    })
}

fn print(
    robot: &Robot,
    arguments: &Arguments,
    findings: &Findings,
    failures: &[Figure],
    out: &mut impl Write,
) -> std::io::Result<()> {
    let samples = counted(arguments.samples, "random state");
    writeln!(out, "{}: {samples} (seed {}) and q = 0\n", title(robot), arguments.seed)?;
    let mut table = Table::new(&["quantity", "method", "difference", "bound", "ratio", "at q = 0"], 2);
    let mut above = "";
    for row in findings.rows() {
        let quantity = if row.named.quantity == above { "" } else { row.named.quantity };
        above = row.named.quantity;
        let parts = |figure: &Figure| match figure.verdict(arguments.tolerance) {
            Verdict::NotComparable => ["-".into(), scientific(figure.bound), "-".into()],
            _ => [figure.difference, figure.bound, figure.ratio()].map(scientific),
        };
        let none = || ["-".into(), "-".into(), "-".into()];
        let [difference, bound, ratio] = row.worst().as_ref().map_or_else(none, parts);
        let [.., at_zero] = row.zero.map_or_else(none, parts);
        table.row(vec![quantity.into(), row.named.route.into(), difference, bound, ratio, at_zero]);
    }
    writeln!(out, "{table}")?;
    for line in [
        "analytic       by hand: F_x (21)-(24), y'F_xx by the 2n+1 rule; y'F_x and y'F_xx y without the matrix",
        "dual pass      one dual number through the analytic F_x",
        "packed tensor  all second derivatives by hand, contracted with y",
        "tensors        global inertia tensors and Christoffel coefficients; one dual number through them",
        "dual           dual numbers through F and a, and dual numbers in dual numbers",
        "a, Phi         acceleration in (q, v); one step of 1 ms, d = (y, u)",
        "",
        "The reference are hyper-dual numbers through F, a and Phi. Shown is the entry closest to its bound;",
        "difference and bound are relative to the terms of that entry. The bound follows from propagating the",
        "rounding errors of M, P and L_qq through M^-1 (docs/check.md); ratio = difference / bound.\n",
    ] {
        writeln!(out, "{}", format!("  {line}").trim_end())?;
    }
    writeln!(out, "  Largest cond(M): {}", scientific(findings.condition()))?;
    if findings.nearly_singular > 0 {
        let states = counted(findings.nearly_singular, "state");
        writeln!(out, "  In {states} some entries are not comparable: M is nearly singular.")?;
    }
    if findings.steps_unsolved > 0 {
        let states = counted(findings.steps_unsolved, "state");
        writeln!(
            out,
            "  In {states} an implicit step of 1 ms was not solved: steps are not compared there."
        )?;
    }
    writeln!(out)?;
    let allowed = match arguments.tolerance {
        1.0 => "its bound".to_owned(),
        tolerance => format!("{tolerance} times its bound"),
    };
    if failures.is_empty() {
        writeln!(out, "{}: no difference exceeds {allowed}.", good("PASS"))?;
    }
    for failure in failures {
        let Figure { quantity, route, difference, .. } = failure;
        let how = match difference.is_nan() {
            true => "is not a number".to_owned(),
            false => format!("differs by {} times its bound", scientific(failure.ratio())),
        };
        writeln!(out, "{}: {quantity} by {route} {how}.", bad("FAIL"))?;
    }
    Ok(())
}

/// Two digits and an exponent; an exact zero as such.
fn scientific(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

/// Where a joint is sampled: between its limits; +-pi rad or +-1 m without (limits that coincide are none), as much
/// beyond or before a single one.
fn range(joint: &Joint) -> (f64, f64) {
    let reach = if joint.kind == JointKind::Revolute { std::f64::consts::PI } else { 1.0 };
    let (lower, upper) = (joint.limits.lower, joint.limits.upper);
    match (lower.is_finite(), upper.is_finite()) {
        (true, true) if lower < upper => (lower, upper),
        (true, false) => (lower, lower + 2.0 * reach),
        (false, true) => (upper - 2.0 * reach, upper),
        _ => (-reach, reach),
    }
}
