//! The estimated error of a converged solution, and the next mesh.

use crate::bvp::collocation::Collocation;
use crate::bvp::collocation::lobatto::Lobatto;
use crate::bvp::mesh::{Mesh, Span};
use crate::bvp::timed::Timed;
use crate::bvp::values::Values;
use crate::constants::refinement::{EXPECTED_GAIN, LEAST_GROWTH, MOST_GROWTH, SAFETY, SLOW_GROWTH};
use crate::extremal::Extremal;
use costate::EvalError;

/// Estimated errors of a solution.
#[derive(Clone, Debug)]
pub(crate) struct Estimate {
    /// Largest error of each component, at nodes and between them, relative to its scale.
    pub components: Vec<f64>,
    /// Defect of each span (root mean square, scaled), zero for a switch.
    pub local: Vec<f64>,
}

impl Estimate {
    /// The largest of all components.
    pub fn largest(&self) -> f64 {
        self.components.iter().fold(0.0, |largest, &error| largest.max(error))
    }
}

/// The error from the defect of the solution in the method with one more point:
///
/// $$ e = -A^{-1} \thinspace \delta $$
///
/// Values at the points of that method come from the collocation polynomial, improved by two Picard
/// iterations. Its order is higher by two, so e is the error at the nodes to leading order. Between the nodes
/// the polynomial is compared with the improved values. To be called after the last Newton step, whose matrix
/// is used.
///
/// `respond` writes `-A^-1 defect`: [`Collocation::response`], or the response with further equations.
pub(crate) fn estimate<E: Extremal + ?Sized>(
    equations: &mut Collocation,
    timed: &mut Timed<'_, E>,
    respond: impl FnOnce(&mut Collocation, &[f64], &mut Values),
) -> Result<Estimate, EvalError> {
    let (m, s) = (equations.m, equations.method.len());
    let finer = Lobatto::of(s + 1);
    let mut defects = vec![0.0; equations.mesh.spans.len() * m];
    let mut local = vec![0.0; equations.mesh.spans.len()];
    let mut points = vec![0.0; (s + 1) * m];
    let mut slopes = vec![0.0; (s + 1) * m];
    let mut components = vec![0.0_f64; m];
    for k in 0..equations.mesh.spans.len() {
        let Span::Interval { arc, length } = equations.mesh.spans[k] else { continue };
        slopes[..m].copy_from_slice(&equations.slopes.nodes[k * m..(k + 1) * m]);
        slopes[s * m..].copy_from_slice(&equations.slopes.nodes[(k + 1) * m..(k + 2) * m]);
        for j in 1..s {
            equations.polynomial(k, finer.points[j], &mut points[j * m..(j + 1) * m]);
        }
        let left = &equations.current.nodes[k * m..(k + 1) * m];
        let polynomial = points.clone();
        for round in 0..3 {
            for j in 1..s {
                let range = j * m..(j + 1) * m;
                timed.evaluate(&points[range.clone()], arc, &mut slopes[range])?;
            }
            if round < 2 {
                for j in 1..s {
                    for c in 0..m {
                        let sum: f64 = (0..=s).map(|l| finer.a[j * (s + 1) + l] * slopes[l * m + c]).sum();
                        points[j * m + c] = left[c] + length * sum;
                    }
                }
            }
        }
        for (e, (before, after)) in polynomial.iter().zip(&points).enumerate().take(s * m).skip(m) {
            components[e % m] = components[e % m].max(defined((before - after) / equations.scale[e % m]));
        }
        let right = &equations.current.nodes[(k + 1) * m..(k + 2) * m];
        let mut square = 0.0;
        for c in 0..m {
            let sum: f64 = (0..=s).map(|l| finer.weights()[l] * slopes[l * m + c]).sum();
            let defect = (right[c] - left[c] - length * sum) / equations.scale[c];
            defects[k * m + c] = defect;
            square += defect * defect;
        }
        local[k] = (square / m as f64).sqrt();
    }
    let mut errors = Values::zeros(equations.mesh.nodes(), m, s);
    respond(equations, &defects, &mut errors);
    for (i, &error) in errors.nodes.iter().enumerate() {
        components[i % m] = components[i % m].max(defined(error));
    }
    Ok(Estimate { components, local })
}

/// The absolute value of an error; infinite where it is undefined.
pub(crate) fn defined(error: f64) -> f64 {
    if error.is_nan() { f64::INFINITY } else { error.abs() }
}

/// What a refined mesh must respect.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MeshLimits {
    pub tolerance: f64,
    pub max_intervals: usize,
}

/// A mesh on which the error should fall below the tolerance.
///
/// From the first mesh to the second the number of intervals may fall to half. Later meshes only grow, by
/// half at least if the error `before` was not much larger: then the solution is less smooth than the order
/// of the method requires.
pub(crate) fn next_mesh(
    equations: &Collocation,
    estimate: &Estimate,
    before: Option<f64>,
    limits: MeshLimits,
) -> Mesh {
    let (mesh, order) = (&equations.mesh, equations.method.order());
    let present = mesh.intervals() as f64;
    let power = 1.0 / (order + 1) as f64;
    let total: f64 = estimate.local.iter().sum();
    let shares: f64 = estimate.local.iter().map(|error| error.powf(power)).sum();
    let error = estimate.largest();
    let wanted = if total > 0.0 && total.is_finite() && error.is_finite() {
        let ratio = error / total * shares.powi(order as i32 + 1) / (SAFETY * limits.tolerance);
        ratio.powf(1.0 / order as f64)
    } else {
        2.0 * present
    };
    let least = match before {
        None => LEAST_GROWTH * present.min(1.5 * wanted),
        Some(before) if error > EXPECTED_GAIN * before => SLOW_GROWTH * present,
        Some(_) => LEAST_GROWTH * present,
    };
    let count = wanted.clamp(least, MOST_GROWTH * present).ceil() as usize;
    let count = count.min(limits.max_intervals);
    if total.is_finite() {
        mesh.equidistributed(&estimate.local, order, count)
    } else {
        mesh.equidistributed(&vec![1.0; estimate.local.len()], order, count)
    }
}
