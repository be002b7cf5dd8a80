//! The controller: an optimal motion of the next second in each period.

use crate::plant::Arm;
use costate_control::{
    Budget, FinalTime, MachineCode, MotionLimits, Objective, Problem, Reference, Resolve, Resolved,
    SolverOptions, Task, ToolCost, ToolPose, ToolReference,
};
use std::error::Error;
use std::time::{Duration, Instant};

/// Length of the horizon (s), and its intervals.
const HORIZON: f64 = 1.0;
const INTERVALS: usize = 20;

/// Cost of the distance from the goal (1/s m^2), beside the torques in parts of their limits.
const DISTANCE_WEIGHT: f64 = 300.0;

/// Cost of the angle from the first orientation (1/s rad^2).
const ANGLE_WEIGHT: f64 = 10.0;

/// Knots of the goal's way over the horizon: the cubics between them leave it by less than 0.1 mm.
const KNOTS: usize = 9;

/// The part of the limits of rates that plans use: within a period a rate may exceed what holds at the points
/// of a plan.
const RATES: f64 = 0.95;

/// The gap of the barrier ends at a tenth of this, as a part of the cost: larger ones keep farther away from
/// limits and let the motion change faster.
const TOLERANCE: f64 = 0.03;

/// Plans, and gives torques.
#[derive(Debug)]
pub struct Controller {
    arm: Arm,
    motion: Resolve,
    period: f64,
    steps: usize,
    /// The longest time of a plan.
    longest: Option<Duration>,
    /// The last plan.
    pub last: Resolved,
    limits: Vec<[f64; 3]>,
    start: [Vec<f64>; 2],
    /// Where the goal will be.
    reference: Reference,
}

impl Controller {
    /// Solves the problem for the first time, which may take as long as it likes; later plans take at most so
    /// many Newton steps, and stop early enough to be ready after the part `share` of the period, if any.
    pub fn new(arm: &Arm, period: f64, steps: usize, share: Option<f64>) -> Result<Self, Box<dyn Error>> {
        let n = arm.q.len();
        // Torques count in parts of their limits.
        let limits = || arm.robot.independent_joints().map(|joint| joint.limits);
        let mut problem = Problem::rest_to_rest(arm.robot.clone(), &arm.q, &arm.q, HORIZON);
        // At rest wherever the arm is then: it can always stop.
        problem.end.q_free = (0..n).collect();
        let pose = ToolPose::of(arm.tool).with_rotation(arm.clone().orientation()?);
        let reference = way(arm);
        problem.task = Task::default()
            .with_tool_cost(ToolCost::new(pose, 0.0, ANGLE_WEIGHT))
            .with_reference(reference.clone());
        problem.limits =
            MotionLimits::default().with_v_max(limits().map(|limits| RATES * limits.velocity).collect());
        problem.time = FinalTime::Fixed(HORIZON);
        problem.cost = Objective::new(0.0, limits().map(|limits| 1.0 / limits.effort.powi(2)).collect());
        let options = SolverOptions::default()
            .with_tolerance(TOLERANCE)
            .with_nodes(3 * INTERVALS + 1)
            .with_machine_code(MachineCode::AtOnce);
        let mut motion = Resolve::new(&problem, options)?;
        let last = motion.solve()?;
        let limits = limits().map(|limits| [limits.lower, limits.upper, RATES * limits.velocity]).collect();
        let start = [arm.q.clone(), arm.v.clone()];
        let longest = share.map(|share| Duration::from_secs_f64(share * period));
        Ok(Self { arm: arm.clone(), motion, period, steps, longest, last, limits, start, reference })
    }

    /// Plans the motion of the next second from a measured state. How long it took.
    pub fn plan(&mut self, time: f64, q: &[f64], v: &[f64]) -> Result<Duration, Box<dyn Error>> {
        let began = Instant::now();
        // A measured state may be beyond a limit by a little.
        let [start, speed] = &mut self.start;
        for (i, [lower, upper, velocity]) in self.limits.iter().enumerate() {
            (start[i], speed[i]) = (q[i].clamp(*lower, *upper), v[i].clamp(-velocity, *velocity));
        }
        if time > 0.0 {
            self.motion.advance(self.period);
        }
        self.motion.set_start(start, speed)?;
        // The goal's way from here on, by the clock of the plan.
        place(&mut self.reference, &self.arm, time);
        self.motion.set_reference(0, &self.reference)?;
        let steps = Budget::steps(self.steps);
        let budget =
            self.longest.map_or(steps, |longest| steps.within(longest.saturating_sub(began.elapsed())));
        // Where the time is over, this is the best motion so far.
        self.last = self.motion.solve_again(budget)?;
        Ok(began.elapsed())
    }

    /// The torques of the plan at a time since the begin of the period.
    pub fn torques(&mut self, t: f64, torques: &mut [f64]) -> Result<(), Box<dyn Error>> {
        Ok(self.motion.torques_at(t, torques)?)
    }
}

/// The way of the goal over the first horizon.
fn way(arm: &Arm) -> Reference {
    let times = (0..KNOTS).map(|k| HORIZON * k as f64 / (KNOTS - 1) as f64).collect();
    let reference = ToolReference::of(arm.tool, times)
        .with_positions(vec![[0.0; 3]; KNOTS], DISTANCE_WEIGHT)
        .with_velocities(vec![[0.0; 3]; KNOTS]);
    let mut reference = reference.into();
    place(&mut reference, arm, 0.0);
    reference
}

/// The same over the horizon that begins at a time.
fn place(reference: &mut Reference, arm: &Arm, time: f64) {
    let Reference::Tool(tool) = reference else { return };
    for (k, t) in tool.times.iter().enumerate() {
        let (position, velocity) = arm.goal_with_rate(time + t);
        if let (Some(positions), Some(velocities)) = (&mut tool.positions, &mut tool.velocities) {
            (positions[k], velocities[k]) = (position, velocity);
        }
    }
}
