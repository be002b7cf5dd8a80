//! The sizes of components, in which corrections and errors are measured.
//!
//! The scale of a component is the largest absolute value that it takes along the motion, but no less than a
//! hundredth of the largest in its group. Where an optimal motion needs no control, all costates vanish and
//! hold nothing but rounding errors; these must not become the scale. The costate `y_c` matters when it moves
//! the state by its own size,
//!
//! $$ \hat y_c = \min_i \frac{\hat z_i}{| \partial (dz_i/ds) / \partial y_c |} $$
//!
//! over the states i, and over the costates i whose size is known in this way. A group of costates far below
//! these sizes has them as scales. (Columns of the Jacobian as scales: J. E. Dennis, R. B. Schnabel,
//! *Numerical Methods for Unconstrained Optimization and Nonlinear Equations*, SIAM 1996, section 7.1.)

use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::constants::newton::{LEAST_SCALE, NEGLIGIBLE_COSTATE, SMALL_COSTATE};
use crate::extremal::Extremal;

/// What is known about the scales.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scales {
    Known,
    /// All values of a group are zero; its scale is 1.
    Unknown,
    /// Costates are so small that they may be rounding errors: the coupling is needed to decide. Nothing was
    /// set.
    Small,
}

/// Sets `scale` from the values at the nodes and, if given, a correction `with`. `coupling`: the Jacobian of
/// `dw/ds` at a node; empty if it is not known.
pub(crate) fn set_scales<E: Extremal>(
    timed: &Timed<'_, E>,
    nodes: &[f64],
    scale: &mut [f64],
    coupling: &[f64],
    with: Option<&Values>,
) -> Scales {
    let m = scale.len();
    let mut sizes = vec![0.0_f64; m];
    for (i, value) in nodes.iter().enumerate() {
        let moved = with.map_or(0.0, |with| with.nodes[i].abs() * scale[i % m]);
        sizes[i % m] = sizes[i % m].max(value.abs()).max(moved);
    }
    let z = timed.z_len();
    let group = |c: usize| if c < z { timed.extremal.group(c) } else { usize::MAX - c };
    let (mut known, mut found, mut natural) = (Scales::Known, vec![0.0; m], Vec::new());
    for c in 0..m {
        if c == z / 2 && !coupling.is_empty() {
            natural = natural_sizes(coupling, &found, z);
        }
        let same = |d: &usize| group(*d) == group(c);
        let largest = (0..m).filter(same).map(|d| sizes[d]).fold(0.0_f64, f64::max);
        let costates = (z / 2..z).contains(&c);
        let negligible = |d: usize| {
            natural.get(d).is_some_and(|&size| size.is_finite() && sizes[d] <= NEGLIGIBLE_COSTATE * size)
        };
        if largest == 0.0 {
            found[c] = 1.0;
            known = Scales::Unknown;
        } else if costates && (0..m).filter(same).all(negligible) {
            found[c] = natural[c];
        } else {
            found[c] = sizes[c].max(LEAST_SCALE * largest);
            if costates && coupling.is_empty() && largest < SMALL_COSTATE {
                return Scales::Small;
            }
        }
    }
    scale.copy_from_slice(&found);
    known
}

/// For each component the value that moves the states by their scales, infinite where there is none, from the
/// Jacobian of `dw/ds`. Those of the states are their scales.
pub(crate) fn natural_sizes(jacobian: &[f64], scale: &[f64], z: usize) -> Vec<f64> {
    let (m, states) = (scale.len(), z / 2);
    let mut sizes = vec![f64::INFINITY; m];
    sizes[..states].copy_from_slice(&scale[..states]);
    // A costate may act through others: by one more of them in each round.
    for _ in 0..states {
        for c in states..z {
            let acts = |i: usize| sizes[i] / jacobian[i * m + c].abs();
            sizes[c] = (0..z).filter(|&i| i != c).map(acts).fold(sizes[c], f64::min);
        }
    }
    sizes
}

#[cfg(test)]
mod tests {
    use super::natural_sizes;

    #[test]
    fn costates_are_measured_by_what_they_move() {
        // q' = p/2, p' = u = 4 y_p, y_q' = 0, y_p' = -y_q/2.
        let rows = [[0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 0.0, 4.0], [0.0; 4], [0.0, 0.0, -0.5, 0.0]];
        let sizes = natural_sizes(rows.as_flattened(), &[3.0, 8.0, 1.0, 1.0], 4);
        assert_eq!(sizes, [3.0, 8.0, 4.0, 2.0]);
    }
}
