//! `costate count`: operations of each quantity by each method.

use crate::report::{Table, title};
use crate::work::{Method, Work};
use crate::{Outcome, RobotArguments, terminal};
use costate::derivative::{Extent, OperationRow, OperationTable};
use costate::robot::Robot;
use costate::scalar::Constants;
use costate_comparison::operation_table;
use serde_json::{Value, json};
use std::io::Write;
use std::process::ExitCode;

#[derive(clap::Args)]
pub struct Arguments {
    #[command(flatten)]
    robot: RobotArguments,
    /// Print one JSON object and nothing else
    #[arg(long)]
    json: bool,
    /// Also count operations on constants, and those with 0 and 1
    #[arg(long)]
    unfolded: bool,
    /// Count all methods, however long that takes
    #[arg(long)]
    force: bool,
}

/// Most operations of automatic second derivatives that are counted without `--force`: some seconds.
const MOST_AUTOMATIC: f64 = 1e10;

/// Most joints for which tensors are counted without `--force`: they have n^4 / 4 entries.
const MOST_WITH_TENSORS: usize = 64;

/// Most joints for which anything is counted without `--force`: counting takes about 100 n^3 operations.
const MOST_JOINTS: usize = 300;

/// What is counted, with a note on what is left out.
fn extent(robot: &Robot) -> Result<(Extent, Option<String>), String> {
    let n = robot.dof();
    if n > MOST_JOINTS {
        return Err(format!(
            "counting runs the derivatives of all {n} joints on counting numbers, about {:.0e} operations; the limit is \
             {MOST_JOINTS} joints, use --force to exceed it",
            100.0 * (n as f64).powi(3)
        ));
    }
    if n > MOST_WITH_TENSORS {
        let note = format!(
            "automatic methods, tensors and the whole F_xx are left out: they have up to {:.0e} entries for {n} joints, \
             the limit is {MOST_WITH_TENSORS} joints; use --force to count them",
            (n as f64).powi(4) / 4.0
        );
        return Ok((Extent::Matrices, Some(note)));
    }
    let work = Work::hamiltonian(robot, Method::HyperDual).operations();
    if work > MOST_AUTOMATIC {
        let note = format!(
            "dual and hyperdual are left out: they take about {work:.0e} operations, the limit is {MOST_AUTOMATIC:.0e}; \
             use --force to count them"
        );
        return Ok((Extent::ByHand, Some(note)));
    }
    Ok((Extent::All, None))
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_and_warn()?;
    let constants = if arguments.unfolded { Constants::Kept } else { Constants::Folded };
    let (extent, left_out) = if arguments.force { (Extent::All, None) } else { extent(&robot)? };
    if let Some(note) = left_out {
        terminal::note(note);
    }
    let table = operation_table(&robot, constants, extent)?;
    let mut out = std::io::stdout().lock();
    if arguments.json {
        writeln!(out, "{}", as_json(&robot, constants, &table))?;
    } else {
        print(&robot, constants, &table, &mut out)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn as_json(robot: &Robot, constants: Constants, table: &OperationTable) -> Value {
    let row = |row: OperationRow| {
        let o = row.operations;
        json!({
            "quantity": row.quantity, "route": row.route, "mul": o.mul, "add": o.add, "div": o.div, "sqrt": o.sqrt,
            "sincos": o.sincos, "exp": o.exp, "less": o.less,
        })
    };
    json!({
        "robot": robot.name(),
        "n": robot.dof(),
        "folded": constants == Constants::Folded,
        "rows": table.rows().map(row).collect::<Vec<_>>(),
    })
}

fn print(
    robot: &Robot,
    constants: Constants,
    table: &OperationTable,
    out: &mut impl Write,
) -> std::io::Result<()> {
    let how = match constants {
        Constants::Folded => "products with 0 and 1, sums with 0 and operations on constants are not counted",
        Constants::Kept => "as executed in f64, operations on constants included",
    };
    writeln!(out, "{}: operations of one evaluation,\n{how}\n", title(robot))?;
    let mut printed = Table::new(
        &["quantity", "method", "mul", "add", "div", "sqrt", "sincos", "exp", "less", "mul / F"],
        2,
    );
    let f = table.get("f", "analytic").unwrap_or_default().mul.max(1) as f64;
    let mut above = "";
    for row in table.rows() {
        let needs_no_derivative = matches!(row.quantity, "mass_matrix" | "f");
        if needs_no_derivative && matches!(row.route, "dual" | "hyperdual") {
            continue;
        }
        let quantity = match row.quantity {
            quantity if quantity == above => "",
            "mass_matrix" => "M",
            "f" => "F",
            "f_x" => "F, F_x",
            "y_f_xx" => "F, F_x, y'F_xx",
            "y_f_x" => "F, y'F_x",
            "y_f_xx_d" => "y'F_xx d",
            _ => "F_x, all of F_xx",
        };
        above = row.quantity;
        let o = row.operations;
        let counts = [o.mul, o.add, o.div, o.sqrt, o.sincos, o.exp, o.less].map(|count| count.to_string());
        let ratio = format!("{:.2}", o.mul as f64 / f);
        printed.row([vec![quantity.into(), row.route.into()], counts.into(), vec![ratio]].concat());
    }
    writeln!(out, "{printed}")?;
    writeln!(
        out,
        "  tensors    global inertia tensors and Christoffel coefficients; y'F_xx by one dual number"
    )?;
    writeln!(
        out,
        "  analytic   F_x by hand (21)-(24), y'F_xx by the 2n+1 rule; y'F_x, y'F_xx d without a matrix"
    )?;
    writeln!(out, "  dual pass  one dual number through the analytic F_x")?;
    writeln!(out, "  dual       dual numbers through F, and dual numbers in dual numbers")?;
    writeln!(out, "  hyperdual  hyper-dual numbers through F: all second derivatives at once")?;
    writeln!(out, "  M and F need no derivatives: the counts of analytic hold for dual and hyperdual too.")
}
