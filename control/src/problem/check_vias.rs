//! Whether the vias of a problem fit together.

use super::error::ProblemError;
use super::key::Key;
use super::via_error::ViaError;
use super::{Problem, Via};
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
        match &self.periodic {
            Some(shift) => self.finite(Key::PERIODIC_SHIFT, shift),
            None => Ok(()),
        }
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
