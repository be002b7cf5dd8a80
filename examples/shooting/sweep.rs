//! Many random motions: success rate and cost of each kind of Hessian.

use crate::curvature::Curvature;
use crate::motions::{Motion, RobotProblem};
use crate::solver::{Options, Status, solve};
use costate::dynamics::Dynamics;
use std::fmt::Write;
use std::time::Instant;

const MOTIONS: usize = 20;
const ITERATIONS: usize = 150;
/// An error that suffices for many purposes.
const NEAR: f64 = 1e-4;

/// Iterations (if it was solved), cost and seconds of one motion.
#[derive(Clone, Copy)]
struct Outcome {
    iterations: Option<usize>,
    /// Iterations until the error was first below [`NEAR`].
    near: Option<usize>,
    is_infeasible: bool,
    cost: f64,
    seconds: f64,
}

/// Lines of the table for motions of one robot in one kind of coordinates.
fn lines<D: Dynamics<f64>>(
    name: &str,
    motion: &Motion,
    reach: f64,
    problem: impl Fn(&Motion) -> RobotProblem<D>,
) -> String {
    let mut random = fastrand::Rng::with_seed(1);
    let mut outcomes = Vec::with_capacity(MOTIONS);
    for _ in 0..MOTIONS {
        let mut problem = problem(&motion.elsewhere(&mut random, reach));
        let guess = problem.straight_line(&vec![0.0; motion.from.len()]);
        let outcome = Curvature::ALL.map(|curvature| {
            let start = Instant::now();
            let options = Options { iterations: ITERATIONS, ..Options::new(curvature) };
            let solution = solve(&mut problem, &guess, &options);
            let seconds = start.elapsed().as_secs_f64();
            let solved = solution.status == Status::Solved;
            let near = solution.log.iter().position(|row| row.error() <= NEAR);
            let is_infeasible = matches!(solution.status, Status::Infeasible { .. });
            let iterations = solved.then(|| solution.iterations());
            Outcome { iterations, near, is_infeasible, cost: solution.cost, seconds }
        });
        outcomes.push(outcome);
    }
    let mut text = String::new();
    for (i, curvature) in Curvature::ALL.into_iter().enumerate() {
        let sorted = |count: fn(&Outcome) -> Option<usize>| {
            let mut all: Vec<usize> = outcomes.iter().filter_map(|motion| count(&motion[i])).collect();
            all.sort_unstable();
            all
        };
        let iterations = sorted(|outcome| outcome.iterations);
        let near = sorted(|outcome| outcome.near);
        // Motions that both this kind and the exact one solved.
        let both = outcomes.iter().filter(|motion| motion[0].iterations.and(motion[i].iterations).is_some());
        let mut ratios: Vec<f64> = both.clone().map(|motion| motion[i].seconds / motion[0].seconds).collect();
        ratios.sort_by(f64::total_cmp);
        let [mut better, mut worse] = [0, 0];
        for motion in both {
            let difference = motion[i].cost / motion[0].cost - 1.0;
            better += usize::from(difference < -1e-6);
            worse += usize::from(difference > 1e-6);
        }
        let median = |length: usize| length / 2;
        let _ = writeln!(
            text,
            "{:<28}{:<13}{:>3} of {:<3}{:>5}{:>8}{:>7}{:>8}{:>9}{:>7}{:>8}{:>7}",
            if i == 0 { name } else { "" },
            curvature.name(),
            iterations.len(),
            MOTIONS,
            near.len(),
            outcomes.iter().filter(|motion| motion[i].is_infeasible).count(),
            near.get(median(near.len())).map_or("-".into(), usize::to_string),
            iterations.get(median(iterations.len())).map_or("-".into(), usize::to_string),
            iterations.last().map_or("-".into(), usize::to_string),
            ratios.get(median(ratios.len())).map_or("-".into(), |ratio| format!("{ratio:.2}")),
            better,
            worse,
        );
    }
    text
}

/// The table of all robots.
pub fn table(arm: &Motion, ur5: &Motion) -> String {
    let header = format!(
        "{:<28}{:<13}{:>9}{:>6}{:>8}{:>7}{:>8}{:>9}{:>7}{:>8}{:>7}\n{}\n",
        "random motions",
        "Hessian",
        "solved",
        "near",
        "infeas.",
        "median",
        "median",
        "largest",
        "time",
        "better",
        "worse",
        "-".repeat(110)
    );
    header
        + &lines("two-link arm, (q, v)", arm, 1.0, Motion::in_rates)
        + &lines("UR5, (q, v), rates bounded", ur5, 1.5, Motion::in_rates)
        + &lines("UR5, (q, v)", ur5, 1.5, Motion::in_free_rates)
        + &lines("UR5, (q, p)", ur5, 1.5, Motion::in_momenta)
        + "\nsolved: to 1e-10 within 150 iterations. near: to 1e-4 at any time. infeas.: ended at a local minimum of the\n\
           violation. The medians are iterations to either, largest is that of the solved. Of motions that the exact\n\
           Hessian solved too: time, the median of the ratios to the exact one's; better, worse: how many ended at a lower\n\
           or higher cost than with it.\n"
}
