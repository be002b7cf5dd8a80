//! What a check prints.

use super::arguments::Arguments;
use super::findings::{Findings, Row};
use crate::report::{Table, counted, title};
use crate::terminal::{bad, good};
use costate::derivative::{Figure, Verdict};
use costate::robot::Robot;
use serde_json::{Value, json};
use std::io::Write;

pub(super) fn as_json(
    robot: &Robot,
    arguments: &Arguments,
    findings: &Findings,
    failures: &[Figure],
) -> Value {
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
        "n": robot.dof(),
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

/// If nothing could be compared.
pub(super) fn error_as_json(robot: &Robot, arguments: &Arguments, reason: &str) -> Value {
    json!({
        "robot": robot.name(),
        "n": robot.dof(),
        "samples": arguments.samples,
        "seed": arguments.seed,
        "tolerance": arguments.tolerance,
        "pass": null,
        "error": reason,
        "rows": [],
    })
}

pub(super) fn print(
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
            _ if figure.difference == 0.0 => ["0".into(), "-".into(), "0".into()],
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
        "The reference is hyper-dual numbers through F, a and Phi. Each row shows the block (q or p by q or p)",
        "closest to its bound; difference and bound are relative to the largest entry of that block. The bound is",
        "32 standard deviations of the rounding error, propagated through every operation; a smaller bound, with",
        "one rounding for the error of the reference, is shown where a tenth of it suffices (docs/check.md).",
        "ratio = difference / bound\n",
    ] {
        writeln!(out, "{}", format!("  {line}").trim_end())?;
    }
    writeln!(out, "  Largest cond(M): {}", scientific(findings.condition()))?;
    if findings.nearly_singular > 0 {
        let states = counted(findings.nearly_singular, "state");
        writeln!(out, "  In {states} rounding leaves too few digits to compare some blocks.")?;
    }
    if findings.steps_unsolved > 0 {
        let states = counted(findings.steps_unsolved, "state");
        writeln!(
            out,
            "  In {states} an implicit step of 1 ms was not solved to rounding: steps are not compared there."
        )?;
    }
    writeln!(out)?;
    let allowed = match arguments.tolerance {
        1.0 => "its bound".to_owned(),
        tolerance => format!("{tolerance:e} times its bound"),
    };
    let silent = findings.rows().iter().filter(|row| row.says_nothing()).count();
    if failures.is_empty() && silent == 0 {
        writeln!(out, "{}: no difference exceeds {allowed}.", good("PASS"))?;
    } else if failures.is_empty() {
        let rows = counted(silent, "row");
        writeln!(
            out,
            "{}: no comparable difference exceeds {allowed}; {rows} not comparable in any state.",
            good("PASS")
        )?;
    }
    let limit = match arguments.tolerance {
        1.0 => String::new(),
        tolerance => format!(" (allowed: {tolerance:e})"),
    };
    for failure in failures {
        let Figure { quantity, route, difference, .. } = failure;
        let how = match difference.is_nan() {
            true => "is not a number".to_owned(),
            false if failure.bound == 0.0 => "differs, though no operation rounds".to_owned(),
            false => format!("differs by {} times its bound{limit}", scientific(failure.ratio())),
        };
        writeln!(out, "{}: {quantity} by {route} {how}.", bad("FAIL"))?;
    }
    Ok(())
}

/// Two digits and an exponent; an exact zero as such.
fn scientific(x: f64) -> String {
    match x {
        0.0 => "0".into(),
        _ if x.is_nan() => "undefined".into(),
        _ => format!("{x:.1e}"),
    }
}
