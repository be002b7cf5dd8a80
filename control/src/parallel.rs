//! Several starts of a problem, on several threads.

use crate::options::SolverOptions;
use crate::result::motion::Motion;
use crate::result::solution::{Solution, StartResult};
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
    let threads = options.threads_for(options.starts);
    recorder.split(threads, |recorder| {
        while let Some(number) = next(&shared, options.starts, recorder) {
            let solution = solve(number, recorder);
            lock(&shared).take(number, solution);
        }
    });
    let Shared { best, mut starts, newton_iterations, .. } =
        shared.into_inner().unwrap_or_else(PoisonError::into_inner);
    starts.sort_by_key(|(number, _)| *number);
    let starts = starts.into_iter().map(|(_, start)| start).collect();
    best.map(|(_, best)| Solution { newton_iterations, starts, options: options.clone(), ..best })
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
    fn take(&mut self, number: usize, solution: Solution) {
        let motion = &solution.motion;
        self.starts.push((number, StartResult { total: motion.total(), status: motion.status.clone() }));
        self.newton_iterations += solution.newton_iterations;
        let better = self.best.as_ref().is_none_or(|(kept, best)| {
            compare(motion, &best.motion).then(number.cmp(kept)) == Ordering::Less
        });
        if better {
            self.best = Some((number, solution));
        }
    }
}

/// Solved motions come first, then those whose equations are solved, then motions that are none, and
/// those that exceed limits last; among them the cheapest one.
fn compare(a: &Motion, b: &Motion) -> Ordering {
    let class = |motion: &Motion| match &motion.status {
        status if status.is_solved() => 0,
        Status::NotVerified | Status::SwitchesNotRefined => 1,
        Status::MeshLimit | Status::PathOnly => 2,
        Status::Infeasible => 4,
        Status::LimitsNotKept => 5,
        _ => 3,
    };
    let cost = |motion: &Motion| if motion.total().is_nan() { f64::INFINITY } else { motion.total() };
    class(a).cmp(&class(b)).then(cost(a).total_cmp(&cost(b)))
}
