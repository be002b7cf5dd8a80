//! Positions and rates at a node, as functions of the unknowns and of the time of its phase.

use super::side::{Limited, Side};
use crate::direct::motion::spline::Spline;

/// The unknowns x at a node: q = x, and v = x/T. At the ends of phases they are derivatives in time, v = x.
pub(crate) struct AtNode<'a> {
    spline: &'a Spline,
    first: usize,
    /// 1/T, or 1 at the end of a phase.
    inverse: f64,
    /// The phase whose time rates depend on.
    phase: Option<usize>,
}

/// A position or a rate.
pub(crate) struct NodeValue {
    /// Its unknown, by the number among all.
    pub unknown: usize,
    pub value: f64,
    /// The derivative by the unknown.
    pub scale: f64,
    /// Derivatives by T, of rates inside of a phase.
    pub by_time: Option<ByTime>,
}

/// Derivatives of v = x/T by T.
pub(crate) struct ByTime {
    pub phase: usize,
    /// -v/T.
    pub first: f64,
    /// 2v/T^2.
    pub second: f64,
    /// By x and T, -1/T^2.
    pub mixed: f64,
}

impl<'a> AtNode<'a> {
    pub fn new(spline: &'a Spline, node: usize) -> Self {
        let phase = (!spline.mesh.is_end(node)).then(|| spline.mesh.phase(node));
        Self { spline, first: spline.node() * node, inverse: 1.0 / spline.clock_at(node), phase }
    }

    /// The value that a side limits, a position or a rate.
    #[inline(always)]
    pub fn of(&self, side: &Side) -> NodeValue {
        let (unknown, inverse) = (self.first + side.index(self.spline.dof), self.inverse);
        let x = self.spline.unknowns[unknown];
        if side.limited != Limited::Rate {
            return NodeValue { unknown, value: x, scale: 1.0, by_time: None };
        }
        let v = inverse * x;
        let by_time = self.phase.map(|phase| ByTime {
            phase,
            first: -inverse * v,
            second: 2.0 * inverse * inverse * v,
            mixed: -inverse * inverse,
        });
        NodeValue { unknown, value: v, scale: inverse, by_time }
    }
}

impl NodeValue {
    /// Its change by steps of its unknown and of the times of all phases.
    #[inline(always)]
    pub fn change(&self, step: f64, time_steps: &[f64]) -> f64 {
        match &self.by_time {
            Some(by_time) => self.scale * (step - self.value * time_steps[by_time.phase]),
            None => self.scale * step,
        }
    }
}
