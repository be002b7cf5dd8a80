//! Direct multiple shooting with the exact Hessian of the Lagrangian, compared with solvers that use less.
//!
//! A motion from rest to rest with least effort, under bounds on actuation, angles and rates: the unknowns
//! are the states at the nodes and the controls between them, the constraints `x_(k+1) = Phi(x_k, u_k, h)`.
//! `Step::contract` with the multipliers of these constraints as costates gives the exact Hessian of the
//! Lagrangian. `costate-nlp` solves the program; the derivatives are those of `Step` and `Cost`.
//!
//!     cargo run --release -p costate-examples --example shooting             # iterations, summary, verdict
//!     cargo run --release -p costate-examples --example shooting -- --write  # into docs/shooting.md, too
//!     cargo test -p costate-examples --example shooting

mod compare;
mod curvature;
mod motions;
mod problem;
mod program;
mod solver;
mod sweep;
#[cfg(test)]
mod tests;

use compare::{Comparison, summary, verdict};
use curvature::Curvature;
use motions::Motion;
use solver::{Options, solve};
use std::error::Error;
use std::path::Path;

fn main() -> Result<(), Box<dyn Error>> {
    let write = match std::env::args().nth(1).as_deref() {
        None => false,
        Some("--write") => true,
        Some(other) => return Err(format!("{other} is not known; only --write is").into()),
    };
    let (arm, ur5) = (Motion::two_link()?, Motion::ur5()?);
    let all = [
        Comparison::of("two-link arm, (q, v), no bounds", arm.in_rates().without_bounds()),
        Comparison::of("two-link arm, (q, v), rates bounded", arm.in_rates()),
        Comparison::of("two-link arm, (q, p)", arm.in_momenta()),
        Comparison::of("UR5, (q, v), rates bounded", ur5.in_rates()),
        Comparison::of("UR5, (q, v)", ur5.in_free_rates()),
        Comparison::of("UR5, (q, p)", ur5.in_momenta()),
    ];
    let (mut roomy, mut slow) = (ur5.clone(), arm.clone());
    roomy.effort = vec![150.0, 150.0, 150.0, 28.0, 28.0, 28.0];
    slow.duration = 4.0;
    let random = sweep::table(&slow, &roomy);
    let mut hurried = Motion { duration: 1.5, ..arm }.in_rates();
    let guess = hurried.straight_line(&[0.0; 2]);
    let hurry = solve(&mut hurried, &guess, &Options::new(Curvature::Exact));
    let judged = verdict(&all) + &format!("The two-link arm in half the time: {:?}.\n", hurry.status);
    let mut logs = String::new();
    for comparison in &all {
        println!("{}", comparison.logs());
    }
    [&all[0], &all[1], &all[4]].iter().for_each(|comparison| logs += &comparison.logs());
    let tables = [("summary", summary(&all)), ("verdict", judged), ("random", random), ("iterations", logs)];
    for (_, table) in &tables[..3] {
        println!("{table}");
    }
    if write {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/shooting.md");
        let mut document = std::fs::read_to_string(&path)?;
        for (name, table) in &tables {
            document = replaced(&document, name, table)?;
        }
        std::fs::write(path, document)?;
    }
    Ok(())
}

/// Replaces the text between the markers of this name.
fn replaced(document: &str, name: &str, table: &str) -> Result<String, String> {
    let [begin, end] = ["begin", "end"].map(|edge| format!("<!-- {name}: {edge} -->"));
    let parts = document.split_once(&begin).and_then(|(head, rest)| Some((head, rest.split_once(&end)?.1)));
    let (head, tail) = parts.ok_or_else(|| format!("docs/shooting.md lacks {begin} or {end}"))?;
    Ok(format!("{head}{begin}\n```text\n{}\n```\n{end}{tail}", table.trim_matches('\n')))
}
