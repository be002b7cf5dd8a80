//! What centrality correctors aim at: settings, and the complementarity products of a corrected step.

use crate::iterate::{Iterate, Step};
use costate_numerics::in_widest;

/// Centrality correctors: when steps are corrected, and towards which complementarity products.
///
/// Newton's step leaves out the products of the steps of slacks and multipliers. Where these are large,
/// single slacks or multipliers come close to zero long before the others, and steps are cut short. A
/// corrector wants products between two multiples of mu, after a step that is longer than the possible one.
/// It needs no further factorisation.
///
/// Source: J. Gondzio, "Multiple centrality corrections in a primal-dual method for linear programming",
/// Computational Optimization and Applications 6 (1996), 137-156.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CentralitySettings {
    /// K: most correctors of a step.
    pub correctors: usize,
    /// delta_alpha: a corrector is for a step that is longer by this, and at most 1.
    pub longer: f64,
    /// Steps that are at least this long are not corrected.
    pub enough: f64,
    /// beta_min, beta_max: the range of products that is wanted, in multiples of mu.
    pub products: [f64; 2],
    /// gamma: a corrector is taken where the lengths of the steps of slacks and multipliers grow by at least
    /// this part of what was wanted, and none becomes shorter.
    pub gain: f64,
    /// The corrected step keeps at least this part of the slope of the barrier problem along the step: it
    /// must not lead uphill.
    pub descent: f64,
}

impl Default for CentralitySettings {
    fn default() -> Self {
        Self { correctors: 2, longer: 0.3, enough: 0.95, products: [0.1, 10.0], gain: 0.1, descent: 0.1 }
    }
}

/// Products that a step is made for, for lower and upper bounds.
pub(crate) type Targets = [Vec<f64>; 2];

/// The targets of a corrector: those of the step before, changed by what its products after these parts of
/// the steps of slacks and multipliers are outside of the wanted range.
pub(crate) fn set_targets(
    to: &mut Targets,
    from: &Targets,
    (iterate, step, reciprocals): (&Iterate, &Step, &[Vec<f64>; 2]),
    lengths: [f64; 2],
    wanted: [f64; 2],
) {
    for (side, sign) in [(0, 1.0), (1, -1.0)] {
        let multipliers = (&iterate.z[side][..], &step.z[side][..]);
        let gaps = (&reciprocals[side][..], &step.slacks[..]);
        in_widest!(set_targets_of_side(
            &mut to[side],
            &from[side],
            multipliers,
            gaps,
            (sign, lengths, wanted)
        ));
    }
}

/// `to = from + clamp(p, least, most) - p`, at least `from - most`, with the products p.
#[inline(always)]
fn set_targets_of_side<const FUSED: bool>(
    to: &mut [f64],
    from: &[f64],
    (z, dz): (&[f64], &[f64]),
    (reciprocals, ds): (&[f64], &[f64]),
    (sign, [of_slacks, of_multipliers], [least, most]): (f64, [f64; 2], [f64; 2]),
) {
    let pairs = z.iter().zip(dz).zip(reciprocals.iter().zip(ds));
    for ((to, from), ((z, dz), (reciprocal, ds))) in to.iter_mut().zip(from).zip(pairs) {
        // Without a bound the reciprocal is zero.
        let gap = if *reciprocal > 0.0 { reciprocal.recip() } else { 0.0 };
        let product = (gap + sign * of_slacks * ds) * (z + of_multipliers * dz);
        let change = (product.max(least).min(most) - product).max(-most);
        *to = if *reciprocal > 0.0 { from + change } else { 0.0 };
    }
}

#[cfg(test)]
mod tests {
    use super::set_targets;
    use crate::iterate::{Iterate, Step};
    use crate::layout::{Element, Layout, Rows};

    /// Products after a half step of slacks and a whole one of multipliers: in the range, above, far above,
    /// below, and without a bound.
    #[test]
    fn products_outside_of_their_range_change_towards_its_ends() {
        let layout = Layout::new(vec![1], vec![], 0).with_rows(Element::Node(0), Rows::new(0, 5));
        let expected = [1.0, -9.0, -9.0, 1.0 + 0.1 - 2.5e-4, 0.0];
        for (side, sign) in [(0, 1.0), (1, -1.0)] {
            let (mut iterate, mut step) = (Iterate::new(&layout, 1), Step::zeros(&layout));
            iterate.z[side] = vec![1.0, 10.0, 100.0, 1e-3, 0.0];
            step.z[side] = vec![0.0, 5.0, 0.0, -5e-4, 0.0];
            step.slacks = [0.0, 2.0, 0.0, -1.0, 1.0].map(|step| sign * step).to_vec();
            let mut reciprocals = [vec![0.0; 5], vec![0.0; 5]];
            reciprocals[side] = vec![1.0, 1.0, 1.0, 1.0, 0.0];
            let (mut to, from) = ([vec![0.0; 5], vec![0.0; 5]], [vec![1.0; 5], vec![1.0; 5]]);
            set_targets(&mut to, &from, (&iterate, &step, &reciprocals), [0.5, 1.0], [0.1, 10.0]);
            // Of products 1, 30, 100, 2.5e-4.
            for (found, expected) in to[side].iter().zip(expected) {
                assert!((found - expected).abs() < 1e-15, "{to:?}");
            }
            assert_eq!(to[1 - side], [0.0; 5]);
        }
    }
}
