//! What a run shows.

use crate::plant::Arm;
use costate::EvalError;
use costate_control::{ResolveStatus, Resolved};
use std::fmt;
use std::time::Duration;

/// Figures of a run.
#[derive(Clone, Debug)]
pub struct Report {
    name: String,
    rate: f64,
    /// Of each plan: as measured, and the least of all runs.
    times: Vec<Duration>,
    least: Vec<Duration>,
    pub steps: usize,
    /// Plans that did not stop because their time was over.
    pub in_time: usize,
    /// Plans that exceed a limit at a point, and by how much, in parts of its range.
    pub exceeding: usize,
    pub planned: f64,
    /// Largest violation along what the arm did, in parts of ranges: positions, rates, torques.
    pub violations: [f64; 3],
    /// Distance of the tool from the goal at the end (m).
    pub distance: f64,
}

impl Report {
    pub fn new(arm: &Arm, rate: f64) -> Self {
        Self {
            name: arm.robot.name().into(),
            rate,
            times: Vec::new(),
            least: Vec::new(),
            steps: 0,
            in_time: 0,
            exceeding: 0,
            planned: 0.0,
            violations: [0.0; 3],
            distance: f64::INFINITY,
        }
    }

    /// Adds a plan that took so long.
    pub fn add(&mut self, spent: Duration, plan: &Resolved) {
        self.times.push(spent);
        self.least.push(spent);
        self.steps += plan.iterations;
        self.in_time += usize::from(plan.status != ResolveStatus::OutOfTime);
        self.exceeding += usize::from(!plan.keeps_limits());
        self.planned = self.planned.max(plan.violation);
    }

    /// Looks at where the arm is.
    pub fn look(&mut self, arm: &mut Arm) -> Result<(), EvalError> {
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
        let goal = arm.goal(arm.time);
        self.distance =
            arm.position()?.iter().zip(goal).map(|(x, goal)| (x - goal).powi(2)).sum::<f64>().sqrt();
        Ok(())
    }

    /// Adds another run of the same: its plans are the same, unless their time was over, and where one of
    /// them took longer, another program ran.
    pub fn repeat(&mut self, other: &Self) {
        self.times.extend(&other.times);
        self.least.iter_mut().zip(&other.times).for_each(|(least, &time)| *least = (*least).min(time));
    }
}

/// The time (ms) below which this part of all plans took.
fn within(times: &[Duration], part: f64) -> f64 {
    let mut times = times.to_vec();
    times.sort_unstable();
    let last = times.len().saturating_sub(1);
    1e3 * times.get((part * last as f64).round() as usize).copied().unwrap_or_default().as_secs_f64()
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, rate, times, least, .. } = self;
        let (count, worst) = (least.len().max(1), within(least, 1.0));
        writeln!(f, "{name}, {count} plans at {rate:.0} Hz:")?;
        let held = 1e3 / worst;
        writeln!(
            f,
            "  holds {held:.0} Hz: its slowest plan takes {worst:.3} ms, the least of all runs of each plan"
        )?;
        let [median, most, slowest] = [0.5, 0.99, 1.0].map(|part| within(times, part));
        writeln!(f, "  measured: median {median:.3} ms, 99 % below {most:.3} ms, slowest {slowest:.3} ms")?;
        writeln!(f, "  Newton steps of a plan: {:.2} on average", self.steps as f64 / count as f64)?;
        writeln!(f, "  stopped because their time was over: {}", count - self.in_time.min(count))?;
        writeln!(f, "  plans beyond a limit: {}, at most {:.1e} of its range", self.exceeding, self.planned)?;
        let [q, v, tau] = self.violations;
        writeln!(
            f,
            "  arm beyond limits: positions {q:.1e}, rates {v:.1e}, torques {tau:.1e} of their ranges"
        )?;
        write!(f, "  arm at the end: {:.3} m from its goal", self.distance)
    }
}
