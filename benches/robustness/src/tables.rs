//! The tables of `docs/robustness.md`.

use crate::judge::{Paired, successes};
use crate::problems::{RobotName, Variant};
use crate::record::{COORDINATES, MATRICES, Record, Search};
use crate::statistics::{median, two_sided};
use costate_control::{Coordinates, JacobianRoute};
use std::fmt::{self, Write};

/// The others, beside the exact matrix.
const OTHERS: [JacobianRoute; 2] = [JacobianRoute::Differences, JacobianRoute::WithoutHessian];

fn name(matrix: JacobianRoute) -> &'static str {
    match matrix {
        JacobianRoute::Exact => "exact",
        JacobianRoute::Differences => "differences",
        JacobianRoute::WithoutHessian => "without y'F_xx",
        _ => "other",
    }
}

fn coordinates_name(coordinates: Coordinates) -> &'static str {
    match coordinates {
        Coordinates::Hamiltonian => "(q, p)",
        Coordinates::Lagrangian => "(q, v)",
    }
}

/// All tables.
pub fn tables(records: &[Record]) -> Result<String, fmt::Error> {
    let mut text = String::new();
    success_table(&mut text, records)?;
    paired_table(&mut text, records)?;
    work_table(&mut text, records)?;
    coordinates_table(&mut text, records)?;
    cost_of_jacobians(&mut text, records)?;
    failures(&mut text, records)?;
    Ok(text)
}

/// A row for each robot and variant, and one for all.
fn success_table(text: &mut String, records: &[Record]) -> fmt::Result {
    writeln!(text, "### Successes\n")?;
    writeln!(
        text,
        "| robot | problems | number | exact (q, p) | differences (q, p) | without y'F_xx (q, p) | exact (q, v) | differences (q, v) | without y'F_xx (q, v) |"
    )?;
    writeln!(text, "|---|---|--:|--:|--:|--:|--:|--:|--:|")?;
    let mut row = |robot: &str, variant: &str, keep: &dyn Fn(&Record) -> bool| {
        let [(a, number), (b, _)] = COORDINATES.map(|coordinates| successes(records, coordinates, keep));
        let counts: Vec<String> = a.iter().chain(&b).map(usize::to_string).collect();
        writeln!(text, "| {robot} | {variant} | {number} | {} |", counts.join(" | "))
    };
    for robot in RobotName::ALL {
        for variant in Variant::ALL {
            row(robot.name(), variant.name(), &|record| {
                record.search.robot == robot && record.search.variant == variant
            })?;
        }
    }
    for variant in Variant::ALL {
        row("all", variant.name(), &|record| record.search.variant == variant)?;
    }
    row("all", "all", &|_| true)?;
    writeln!(text)
}

/// Who succeeds alone, with McNemar's test.
fn paired_table(text: &mut String, records: &[Record]) -> fmt::Result {
    writeln!(text, "### The exact matrix against another: success\n")?;
    writeln!(
        text,
        "| coordinates | problems | other matrix | both | exact alone | other alone | neither | p (McNemar, exact) | two extremals | of these exact cheaper |"
    )?;
    writeln!(text, "|---|---|---|--:|--:|--:|--:|--:|--:|--:|")?;
    for_each(|coordinates, variant, matrix| {
        let Paired { both, alone, neither, differ, .. } = paired(records, coordinates, variant, matrix);
        writeln!(
            text,
            "| {} | {} | {} | {both} | {} | {} | {neither} | {} | {} | {} |",
            coordinates_name(coordinates),
            variant.map_or("all", Variant::name),
            name(matrix),
            alone.0,
            alone.1,
            probability(two_sided(alone.0, alone.1)),
            differ.0,
            differ.1
        )
    })?;
    writeln!(text)
}

/// Medians of ratios, with the sign test.
fn work_table(text: &mut String, records: &[Record]) -> fmt::Result {
    writeln!(text, "### The exact matrix against another: work where both succeed\n")?;
    writeln!(
        text,
        "Medians of the other in multiples of the exact one, and how often the exact one took less.\n"
    )?;
    writeln!(
        text,
        "| coordinates | problems | other matrix | pairs | RHS-equivalents | less | p (sign test) | time | less | p (sign test) | Newton steps |"
    )?;
    writeln!(text, "|---|---|---|--:|--:|--:|--:|--:|--:|--:|--:|")?;
    for_each(|coordinates, variant, matrix| {
        let mut found = paired(records, coordinates, variant, matrix);
        let sign = |ratios: &[f64]| {
            let (less, more) =
                (ratios.iter().filter(|&&r| r > 1.0).count(), ratios.iter().filter(|&&r| r < 1.0).count());
            (less, probability(two_sided(less, more)))
        };
        let ((work, of_work), (time, of_time)) = (sign(&found.work), sign(&found.time));
        writeln!(
            text,
            "| {} | {} | {} | {} | {} | {work} | {of_work} | {} | {time} | {of_time} | {} |",
            coordinates_name(coordinates),
            variant.map_or("all", Variant::name),
            name(matrix),
            found.both,
            ratio(median(&mut found.work)),
            ratio(median(&mut found.time)),
            ratio(median(&mut found.steps)),
        )
    })?;
    writeln!(text)
}

/// What a Jacobian costs.
fn cost_of_jacobians(text: &mut String, records: &[Record]) -> fmt::Result {
    writeln!(text, "### A Jacobian in evaluations of the right-hand side\n")?;
    writeln!(text, "| robot | coordinates | exact | differences | without y'F_xx |\n|---|---|--:|--:|--:|")?;
    for robot in RobotName::ALL {
        for coordinates in COORDINATES {
            let cells = MATRICES.map(|matrix| {
                let of = |record: &&Record| {
                    let search = &record.search;
                    search.robot == robot && search.coordinates == coordinates && search.matrix == matrix
                };
                let mut costs: Vec<f64> =
                    records.iter().filter(of).map(|record| record.jacobian_cost).collect();
                ratio(median(&mut costs))
            });
            writeln!(
                text,
                "| {} | {} | {} |",
                robot.name(),
                coordinates_name(coordinates),
                cells.join(" | ")
            )?;
        }
    }
    writeln!(text)
}

/// How searches ended that are no success.
fn failures(text: &mut String, records: &[Record]) -> fmt::Result {
    writeln!(text, "### How the other searches ended\n")?;
    writeln!(text, "| coordinates | matrix | status | searches |\n|---|---|---|--:|")?;
    for coordinates in COORDINATES {
        for matrix in MATRICES {
            let of = |record: &&Record| {
                record.search.coordinates == coordinates
                    && record.search.matrix == matrix
                    && !record.succeeded()
            };
            let mut statuses: Vec<&str> =
                records.iter().filter(of).map(|record| record.status.as_str()).collect();
            statuses.sort_unstable();
            for group in statuses.chunk_by(|a, b| a == b) {
                let status = match group[0] {
                    "converged" => "converged, but end defect or drift too large",
                    other => other,
                };
                let (coordinates, matrix) = (coordinates_name(coordinates), name(matrix));
                writeln!(text, "| {coordinates} | {matrix} | {status} | {} |", group.len())?;
            }
        }
    }
    Ok(())
}

/// Coordinates, variants (`None` for all together) and other matrices.
fn for_each(mut row: impl FnMut(Coordinates, Option<Variant>, JacobianRoute) -> fmt::Result) -> fmt::Result {
    for coordinates in COORDINATES {
        for matrix in OTHERS {
            for variant in Variant::ALL.map(Some).into_iter().chain([None]) {
                row(coordinates, variant, matrix)?;
            }
        }
    }
    Ok(())
}

/// The exact matrix beside another.
fn paired(
    records: &[Record],
    coordinates: Coordinates,
    variant: Option<Variant>,
    matrix: JacobianRoute,
) -> Paired {
    let keep = |search: &Search| {
        let asked = search.coordinates == coordinates && search.matrix == JacobianRoute::Exact;
        asked && variant.is_none_or(|variant| search.variant == variant)
    };
    Paired::new(records, keep, |search| Search { matrix, ..search })
}

/// (q, p) beside (q, v), with the exact matrix.
fn coordinates_table(text: &mut String, records: &[Record]) -> fmt::Result {
    writeln!(text, "### (q, p) against (q, v), both with the exact matrix\n")?;
    writeln!(
        text,
        "| problems | both | (q, p) alone | (q, v) alone | neither | p (McNemar, exact) | two extremals | time of (q, v) in times of (q, p) | Newton steps |"
    )?;
    writeln!(text, "|---|--:|--:|--:|--:|--:|--:|--:|--:|")?;
    for variant in Variant::ALL.map(Some).into_iter().chain([None]) {
        let keep = |search: &Search| {
            let asked =
                search.coordinates == Coordinates::Hamiltonian && search.matrix == JacobianRoute::Exact;
            asked && variant.is_none_or(|variant| search.variant == variant)
        };
        let other = |search| Search { coordinates: Coordinates::Lagrangian, ..search };
        let mut found = Paired::new(records, keep, other);
        writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            variant.map_or("all", Variant::name),
            found.both,
            found.alone.0,
            found.alone.1,
            found.neither,
            probability(two_sided(found.alone.0, found.alone.1)),
            found.differ.0,
            ratio(median(&mut found.time)),
            ratio(median(&mut found.steps)),
        )?;
    }
    writeln!(text)
}

fn probability(p: f64) -> String {
    if p < 1e-4 { "< 0.0001".into() } else { format!("{p:.4}") }
}

fn ratio(ratio: f64) -> String {
    if ratio.is_nan() { "-".into() } else { format!("{ratio:.2}") }
}
