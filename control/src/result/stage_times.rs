//! Where the time of the direct method goes.

use serde::Serialize;
use std::time::Instant;

/// Time that the direct method spent on each of its stages (s), over all meshes and starts. Starts on several
/// threads count each for itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct StageTimes {
    /// First guess and workspaces; the machine code of a robot whose motion is solved for the first time.
    pub preparation: f64,
    /// Torques, tools and clearances with first and second derivatives at the points of the iterates.
    pub points: f64,
    /// Newton's equations from what is known at the points.
    pub assembly: f64,
    /// Factorisation of these equations and substitution.
    pub equations: f64,
    /// What the step changes in the limits, choice of the barrier, corrections of the step.
    pub limits: f64,
    /// Trial motions along the step.
    pub search: f64,
    /// Estimated errors and the next mesh.
    pub meshes: f64,
    /// Integration of the motion, costates, and the report on its limits.
    pub verification: f64,
    /// An extremal from the motion ([`Polish`](crate::Polish)).
    pub polish: f64,
}

/// A stage, in the order of [`StageTimes`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stage {
    Preparation,
    Points,
    Assembly,
    Equations,
    Limits,
    Search,
    Meshes,
    Verification,
    Polish,
}

impl StageTimes {
    /// Name and time (s) of each stage.
    pub fn named(&self) -> [(&'static str, f64); 9] {
        [
            ("preparation", self.preparation),
            ("points", self.points),
            ("assembly", self.assembly),
            ("equations", self.equations),
            ("limits", self.limits),
            ("search", self.search),
            ("meshes", self.meshes),
            ("verification", self.verification),
            ("polish", self.polish),
        ]
    }

    /// All stages together (s).
    pub fn total(&self) -> f64 {
        self.named().iter().map(|(_, time)| time).sum()
    }

    /// Both together.
    pub(crate) fn and(mut self, other: &Self) -> Self {
        use Stage::{Assembly, Equations, Limits, Meshes, Points, Polish, Preparation, Search, Verification};
        let all = [Preparation, Points, Assembly, Equations, Limits, Search, Meshes, Verification, Polish];
        for (stage, (_, time)) in all.into_iter().zip(other.named()) {
            *self.of(stage) += time;
        }
        self
    }

    pub(crate) fn of(&mut self, stage: Stage) -> &mut f64 {
        match stage {
            Stage::Preparation => &mut self.preparation,
            Stage::Points => &mut self.points,
            Stage::Assembly => &mut self.assembly,
            Stage::Equations => &mut self.equations,
            Stage::Limits => &mut self.limits,
            Stage::Search => &mut self.search,
            Stage::Meshes => &mut self.meshes,
            Stage::Verification => &mut self.verification,
            Stage::Polish => &mut self.polish,
        }
    }
}

/// Adds the time since its last lap to a stage; without a start it does nothing.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Clock {
    last: Option<Instant>,
    times: StageTimes,
}

impl Clock {
    /// Started if it `runs`.
    pub fn new(runs: bool) -> Self {
        Self { last: runs.then(Instant::now), times: StageTimes::default() }
    }

    /// What was done since the last lap belongs to this stage.
    #[inline]
    pub fn lap(&mut self, stage: Stage) {
        if let Some(last) = &mut self.last {
            let now = Instant::now();
            *self.times.of(stage) += (now - *last).as_secs_f64();
            *last = now;
        }
    }

    /// The times so far, if it runs.
    pub fn times(&self) -> Option<StageTimes> {
        self.last.map(|_| self.times)
    }
}

#[cfg(test)]
mod tests {
    use super::{Clock, Stage};
    use std::time::{Duration, Instant};

    #[test]
    fn laps_add_up_to_the_time_since_the_start() {
        let began = Instant::now();
        let mut clock = Clock::new(true);
        for stage in [Stage::Points, Stage::Search, Stage::Points] {
            std::thread::sleep(Duration::from_millis(2));
            clock.lap(stage);
        }
        let (times, all) = (clock.times().unwrap(), began.elapsed().as_secs_f64());
        assert!(times.points >= 4e-3 && times.search >= 2e-3);
        assert!(times.total() <= all && times.and(&times).total() == 2.0 * times.total());
        assert_eq!(times.total(), times.points + times.search);
        let mut off = Clock::new(false);
        off.lap(Stage::Points);
        assert_eq!(off.times(), None);
    }
}
