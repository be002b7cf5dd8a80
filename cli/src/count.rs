//! `costate count`: operations of each quantity by each method.

use crate::report::{Table, title};
use crate::work::refuse_excessive_count;
use crate::{Outcome, RobotArguments};
use costate::derivative::{OperationRow, OperationTable};
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
    /// Count operations with constants 0 and 1 too: every operation, as scalars without a fused multiply-add
    /// execute them, one lane at a time
    #[arg(long)]
    unfolded: bool,
    /// Run all methods on long chains even if that takes minutes or gigabytes
    #[arg(long)]
    force: bool,
}

pub fn run(arguments: &Arguments) -> Outcome {
    let robot = arguments.robot.load_tree_and_warn()?;
    refuse_excessive_count(&robot, arguments.force)?;
    let constants = if arguments.unfolded { Constants::Kept } else { Constants::Folded };
    let table = operation_table(&robot, constants)?;
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
        "nq": robot.nq(),
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
        Constants::Folded => "products with 0 and 1, sums with 0 and operations between constants are free",
        Constants::Kept => {
            "constants not folded: as scalars without a fused multiply-add execute them, one lane at a time"
        }
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
        "  tensors    global inertia tensors and Christoffel coefficients; y'F_xx by one dual pass"
    )?;
    writeln!(
        out,
        "  analytic   F_x by hand (21)-(24), second derivatives by the 2n+1 rule; y'F_x, y'F_xx d without matrix"
    )?;
    writeln!(out, "  dual pass  one dual number carried through the analytic F_x")?;
    writeln!(out, "  dual       dual numbers through F, and dual numbers in dual numbers")?;
    writeln!(out, "  hyperdual  hyper-dual numbers through F: all second derivatives at once")?;
    writeln!(out, "  M and F have no derivatives: by dual and hyperdual they are those of analytic.")?;
    if !robot.free_joints().is_empty() {
        writeln!(
            out,
            "  Derivatives are those in the tangent space, by dual numbers of q (+) d. Tensors, dual pass and all of\n  \
             F_xx by hand take no floating and spherical joints."
        )?;
    }
    Ok(())
}
