//! When softer equations are tried.

use crate::constants::direct as constants;

/// When softer equations are tried: after a few damped steps, and after they did not help k times, one after
/// the other, 2^k steps later.
#[derive(Clone, Copy, Debug)]
pub(super) struct Softer {
    failed: u32,
    wait: usize,
}

impl Default for Softer {
    fn default() -> Self {
        Self { failed: 0, wait: constants::FIRST_WAIT }
    }
}

impl Softer {
    /// Whether it is time for a trial.
    pub(super) fn is_due(&mut self) -> bool {
        let is_due = self.wait == 0;
        self.wait = self.wait.saturating_sub(1);
        is_due
    }

    /// What came of one.
    pub(super) fn learn(&mut self, helped: bool) {
        self.failed = if helped { 0 } else { (self.failed + 1).min(constants::MOST_WAITS) };
        self.wait = if helped { 0 } else { 1 << self.failed };
    }
}

#[cfg(test)]
mod tests {
    use super::Softer;

    #[test]
    fn trials_become_rare_where_they_do_not_help() {
        let mut softer = Softer::default();
        let mut trials = Vec::new();
        for step in 0..200 {
            if softer.is_due() {
                trials.push(step);
                softer.learn(false);
            }
        }
        assert_eq!(trials, [4, 7, 12, 21, 38, 71, 136]);
        softer.learn(true);
        assert!(softer.is_due());
    }
}
