//! How much less a loose tolerance needs.

use crate::constants::direct::{LOOSE, TIGHT};

/// Where the tolerance lies between tight ones and loose ones, on a logarithmic scale:
///
/// $$ \lambda = \frac{\ln(\epsilon / \epsilon_0)}{\ln(\epsilon_1 / \epsilon_0)} $$
///
/// for the tolerance $\epsilon$ that is asked for, [`TIGHT`] and [`LOOSE`]; 0 below the first, 1 above the
/// second one. By default 0.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Looseness(f64);

impl Looseness {
    /// That of a tolerance, relative to the cost.
    pub fn of(tolerance: f64) -> Self {
        Self(((tolerance / TIGHT).ln() / (LOOSE / TIGHT).ln()).clamp(0.0, 1.0))
    }

    /// A number that has the first value at tight tolerances and the second one at loose ones; its logarithm
    /// goes in proportion between them.
    pub fn between(self, [tight, loose]: [f64; 2]) -> f64 {
        tight * (loose / tight).powf(self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::{LOOSE, Looseness, TIGHT};

    #[test]
    fn numbers_go_from_tight_to_loose_without_a_jump() {
        let at = |tolerance: f64| Looseness::of(tolerance).between([0.1, 0.4]);
        assert_eq!([at(1e-12), at(TIGHT), Looseness::default().between([0.1, 0.4])], [0.1; 3]);
        assert!((at(LOOSE) - 0.4).abs() < 1e-15 && at(1.0) == at(LOOSE));
        assert!((at((TIGHT * LOOSE).sqrt()) - 0.2).abs() < 1e-15, "half of the way is twice as much");
        assert!((at(TIGHT * 1.001) - 0.1).abs() < 1e-4 && (at(LOOSE / 1.001) - 0.4).abs() < 1e-3);
    }
}
