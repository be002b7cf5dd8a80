//! Bounds as a logarithmic barrier `-mu sum ln(distance to the bound)`, with a multiplier for each bound.

use crate::problem::Problem;
use nalgebra::DVector;

/// One vector for each node.
pub type Nodes = Vec<DVector<f64>>;

/// Smallest distance of the start from a bound, relative to the range between the bounds or to the bound.
const INSIDE: f64 = 1e-2;
/// A multiplier stays within this factor of mu over the distance.
const DRIFT: f64 = 1e10;

/// Bounds of every node and their multipliers: positive for a bound, else zero.
#[derive(Clone)]
pub struct Barrier {
    pub sides: [Side; 2],
}

/// Lower bounds (sign +1, distance z - bound) or upper bounds (sign -1, distance bound - z).
#[derive(Clone)]
pub struct Side {
    pub sign: f64,
    pub bounds: Nodes,
    pub multipliers: Nodes,
}

impl Side {
    fn new(sign: f64, bounds: Nodes) -> Self {
        Self { sign, multipliers: bounds.iter().map(|node| node.map(|_| 0.0)).collect(), bounds }
    }

    /// Distances to the bounds; infinite if there is none.
    pub fn distance(&self, k: usize, node: &DVector<f64>) -> DVector<f64> {
        (node - &self.bounds[k]) * self.sign
    }

    /// (distance, inward step, multiplier) of every bound.
    fn each(&self, nodes: &Nodes, steps: &Nodes) -> Vec<[f64; 3]> {
        let mut all = Vec::new();
        for (k, node) in nodes.iter().enumerate() {
            for (i, bound) in self.bounds[k].iter().enumerate().filter(|(_, bound)| bound.is_finite()) {
                let towards = self.sign * steps[k][i];
                all.push([self.sign * (node[i] - bound), towards, self.multipliers[k][i]]);
            }
        }
        all
    }
}

impl Barrier {
    pub fn new<M, L, F>(problem: &Problem<M, L, F>) -> Self
    where
        M: costate::step::Step<f64>,
        L: costate::dynamics::Cost<f64>,
        F: costate::dynamics::Cost<f64>,
    {
        let (lower, upper) = (0..=problem.intervals)
            .map(|k| problem.bounds(k))
            .map(|bounds| (DVector::from_vec(bounds.lower), DVector::from_vec(bounds.upper)))
            .unzip();
        Self { sides: [Side::new(1.0, lower), Side::new(-1.0, upper)] }
    }

    /// Whether there is any bound.
    pub fn is_empty(&self) -> bool {
        self.sides
            .iter()
            .all(|side| side.bounds.iter().all(|node| node.iter().all(|bound| bound.is_infinite())))
    }

    /// Moves nodes strictly inside the bounds and sets each multiplier to mu over its distance.
    pub fn start(&mut self, nodes: &mut Nodes, mu: f64) {
        let [lower, upper] = &self.sides;
        for (k, node) in nodes.iter_mut().enumerate() {
            for (i, z) in node.iter_mut().enumerate() {
                let (low, high) = (lower.bounds[k][i], upper.bounds[k][i]);
                let margin = |bound: f64| INSIDE * bound.abs().max(1.0).min(high - low);
                if low.is_finite() {
                    *z = z.max(low + margin(low));
                }
                if high.is_finite() {
                    *z = z.min(high - margin(high));
                }
            }
        }
        for side in &mut self.sides {
            for (k, node) in nodes.iter().enumerate() {
                side.multipliers[k] = side.distance(k, node).map(|distance| mu / distance);
            }
        }
    }

    /// `-mu sum ln(distance)`; infinite outside.
    pub fn value(&self, nodes: &Nodes, mu: f64) -> f64 {
        let log = |distance: f64| if distance > 0.0 { -distance.ln() } else { f64::INFINITY };
        let sum: f64 = self.sides.iter().flat_map(|side| side.each(nodes, nodes)).map(|[d, ..]| log(d)).sum();
        if mu > 0.0 { mu * sum } else { 0.0 }
    }

    /// Gradient of the barrier.
    pub fn gradient(&self, nodes: &Nodes, mu: f64) -> Nodes {
        let at = |k: usize, node: &DVector<f64>| {
            let parts = self.sides.each_ref().map(|side| side.distance(k, node).map(|d| -mu * side.sign / d));
            &parts[0] + &parts[1]
        };
        nodes.iter().enumerate().map(|(k, node)| at(k, node)).collect()
    }

    /// Multiplier over distance, summed over the two sides: the diagonal that the barrier adds to the
    /// Hessian.
    pub fn diagonal(&self, nodes: &Nodes) -> Nodes {
        let at = |k: usize, node: &DVector<f64>| {
            let parts =
                self.sides.each_ref().map(|side| side.multipliers[k].component_div(&side.distance(k, node)));
            &parts[0] + &parts[1]
        };
        nodes.iter().enumerate().map(|(k, node)| at(k, node)).collect()
    }

    /// Subtracts the multipliers of lower and adds those of upper bounds.
    pub fn add_multipliers(&self, gradient: &mut Nodes) {
        for side in &self.sides {
            gradient.iter_mut().zip(&side.multipliers).for_each(|(g, z)| *g -= z * side.sign);
        }
    }

    /// The largest `|multiplier distance - mu|`.
    pub fn complementarity(&self, nodes: &Nodes, mu: f64) -> f64 {
        let each = self.sides.iter().flat_map(|side| side.each(nodes, nodes));
        each.map(|[distance, _, multiplier]| (multiplier * distance - mu).abs()).fold(0.0, f64::max)
    }

    /// The largest fraction of a step, at most 1, that keeps the fraction `1 - tau` of each distance.
    pub fn longest(&self, nodes: &Nodes, steps: &Nodes, tau: f64) -> f64 {
        let each = self.sides.iter().flat_map(|side| side.each(nodes, steps));
        each.filter(|[_, towards, _]| *towards < 0.0)
            .map(|[d, towards, _]| -tau * d / towards)
            .fold(1.0, f64::min)
    }

    /// Makes the Newton step of the multipliers, shortened to keep the fraction `1 - tau` of each.
    pub fn move_multipliers(&mut self, nodes: &Nodes, steps: &Nodes, mu: f64, tau: f64) {
        let mut changes = Vec::new();
        let mut longest = 1.0_f64;
        for side in &self.sides {
            for (k, node) in nodes.iter().enumerate() {
                let mut change = side.distance(k, node);
                for (i, entry) in change.iter_mut().enumerate() {
                    let z = side.multipliers[k][i];
                    *entry = if z > 0.0 { (mu - z * side.sign * steps[k][i]) / *entry - z } else { 0.0 };
                    if *entry < 0.0 {
                        longest = longest.min(-tau * z / *entry);
                    }
                }
                changes.push(change);
            }
        }
        let targets = self.sides.iter_mut().flat_map(|side| &mut side.multipliers);
        targets.zip(&changes).for_each(|(z, change)| *z += change * longest);
    }

    /// Keeps each multiplier within a large factor of mu over its distance.
    pub fn restrain(&mut self, nodes: &Nodes, mu: f64) {
        for side in &mut self.sides {
            for (k, node) in nodes.iter().enumerate() {
                let distance = side.distance(k, node);
                for (z, d) in side.multipliers[k].iter_mut().zip(&distance).filter(|(z, _)| **z > 0.0) {
                    *z = z.clamp(mu / (DRIFT * d), DRIFT * mu / d);
                }
            }
        }
    }
}
