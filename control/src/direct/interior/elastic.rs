//! The elastic phase: limits give, and what they give is minimised.

use super::iterate::Interior;
use super::relaxation::Relaxation;
use crate::constants::direct as constants;
use crate::constants::elastic;
use crate::direct::limits::barrier::Barrier;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::PointDynamics;
use costate::EvalError;

/// A limit that gives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Given {
    /// Its side, and its entry with the largest multiplier.
    pub side: usize,
    pub at: usize,
    /// The largest violation along the motion, in the unit of the value..
    pub amount: f64,
    /// .. and in parts of the range that the limit has outside of the elastic phase.
    pub part: f64,
}

/// An iterate of the elastic phase.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    spline: Spline,
    barrier: Barrier,
    relaxation: Relaxation,
}

impl<D: PointDynamics> Interior<D> {
    /// Lets all limits give so much that the motion keeps them; equations of tasks along the motion become
    /// two limits, laws of physics stay equations.
    /// With price and ranges of a coarser mesh the motion is near its minimum. The barrier that was there
    /// before.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn relax(&mut self, coarser: Option<&(f64, Vec<f64>)>) -> Result<Barrier, EvalError> {
        // Without relief, for the distances.
        let relaxed = self.barrier.with_halves();
        let kept = std::mem::replace(&mut self.barrier, relaxed);
        self.start(None)?;
        let own = self.barrier.ranges();
        let (room, gap) = if coarser.is_some() { elastic::WARM } else { elastic::COLD };
        let cold = || (elastic::PRICE * self.figures.size, Relaxation::widened(&self.barrier));
        let (price, ranges) = coarser.cloned().unwrap_or_else(cold);
        self.barrier.set_ranges(&ranges);
        self.relaxation = Relaxation::of(&self.barrier, own, price, room);
        self.prepare();
        self.barrier.move_out(|side| self.relaxation.relief(side));
        self.begin(None)?;
        self.centre(gap);
        Ok(kept)
    }

    /// Ends the elastic phase, with the barrier of before on the mesh as it is now, and this gap in parts of
    /// the cost.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn tighten(&mut self, barrier: Barrier, gap: f64) -> Result<(), EvalError> {
        self.barrier = barrier;
        self.relaxation = Relaxation::default();
        self.start(None)?;
        self.centre(gap);
        Ok(())
    }

    /// Puts slacks where the motion is, and multipliers on the central path, with this gap in parts of the
    /// cost.
    fn centre(&mut self, gap: f64) {
        let total = self.barrier.total_weight().max(f64::MIN_POSITIVE);
        self.mu = gap * self.figures.size / total;
        for at in 0..self.barrier.count() {
            if self.barrier.is_limit(at) {
                let least = elastic::LEAST_ROOM / self.barrier.unit[at];
                let slack = self.barrier.distance[at].max(least);
                self.barrier.slack[at] = slack;
                self.barrier.multiplier[at] = self.mu * self.barrier.weight[at] / slack;
            }
        }
        self.measure_figures();
    }

    /// Makes what limits give dearer, and multipliers with it.
    pub fn raise_price(&mut self, factor: f64) {
        self.relaxation.scale_price(factor);
        self.barrier.multiplier.iter_mut().for_each(|multiplier| *multiplier *= factor);
        self.measure_figures();
        // As far as equations may become stiffer elsewhere.
        let most = (constants::MOST_STIFFNESS * self.figures.size).max(self.barrier.stiffness);
        self.barrier.stiffness = (factor * self.barrier.stiffness).min(most);
    }

    /// What is needed to come back to this iterate of the elastic phase.
    pub fn keep(&self) -> Kept {
        Kept {
            spline: self.spline.clone(),
            barrier: self.barrier.clone(),
            relaxation: self.relaxation.clone(),
        }
    }

    /// Comes back to an iterate of the elastic phase.
    ///
    /// # Errors
    /// A motion that cannot be evaluated.
    pub fn come_back(&mut self, kept: Kept) -> Result<(), EvalError> {
        Kept { spline: self.spline, barrier: self.barrier, relaxation: self.relaxation } = kept;
        self.evaluate()?;
        self.measure_figures();
        Ok(())
    }

    /// The same path in a multiple of its time, with what is given at the ends of phases.
    pub fn slow_down(&mut self, factor: f64) {
        let n = self.spline.dof;
        self.spline.times.iter_mut().for_each(|time| *time *= factor);
        for (end, given) in self.ends.given.iter().enumerate() {
            let unknowns = self.spline.end_unknowns(end);
            let derivatives = self.spline.unknowns[unknowns].iter_mut().zip(given).enumerate().skip(n);
            for (i, (derivative, _)) in derivatives.filter(|(_, (_, given))| !**given) {
                *derivative /= if i < 2 * n { factor } else { factor * factor };
            }
        }
    }

    /// Takes a part of the step of what limits give.
    pub(super) fn take_relief(&mut self, alpha: f64) {
        self.relaxation.take(alpha, self.mu);
        self.barrier.move_out(|side| self.relaxation.relief(side));
    }

    /// The largest violation of a limit as it is, without what it gives, in parts of ranges; negative inside.
    /// Equations may be off by what Newton's method mends.
    pub fn violation_without_relief(&self) -> f64 {
        let on = (0..self.barrier.count()).filter(|&at| self.barrier.is_on(at));
        let part = |at: usize| {
            let side = self.barrier.side(at);
            let room = if side.is_half || side.is_equation { elastic::OFF_EQUATIONS } else { 0.0 };
            self.part(at) - room
        };
        on.map(part).fold(f64::NEG_INFINITY, f64::max)
    }

    /// The violation of an entry as it is, in parts of its range.
    fn part(&self, at: usize) -> f64 {
        self.barrier.side(at).violation(self.barrier.true_distance(at))
    }

    /// All limits with what they have to give: the largest violation of each along the motion.
    pub fn given(&self) -> Vec<Given> {
        let limits = self.relaxation.limits();
        let count = limits.iter().flatten().max().map_or(0, |last| last + 1);
        let mut found: Vec<Option<Given>> = vec![None; count];
        for at in (0..self.barrier.count()).filter(|&at| self.barrier.is_limit(at)) {
            let Some(side) = self.barrier.side_index(at) else { continue };
            let Some(limit) = limits[side] else { continue };
            let amount = self.part(at) * self.barrier.side(at).range;
            let part = amount / self.relaxation.own_range(side);
            let given = found[limit].get_or_insert(Given { side, at, amount, part });
            (given.amount, given.part) = (given.amount.max(amount), given.part.max(part));
            if self.barrier.multiplier[at] > self.barrier.multiplier[given.at] {
                (given.side, given.at) = (side, at);
            }
        }
        found.into_iter().flatten().collect()
    }
}
