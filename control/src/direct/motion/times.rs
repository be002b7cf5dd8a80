//! Which times of phases are unknowns.

use crate::problem::{FinalTime, Problem};

/// The times T_p of K phases as functions of J parameters, `T = T_0 + A theta`.
///
/// A phase between two given times has a given one. The free ones are parameters themselves; where the motion
/// ends at a given time, or a via has one, the last of the phases before it takes what is left. Phases whose
/// parts of a free duration are given have this duration as their one parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct FreeTimes {
    phases: usize,
    /// Whether the time of each end of a phase is given.
    is_given: Vec<bool>,
    /// A, K x J, row by row.
    factors: Vec<f64>,
    /// J.
    count: usize,
}

impl FreeTimes {
    /// For ends of phases of which some have a given time; the first one always has.
    pub fn new(is_given: &[bool]) -> Self {
        let phases = is_given.len() - 1;
        let mut columns: Vec<Vec<f64>> = Vec::new();
        let mut first = 0;
        for (end, &given) in is_given.iter().enumerate().skip(1) {
            let last = end == phases;
            if !given && !last {
                continue;
            }
            // The phases between two given times; after the last one all are free.
            for p in first..if given { end - 1 } else { end } {
                let mut column = vec![0.0; phases];
                column[p] = 1.0;
                if given {
                    column[end - 1] = -1.0;
                }
                columns.push(column);
            }
            first = end;
        }
        let count = columns.len();
        let factors = (0..phases).flat_map(|p| columns.iter().map(move |column| column[p])).collect();
        Self { phases, is_given: is_given.to_vec(), factors, count }
    }

    /// Those of phases that take these parts of a free duration.
    pub fn in_parts(parts: &[f64]) -> Self {
        let is_given = (0..=parts.len()).map(|end| end == 0).collect();
        Self { phases: parts.len(), is_given, factors: parts.to_vec(), count: 1 }
    }

    /// All of them, of so many phases.
    pub fn all(phases: usize) -> Self {
        Self::new(&(0..=phases).map(|end| end == 0).collect::<Vec<_>>())
    }

    /// Those where the times up to the start of a phase are given too.
    pub fn after(&self, phase: usize) -> Self {
        let is_given = self.is_given.iter().enumerate().map(|(end, given)| end <= phase || *given);
        Self::new(&is_given.collect::<Vec<_>>())
    }

    /// Whether the time of an end behind the start of a phase is given.
    pub fn is_given_after(&self, phase: usize) -> bool {
        self.is_given[phase + 1..].iter().any(|given| *given)
    }

    /// Those of a problem.
    pub fn of(problem: &Problem) -> Self {
        let is_free = matches!(problem.time, FinalTime::Free { .. });
        if let Some(parts) = problem.parts_of_time().filter(|_| is_free) {
            return Self::in_parts(&parts);
        }
        Self::new(&problem.times_at_ends().iter().map(Option::is_some).collect::<Vec<_>>())
    }

    /// J.
    #[inline(always)]
    pub fn count(&self) -> usize {
        self.count
    }

    /// Derivatives by the parameters from those by the times.
    pub fn reduce(&self, by_times: &[f64], to: &mut [f64]) {
        to.fill(0.0);
        if self.count == 0 {
            return;
        }
        for (row, by_time) in self.factors.chunks_exact(self.count).zip(by_times) {
            to.iter_mut().zip(row).for_each(|(to, factor)| *to += factor * by_time);
        }
    }

    /// Parameters that give these times: each is the time of a phase, or the whole duration, over its factor.
    pub fn values(&self, times: &[f64]) -> Vec<f64> {
        let of = |j: usize| {
            let mut own = (0..self.phases).filter(|&phase| self.factor(phase, j) > 0.0);
            own.next().map_or(0.0, |phase| times[phase] / self.factor(phase, j))
        };
        (0..self.count).map(of).collect()
    }

    /// Steps of the times from those of the parameters.
    pub fn expand(&self, steps: &[f64], times: &mut Vec<f64>) {
        times.clear();
        times.resize(self.phases, 0.0);
        if self.count == 0 {
            return;
        }
        for (row, time) in self.factors.chunks_exact(self.count).zip(times) {
            *time = row.iter().zip(steps).map(|(factor, step)| factor * step).sum();
        }
    }

    /// The factor of a parameter in the time of a phase.
    #[inline(always)]
    pub fn factor(&self, phase: usize, parameter: usize) -> f64 {
        self.factors[self.count * phase + parameter]
    }
}

#[cfg(test)]
mod tests {
    use super::FreeTimes;

    /// Changes of the times of phases by each parameter.
    fn columns(is_given: &[bool]) -> Vec<Vec<f64>> {
        let times = FreeTimes::new(is_given);
        let unit = |j: usize| (0..times.count()).map(|i| f64::from(i == j)).collect::<Vec<_>>();
        let mut found = Vec::new();
        for j in 0..times.count() {
            let mut column = Vec::new();
            times.expand(&unit(j), &mut column);
            found.push(column);
        }
        found
    }

    #[test]
    fn given_times_stay() {
        assert!(columns(&[true, true]).is_empty());
        assert_eq!(columns(&[true, false]), [[1.0]]);
        // All free; the end given; a via given and the end free.
        assert_eq!(columns(&[true, false, false]), [[1.0, 0.0], [0.0, 1.0]]);
        assert_eq!(columns(&[true, false, false, true]), [[1.0, 0.0, -1.0], [0.0, 1.0, -1.0]]);
        assert_eq!(columns(&[true, false, true, false]), [[1.0, -1.0, 0.0], [0.0, 0.0, 1.0]]);
        assert!(columns(&[true, true, true]).is_empty());
    }

    #[test]
    fn phases_in_given_parts_stretch_together() {
        let times = FreeTimes::in_parts(&[0.2, 0.8]);
        let mut steps = Vec::new();
        times.expand(&[0.5], &mut steps);
        assert_eq!((times.count(), &*steps), (1, &[0.1, 0.4][..]));
        let mut by_duration = [f64::NAN];
        times.reduce(&[3.0, -1.0], &mut by_duration);
        assert!((by_duration[0] + 0.2).abs() < 1e-15, "{by_duration:?}");
    }

    #[test]
    fn what_is_over_has_given_times() {
        let times = FreeTimes::new(&[true, false, false, true]);
        assert_eq!(times.after(0), times);
        assert_eq!(times.after(1), FreeTimes::new(&[true, true, false, true]));
        assert!(times.is_given_after(2) && !FreeTimes::new(&[true, true, false]).is_given_after(1));
        assert_eq!((times.after(1).count(), times.after(2).count()), (1, 0));
    }

    #[test]
    fn derivatives_and_steps_belong_together() {
        let times = FreeTimes::new(&[true, false, true, false, false]);
        let (by_times, steps) = ([0.3, -1.1, 0.7, 2.0], [0.4, -0.2, 0.9]);
        let (mut reduced, mut expanded) = ([f64::NAN; 3], Vec::new());
        times.reduce(&by_times, &mut reduced);
        times.expand(&steps, &mut expanded);
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        assert!((dot(&reduced, &steps) - dot(&by_times, &expanded)).abs() < 1e-15);
    }
}
