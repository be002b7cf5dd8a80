//! Where the time goes.

use crate::measure::stages;
use crate::problems::{Failure, of_file, panda};
use crate::tables::{duration, markdown};
use costate_control::{MachineCode, Polish, Problem, SolverOptions};

/// The share of each stage in the least of so many times.
const REPEATS: usize = 50;

/// Times of the stages of four motions.
pub fn table(short: bool) -> Result<String, Failure> {
    let problems: [(&str, Problem); 4] = [
        ("two-link arm, effort", of_file("two_link.toml")?),
        ("UR5, all limits", of_file("ur5_limits.toml")?),
        ("Panda, all limits", panda()?),
        ("PUMA 560, least time", of_file("puma560_least_time.toml")?),
    ];
    let options = SolverOptions::default()
        .with_machine_code(MachineCode::AtOnce)
        .with_polish(Polish::Never)
        .with_tolerance(1e-4);
    let (mut rows, mut names) = (Vec::new(), Vec::new());
    for (name, problem) in problems {
        let (solution, seconds, times) = stages(&problem, &options, if short { 3 } else { REPEATS })?;
        let parts = times.named().map(|(_, time)| time).into_iter().chain([seconds - times.total()]);
        let part =
            |time: f64| format!("{} ({:.0} %)", duration(time.max(0.0)), 100.0 * time.max(0.0) / seconds);
        names = times.named().map(|(name, _)| name).to_vec();
        let head = [
            name.to_owned(),
            solution.motion.status.name().to_owned(),
            solution.newton_iterations.to_string(),
            solution.mesh_nodes().to_string(),
            duration(seconds),
        ];
        rows.push(head.into_iter().chain(parts.map(part)).collect::<Vec<_>>());
    }
    // Polish is off.
    let skipped = 5 + names.len() - 1;
    rows.iter_mut().for_each(|row| drop(row.remove(skipped)));
    names.pop();
    let head: Vec<&str> =
        ["motion", "status", "steps", "nodes", "time"].into_iter().chain(names).chain(["rest"]).collect();
    // A column for each motion.
    let columns: Vec<Vec<String>> = (1..head.len())
        .map(|i| [head[i].to_owned()].into_iter().chain(rows.iter().map(|row| row[i].clone())).collect())
        .collect();
    let titles: Vec<&str> = [""].into_iter().chain(rows.iter().map(|row| row[0].as_str())).collect();
    Ok(markdown(&titles, &columns))
}
