//! The sizes of components, in which corrections and errors are measured.
//!
//! The scale of a component is the largest absolute value that it takes along the motion, but no less than a
//! hundredth of the largest in its group. Where all values of a group vanish, for example the costates of a
//! motion that needs no control, they hold nothing but rounding errors. These must not become the scale. Such
//! a component c matters when it moves another one by its size,
//!
//! $$ \hat z_c = \min_i \frac{\hat z_i}{| \partial (dz_i/ds) / \partial z_c |} $$
//!
//! over the components i whose sizes are known. A group far below these sizes has them as scales. (Columns of
//! the Jacobian as scales: J. E. Dennis, R. B. Schnabel, *Numerical Methods for Unconstrained Optimization
//! and Nonlinear Equations*, SIAM 1996, section 7.1.)

use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::constants::newton::{LEAST_SCALE, NEGLIGIBLE, SMALL};
use crate::extremal::Extremal;

/// What is known about the scales.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scales {
    Known,
    /// All values of a group are zero; its scale is 1.
    Unknown,
    /// Values of a group are so small that they may be rounding errors: the coupling is needed to decide.
    /// Nothing was set.
    Small,
}

/// Sets `scale` from the values at the nodes and, if given, a correction `with`. `coupling`: the Jacobian of
/// `dw/ds` at a node; empty if it is not known.
pub(crate) fn set_scales<E: Extremal + ?Sized>(
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
    let same = |c: usize| (0..m).filter(move |&d| group(d) == group(c));
    let largest: Vec<f64> = (0..m).map(|c| same(c).map(|d| sizes[d]).fold(0.0, f64::max)).collect();
    let small = |c: usize| c < z && largest[c] > 0.0 && largest[c] < SMALL;
    if coupling.is_empty() && (0..z).any(small) {
        return Scales::Small;
    }
    for c in 0..m {
        scale[c] = if largest[c] > 0.0 { sizes[c].max(LEAST_SCALE * largest[c]) } else { 1.0 };
    }
    if (0..z).any(small) {
        // A motion at rest at zero: its positions are measured in rad and m.
        let rests = (0..z / 2).all(|c| small(c) || largest[c] == 0.0);
        let known = |c: usize| match small(c) {
            true if rests && group(c) == group(0) => 1.0,
            true => f64::INFINITY,
            false => scale[c],
        };
        let known: Vec<f64> = (0..z).map(known).collect();
        let natural = natural_sizes(coupling, m, known);
        let negligible = |c: usize| natural[c].is_finite() && sizes[c] <= NEGLIGIBLE * natural[c];
        for c in (0..z).filter(|&c| small(c) && same(c).all(negligible)) {
            scale[c] = natural[c];
        }
    }
    if largest.contains(&0.0) { Scales::Unknown } else { Scales::Known }
}

/// For each component whose size is infinite the value that moves others by their sizes, infinite where there
/// is none, from the Jacobian of `dw/ds` with rows of m.
fn natural_sizes(jacobian: &[f64], m: usize, mut sizes: Vec<f64>) -> Vec<f64> {
    let z = sizes.len();
    let unknown: Vec<usize> = (0..z).filter(|&c| sizes[c].is_infinite()).collect();
    // A component may act through others: by one more of them in each round.
    for _ in 0..z {
        for &c in &unknown {
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
        let sizes = natural_sizes(rows.as_flattened(), 4, vec![3.0, 8.0, f64::INFINITY, f64::INFINITY]);
        assert_eq!(sizes, [3.0, 8.0, 4.0, 2.0]);
        let at_rest = natural_sizes(rows.as_flattened(), 4, vec![3.0, f64::INFINITY, 1.0, 1.0]);
        assert_eq!(at_rest, [3.0, 6.0, 1.0, 1.0]);
    }
}
