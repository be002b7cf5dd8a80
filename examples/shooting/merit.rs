//! Line search on an exact penalty of the barrier problem.
//!
//! The penalty is `cost + barrier + weight |defects|_1`. If the full step does not reduce it because of the
//! curvature of the defects, a second-order correction is tried before the step is shortened.

use crate::barrier::Nodes;
use crate::convexify::Convex;
use crate::curvature::Model;
use crate::problem::Problem;
use crate::solution::Solution;
use costate::dynamics::Cost;
use costate::step::Step;
use nalgebra::DVector;

/// Required fraction of the predicted decrease.
const FALL: f64 = 1e-4;
/// Maximum number of corrections, and the factor by which each must reduce the defects.
const CORRECTIONS: usize = 4;
const SHRINK: f64 = 0.9;
/// Number of refinements of each linear-quadratic solution.
const ROUNDS: usize = 2;
/// Smallest step length.
const SHORTEST: f64 = 1e-8;

/// The weight of the defects.
#[derive(Default)]
pub struct Merit {
    weight: f64,
}

/// A step that was accepted.
pub struct Move {
    pub nodes: Nodes,
    /// The Newton step, possibly corrected.
    pub full: Nodes,
    /// The costates at the end of the full step.
    pub costates: Nodes,
    pub part: f64,
    /// Whether the penalty shortened it, not only the bounds.
    pub shortened: bool,
    pub second_order: bool,
}

fn dot(a: &[DVector<f64>], b: &[DVector<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(b)).sum()
}

fn moved(nodes: &[DVector<f64>], step: &[DVector<f64>], part: f64) -> Nodes {
    nodes.iter().zip(step).map(|(node, step)| node + step * part).collect()
}

impl Merit {
    /// Resets the weight.
    pub fn forget(&mut self) {
        self.weight = 0.0;
    }

    /// The step of the linear-quadratic problem after the line search.
    pub fn search<M: Step<f64>, L: Cost<f64>, F: Cost<f64>>(
        &mut self,
        problem: &mut Problem<M, L, F>,
        at: &Solution,
        model: &Model,
        convex: &Convex,
        gradient: &Nodes,
        mu: f64,
    ) -> Option<Move> {
        let solve = |offset: &[DVector<f64>]| {
            convex.factor.solve_refined(&convex.hessian, &model.jacobian, gradient, offset, ROUNDS)
        };
        let violation = model.values.violation_1();
        let step = solve(&model.values.defects);
        let slope = dot(gradient, &step.nodes);
        let bent = step.nodes.iter().zip(&convex.hessian).map(|(d, h)| d.dot(&(h * d))).sum::<f64>();
        if !(slope.is_finite() && bent.is_finite()) {
            return None;
        }
        if violation > 0.0 {
            let needed = (slope + 0.5 * bent.max(0.0)) / (0.9 * violation);
            if self.weight < needed {
                self.weight = 1.1 * needed;
            }
        }
        let weight = self.weight;
        let fall = slope - weight * violation;
        let mut penalty = |nodes: &Nodes| {
            let barrier = at.barrier.value(nodes, mu);
            let values = if barrier.is_finite() { problem.values(nodes).ok() } else { None };
            let total =
                values.as_ref().map_or(f64::INFINITY, |v| v.cost + barrier + weight * v.violation_1());
            (if total.is_finite() { total } else { f64::INFINITY }, values)
        };
        let here = model.values.cost + at.barrier.value(&at.nodes, mu) + weight * violation;
        // The possible rounding error of the penalty.
        let noise = 10.0 * f64::EPSILON * (here.abs() + weight.max(1.0));
        let tau = (1.0 - mu).max(0.99);
        let longest = at.barrier.longest(&at.nodes, &step.nodes, tau);
        let mut part = longest;
        while part >= SHORTEST {
            let nodes = moved(&at.nodes, &step.nodes, part);
            let (there, values) = penalty(&nodes);
            if there <= here + FALL * part * fall + noise {
                return Some(Move {
                    nodes,
                    full: step.nodes,
                    costates: step.costates,
                    part,
                    shortened: part < longest,
                    second_order: false,
                });
            }
            if let (true, Some(values)) = (part == longest, values) {
                let mut offset: Nodes = model.values.defects.iter().map(|c| c * part).collect();
                let (mut left, mut defects) = (values.violation_1(), values.defects);
                for _ in 0..CORRECTIONS {
                    offset.iter_mut().zip(&defects).for_each(|(sum, defect)| *sum += defect);
                    let corrected = solve(&offset);
                    let part = at.barrier.longest(&at.nodes, &corrected.nodes, tau);
                    let nodes = moved(&at.nodes, &corrected.nodes, part);
                    let (there, values) = penalty(&nodes);
                    if there <= here + FALL * longest * fall + noise {
                        let (full, costates) = (corrected.nodes, corrected.costates);
                        return Some(Move {
                            nodes,
                            full,
                            costates,
                            part,
                            shortened: false,
                            second_order: true,
                        });
                    }
                    match values {
                        Some(values) if values.violation_1() < SHRINK * left => {
                            left = values.violation_1();
                            defects = values.defects;
                        }
                        _ => break,
                    }
                }
            }
            part *= 0.5;
        }
        None
    }
}
