//! Times of several candidates, measured alternately.

use super::routes::{Candidate, Failure};
use crate::interrupt::Interrupt;
use indicatif::ProgressBar;
use std::time::{Duration, Instant};

/// Median and quartiles of the time of one call (ns).
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    pub median: f64,
    pub q25: f64,
    pub q75: f64,
}

impl Spread {
    /// The time per state if one call computes `count` states.
    pub fn divided_by(self, count: usize) -> Self {
        let [median, q25, q75] = [self.median, self.q25, self.q75].map(|time| time / count as f64);
        Self { median, q25, q75 }
    }
}

/// Shortest batch: long enough that reading the clock costs nothing in comparison.
const BATCH: Duration = Duration::from_micros(300);

/// Times all candidates, one batch of each after the other, so that other loads of the machine affect all
/// alike.
///
/// The bar counts batches; the first of each candidate sets its number of calls.
pub fn measure(
    candidates: &mut [Candidate<'_>],
    batches: usize,
    bar: &ProgressBar,
    interrupt: &Interrupt,
) -> Result<Vec<Spread>, Failure> {
    let mut calls = Vec::new();
    for candidate in candidates.iter_mut() {
        calls.push(calls_per_batch(candidate, interrupt)?);
        bar.inc(1);
    }
    let mut times = vec![Vec::with_capacity(batches); candidates.len()];
    for _ in 0..batches {
        for ((candidate, &calls), times) in candidates.iter_mut().zip(&calls).zip(&mut times) {
            interrupt.check()?;
            times.push(batch(candidate, calls)?.as_nanos() as f64 / f64::from(calls));
            bar.inc(1);
        }
    }
    Ok(times.into_iter().map(spread).collect())
}

fn batch(candidate: &mut Candidate<'_>, calls: u32) -> Result<Duration, Failure> {
    let start = Instant::now();
    for _ in 0..calls {
        (candidate.work)(None)?;
    }
    Ok(start.elapsed())
}

/// Doubles the number of calls until they last long enough, which also warms up the caches.
fn calls_per_batch(candidate: &mut Candidate<'_>, interrupt: &Interrupt) -> Result<u32, Failure> {
    let mut calls = 1;
    while batch(candidate, calls)? < BATCH && calls < 1 << 24 {
        interrupt.check()?;
        calls *= 2;
    }
    Ok(calls)
}

fn spread(mut times: Vec<f64>) -> Spread {
    times.sort_by(f64::total_cmp);
    let at = |part: f64| times[((times.len() - 1) as f64 * part).round() as usize];
    Spread { median: at(0.5), q25: at(0.25), q75: at(0.75) }
}

#[cfg(test)]
mod tests {
    use super::spread;

    #[test]
    fn quartiles_are_those_of_the_sorted_times() {
        let spread = spread(vec![5.0, 1.0, 4.0, 2.0, 3.0]);
        assert_eq!([spread.q25, spread.median, spread.q75], [2.0, 3.0, 4.0]);
    }
}
