//! Several starts of a problem, on several threads.

use crate::options::SolverOptions;
use crate::result::solution::Solution;
use crate::result::stage_times::StageTimes;
use crate::result::start::{GuessKind, StartResult};
use crate::solve::Recorder;
use crate::status::Status;
use std::cmp::Ordering;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What the threads share: the next start, and what the starts so far have given.
#[derive(Default)]
struct Shared {
    next: usize,
    /// Best solution and its number.
    best: Option<(usize, Solution)>,
    starts: Vec<(usize, StartResult)>,
    newton_iterations: usize,
    stage_times: Option<StageTimes>,
}

/// The best solution of all starts; each of them is solved on its own by `solve`, from its number, with a
/// recorder of its thread.
///
/// Starts begin in their order, and none begins once the search is stopped, except for the first. As no start
/// knows of another one, the result does not depend on the number of threads, unless the search is stopped:
/// of equally good solutions the first one is chosen.
pub(crate) fn best_of_starts(
    options: &SolverOptions,
    recorder: &mut Recorder<'_>,
    solve: impl Fn(usize, &mut Recorder<'_>) -> Solution + Sync,
) -> Option<Solution> {
    let shared = Mutex::new(Shared::default());
    let count = options.count();
    let threads = options.threads();
    recorder.split(threads, |recorder| {
        while let Some(number) = next(&shared, count, recorder) {
            let solution = solve(number, recorder);
            lock(&shared).take(number, solution);
        }
    });
    shared.into_inner().unwrap_or_else(PoisonError::into_inner).solution(options)
}

/// The number of the next start, if there is one and the search goes on.
fn next(shared: &Mutex<Shared>, count: usize, recorder: &mut Recorder<'_>) -> Option<usize> {
    let mut shared = lock(shared);
    let number = shared.next;
    if number == count || (number > 0 && recorder.interruption().is_some()) {
        return None;
    }
    shared.next += 1;
    Some(number)
}

/// A thread that panics ends the search anyway, as `split` passes the panic on.
fn lock(shared: &Mutex<Shared>) -> MutexGuard<'_, Shared> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// The best solution, with the results of all starts in their order.
    fn solution(self, options: &SolverOptions) -> Option<Solution> {
        let Self { best, mut starts, newton_iterations, stage_times, .. } = self;
        starts.sort_by_key(|(number, _)| *number);
        let starts = starts.into_iter().map(|(_, start)| start).collect();
        let options = options.clone();
        best.map(|(_, best)| Solution { newton_iterations, stage_times, starts, options, ..best })
    }

    fn take(&mut self, number: usize, mut solution: Solution) {
        let own = solution.starts.pop().unwrap_or_else(|| {
            let guess = if number == 0 { GuessKind::Straight } else { GuessKind::Disturbed };
            StartResult::of(&solution.motion, guess, 1)
        });
        self.starts.push((number, own));
        self.newton_iterations += solution.newton_iterations;
        self.stage_times = solution.stage_times.map(|own| own.and(&self.stage_times.unwrap_or_default()));
        let better = self
            .best
            .as_ref()
            .is_none_or(|(kept, best)| compare(&solution, best).then(number.cmp(kept)) == Ordering::Less);
        if better {
            self.best = Some((number, solution));
        }
    }
}

/// Solved motions come first, then a proof that there is none, then motions whose equations are solved, then
/// other motions that keep their limits, then what would have to give, then motions that exceed limits, and
/// what is no motion last. What would have to give is compared by how much that is, all others by their
/// costs.
pub(crate) fn compare(a: &Solution, b: &Solution) -> Ordering {
    let cost = |solution: &Solution| match solution.motion.total() {
        total if total.is_nan() => f64::INFINITY,
        total => total,
    };
    let is_proven = |solution: &Solution| {
        let infeasible = solution.limits.infeasible.as_ref();
        infeasible.is_some_and(|found| found.is_global)
    };
    let class = |solution: &Solution| match &solution.motion.status {
        status if status.is_solved() => 0,
        Status::Infeasible if is_proven(solution) => 1,
        Status::NotVerified | Status::SwitchesNotRefined => 2,
        Status::MeshLimit | Status::PathOnly => 3,
        Status::Infeasible => 5,
        Status::LimitsNotKept => 6,
        _ if cost(solution).is_finite() => 4,
        _ => 7,
    };
    let lacking = |solution: &Solution| -> f64 {
        let limits = solution.limits.infeasible.iter().flat_map(|found| &found.limits);
        limits.map(|limit| limit.part).sum()
    };
    let by_lack = lacking(a).total_cmp(&lacking(b));
    class(a).cmp(&class(b)).then(by_lack).then(cost(a).total_cmp(&cost(b)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::result::infeasibility::{Infeasibility, RelaxedLimit};

    fn solution(status: Status, cost: f64, lacking: Option<(f64, bool)>) -> Solution {
        let robot = costate::robot::Robot::from_file("../robots/two_link.toml").unwrap();
        let mut solution = Solution::missing(&robot, status, 1.0);
        solution.motion.cost = cost;
        solution.limits.infeasible = lacking.map(|(part, is_global)| {
            let limit = |part| RelaxedLimit {
                kind: "torque".into(),
                name: "elbow".into(),
                side: "max".into(),
                time: 0.0,
                amount: 1.0,
                part,
                unit: "N m".into(),
                limit: None,
                rate: None,
                no_load_speed: None,
            };
            let limits = vec![limit(0.75 * part), limit(0.25 * part)];
            Infeasibility { limits, is_global, ..Infeasibility::default() }
        });
        solution
    }

    #[test]
    fn failures_are_ordered_by_what_they_tell() {
        let infinite = f64::INFINITY;
        let best_first = [
            solution(Status::Converged, 9.0, None),
            solution(Status::Infeasible, 5.0, Some((0.5, true))),
            solution(Status::NotVerified, 1.0, None),
            solution(Status::MeshLimit, 1.0, None),
            solution(Status::IterationLimit, 3.0, None),
            solution(Status::Infeasible, 7.0, Some((0.1, false))),
            solution(Status::Infeasible, 1.0, Some((0.2, false))),
            solution(Status::Infeasible, 2.0, Some((0.2, false))),
            solution(Status::LimitsNotKept, 1.0, None),
            solution(Status::NewtonFailed, infinite, None),
        ];
        for (i, a) in best_first.iter().enumerate() {
            for (j, b) in best_first.iter().enumerate() {
                assert_eq!(compare(a, b), i.cmp(&j), "{i} {j}");
            }
        }
    }
}
