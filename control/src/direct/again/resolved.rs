//! What solving again may take, and what it gives.

use crate::constants::direct::{CLEARANCE_ACCEPTED, VIOLATION_ACCEPTED};
use crate::direct::interior::iterate::Interior;
use crate::direct::limits::tasks::Tasks;
use crate::direct::motion::spline::Spline;
use crate::direct::solve::prepare::Dynamics;
use costate::EvalError;
use std::time::Duration;

/// Limits on solving again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Budget {
    /// Most Newton steps, at least 1.
    pub iterations: usize,
    /// Longest time. No further step begins that would probably exceed it: one that takes as long as the
    /// longest of the last ones. The first step is always made.
    pub time: Option<Duration>,
}

impl Budget {
    /// So many Newton steps.
    pub fn steps(iterations: usize) -> Self {
        Self { iterations: iterations.max(1), time: None }
    }

    /// With this longest time.
    #[must_use]
    pub fn within(self, time: Duration) -> Self {
        Self { time: Some(time), ..self }
    }
}

/// How solving again ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ResolveStatus {
    /// To the tolerance of the options.
    Solved,
    /// After all Newton steps that were allowed.
    Iterations,
    /// Because the time was over.
    OutOfTime,
    /// Because the callback of [`Resolve::solve_until`](crate::Resolve::solve_until) asked to stop.
    Cancelled,
    /// No step was better than the iterate.
    NoProgress,
}

/// What solving again gave: figures of the motion that is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Resolved {
    /// How it ended. Unless it is solved, the motion is the cheapest iterate that keeps all limits, or the
    /// one that exceeds them least.
    pub status: ResolveStatus,
    /// Newton steps.
    pub iterations: usize,
    /// J.
    pub cost: f64,
    /// What barriers cost at most: the sum of slack times multiplier.
    pub gap: f64,
    /// Largest violation of a limit, a tool or a clearance at the points, in parts of its range.
    pub violation: f64,
    /// Largest violation of a clearance between the points, in parts of the sum of the radii and the margin;
    /// infinite where a distance is undefined. Rates of joints and lengths of links bound how fast distances
    /// change, and the motion is looked at so often that the cores of two bodies, of bodies and obstacles,
    /// cannot meet unseen. Half-spaces count at the points alone: nothing is beyond them.
    pub clearance_violation: f64,
    /// How long it took.
    pub time: Duration,
}

impl Resolved {
    /// Whether the motion keeps all limits at its points, to 1e-7 of their ranges, and all clearances between
    /// them too, to a hundredth of the radii and the margin: no body passes through another one, however thin
    /// it is. Other limits between the points of the mesh are not looked at.
    pub fn keeps_limits(&self) -> bool {
        self.violation <= VIOLATION_ACCEPTED && self.clearance_violation <= CLEARANCE_ACCEPTED
    }
}

/// The best motion of a solve.
#[derive(Clone, Debug, Default)]
pub(super) struct Shown {
    pub spline: Spline,
    pub cost: f64,
    pub gap: f64,
    pub violation: f64,
}

impl Shown {
    pub fn take(&mut self, iterate: &Interior<Dynamics>) {
        self.spline.copy_from(&iterate.spline);
        let figures = &iterate.figures;
        (self.cost, self.gap, self.violation) = (figures.cost, figures.gap, figures.violation);
    }

    /// The largest violation of a clearance along the motion, at the points and between them.
    pub fn sweep(&self, tasks: &mut Tasks) -> Result<f64, EvalError> {
        let mut worst = 0.0_f64;
        for k in 0..self.spline.mesh.intervals() {
            let violation = tasks.sweep(&self.spline, k)?.part;
            worst = if violation.is_nan() { f64::INFINITY } else { worst.max(violation) };
        }
        Ok(worst)
    }

    /// Takes an iterate if it is better.
    pub fn offer(&mut self, iterate: &Interior<Dynamics>) {
        let (cost, violation) = (iterate.figures.cost, iterate.figures.violation);
        let keeps = [violation, self.violation].map(|violation| violation <= VIOLATION_ACCEPTED);
        let better = match keeps {
            [true, true] => cost < self.cost,
            [false, false] => violation < self.violation,
            [new, _] => new,
        };
        if better {
            self.take(iterate);
        }
    }
}
