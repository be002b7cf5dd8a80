//! Several starts of a problem, on several threads.

use crate::options::SolverOptions;
use crate::result::solution::Solution;
use crate::result::stage_times::StageTimes;
use crate::result::start::{GuessKind, StartResult};
use crate::solve::Recorder;
use crate::verdict::rank::compare;
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
            StartResult::of(&solution.motion, solution.limits.violation(), guess, 1)
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
