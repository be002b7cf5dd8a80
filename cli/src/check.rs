//! `costate check`: every route against every other.

use crate::report::Table;
use crate::{Outcome, RobotArguments};
use costate::EvalError;
use costate::derivative::{DerivativeError, Routes, StateReport};
use costate::hamiltonian::Hamiltonian;
use costate::robot::{Joint, JointKind, Robot};
use fastrand::Rng;
use indicatif::{ProgressBar, ProgressStyle};
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
    #[arg(long, default_value = "1e-12")]
    tolerance: f64,
}

/// A state, what acts on it, and the costate to contract with.
struct Sample {
    x: Vec<f64>,
    u: Vec<f64>,
    y: Vec<f64>,
}

/// The largest figures over some states.
#[derive(Default)]
struct Worst {
    states: usize,
    condition: f64,
    f_x: [f64; 3],
    y_f_xx: [f64; 3],
    jacobian_asymmetry: [f64; 3],
    hessian_asymmetry: [f64; 3],
    energy_drift: f64,
    /// Largest ratio of a figure to its tolerance.
    excess: f64,
}

pub fn run(arguments: &Arguments) -> Outcome {
    if !(arguments.tolerance > 0.0 && arguments.tolerance.is_finite()) {
        return Err("--tolerance must be a positive number".into());
    }
    let robot = arguments.robot.load_and_warn()?;
    let mut rng = Rng::with_seed(arguments.seed);
    let mut routes = Routes::new(&robot);
    let mut hamiltonian = Hamiltonian::new(&robot);
    let bar = ProgressBar::new(arguments.samples as u64 + 1);
    bar.set_style(ProgressStyle::with_template("{bar:40} {pos}/{len} states, {eta} left")?);
    let (mut at_zero, mut at_random, mut singular) = (Worst::default(), Worst::default(), Vec::new());
    for k in 0..=arguments.samples {
        let sample = random_sample(&robot, &mut hamiltonian, &mut rng, k == 0)?;
        let worst = if k == 0 { &mut at_zero } else { &mut at_random };
        match routes.compare(&sample.x, &sample.u, &sample.y) {
            Ok(report) => worst.include(&report, arguments.tolerance),
            Err(DerivativeError::Function(error @ EvalError::SingularMassMatrix { .. })) => {
                singular.push(error)
            }
            Err(error) => return Err(error.into()),
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    if let Some(first) = singular.first() {
        eprintln!("warning: {} of {} states are left out: {first}", singular.len(), arguments.samples + 1);
    }
    if singular.len() > arguments.samples {
        return Err("no state could be evaluated".into());
    }
    let mut out = std::io::stdout().lock();
    print(&robot, arguments, &at_zero, &at_random, &mut out)
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

impl Worst {
    fn include(&mut self, report: &StateReport, tolerance: f64) {
        self.states += 1;
        let worse = |a: &mut f64, b: f64| *a = if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) };
        worse(&mut self.condition, report.condition);
        for k in 0..3 {
            worse(&mut self.f_x[k], report.differences[k].f_x);
            worse(&mut self.y_f_xx[k], report.differences[k].y_f_xx);
            worse(&mut self.jacobian_asymmetry[k], report.jacobian_asymmetry[k]);
            worse(&mut self.hessian_asymmetry[k], report.hessian_asymmetry[k]);
        }
        worse(&mut self.energy_drift, report.energy_drift);
        worse(&mut self.excess, report.worst() / (tolerance * (report.condition / 1000.0).max(1.0)));
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
    writeln!(
        out,
        "{}, {} joint{}: {samples} random states (seed {}) and q = 0\n",
        robot.name(),
        robot.len(),
        if robot.len() == 1 { "" } else { "s" },
        arguments.seed
    )?;
    writeln!(out, "Largest relative difference, max |a - b| / max |b|:\n")?;
    let mut table = Table::new(&["quantity", "routes", "at q = 0", "random states"], 2);
    let figure = |worst: &Worst, x: f64| if worst.states == 0 { "-".into() } else { scientific(x) };
    let pairs = [(0, 1), (0, 2), (1, 2)].map(|(a, b)| format!("{} - {}", Routes::NAMES[a], Routes::NAMES[b]));
    let singles = Routes::NAMES.map(str::to_string);
    let groups = [
        ("F_x", &pairs, zero.f_x, random.f_x),
        ("y'F_xx", &pairs, zero.y_f_xx, random.y_f_xx),
        ("asymmetry of J F_x (no friction)", &singles, zero.jacobian_asymmetry, random.jacobian_asymmetry),
        ("asymmetry of y'F_xx", &singles, zero.hessian_asymmetry, random.hessian_asymmetry),
    ];
    for (quantity, names, at_zero, at_random) in groups {
        for k in 0..3 {
            let quantity = if k == 0 { quantity } else { "" };
            let figures = [figure(zero, at_zero[k]), figure(random, at_random[k])];
            table.row([vec![quantity.into(), names[k].clone()], figures.into()].concat());
        }
    }
    for (quantity, at_zero, at_random) in [
        ("energy drift dH/dt, u = D = 0", zero.energy_drift, random.energy_drift),
        ("cond(M), largest", zero.condition, random.condition),
    ] {
        let figures = [figure(zero, at_zero), figure(random, at_random)];
        table.row([vec![quantity.into(), "-".into()], figures.into()].concat());
    }
    writeln!(out, "{table}")?;
    writeln!(out, "  analytic   F_x by hand (21)-(24), y'F_xx by one dual number carried through it")?;
    writeln!(out, "  dual       dual numbers through F, and dual numbers in dual numbers")?;
    writeln!(out, "  hyperdual  hyper-dual numbers through F")?;
    writeln!(
        out,
        "  Where a quantity vanishes, b is the size of the terms that cancel: energies, forces.\n"
    )?;
    let excess = if zero.excess.is_nan() || random.excess.is_nan() {
        f64::NAN
    } else {
        zero.excess.max(random.excess)
    };
    let allowed = format!("{tolerance:.0e} max(1, cond(M)/1000)");
    if excess <= 1.0 {
        writeln!(out, "PASS: every figure is below {allowed}; the largest is {} of it.", scientific(excess))?;
        return Ok(ExitCode::SUCCESS);
    }
    writeln!(out, "FAIL: a figure exceeds {allowed} by the factor {}.", scientific(excess))?;
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
