//! Operations of M, F, F_x and y'F_xx by every route, beside those that the paper gives.
//!
//! `cargo bench --bench operations` prints the table, `cargo bench --bench operations -- --write` also puts it into
//! `docs/operations.md`; `cargo test --bench operations` fails where the table there is not the one counted now.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    missing_docs,
    reason = "a bench may stop on what a library may not"
)]

#[path = "frames/robots.rs"]
mod robots;

use costate::derivative::OperationTable;
use costate::robot::{Robot, Tree};
use costate::scalar::{Constants, Operations};
use std::fmt::Write;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/operations.md");
const BEGIN: &str = "<!-- table: begin -->";
const END: &str = "<!-- table: end -->";

/// Name for the table, robot, and multiplications for F and F_x in the paper for a robot with as many joints: by the
/// Hamiltonian, by the Lagrangian model.
fn all() -> [(&'static str, Robot, [u64; 2]); 4] {
    let (six, twelve) = ([1167, 1775], [14_610, 18_067]);
    [
        ("PUMA 560", robots::file("puma560.toml"), six),
        ("general 6R", robots::random("chain", 6, 1), six),
        ("biped", robots::file("biped.toml"), twelve),
        ("general 12R", robots::random("chain", 12, 1), twelve),
    ]
}

/// Of 10 inertial constants a link - mass, first moment, inertia matrix about the origin -, those that are not 0.
fn constants_of_links(tree: &Tree) -> usize {
    let of_link = |joint: &costate::robot::JointFrame| {
        let inertia = &joint.inertia;
        let constants = [[inertia.mass].as_slice(), &inertia.first_moment, &inertia.matrix].concat();
        constants.iter().filter(|&&constant| constant != 0.0).count()
    };
    tree.joints().iter().map(of_link).sum()
}

fn cell(o: Operations) -> String {
    format!("{} / {}", o.mul, o.add)
}

fn table() -> String {
    let mut text = format!("{BEGIN}\nMultiplications / additions, constants folded.\n\n");
    let robots = all();
    let names: Vec<&str> = robots.iter().map(|(name, ..)| *name).collect();
    writeln!(text, "| quantity: route | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len()))
        .unwrap();
    let mut line =
        |title: &str, cells: Vec<String>| writeln!(text, "| {title} | {} |", cells.join(" | ")).unwrap();
    let trees: Vec<Tree> = robots.iter().map(|(_, robot, _)| Tree::from(robot)).collect();
    line("joints", trees.iter().map(|tree| tree.len().to_string()).collect());
    line("pairs i <= j of joints on one branch", trees.iter().map(|tree| tree.pairs().to_string()).collect());
    let constants = |tree: &Tree| format!("{} of {}", constants_of_links(tree), 10 * tree.len());
    line("inertial constants not 0", trees.iter().map(constants).collect());
    let count = |constants| -> Vec<OperationTable> {
        robots.iter().map(|(_, robot, _)| OperationTable::new(robot, constants).unwrap()).collect()
    };
    let (folded, kept) = (count(Constants::Folded), count(Constants::Kept));
    let titles = ["M", "F", "F, F_x", "F, F_x, y'F_xx"];
    for (quantity, title) in OperationTable::QUANTITIES.into_iter().zip(titles) {
        for route in OperationTable::ROUTES {
            if matches!((quantity, route), ("mass_matrix" | "f", "dual" | "hyperdual")) {
                continue;
            }
            let cells = folded.iter().map(|table| cell(table.get(quantity, route).unwrap())).collect();
            line(&format!("{title}: {route}"), cells);
        }
        if quantity == "f_x" {
            let cells = kept.iter().map(|table| cell(table.get(quantity, "analytic").unwrap())).collect();
            line("F, F_x: analytic, constants not folded", cells);
            for (k, model) in ["Hamiltonian", "Lagrangian"].into_iter().enumerate() {
                let cells = robots.iter().map(|(_, _, paper)| paper[k].to_string()).collect();
                line(&format!("F, F_x: the paper, {model} model, multiplications"), cells);
            }
            for route in ["tensors", "analytic"] {
                let ratio = |(table, (_, _, paper)): (&OperationTable, &(_, _, [u64; 2]))| {
                    format!("{:.2}", table.get(quantity, route).unwrap().mul as f64 / paper[0] as f64)
                };
                let cells = folded.iter().zip(&robots).map(ratio).collect();
                line(&format!("F, F_x: {route} / the paper, Hamiltonian model"), cells);
            }
        }
    }
    let functions = |table: &OperationTable| {
        let o = table.get("f_x", "analytic").unwrap();
        format!("{} / {} / {}", o.div, o.sqrt, o.sincos)
    };
    line("F, F_x: analytic, divisions / roots / sine-cosine pairs", folded.iter().map(functions).collect());
    text
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let asked = |what: &str| arguments.iter().any(|argument| argument == what);
    let table = table();
    let page = std::fs::read_to_string(PAGE).unwrap();
    let (before, rest) = page.split_once(BEGIN).expect("a marker where the table begins");
    let (_, after) = rest.split_once(END).expect("a marker where the table ends");
    let renewed = format!("{before}{table}{END}{after}");
    if asked("--write") {
        std::fs::write(PAGE, renewed).unwrap();
    } else if !asked("--bench") {
        assert!(
            renewed == page,
            "docs/operations.md is out of date: cargo bench --bench operations -- --write\n{table}"
        );
        println!("docs/operations.md holds the operations counted now");
        return;
    }
    println!("{table}");
}
