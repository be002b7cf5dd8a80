//! What a check prints.

use super::arguments::Arguments;
use super::findings::{Findings, Row};
use crate::report::{Table, counted, scientific, title};
use crate::terminal::{bad, good};
use costate::derivative::{Figure, Verdict};
use costate::robot::Robot;
use serde_json::{Value, json};
use std::io::{self, Write};

/// What was found, and how it is judged.
pub(super) struct Report<'a> {
    pub robot: &'a Robot,
    pub arguments: &'a Arguments,
    pub findings: &'a Findings,
    pub failures: &'a [Figure],
}

/// Below the table.
const LEGEND: [&str; 15] = [
    "analytic       by hand: F_x (21)-(24), y'F_xx by the 2n+1 rule; y'F_x and y'F_xx y without the matrix",
    "dual pass      one dual number through the analytic F_x",
    "packed tensor  all second derivatives by hand, contracted with y",
    "tensors        global inertia tensors and Christoffel coefficients; one dual number through them",
    "dual           dual numbers through F and a, and dual numbers in dual numbers",
    "machine code   recorded from the analytic methods and compiled in memory",
    "a, tau, Phi    forward and inverse dynamics in (q, v); one step of 1 ms, d = (y, u)",
    "w.V, x, e      fixed weights times twists of frames in three conventions, positions, orientation errors;",
    "w.c, w.h       ... times the centre of mass, the momentum about it; z = (q, v)",
    "",
    "The reference is hyper-dual numbers through these. Each row shows the block (q or p by q or p)",
    "closest to its bound; difference and bound are relative to the largest entry of that block. The bound is",
    "32 standard deviations of the rounding error, propagated through every operation; a smaller bound, with",
    "one rounding for the error of the reference, is shown where a tenth of it suffices (docs/check.md).",
    "ratio = difference / bound\n",
];

/// The same with floating and spherical joints.
const FREE_LEGEND: [&str; 14] = [
    "analytic       by hand: F_x, y'F_xx by the 2n+1 rule; y'F_x and y'F_xx y without the matrix",
    "dual           dual numbers through F and a, and dual numbers in dual numbers",
    "machine code   recorded from the analytic methods and compiled in memory",
    "a, tau, Phi    forward and inverse dynamics in (q, v); one step of 1 ms, d = (y, u)",
    "w.V, w.x       fixed weights times twists of frames in three conventions, positions;",
    "w.c, w.h       ... times the centre of mass, the momentum about it; z = (q, v)",
    "",
    "Derivatives by q are those in the tangent space: the reference is hyper-dual numbers through these at",
    "q (+) d, with (-) from the end of a step. Each row shows the block (q or p by q or p) closest to its bound;",
    "difference and bound are relative to the largest entry of that block. The bound is 32 standard deviations of",
    "the rounding error, propagated through every operation; a smaller bound, with one rounding for the error of",
    "the reference, is shown where a tenth of it suffices (docs/check.md). Other methods and second derivatives",
    "take no such joints.",
    "ratio = difference / bound\n",
];

/// The robot and how it was sampled: the entries of every JSON object.
fn heading(robot: &Robot, arguments: &Arguments) -> Value {
    json!({
        "robot": robot.name(),
        "n": robot.dof(),
        "samples": arguments.samples,
        "seed": arguments.seed,
        "tolerance": arguments.tolerance,
    })
}

/// If nothing could be compared.
pub(super) fn error_as_json(robot: &Robot, arguments: &Arguments, reason: &str) -> Value {
    let mut object = heading(robot, arguments);
    object["pass"] = Value::Null;
    object["error"] = json!(reason);
    object["rows"] = json!([]);
    object
}

impl Report<'_> {
    pub fn as_json(&self) -> Value {
        let figure = |figure: &Figure| {
            json!({
                "difference": figure.difference, "bound": figure.bound, "ratio": figure.ratio(),
                "verdict": match figure.verdict(self.arguments.tolerance) {
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
        let mut object = heading(self.robot, self.arguments);
        object["pass"] = json!(self.failures.is_empty());
        object["condition"] = json!(self.findings.condition());
        object["states_singular"] = json!(self.findings.singular.len());
        object["states_nearly_singular"] = json!(self.findings.nearly_singular);
        object["states_without_steps"] = json!(self.findings.steps_unsolved);
        object["rows"] = self.findings.rows().iter().map(row).collect();
        object
    }

    pub fn print(&self, out: &mut impl Write) -> io::Result<()> {
        let samples = counted(self.arguments.samples, "random state");
        let is_plain = self.robot.free_joints().is_empty();
        let (zero, legend) = match is_plain {
            true => ("q = 0", &LEGEND[..]),
            false => ("the neutral configuration", &FREE_LEGEND[..]),
        };
        writeln!(out, "{}: {samples} (seed {}) and {zero}\n", title(self.robot), self.arguments.seed)?;
        writeln!(out, "{}", self.table())?;
        for line in legend {
            writeln!(out, "{}", format!("  {line}").trim_end())?;
        }
        self.print_states(out)?;
        self.print_verdicts(out)
    }

    fn table(&self) -> Table {
        let zero = if self.robot.free_joints().is_empty() { "at q = 0" } else { "at neutral" };
        let mut table = Table::new(&["quantity", "method", "difference", "bound", "ratio", zero], 2);
        let mut above = "";
        for row in self.findings.rows() {
            let quantity = if row.named.quantity == above { "" } else { row.named.quantity };
            above = row.named.quantity;
            let parts = |figure: &Figure| match figure.verdict(self.arguments.tolerance) {
                Verdict::NotComparable => ["-".into(), defined(figure.bound), "-".into()],
                _ if figure.difference == 0.0 => ["0".into(), "-".into(), "0".into()],
                _ => [figure.difference, figure.bound, figure.ratio()].map(defined),
            };
            let none = || ["-".into(), "-".into(), "-".into()];
            let [difference, bound, ratio] = row.worst().as_ref().map_or_else(none, parts);
            let [.., at_zero] = row.zero.map_or_else(none, parts);
            table.row(vec![quantity.into(), row.named.route.into(), difference, bound, ratio, at_zero]);
        }
        table
    }

    /// The condition of M, and states in which something is not compared.
    fn print_states(&self, out: &mut impl Write) -> io::Result<()> {
        writeln!(out, "  Largest cond(M): {}", defined(self.findings.condition()))?;
        if self.findings.nearly_singular > 0 {
            let states = counted(self.findings.nearly_singular, "state");
            writeln!(out, "  In {states} rounding leaves too few digits to compare some blocks.")?;
        }
        if self.findings.steps_unsolved > 0 {
            let states = counted(self.findings.steps_unsolved, "state");
            writeln!(
                out,
                "  In {states} an implicit step of 1 ms was not solved to rounding: steps are not compared there."
            )?;
        }
        writeln!(out)
    }

    fn print_verdicts(&self, out: &mut impl Write) -> io::Result<()> {
        let (allowed, limit) = match self.arguments.tolerance {
            1.0 => ("its bound".to_owned(), String::new()),
            tolerance => (format!("{tolerance:e} times its bound"), format!(" (allowed: {tolerance:e})")),
        };
        for failure in self.failures {
            let Figure { quantity, route, difference, bound, .. } = failure;
            let how = match difference.is_nan() {
                true => "is not a number".to_owned(),
                false if *bound == 0.0 => "differs, though no operation rounds".to_owned(),
                false => format!("differs by {} times its bound{limit}", defined(failure.ratio())),
            };
            writeln!(out, "{}: {quantity} by {route} {how}.", bad("FAIL"))?;
        }
        if !self.failures.is_empty() {
            return Ok(());
        }
        match self.findings.rows().iter().filter(|row| row.says_nothing()).count() {
            0 => writeln!(out, "{}: no difference exceeds {allowed}.", good("PASS")),
            silent => writeln!(
                out,
                "{}: no comparable difference exceeds {allowed}; {} not comparable in any state.",
                good("PASS"),
                counted(silent, "row"),
            ),
        }
    }
}

/// As [`scientific`]; not-a-number in words.
fn defined(x: f64) -> String {
    if x.is_nan() { "undefined".into() } else { scientific(x) }
}
