//! What a run shows.

use crate::plant::Arm;
use costate_control::Resolved;
use std::fmt;
use std::time::Duration;

/// Figures of a run.
#[derive(Clone, Debug)]
pub struct Report {
    name: String,
    rate: f64,
    times: Vec<Duration>,
    steps: usize,
    /// Plans that exceed a limit at a point, and by how much, in parts of its range.
    pub exceeding: usize,
    pub planned: f64,
    /// Largest violation along what the arm did, in parts of ranges: positions, rates, torques.
    pub violations: [f64; 3],
    /// Distance from the goal at the end (rad).
    pub distance: f64,
    goal: [Vec<f64>; 2],
}

impl Report {
    pub const HEADER: &'static str = "arm      rate asked  rate held  step median  99 %    worst     Newton steps  plans \
                                      beyond limits (worst)  arm beyond q, v, tau  from the goal";

    pub fn new(arm: &Arm, rate: f64) -> Self {
        let zeros = || vec![0.0; arm.q.len()];
        Self {
            name: arm.robot.name().into(),
            rate,
            times: Vec::new(),
            steps: 0,
            exceeding: 0,
            planned: 0.0,
            violations: [0.0; 3],
            distance: f64::INFINITY,
            goal: [zeros(), zeros()],
        }
    }

    /// Adds a plan that took so long.
    pub fn add(&mut self, spent: Duration, plan: &Resolved) {
        self.times.push(spent);
        self.steps += plan.iterations;
        self.exceeding += usize::from(!plan.keeps_limits());
        self.planned = self.planned.max(plan.violation);
    }

    /// Looks at where the arm is.
    pub fn look(&mut self, arm: &Arm) {
        for (i, joint) in arm.robot.independent_joints().enumerate() {
            let limits = &joint.limits;
            let (q, range) = (arm.q[i], limits.upper - limits.lower);
            let over = [
                (limits.lower - q).max(q - limits.upper) / range,
                (arm.v[i].abs() - limits.velocity) / (2.0 * limits.velocity),
                (arm.torques[i].abs() - limits.effort) / (2.0 * limits.effort),
            ];
            self.violations.iter_mut().zip(over).for_each(|(most, over)| *most = most.max(over));
        }
        let [q, v] = &mut self.goal;
        arm.goal(arm.time, q, v);
        self.distance = q.iter().zip(&arm.q).fold(0.0, |most, (goal, q)| most.max((goal - q).abs()));
    }

    /// The time below which this part of all plans took.
    pub fn within(&self, part: f64) -> Duration {
        let mut times = self.times.clone();
        times.sort_unstable();
        let last = times.len().saturating_sub(1);
        times.get((part * last as f64).round() as usize).copied().unwrap_or_default()
    }

    /// The rate that would have been held in all periods (Hz).
    pub fn held(&self) -> f64 {
        1.0 / self.within(1.0).as_secs_f64()
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let ms = |part: f64| 1e3 * self.within(part).as_secs_f64();
        let [q, v, tau] = self.violations;
        write!(
            f,
            "{:<8} {:>7.0} Hz {:>7.0} Hz {:>9.3} ms {:>6.3} ms {:>6.3} ms {:>13.2} {:>9} of {} ({:.1e}) {:>9.1e} {:.1e} \
             {:.1e} {:>9.1e} rad",
            self.name,
            self.rate,
            self.held(),
            ms(0.5),
            ms(0.99),
            ms(1.0),
            self.steps as f64 / self.times.len().max(1) as f64,
            self.exceeding,
            self.times.len(),
            self.planned,
            q,
            v,
            tau,
            self.distance,
        )
    }
}
