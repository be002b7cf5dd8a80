//! Convex Hessians in the place of exact ones that are indefinite.
//!
//! Gauss-Newton Hessians lead farther than multiples of a metric on top of an indefinite Hessian; near a
//! solution where the exact Hessian has the right inertia, that one converges faster.

/// When convex Hessians take the place of exact ones ([`StagedProblem::convexify`](crate::StagedProblem)),
/// and the multiples of the metric that are added to them (Levenberg-Marquardt).
///
/// Source: J. Nocedal, S. J. Wright, "Numerical Optimization", 2006, section 10.3; the values are those with
/// which the motions of the benchmark take the fewest steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConvexSettings {
    /// Most steps of a solution with convex Hessians.
    pub most: usize,
    /// Where less than the first part of the longest step was accepted, the metric of the next one grows;
    /// where more than the second was, it shrinks.
    pub accepted: [f64; 2],
    /// First multiple of the metric; where it would shrink below the second one it is none.
    pub metric: [f64; 2],
    /// Factors by which it grows and shrinks.
    pub factors: [f64; 2],
}

impl Default for ConvexSettings {
    fn default() -> Self {
        Self { most: 40, accepted: [0.3, 0.6], metric: [1e-2, 1e-3], factors: [10.0, 0.2] }
    }
}

/// How far a solution has come with them.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Convex {
    settings: ConvexSettings,
    /// How many steps may still be made.
    left: usize,
    /// The multiple of the metric for the next one.
    metric: f64,
}

impl Convex {
    /// Begins another solution.
    pub fn restart(&mut self, settings: ConvexSettings) {
        *self = Self { settings, left: settings.most, metric: 0.0 };
    }

    /// Whether one more step may be made.
    pub fn may_begin(&self) -> bool {
        self.left > 0
    }

    /// Begins such a step. The multiple of the metric for it.
    pub fn begin(&mut self) -> f64 {
        self.left = self.left.saturating_sub(1);
        self.metric
    }

    /// Takes note of the part of the longest step that was accepted, with this multiple of the metric.
    pub fn adapt(&mut self, metric: f64, part: f64) {
        let ConvexSettings { accepted: [poor, good], metric: [first, least], factors: [up, down], .. } =
            self.settings;
        self.metric = match () {
            () if part < poor => (up * metric).max(first),
            () if part <= good => metric,
            () if down * metric >= least => down * metric,
            () => 0.0,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::{Convex, ConvexSettings};

    #[test]
    fn the_metric_grows_after_short_steps_and_vanishes_after_long_ones() {
        let mut convex = Convex::default();
        convex.restart(ConvexSettings { most: 2, ..ConvexSettings::default() });
        assert!(convex.may_begin() && convex.begin() == 0.0);
        convex.adapt(0.0, 0.1);
        assert_eq!(convex.begin(), 1e-2);
        assert!(!convex.may_begin());
        let mut after = |metric: f64, part: f64| {
            convex.adapt(metric, part);
            convex.begin()
        };
        assert!(after(1e-2, 0.1) == 0.1 && after(1e-2, 0.5) == 1e-2 && after(1e-2, 1.0) == 2e-3);
        assert_eq!(after(2e-3, 1.0), 0.0);
    }
}
