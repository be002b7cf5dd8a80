//! Cheaper positions along what places of tools leave free.

use super::Search;
use crate::constants::task::reach::{BRANCH_STEPS, MOST_SLIDES, SLIDES, STILL};
use crate::task::functions::TaskFunctions;

/// From a `known` position, whose cost is `best`, along positions that keep all rows, to one that costs less.
/// `None` if none is found, or if there are at least as many rows as free coordinates.
///
/// A step goes along one tangent and back to where the rows have their values; one that helps is repeated.
pub(crate) fn cheaper(
    functions: &mut TaskFunctions,
    known: &[f64],
    free: &[usize],
    limits: &[[f64; 2]],
    mut best: f64,
    mut cost: impl FnMut(&[f64]) -> Option<f64>,
) -> Option<Vec<f64>> {
    let mut search = Search { steps: BRANCH_STEPS, ..Search::new(functions, free, limits) };
    if search.g.len() >= free.len() {
        return None;
    }
    let (mut found, mut left): (Option<Vec<f64>>, _) = (None, MOST_SLIDES);
    for size in SLIDES {
        let tangents = search.tangents(found.as_deref().unwrap_or(known));
        for (tangent, step) in tangents.iter().flat_map(|tangent| [(tangent, size), (tangent, -size)]) {
            let mut helps = true;
            while helps {
                if left == 0 {
                    return found;
                }
                left -= 1;
                let mut q = found.as_deref().unwrap_or(known).to_vec();
                free.iter().zip(tangent).for_each(|(&i, part)| q[i] += step * part);
                let reached = search.descend(q);
                let own = if reached.is_there() { cost(&reached.q) } else { None };
                helps = own.is_some_and(|own| own < best);
                if let Some(own) = own.filter(|own| *own < best) {
                    (found, best) = (Some(reached.q), own);
                }
            }
        }
    }
    found
}

impl Search<'_> {
    /// An orthonormal basis of the changes of the free coordinates that change no row at q, to first order.
    fn tangents(&mut self, q: &[f64]) -> Vec<Vec<f64>> {
        self.linearise(q);
        let n = self.free.len();
        let mut basis = Vec::new();
        for row in self.jacobian.chunks_exact(2 * q.len()) {
            extend(&mut basis, self.free.iter().map(|&i| row[i]).collect(), STILL);
        }
        let rank = basis.len();
        // Of each direction that is still missing, some coordinate has this part at least.
        let least = 0.5 / (n as f64).sqrt();
        for k in 0..n {
            extend(&mut basis, (0..n).map(|i| f64::from(i == k)).collect(), least);
        }
        basis.split_off(rank)
    }
}

/// Adds to an orthonormal basis what of a vector is new, if it is longer than `least` (Gram and Schmidt).
fn extend(basis: &mut Vec<Vec<f64>>, mut vector: Vec<f64>, least: f64) {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for other in &*basis {
        let part = product(other, &vector);
        vector.iter_mut().zip(other).for_each(|(x, other)| *x -= part * other);
    }
    let length = product(&vector, &vector).sqrt();
    if length > least {
        vector.iter_mut().for_each(|x| *x /= length);
        basis.push(vector);
    }
}
