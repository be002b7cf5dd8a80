//! Solves a problem with default options and judges the answer without the solver's code.

use crate::cost::{Cost, cost};
use crate::finer::{self, Finer};
use crate::limits::excesses;
use crate::moving::Moving;
use crate::record::Record;
use costate::robot::LoadOptions;
use costate_control::{BoundaryState, Problem, ProblemFile, Solution, Solver};
use std::collections::BTreeMap;
use std::path::Path;
use std::time::{Duration, Instant};

/// Multiples of the stated error that a cost may be wrong by.
const TIMES: f64 = 10.0;
/// Rounding of sums of a cost, relative to its size: no stated error is trusted below it.
const ROUNDING: f64 = 1e-11;
/// Costs below are those of a motion that takes nothing: their digits are rounding.
const NOTHING: f64 = 1e-12;
/// Miss of a given end of the finer motion, relative to the way, above which it counts for nothing.
const MISS: f64 = 1e-7;

/// Judges the problem of a file.
///
/// `solved` gets the record as it is before the judgement.
pub fn judge(path: &Path, limit: Duration, mut solved: impl FnMut(&Record)) -> Record {
    let refused = |message: String| Record { status: "refused".into(), message, ..Record::default() };
    let file = match ProblemFile::read(path, LoadOptions::default()) {
        Ok(file) => file,
        Err(error) => return refused(error.to_string()),
    };
    let problem = &file.problem;
    let options = file.options.clone().with_time_limit(limit).with_threads(1);
    let began = Instant::now();
    let solution = match Solver::new(problem, options.clone()) {
        Ok(solver) => solver.solve(),
        Err(error) => return refused(error.to_string()),
    };
    let milliseconds = 1e3 * began.elapsed().as_secs_f64();
    let began = Instant::now();
    let mut record = Record {
        joints: problem.robot.dof(),
        status: solution.motion.status.name().into(),
        message: solution.motion.status.to_string(),
        tolerance: options.tolerance,
        intervals: solution.intervals(),
        polished: solution.polish.as_ref().is_some_and(|polish| polish.outcome.is_polished()),
        milliseconds,
        ..Record::default()
    };
    let finite = |x: f64| x.is_finite().then_some(x);
    (record.cost, record.final_time) = (finite(solution.total()), finite(solution.motion.final_time));
    solved(&record);
    if solution.motion.status.is_converged() {
        converged(problem, &solution, &options, limit, &mut record);
    }
    record.judge_milliseconds = 1e3 * began.elapsed().as_secs_f64();
    record
}

fn converged(
    problem: &Problem,
    solution: &Solution,
    options: &costate_control::SolverOptions,
    limit: Duration,
    record: &mut Record,
) {
    let stated = solution.cost_error().unwrap_or(options.tolerance);
    record.stated_error = Some(stated);
    let mut moving = Moving::new(problem, solution);
    let own = match cost(&mut moving) {
        Ok(own) => own,
        Err(why) => return record.not_judged.push(why),
    };
    let Cost { needed, given, size, .. } = own;
    let off = (needed - solution.total()).abs().min((given - solution.total()).abs()) / size;
    (record.own_cost, record.own_cost_cut) = (Some(needed), Some(given));
    (record.size, record.cost_off) = (Some(size), Some(off));
    let allowed = (TIMES * stated).max(ROUNDING).max(NOTHING / size);
    // Torques that are interpolated between nodes show the error of that, not the one of the cost.
    let interpolated = moving.torques_are_interpolated();
    if interpolated {
        record.not_judged.push("cost: torques between nodes".into());
    } else if off.is_nan() || off > allowed {
        record.faults.push("wrong cost".into());
    }
    let mut means = BTreeMap::new();
    match excesses(&mut moving) {
        Ok(found) => {
            if found.worst.iter().any(|excess| excess.kind != "torque cut") {
                record.faults.push("limits broken".into());
            }
            record.excesses = found.worst;
            means = found.means;
        }
        Err(why) => record.not_judged.push(why),
    }
    let Some((how, finer)) = finer::solve(&mut moving, options, limit) else {
        return record.not_judged.push("no finer mesh".into());
    };
    record.finer = Some(match how {
        Finer::Crossings => "crossings".into(),
        Finer::Parts(parts) => parts.to_string(),
    });
    record.finer_intervals = finer.intervals();
    record.finer_status = Some(finer.motion.status.name().into());
    let mut other = Moving::new(problem, &finer);
    let Ok(cost) = cost(&mut other) else { return };
    record.finer_cost = Some(cost.needed.max(cost.given));
    if !meets_ends(problem, &finer) || !keeps(&mut other, &means, 0.1 * allowed) {
        return;
    }
    // The lower one of both counts for the first motion, the higher one for the other.
    let cheaper = match interpolated {
        true => (solution.total() - finer.total()) / size,
        false => (needed.min(given) - cost.needed.max(cost.given)) / size,
    };
    record.cheaper = Some(cheaper);
    if cheaper > allowed {
        record.faults.push("cheaper found".into());
    }
}

/// Compares a converged motion with a known one.
pub fn compare(record: &mut Record, known: f64) {
    record.known_cost = Some(known);
    let (Some(cost), Some(stated)) = (record.cost, record.stated_error) else { return };
    if cost > known * (1.0 + (TIMES * stated).max(ROUNDING)) {
        record.faults.push("cheaper known".into());
    }
}

/// Whether a motion keeps its limits no worse than the one that it is compared with: in the mean over time,
/// as what a limit saves where it is exceeded is in proportion to that.
fn keeps(moving: &mut Moving<'_>, before: &BTreeMap<String, f64>, most: f64) -> bool {
    let is_free = !moving.problem.robot.free_joints().is_empty();
    let Ok(found) = excesses(moving) else { return is_free };
    found.means.iter().all(|(kind, mean)| *mean <= before.get(kind).unwrap_or(&0.0) + most)
        && moving.solution.limits.violations().next().is_none()
}

/// Whether a motion begins and ends where it should.
fn meets_ends(problem: &Problem, solution: &Solution) -> bool {
    let trajectory = &solution.trajectory;
    let (Some(first), Some(last)) = (trajectory.q.first(), trajectory.q.last()) else { return false };
    if problem.gait.is_some() || problem.periodic.is_some() || !problem.robot.free_joints().is_empty() {
        return solution.motion.status.is_solved() || solution.end_defect < 1e-5;
    }
    let meets = |end: &BoundaryState, q: &[f64], v: &[f64]| {
        let way = |wanted: f64| MISS * (1.0 + wanted.abs());
        (0..v.len()).all(|i| {
            (end.q_free.contains(&i) || (q[i] - end.q[i]).abs() <= way(end.q[i]))
                && (end.v_free.contains(&i) || (v[i] - end.v[i]).abs() <= way(end.v[i]))
        })
    };
    let (first_v, last_v) = (&trajectory.v[0], &trajectory.v[trajectory.v.len() - 1]);
    meets(&problem.start, first, first_v) && meets(&problem.end, last, last_v)
}

#[cfg(test)]
mod tests {
    use super::*;
    use costate_control::SolverOptions;

    /// A mass that goes a metre in a second: cost 6, and a judge that agrees.
    #[test]
    fn a_right_cost_passes_and_a_wrong_one_does_not() {
        let folder = std::env::temp_dir().join(format!("costate_random_motions_{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let robot = "name = \"slider\"\ngravity = [0, 0, 0]\n[[joint]]\nname = \"x\"\ntype = \"prismatic\"\n\
                     axis = [1, 0, 0]\nmass = 1\n";
        std::fs::write(folder.join("slider.toml"), robot).unwrap();
        let problem = "robot = \"slider.toml\"\n[start]\nq = [0]\n[end]\nq = [1]\n[time]\nfinal = 1\n[cost]\n\
                       effort = [1]\n";
        let path = folder.join("problem.toml");
        std::fs::write(&path, problem).unwrap();
        let mut record = judge(&path, Duration::from_secs(30), |_| ());
        assert!(record.is_converged() && record.faults.is_empty(), "{record:?}");
        assert!((record.own_cost.unwrap() - 6.0).abs() < 1e-9, "{record:?}");
        compare(&mut record, 5.9);
        assert!(record.has("cheaper known"));
        // The same motion with a cost that is off by twice what is allowed.
        let file = ProblemFile::read(&path, LoadOptions::default()).unwrap();
        let mut solution = Solver::new(&file.problem, SolverOptions::default()).unwrap().solve();
        let stated = solution.cost_error().unwrap_or(file.options.tolerance);
        solution.motion.cost *= 1.0 + 2.0 * TIMES * stated;
        let mut record = Record::default();
        converged(&file.problem, &solution, &file.options, Duration::from_secs(30), &mut record);
        assert!(record.has("wrong cost"), "{record:?}");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
