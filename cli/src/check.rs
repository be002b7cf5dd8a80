//! `costate check`: every route against every other.

use crate::arguments::positive;
use crate::report::{Table, title};
use crate::terminal::{bad, good};
use crate::work::refuse_excessive;
use crate::{Outcome, RobotArguments, terminal};
use costate::EvalError;
use costate::derivative::{DerivativeError, StateReport, worse};
use costate::hamiltonian::Hamiltonian;
use costate::robot::{Joint, JointKind, Robot};
use costate::step::StepError;
use costate_comparison::{Routes, StepRoutes};
use fastrand::Rng;
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
    /// Largest relative difference allowed; scaled by cond(M)/1000 where that exceeds 1
    #[arg(long, default_value = "1e-12", value_parser = positive)]
    tolerance: f64,
    /// Run all methods on long chains even if that takes minutes or gigabytes
    #[arg(long)]
    force: bool,
}

/// Duration of the steps that are checked (s).
const STEP: f64 = 1e-3;

/// A state, what acts on it, and the costate to contract with.
struct Sample {
    x: Vec<f64>,
    u: Vec<f64>,
    y: Vec<f64>,
}

/// The largest figures over some states.
#[derive(Default)]
struct Worst {
    report: Option<StateReport>,
    /// Largest ratio of a figure to its tolerance.
    excess: f64,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_and_warn()?;
    refuse_excessive(&robot, arguments.force)?;
    let mut rng = Rng::with_seed(arguments.seed);
    let mut routes = Routes::new(&robot);
    let mut steps = StepRoutes::new(&robot);
    let mut hamiltonian = Hamiltonian::new(&robot);
    let bar = terminal::progress_bar(arguments.samples as u64 + 1, "states");
    let (mut at_zero, mut at_random, mut left_out) = (Worst::default(), Worst::default(), Vec::new());
    let mut steps_left_out = 0;
    for k in 0..=arguments.samples {
        let sample = random_sample(&robot, &mut hamiltonian, &mut rng, k == 0)?;
        let worst = if k == 0 { &mut at_zero } else { &mut at_random };
        match compare(&mut routes, &mut steps, &sample) {
            Ok((report, unsolved)) => {
                worst.include(report, arguments.tolerance);
                steps_left_out += usize::from(unsolved);
            }
            Err(Left::Out(reason)) => left_out.push(reason),
            Err(Left::Failed(error)) => return Err(error),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if let Some(first) = left_out.first() {
        let (count, samples) = (left_out.len(), arguments.samples + 1);
        terminal::warning(format!("{count} of {samples} states are left out: {first}"));
    }
    if left_out.len() > arguments.samples {
        return Err("no state could be evaluated".into());
    }
    let mut out = terminal::stdout();
    if steps_left_out > 0 {
        writeln!(
            out,
            "In {steps_left_out} states an implicit step of 1 ms was not solved: no figures of steps there.\n"
        )?;
    }
    print(&robot, arguments, &at_zero, &at_random, &mut out)
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
    let n = robot.dof();
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

impl Worst {
    fn include(&mut self, report: StateReport, tolerance: f64) {
        self.excess = worse(self.excess, report.excess(tolerance));
        self.report = Some(match self.report.take() {
            Some(worst) => worst.with_worse_of(&report),
            None => report,
        });
    }

    /// One figure of the report, in print; a dash where no state was evaluated.
    fn figure(&self, figure: impl Fn(&StateReport) -> Option<f64>) -> String {
        self.report.as_ref().and_then(figure).map_or("-".into(), scientific)
    }
}

fn print(
    robot: &Robot,
    arguments: &Arguments,
    zero: &Worst,
    random: &Worst,
    out: &mut impl Write,
) -> Outcome {
    let (samples, tolerance) = (arguments.samples, arguments.tolerance);
    writeln!(out, "{}: {samples} random states (seed {}) and q = 0\n", title(robot), arguments.seed)?;
    writeln!(out, "Largest relative difference, max |a - b| / max |b|:\n")?;
    let mut table = Table::new(&["quantity", "route", "at q = 0", "random states"], 2);
    let mut above = "";
    let reports = zero.report.iter().chain(&random.report);
    let fullest = reports.max_by_key(|report| report.figures.len());
    for (k, named) in fullest.iter().flat_map(|report| &report.figures).enumerate() {
        let quantity = if named.quantity == above { "" } else { named.quantity };
        above = named.quantity;
        let figures = [zero, random].map(|worst| worst.figure(|report| Some(report.figures.get(k)?.value)));
        table.row([vec![quantity.into(), named.route.into()], figures.into()].concat());
    }
    let conditions = [zero, random].map(|worst| worst.figure(|report| Some(report.condition)));
    table.row([vec!["cond(M), largest".into(), "-".into()], conditions.into()].concat());
    writeln!(out, "{table}")?;
    for line in [
        "analytic       by hand: F_x (21)-(24), y'F_xx by the 2n+1 rule; y'F_x and y'F_xx y without the matrix",
        "dual pass      one dual number through the analytic F_x",
        "packed tensor  all second derivatives by hand, contracted with y",
        "tensors        global inertia tensors and Christoffel coefficients; one dual number through them",
        "dual           dual numbers through F and a, and dual numbers in dual numbers",
        "Phi            one step of 1 ms, by the adjoint of its stages; d = (y, u)",
        "Every route is set beside hyper-dual numbers through F, a, the acceleration in (q, v), and Phi.",
        "y'F_xx by tensors and y'a_zz by hand round M in another way: they are allowed cond(M)/100 below.",
        "Where a quantity vanishes, b is the size of the terms that cancel: energies, forces.\n",
    ] {
        writeln!(out, "  {line}")?;
    }
    let excess = worse(zero.excess, random.excess);
    let allowed = format!("{tolerance:.0e} max(1, cond(M)/1000)");
    if excess <= 1.0 {
        writeln!(
            out,
            "{}: every figure is below {allowed}; the largest is {} of it.",
            good("PASS"),
            scientific(excess)
        )?;
        return Ok(ExitCode::SUCCESS);
    }
    writeln!(out, "{}: a figure exceeds {allowed} by the factor {}.", bad("FAIL"), scientific(excess))?;
    Ok(ExitCode::FAILURE)
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
