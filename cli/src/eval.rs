//! `costate eval`: states in, derivatives out, as JSON lines.

use crate::{Outcome, RobotArguments};
use costate::derivative::{Hessian, Jacobian, NestedHessian, PhaseVelocity};
use costate::hamiltonian::{Hamiltonian, SecondOrder};
use costate::matrix::{Block, Matrix};
use costate::robot::Robot;
use serde_json::{Map, Value};
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Write};
use std::path::PathBuf;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// File of states, one JSON object a line [default: standard input]
    #[arg(long)]
    states: Option<PathBuf>,
    /// How the derivatives are computed
    #[arg(long, value_enum, default_value = "analytic")]
    route: Route,
    /// State variables
    #[arg(long, value_enum, default_value = "hamiltonian")]
    coordinates: Coordinates,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Route {
    /// Hand-derived F_x; y'F_xx by one dual pass through it
    Analytic,
    /// Dual numbers through F; dual numbers in dual numbers
    Dual,
    /// Hyper-dual numbers through F
    Hyperdual,
}

#[derive(Clone, Copy, PartialEq, clap::ValueEnum)]
enum Coordinates {
    /// x = (q, p)
    Hamiltonian,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let Coordinates::Hamiltonian = arguments.coordinates;
    let robot = arguments.robot.load_and_warn()?;
    let mut input: Box<dyn BufRead> = match &arguments.states {
        Some(path) => {
            let unreadable = |error| format!("{}: cannot be read ({error}); check the path", path.display());
            let file = File::open(path).map_err(unreadable)?;
            if path.is_dir() {
                return Err(unreadable(std::io::ErrorKind::IsADirectory.into()).into());
            }
            Box::new(BufReader::new(file))
        }
        None => Box::new(std::io::stdin().lock()),
    };
    let mut out = BufWriter::new(std::io::stdout().lock());
    let mut evaluator = Evaluator::new(&robot, arguments.route);
    let (mut line, mut number, mut bad) = (Vec::new(), 0, 0);
    while {
        line.clear();
        input.read_until(b'\n', &mut line)? > 0
    } {
        number += 1;
        if line.iter().all(u8::is_ascii_whitespace) {
            continue;
        }
        match evaluator.line(&line) {
            Ok(answer) => writeln!(out, "{answer}")?,
            Err(error) => {
                bad += 1;
                eprintln!("error: line {number}: {error}");
                writeln!(out, "{}", serde_json::json!({ "line": number, "error": error }))?;
            }
        }
        if arguments.states.is_none() {
            out.flush()?;
        }
    }
    out.flush()?;
    Ok(if bad == 0 { ExitCode::SUCCESS } else { ExitCode::from(2) })
}

/// The workspaces of one route.
enum Workspace {
    Analytic(Box<SecondOrder<f64>>),
    Dual(Box<Jacobian<PhaseVelocity>>, Box<NestedHessian<PhaseVelocity>>),
    Hyperdual(Box<Hessian<PhaseVelocity>>),
}

struct Evaluator {
    hamiltonian: Hamiltonian<f64>,
    workspace: Workspace,
    n: usize,
}

impl Evaluator {
    fn new(robot: &Robot, route: Route) -> Self {
        let function = || PhaseVelocity::new(robot);
        let workspace = match route {
            Route::Analytic => Workspace::Analytic(Box::new(SecondOrder::new(robot))),
            Route::Dual => {
                Workspace::Dual(Box::new(Jacobian::new(function())), Box::new(NestedHessian::new(function())))
            }
            Route::Hyperdual => Workspace::Hyperdual(Box::new(Hessian::new(function()))),
        };
        Self { hamiltonian: Hamiltonian::new(robot), workspace, n: robot.len() }
    }

    /// The answer to one line, or what is wrong with it.
    fn line(&mut self, line: &[u8]) -> Result<Value, String> {
        let state: Map<String, Value> = serde_json::from_slice(line)
            .map_err(|error| format!("not a JSON object ({error}); write {{\"q\":[…],\"p\":[…]}}"))?;
        let n = self.n;
        let q = numbers(&state, "q", n)?.ok_or("`q` is missing; give the n joint positions")?;
        let u = numbers(&state, "u", n)?.unwrap_or_else(|| vec![0.0; n]);
        let y = numbers(&state, "y", 2 * n)?;
        let p = match numbers(&state, "p", n)? {
            Some(p) => p,
            None => {
                let v = numbers(&state, "v", n)?
                    .ok_or("`p` and `v` are missing; give the momenta or the velocities")?;
                self.hamiltonian.momentum(&q, &v).map_err(|error| error.to_string())?.to_vec()
            }
        };
        let answer = self.answer(q, p, &u, y.as_deref()).map_err(|error| error.to_string())?;
        match answer.iter().find(|(_, value)| !all_finite(value)) {
            Some((key, _)) => Err(format!("`{key}` overflows; scale the state or the robot down")),
            None => Ok(Value::Object(answer)),
        }
    }

    fn answer(
        &mut self,
        q: Vec<f64>,
        p: Vec<f64>,
        u: &[f64],
        y: Option<&[f64]>,
    ) -> Result<Map<String, Value>, Box<dyn std::error::Error>> {
        let energy = self.hamiltonian.energy(&q, &p)?;
        let mut answer = Map::new();
        let mut give = |key: &str, value: Value| answer.insert(key.to_string(), value);
        give("energy", vec![energy.kinetic, energy.potential].into());
        give("M", rows(self.hamiltonian.mass_matrix(&q)?.view()));
        let x = [q.as_slice(), &p].concat();
        let mut derivatives = |f: &[f64], f_x: Block<'_, f64>, y_f_xx: Option<Block<'_, f64>>| {
            give("v", f[..q.len()].into());
            give("f", f.into());
            give("f_x", rows(f_x));
            if let Some(y_f_xx) = y_f_xx {
                give("y_f_xx", rows(y_f_xx));
            }
        };
        match (&mut self.workspace, y) {
            (Workspace::Analytic(_), None) => {
                let linear = self.hamiltonian.jacobian(&q, &p, u)?;
                derivatives(linear.f(), linear.matrix(), None);
            }
            (Workspace::Analytic(second), Some(y)) => {
                let second = second.contracted_hessian(&q, &p, u, y)?;
                let linear = second.linearisation();
                derivatives(linear.f(), linear.matrix(), Some(second.matrix()));
            }
            (Workspace::Dual(jacobian, nested), y) => {
                jacobian.function_mut().u.copy_from_slice(u);
                nested.function_mut().u.copy_from_slice(u);
                let first = jacobian.evaluate(&x)?;
                let second = y.map(|y| nested.contracted(&x, y)).transpose()?;
                derivatives(first.value, first.jacobian.view(), second.map(Matrix::view));
            }
            (Workspace::Hyperdual(hessian), y) => {
                hessian.function_mut().u.copy_from_slice(u);
                hessian.contracted(&x, y.unwrap_or(&vec![0.0; x.len()]))?;
                let (last, second) = (hessian.last(), hessian.last_contracted().view());
                derivatives(last.value(), last.jacobian().view(), y.map(|_| second));
            }
        }
        give("q", q.into());
        give("p", p.into());
        Ok(answer)
    }
}

/// The numbers under `key`, `None` where it is absent or null.
fn numbers(state: &Map<String, Value>, key: &str, expected: usize) -> Result<Option<Vec<f64>>, String> {
    let Some(value) = state.get(key).filter(|value| !value.is_null()) else { return Ok(None) };
    let values = value.as_array().ok_or_else(|| format!("`{key}` is not an array of numbers"))?;
    if values.len() != expected {
        return Err(format!("`{key}` has {} numbers, not {expected}", values.len()));
    }
    let number =
        |(i, value): (usize, &Value)| value.as_f64().ok_or_else(|| format!("`{key}[{i}]` is not a number"));
    values.iter().enumerate().map(number).collect::<Result<_, _>>().map(Some)
}

fn rows(block: Block<'_, f64>) -> Value {
    block.iter_rows().map(Value::from).collect()
}

/// Numbers that JSON cannot hold have become null.
fn all_finite(value: &Value) -> bool {
    match value {
        Value::Array(values) => values.iter().all(all_finite),
        value => !value.is_null(),
    }
}
