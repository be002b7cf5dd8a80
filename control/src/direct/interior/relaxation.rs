//! How far limits give in the elastic phase, and what that adds to Newton's equations.

use crate::constants::direct::LEAST_CURVATURE;
use crate::constants::elastic::ROUNDED_PRICE;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::newton::point_terms::Work;
use crate::direct::newton::rate_rows::RateRows;
use crate::direct::newton::system::System;
use crate::numerics::bordered::Bordered;

/// Each limit is relaxed by a constant part e of its range, so its distances are `d + range e`, at the price
///
/// $$ \varphi(e) = \frac{P}{2} \left( e + \sqrt{e^2 + \delta^2} \right) $$
///
/// which is about P e where it is relaxed and next to nothing where it is not. Both sides of a limit on a
/// magnitude are relaxed alike, as both halves of an equation do. What is still an equation is a law of
/// physics and not relaxed. Empty outside of the elastic phase.
///
/// The sum over limits of the largest violation along the motion is what SNOPT's elastic mode minimises, with
/// one elastic variable for all constraints of a limit (P. E. Gill, W. Murray, M. A. Saunders, "SNOPT: an SQP
/// algorithm for large-scale constrained optimization", SIAM Review 47, 2005, section 4.7). The unknowns e
/// border Newton's equations,
///
/// $$ \begin{pmatrix} K & B \\\\ B^\top & C \end{pmatrix} \begin{pmatrix} \Delta x \\\\ \Delta e
///    \end{pmatrix} = - \begin{pmatrix} g \\\\ g_e \end{pmatrix}, \qquad B_i = \sum_{at \in i} \sigma
///    \, \mathrm{range} \, \nabla d, \qquad C_{ii} = \varphi'' + \sum_{at \in i} \sigma \,
///    \mathrm{range}^2 $$
///
/// with the slacks and multipliers eliminated as elsewhere
/// ([`side_terms`](crate::direct::newton::side_terms::side_terms)): one substitution for each limit,
/// and a dense matrix C - B'K^-1 B.
#[derive(Clone, Debug, Default)]
pub(crate) struct Relaxation {
    /// The limit that each side of the barrier belongs to; none for equations.
    pub(super) limits: Vec<Option<usize>>,
    pub(super) ranges: Vec<f64>,
    /// Those outside of the elastic phase.
    own: Vec<f64>,
    /// e, in parts of ranges.
    pub(super) give: Vec<f64>,
    /// P.
    pub(super) price: f64,
    /// B, the entries of shared unknowns last, and C.
    pub(super) border: Bordered,
    /// Entries of B for the times of phases.
    pub(super) by_times: Vec<Vec<f64>>,
    /// Room for a point, and for jerks and rates of torques of an interval.
    pub(super) work: Work,
    pub(super) rates: RateRows,
    /// Gradients in e at mu = 0, and its factor of mu.
    pub(super) gradient: [Vec<f64>; 2],
    steps: [Vec<f64>; 2],
}

/// The limits that the sides belong to, counted from 0; none for equations, which are not relaxed.
fn limits_of<'a>(sides: impl Iterator<Item = &'a Side>) -> Vec<Option<usize>> {
    let key = |side: &Side| {
        // Lower and upper limits of positions, of boxes and the like are two.
        let apart = matches!(side.limited, Limited::Position | Limited::Task) && !side.is_half;
        (side.limited, side.joint, apart && side.sign < 0.0)
    };
    let mut found = Vec::new();
    let mut number = |side: &Side| {
        let key = key(side);
        found.iter().position(|other| *other == key).unwrap_or_else(|| {
            found.push(key);
            found.len() - 1
        })
    };
    sides.map(|side| (!side.is_equation).then(|| number(side))).collect()
}

impl Relaxation {
    /// For a barrier that has been measured without it, whose sides have the ranges `own` outside of the
    /// elastic phase: all distances become positive, by this room in parts of ranges and of what limits must
    /// give.
    pub fn of(barrier: &Barrier, own: Vec<f64>, price: f64, room: f64) -> Self {
        let limits = limits_of(barrier.all_sides());
        let count = limits.iter().flatten().max().map_or(0, |last| last + 1);
        let mut give = vec![0.0_f64; count];
        for (limit, violation) in limits.iter().zip(barrier.violations()) {
            limit.iter().for_each(|&limit| give[limit] = give[limit].max(violation));
        }
        give.iter_mut().for_each(|give| *give += room * (1.0 + *give));
        Self {
            ranges: barrier.ranges(),
            gradient: [vec![0.0; count], vec![0.0; count]],
            steps: [vec![0.0; count], vec![0.0; count]],
            limits,
            give,
            price,
            own,
            ..Self::default()
        }
    }

    /// What it adds to the distances of a side.
    pub fn relief(&self, side: usize) -> f64 {
        self.limits[side].map_or(0.0, |limit| self.ranges[side] * self.give[limit])
    }

    /// Whether limits may give.
    pub fn is_on(&self) -> bool {
        !self.limits.is_empty()
    }

    /// Ranges in which limits give: as large as the largest violation at the start, where that is larger.
    pub fn widened(barrier: &Barrier) -> Vec<f64> {
        let limits = limits_of(barrier.all_sides());
        let mut scale = vec![1.0_f64; limits.len()];
        for (limit, violation) in limits.iter().zip(barrier.violations()) {
            limit.iter().for_each(|&limit| scale[limit] = scale[limit].max(violation));
        }
        let widened =
            |(range, limit): (&f64, &Option<usize>)| range * limit.map_or(1.0, |limit| scale[limit]);
        barrier.ranges().iter().zip(&limits).map(widened).collect()
    }

    /// The range of a side outside of the elastic phase.
    pub fn own_range(&self, side: usize) -> f64 {
        self.own[side]
    }

    /// The limit of each side; none for equations.
    pub fn limits(&self) -> &[Option<usize>] {
        &self.limits
    }

    /// P.
    pub fn price(&self) -> f64 {
        self.price
    }

    /// Makes it dearer, or cheaper.
    pub fn scale_price(&mut self, factor: f64) {
        self.price *= factor;
    }

    /// The price after the part `alpha` of the step for a barrier `mu`.
    pub fn cost(&self, alpha: f64, mu: f64) -> f64 {
        let steps = self.steps[0].iter().zip(&self.steps[1]);
        self.give.iter().zip(steps).map(|(e, (a, b))| self.price * price(e + alpha * (a + mu * b))[0]).sum()
    }

    /// Takes a part of the step.
    pub fn take(&mut self, alpha: f64, mu: f64) {
        let steps = self.steps[0].iter().zip(&self.steps[1]);
        self.give.iter_mut().zip(steps).for_each(|(e, (a, b))| *e += alpha * (a + mu * b));
    }

    /// Adds what a part of the step changes in the distances, for a barrier with these entries.
    pub fn add_step(&self, alpha: f64, mu: f64, barrier: &Barrier, distance: &mut [f64]) {
        if self.limits.is_empty() {
            return;
        }
        let step = |limit: usize| alpha * (self.steps[0][limit] + mu * self.steps[1][limit]);
        self.add(step, barrier, distance);
    }

    /// Adds what a part (0 or 1) of the step changes in the distances.
    pub fn add_change(&self, part: usize, barrier: &Barrier, changes: &mut [f64]) {
        if !self.limits.is_empty() {
            self.add(|limit| self.steps[part][limit], barrier, changes);
        }
    }

    fn add(&self, step: impl Fn(usize) -> f64, barrier: &Barrier, to: &mut [f64]) {
        for (at, to) in to.iter_mut().enumerate() {
            let Some(side) = barrier.side_index(at) else { continue };
            if let Some(limit) = self.limits[side] {
                *to += self.ranges[side] * step(limit);
            }
        }
    }

    /// (g_e at mu = 0) times the step, or with the barrier's part of the gradient too.
    pub fn slope(&self, mu: f64, with_barrier: bool) -> f64 {
        let of_mu = if with_barrier { mu } else { 0.0 };
        let gradient = self.gradient[0].iter().zip(&self.gradient[1]).map(|(a, b)| a + of_mu * b);
        let steps = self.steps[0].iter().zip(&self.steps[1]).map(|(a, b)| a + mu * b);
        gradient.zip(steps).map(|(gradient, step)| gradient * step).sum()
    }

    /// Factorises the border of a factorised system. Whether the whole is positive definite.
    pub fn factorise(&mut self, system: &mut System) -> bool {
        self.border.factorise(LEAST_CURVATURE, |column| system.solve_column(column))
    }

    /// Turns a part of the step with constant e into that of the whole.
    pub fn correct(&mut self, part: usize, dx: &mut [f64], shared: &mut [f64]) {
        let steps = self.steps[part].iter_mut().zip(&self.gradient[part]);
        steps.for_each(|(step, gradient)| *step = -gradient);
        self.border.finish([dx, shared], &mut self.steps[part]);
    }
}

/// The price of e for P = 1, with its first and second derivative.
pub(super) fn price(e: f64) -> [f64; 3] {
    let delta = ROUNDED_PRICE;
    let root = e.hypot(delta);
    // e + root without cancellation.
    let sum = if e >= 0.0 { e + root } else { delta * delta / (root - e) };
    [0.5 * sum, 0.5 * sum / root, 0.5 * delta * delta / (root * root * root)]
}

#[cfg(test)]
#[path = "relaxation_tests.rs"]
mod tests;
