//! Operations of M, F, F_x and y'F_xx by every method, compared with the figures of the paper.
//!
//! `cargo bench -p costate-benches --bench operations` prints the table, with `-- --write` it also writes it
//! into `docs/operations.md`; `cargo test -p costate-benches --bench operations` fails if the table there is
//! out of date. The test leaves out what takes minutes to count: dual and hyper-dual numbers for robots of
//! more than [`QUICK`] joints.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    missing_docs,
    reason = "a bench may stop on what a library may not"
)]

use costate::codegen::{Coordinates, Quantity, RobotQuantity};
use costate::derivative::OperationTable;
use costate::robot::{Joint, JointFrame, Robot, Tree};
use costate::scalar::{Constants, Count, Operations, Scalar, count};
use costate_test_support::robots;
use std::fmt::Write;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/operations.md");
const BEGIN: &str = "<!-- table: begin -->";
const END: &str = "<!-- table: end -->";

/// The test counts automatic differentiation up to so many joints.
const QUICK: usize = 12;

/// A cell that was not counted.
const UNKNOWN: &str = "not counted";

/// Name for the table, robot, and multiplications for F and F_x in the paper for a robot with as many joints,
/// if it has any: by the Hamiltonian, by the Lagrangian model.
fn all() -> [(&'static str, Robot, Option<[u64; 2]>); 6] {
    let (six, twelve) = (Some([1167, 1775]), Some([14_610, 18_067]));
    [
        ("PUMA 560", robots::file("puma560.toml"), six),
        ("general 6R", robots::random("chain", 6, 1), six),
        ("biped", robots::file("biped.toml"), twelve),
        ("general 12R", robots::random("chain", 12, 1), twelve),
        ("humanoid 32", robots::file("humanoid32.urdf"), None),
        ("humanoid 50", robots::file("humanoid50.urdf"), None),
    ]
}

/// Nonzero inertial constants, of 10 per link: before and after regrouping.
fn inertial_constants(robot: &Robot) -> String {
    let of = |mass: f64, moment: &[f64], matrix: [f64; 6]| {
        [&[mass], moment, &matrix].concat().iter().filter(|&&constant| constant != 0.0).count()
    };
    let of_link = |joint: &Joint| {
        let (link, i) = (&joint.inertia, |k| joint.inertia.inertia[k]);
        let matrix = [i((0, 0)), i((1, 1)), i((2, 2)), i((0, 1)), i((0, 2)), i((1, 2))];
        of(link.mass, link.com.as_slice(), matrix)
    };
    let regrouped =
        |joint: &JointFrame| of(joint.lumped.mass, &joint.lumped.first_moment, joint.lumped.matrix);
    let (links, tree) = (robot.joints().iter().map(of_link), Tree::from(robot));
    let regrouped = tree.joints().iter().map(regrouped);
    format!("{}, {}", links.sum::<usize>(), regrouped.sum::<usize>())
}

/// Forward dynamics in (q, v), alone, with its Jacobian, and with its contracted Hessian too; and inverse
/// dynamics with both, as generated code computes them.
fn lagrangian(robot: &Robot) -> [Operations; 4] {
    [Quantity::F, Quantity::FX, Quantity::YFXX, Quantity::YTauZZ].map(|quantity| {
        let mut function = RobotQuantity::<Count>::new(robot, quantity, Coordinates::Lagrangian).unwrap();
        let inputs: Vec<_> = (0..function.inputs()).map(|i| Count::variable(0.3 + i as f64)).collect();
        let mut outputs = vec![Count::zero(); function.outputs()];
        count(|| function.evaluate(&inputs, &mut outputs).unwrap()).1
    })
}

/// How many times the multiplications of the paper.
fn ratio_to_paper(multiplications: u64, paper: Option<u64>) -> String {
    paper.map_or("-".to_owned(), |paper| format!("{:.2}", multiplications as f64 / paper as f64))
}

fn cell(o: Option<Operations>) -> String {
    o.map_or(UNKNOWN.to_owned(), |o| format!("{} / {}", o.mul, o.add))
}

/// Whether the page has the cells of this table, as far as they were counted.
fn holds(page: &str, table: &str) -> bool {
    let cells = |text: &str| -> Vec<Vec<String>> {
        text.lines().map(|line| line.split('|').map(|cell| cell.trim().to_owned()).collect()).collect()
    };
    let (page, table) = (cells(page), cells(table));
    let same_row = |(page, table): (&Vec<String>, &Vec<String>)| {
        page.len() == table.len() && page.iter().zip(table).all(|(p, t)| p == t || t == UNKNOWN)
    };
    page.len() == table.len() && page.iter().zip(&table).all(same_row)
}

/// With every cell, or without those that take minutes.
fn table(whole: bool) -> String {
    let mut text = format!("{BEGIN}\nMultiplications / additions, constants folded.\n\n");
    let robots = all();
    let names: Vec<&str> = robots.iter().map(|(name, ..)| *name).collect();
    writeln!(text, "| quantity: method | {} |\n|---|{}", names.join(" | "), "---|".repeat(names.len()))
        .unwrap();
    let mut line =
        |title: &str, cells: Vec<String>| writeln!(text, "| {title} | {} |", cells.join(" | ")).unwrap();
    let trees: Vec<Tree> = robots.iter().map(|(_, robot, _)| Tree::from(robot)).collect();
    line("joints", trees.iter().map(|tree| tree.dof().to_string()).collect());
    line("pairs i <= j of joints on one branch", trees.iter().map(|tree| tree.pairs().to_string()).collect());
    let constants = robots.iter().map(|(_, robot, _)| inertial_constants(robot)).collect();
    line("inertial constants not 0: of the links, regrouped", constants);
    let count = |constants| -> Vec<OperationTable> {
        let table = |(_, robot, _): &(_, Robot, _)| {
            if whole || robot.dof() <= QUICK {
                OperationTable::new(robot, constants).unwrap()
            } else {
                OperationTable::by_hand(robot, constants).unwrap()
            }
        };
        robots.iter().map(table).collect()
    };
    let (folded, kept) = (count(Constants::Folded), count(Constants::Kept));
    let titles = ["M", "F", "F, F_x", "F, F_x, y'F_xx"];
    for (quantity, title) in OperationTable::QUANTITIES.into_iter().zip(titles) {
        for route in OperationTable::ROUTES {
            if matches!((quantity, route), ("mass_matrix" | "f", "dual" | "hyperdual")) {
                continue;
            }
            let cells = folded.iter().map(|table| cell(table.get(quantity, route))).collect();
            line(&format!("{title}: {route}"), cells);
        }
        if quantity == "f_x" {
            let cells = kept.iter().map(|table| cell(table.get(quantity, "analytic"))).collect();
            line("F, F_x: analytic, constants not folded", cells);
            for (k, model) in ["Hamiltonian", "Lagrangian"].into_iter().enumerate() {
                let of_paper =
                    |paper: &Option<[u64; 2]>| paper.map_or("-".to_owned(), |paper| paper[k].to_string());
                let cells = robots.iter().map(|(_, _, paper)| of_paper(paper)).collect();
                line(&format!("F, F_x: the paper, {model} model, multiplications"), cells);
            }
            for route in ["tensors", "analytic"] {
                let ratio = |(table, (_, _, paper)): (&OperationTable, &(_, _, Option<[u64; 2]>))| {
                    ratio_to_paper(table.get(quantity, route).unwrap().mul, paper.map(|[model, _]| model))
                };
                let cells = folded.iter().zip(&robots).map(ratio).collect();
                line(&format!("F, F_x: {route} / the paper, Hamiltonian model"), cells);
            }
        }
    }
    let more = ["F, F_x, y'F_xx", "F, y'F_x", "y'F_xx d", "F_x, all of F_xx", "F_x, all of F_xx"];
    for ((quantity, route), title) in OperationTable::MORE.into_iter().zip(more) {
        let cells = folded.iter().map(|table| cell(table.get(quantity, route))).collect();
        line(&format!("{title}: {route}"), cells);
    }
    for (title, tables) in [("", &folded), (", constants not folded", &kept)] {
        for route in ["analytic", "hyperdual"] {
            let ratio = |table: &OperationTable| {
                let of = |quantity, route| table.get(quantity, route).map(|operations| operations.mul as f64);
                match (of("y_f_xx", route), of("f_x", "analytic")) {
                    (Some(second), Some(first)) => format!("{:.2}", second / first),
                    _ => UNKNOWN.to_owned(),
                }
            };
            let title = format!("F, F_x, y'F_xx: {route} / F, F_x: analytic{title}");
            line(&title, tables.iter().map(ratio).collect());
        }
    }
    let by_lagrangian: Vec<_> = robots.iter().map(|(_, robot, _)| lagrangian(robot)).collect();
    let titles =
        ["a(q, v, u)", "a, a_z, z = (q, v, u)", "a, a_z, y'a_zz", "tau, tau_z, w'tau_zz, z = (q, v, a)"];
    for (k, title) in titles.iter().enumerate() {
        let cells = by_lagrangian.iter().map(|counts| cell(Some(counts[k]))).collect();
        line(&format!("{title}: Lagrangian, analytic"), cells);
    }
    let ratio = |([_, a_z, ..], (_, _, paper)): (&[Operations; 4], &(_, _, Option<[u64; 2]>))| {
        ratio_to_paper(a_z.mul, paper.map(|[_, model]| model))
    };
    let cells = by_lagrangian.iter().zip(&robots).map(ratio).collect();
    line("a, a_z / the paper, Lagrangian model", cells);
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
    // As a test: neither printed nor written.
    let test = !asked("--write") && !asked("--bench");
    let table = table(!test);
    let page = std::fs::read_to_string(PAGE).unwrap();
    let (before, rest) = page.split_once(BEGIN).expect("a marker where the table begins");
    let (written, after) = rest.split_once(END).expect("a marker where the table ends");
    if test {
        assert!(
            holds(&format!("{BEGIN}{written}"), &table),
            "docs/operations.md is out of date: cargo bench -p costate-benches --bench operations -- --write\n{table}"
        );
        println!("docs/operations.md holds the operations counted now");
        return;
    }
    if asked("--write") {
        std::fs::write(PAGE, format!("{before}{table}{END}{after}")).unwrap();
    }
    println!("{table}");
}
