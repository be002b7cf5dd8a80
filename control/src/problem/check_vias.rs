//! Whether the vias of a problem fit together.

use super::error::ProblemError;
use super::key::Key;
use super::via_error::ViaError;
use super::{BoundaryState, FinalTime, Problem, Via};
use crate::constants::task::MOST_ENTRIES;

impl Problem {
    /// Lengths and numbers of all vias, their times, their payloads; the shift of a periodic motion.
    ///
    /// # Errors
    /// The first [`ProblemError`], with the number of the via.
    pub(super) fn check_vias(&self) -> Result<(), ProblemError> {
        let found = self.vias.len();
        if found > MOST_ENTRIES {
            let cause = ViaError::TooMany { found, most: MOST_ENTRIES };
            return Err(ProblemError::Via { key: Key::via("q", MOST_ENTRIES), cause });
        }
        let mut before = 0.0;
        for (number, via) in self.vias.iter().enumerate() {
            self.check_via(number, via)?;
            via.payload.as_ref().map_or(Ok(()), |payload| self.loaded(number, payload).map(drop))?;
            let Some(time) = via.time else { continue };
            let refuse = |cause| Err(ProblemError::Via { key: Key::via("time", number), cause });
            let later = time > before && time.is_finite();
            if !later {
                return refuse(ViaError::NotLater { time, before });
            }
            let last = self.time.value();
            if time >= last {
                return refuse(ViaError::BeyondEnd { time, last });
            }
            before = time;
        }
        if let Some(shift) = &self.periodic {
            self.finite(Key::PERIODIC_SHIFT, shift)?;
        }
        self.check_ways()
    }

    /// No via with a free time asks what the place before or after it asks too, or less: it would move there.
    /// Where states or times themselves have a value, what lies between may have one too.
    fn check_ways(&self) -> Result<(), ProblemError> {
        if !self.terms.is_empty() || !self.task.references.is_empty() {
            return Ok(());
        }
        let ends = self.ends();
        let tools: Vec<_> = self.tools_at_ends().collect();
        let free = matches!(self.time, FinalTime::Free { .. }) && !self.has_via_times();
        for (number, via) in self.vias.iter().enumerate().filter(|(_, via)| via.time.is_none()) {
            let own = number + 1;
            let state = &ends[own];
            // What is carried on the way may be worth waiting for, unless time is what costs.
            let is_given = state.q_free.is_empty() && state.v_free.is_empty();
            if via.payload.is_some() && !(free && is_given) {
                continue;
            }
            let others = [own - 1, own + 1];
            let implies = |&&other: &&usize| {
                let has_tools = tools[own].iter().all(|pose| tools[other].contains(pose));
                has_tools && asks_for(&ends[other], state)
            };
            if let Some(&other) = others.iter().find(implies) {
                let given = [("q", via.q.is_some()), ("v", via.v.is_some()), ("stop", via.stop)];
                let name = given.iter().find(|(_, is_given)| *is_given).map_or("tool", |(name, _)| name);
                let other = match other {
                    0 => "the start".into(),
                    last if last + 1 == ends.len() => "the end".into(),
                    via => format!("via {via}"),
                };
                let cause = ViaError::NoWay { other, loads: via.payload.is_some() };
                return Err(ProblemError::Via { key: Key::via(name, number), cause });
            }
        }
        Ok(())
    }

    fn check_via(&self, number: usize, via: &Via) -> Result<(), ProblemError> {
        let key = |name| Key::via(name, number);
        for (name, values) in [("q", &via.q), ("v", &via.v)] {
            values.as_ref().map_or(Ok(()), |values| self.finite(key(name), values))?;
        }
        let refuse = |name, cause| Err(ProblemError::Via { key: key(name), cause });
        let lists =
            [("q_free", &via.q_free, via.q.is_some(), "q"), ("v_free", &via.v_free, via.v.is_some(), "v")];
        for (name, joints, is_given, given) in lists {
            self.exist(key(name), joints)?;
            if !joints.is_empty() && !is_given {
                return refuse(name, ViaError::NothingToFree { given });
            }
        }
        if via.stop && via.v.is_some() {
            return refuse("stop", ViaError::StopAndRates);
        }
        let asks = via.q.is_some() || via.v.is_some() || via.stop;
        if !asks && via.tools.is_empty() && via.payload.is_none() {
            return refuse("q", ViaError::NothingAsked);
        }
        Ok(())
    }
}

/// Whether a state has the positions and rates that another one asks for.
fn asks_for(state: &BoundaryState, other: &BoundaryState) -> bool {
    let same = |x: &[f64], free: &[usize], y: &[f64], other_free: &[usize]| {
        (0..x.len()).all(|j| other_free.contains(&j) || (!free.contains(&j) && x[j] == y[j]))
    };
    same(&state.q, &state.q_free, &other.q, &other.q_free)
        && same(&state.v, &state.v_free, &other.v, &other.v_free)
}
