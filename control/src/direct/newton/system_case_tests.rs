//! A random motion with limits, rows and costs of all kinds.

use super::super::System;
use crate::direct::limits::barrier::Barrier;
use crate::direct::limits::ends::Ends;
use crate::direct::limits::model::Model;
use crate::direct::limits::power::Powers;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::limits::tasks::Tasks;
use crate::direct::motion::mesh::Mesh;
use crate::direct::motion::shape::Shape;
use crate::direct::motion::spline::Spline;
use crate::direct::newton::side_terms::weigh;
use crate::direct::points::generic_points::RobotPoints;
use crate::direct::points::phases::PhaseDynamics;
use crate::direct::points::running::Running;
use crate::direct::points::values::Points;
use crate::problem::running_cost::{RunningCost, UserTerm};
use crate::problem::{
    FinalTime, JointReference, Keep, Kept, MotionLimits, Objective, Payload, Penalty, Problem, Task, Tool,
    ToolCost, ToolPose, ToolReference, Via,
};
use crate::task::build::TaskRows;
use costate::robot::Robot;
use costate::scalar::Scalar;
use nalgebra::Rotation3;

/// A term that couples positions and rates.
struct Coupled;

impl RunningCost for Coupled {
    fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
        q[0].sin_cos().0 * v[1] * v[1] + q[1] * v[0]
    }
}

/// Rows of all kinds: an equation and limits along the motion, one of them on the speed and one on the
/// acceleration; equations at the end; costs of a tool, and of references of joints and of a tool, with knots
/// between the points.
fn task() -> Task {
    let tool = || Tool::new("joint:elbow").with_offset([0.3, 0.1, 0.0]);
    let keep = |kept| Keep::new(tool(), kept);
    let free = f64::INFINITY;
    let times = || vec![0.07, 0.9, 2.3];
    let rows = || vec![vec![0.3, -0.2], vec![0.9, 0.4], vec![-0.5, 0.1]];
    let turns = [0.2, 1.1, 0.4].map(|angle| Rotation3::from_euler_angles(0.3, -0.2, angle)).to_vec();
    Task::default()
        .with_reference(JointReference::new(times(), rows(), vec![1.2, 0.7]).with_velocities(rows()))
        .with_reference(
            ToolReference::of(tool(), times())
                .with_positions(vec![[0.1, free, 0.0], [0.6, free, 0.3], [0.2, free, 0.0]], 2.0)
                .with_orientations(turns, 0.8),
        )
        .with_end_tool(ToolPose::of(tool()).with_position([free, 0.3, free]))
        .with_tool_cost(ToolCost::new(ToolPose::of(tool()).with_position([0.1, 0.2, free]), 1.5, 1.0))
        .with_keep(keep(Kept::Plane { through: [0.1; 3], normal: [1.0, 0.5, 0.0], distance: 0.0 }))
        .with_keep(keep(Kept::Box { min: [-0.1, -0.2, -free], max: [0.3, 0.4, free] }))
        .with_keep(keep(Kept::Speed { max: 1.0 }))
        .with_keep(keep(Kept::Acceleration { max: 2.0 }))
}

/// A random motion with random slacks and multipliers.
pub struct Case {
    pub spline: Spline,
    pub barrier: Barrier,
    /// Subtracted from the distances.
    pub shift: Vec<f64>,
    pub running: Running,
    pub ends: Ends,
    pub model: Model<PhaseDynamics<RobotPoints>>,
    pub points: Points,
    pub system: System,
}

/// What a motion is between its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    OnePhase,
    /// A via with a given position and rate, a payload and a tool; then one with a given time: T_1 and T_3
    /// are free.
    Vias,
    /// Two phases in a given time; what is free at the start is free at the end, too.
    Periodic,
}

impl Kind {
    pub const ALL: [Self; 3] = [Self::OnePhase, Self::Vias, Self::Periodic];

    fn apply(self, problem: Problem) -> Problem {
        let tip = || Payload::point("joint:elbow", 0.6, [0.9, 0.1, 0.0]);
        match self {
            Self::OnePhase => problem,
            Self::Vias => {
                let tool = Tool::new("joint:elbow").with_offset([0.2, 0.0, 0.0]);
                let pose = ToolPose::of(tool).with_position([0.2, f64::INFINITY, f64::INFINITY]);
                let first = Via::at(&[0.2, 0.4]).with_q_free(&[1]).with_v(&[0.3, 0.7]).with_v_free(&[1]);
                problem
                    .with_via(first.with_payload(tip()).with_tool(pose))
                    .with_via(Via::at(&[0.5, 0.1]).with_time(2.2).without_payload())
            }
            Self::Periodic => {
                let via = Via::at(&[0.2, 0.4]).with_payload(tip());
                let start = problem.start.clone().with_q_free(&[0]);
                let problem = problem.with_start(start).with_via(via).with_time(FinalTime::Fixed(2.2));
                problem.with_period(vec![0.3, 0.0])
            }
        }
    }

    fn nodes(self) -> Vec<f64> {
        match self {
            Self::OnePhase => vec![0.0, 0.3, 0.55, 1.0],
            Self::Vias => vec![0.0, 0.3, 1.0, 1.4, 1.7, 2.0, 3.0],
            Self::Periodic => vec![0.0, 0.3, 1.0, 1.4, 2.0],
        }
    }

    fn times(self) -> Vec<f64> {
        match self {
            Self::OnePhase => vec![1.3],
            Self::Vias => vec![1.3, 0.9, 0.6],
            Self::Periodic => vec![1.3, 0.9],
        }
    }
}

impl Case {
    pub fn new(shape: Shape, kind: Kind) -> Self {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let mut problem = Problem::rest_to_rest(robot, &[0.1, 0.2], &[0.5, -0.3], 1.3);
        problem.time = FinalTime::Free { guess: 1.3 };
        problem.cost =
            Objective::new(0.7, vec![1.2, 0.4]).with_energy(vec![0.9, 2.0]).with_energy_smoothing(0.3);
        problem.limits = MotionLimits::none()
            .with_power_max(vec![1.5, 2.0])
            .with_total_power_max(2.5)
            .with_torque_max(vec![1.5, 2.0])
            .with_torque_speed(vec![0.5, f64::INFINITY], vec![2.0, f64::INFINITY]);
        problem.penalty = Some(Penalty { q_max: Some(vec![0.1, 0.2]), ..Penalty::new(3.0) });
        problem.terms = vec![UserTerm::new(Coupled)];
        // Rates that are given and not zero move with T; a free position and a free rate.
        problem.start.v = vec![0.4, -0.8];
        problem.end.v = vec![0.3, 0.5];
        problem.start.v_free = vec![1];
        problem.end.q_free = vec![0];
        let mut kinds = vec![Limited::Position, Limited::Rate, Limited::Acceleration, Limited::Torque];
        if shape.is_smooth() {
            problem.cost = problem.cost.with_jerk(vec![0.02, 0.05]).with_torque_rate(vec![0.3, 0.0]);
            // Accelerations that are given change with T, and not in proportion to it.
            problem.start.a = Some(vec![0.7, -0.4]);
            kinds.extend([Limited::Jerk, Limited::TorqueRate]);
        }
        let problem = &mut kind.apply(problem);
        assert_eq!(Shape::of(problem), shape);
        let pair = |kind| (0..2).flat_map(move |joint| Side::pair(kind, joint, -1.5, 2.0 + joint as f64));
        let sides: Vec<Side> = kinds.into_iter().flat_map(pair).collect();
        let mut random = fastrand::Rng::with_seed(11);
        let mesh = Mesh::new(kind.nodes(), shape);
        let unknowns = (0..Spline::size(2, mesh.intervals(), shape)).map(|_| random.f64() - 0.5).collect();
        let spline = Spline { dof: 2, mesh, unknowns, times: kind.times(), ..Spline::default() };
        problem.task = task();
        let ends = Ends::new(problem);
        let task = TaskRows::new(problem).unwrap();
        let powers = Powers::new(problem);
        let tasks = Tasks::new(&task, 2, powers.rows());
        let sides = sides.into_iter().chain(powers.sides().iter().copied()).chain(tasks.sides());
        let mut barrier = Barrier::new(sides.collect(), &tasks.end_sides());
        barrier.stiffness = 3.0;
        barrier.resize(&spline.mesh, &ends);
        let count = barrier.count();
        for at in 0..count {
            let on = barrier.weight[at] > 0.0;
            let is_equation = barrier.side(at).is_equation;
            barrier.slack[at] = match on {
                true if is_equation => 0.0,
                true => 0.2 + random.f64(),
                false => f64::INFINITY,
            };
            barrier.multiplier[at] = if on { 0.2 + random.f64() } else { 0.0 };
        }
        let mut points = Points::default();
        let dynamics = PhaseDynamics::new(&problem.robots(), RobotPoints::new);
        let model = Model { dynamics, tasks, powers };
        model.resize(&spline, &mut points);
        Self {
            running: Running::new(problem, &task),
            ends,
            shift: vec![0.0; count],
            system: System::new(2, shape, model.rows()),
            model,
            spline,
            barrier,
            points,
        }
    }

    /// The same whose limits of what may jump are those of coefficients.
    pub fn with_hulls(shape: Shape, kind: Kind) -> Self {
        let mut case = Self::new(shape, kind);
        let sides: Vec<Side> = case.barrier.all_sides().copied().collect();
        let jumps = |i: &usize| sides[*i].limited.jumps(shape) && !sides[*i].is_equation;
        let hulls = (0..sides.len()).filter(jumps).filter(|&i| case.barrier.take_hull(i)).count();
        assert!(hulls >= 4, "{hulls}");
        case
    }

    /// Whether an unknown is given, or tied to another one.
    pub fn is_removed(&self, at: usize) -> bool {
        let mut removed = self.ends.removed(&self.spline.mesh);
        removed.any(|(k, i)| self.spline.node() * k + i == at)
    }

    /// Number of unknowns of the equations.
    pub fn size(&self) -> usize {
        self.spline.unknowns.len() + self.ends.shared()
    }

    /// Adds to an unknown; those after the last one are shared.
    pub fn shifted(&mut self, at: usize, step: f64) {
        let last = self.spline.unknowns.len();
        if at < last {
            self.spline.unknowns[at] += step;
            return;
        }
        let shared: Vec<f64> = (last..self.size()).map(|i| if i == at { step } else { 0.0 }).collect();
        let (mut unknowns, mut times) = (vec![0.0; last], Vec::new());
        self.ends.expand(&self.spline.mesh, &shared, &mut unknowns, &mut times);
        self.spline.unknowns.iter_mut().zip(&unknowns).for_each(|(to, step)| *to += step);
        self.spline.times.iter_mut().zip(&times).for_each(|(to, step)| *to += step);
    }

    /// Evaluates the points and their distances.
    pub fn evaluate(&mut self) {
        self.model.evaluate(&self.spline, &mut self.points).unwrap();
        let mut distance = std::mem::take(&mut self.barrier.distance);
        self.barrier.measure(&self.spline, &self.points, &mut distance);
        self.barrier.distance = distance;
        self.barrier.distance.iter_mut().zip(&self.shift).for_each(|(d, shift)| *d -= shift);
    }

    /// The cost, `-sum eta d + 1/2 sum sigma d^2`; and `-sum w d / s`.
    pub fn values(&mut self) -> [f64; 2] {
        self.evaluate();
        let mut values = [self.running.cost(&self.spline, &self.points), 0.0];
        for (at, (d, s)) in self.barrier.distance.iter().zip(&self.barrier.slack).enumerate() {
            if s.is_finite() {
                let eta = self.barrier.multiplier[at];
                values[0] += -eta * d + 0.5 * self.barrier.curvature(at) * d * d;
                values[1] -= if *s > 0.0 { self.barrier.weight[at] / s * d } else { 0.0 };
            }
        }
        values
    }

    pub fn assemble(&mut self) {
        self.evaluate();
        weigh(&self.spline, &mut self.points, &self.barrier, &self.running);
        self.model.contract(&self.spline, &mut self.points).unwrap();
        self.system.assemble(&self.spline, &self.points, &self.barrier, &mut self.running, &self.ends);
    }

    /// A part of the gradient, with that in the shared unknowns.
    pub fn gradient(&self, part: usize) -> Vec<f64> {
        [&self.system.gradient[part][..], &self.system.shared_gradient[part]].concat()
    }

    /// An entry of the bordered matrix.
    pub fn entry(&self, i: usize, j: usize) -> f64 {
        let (size, border) = (self.spline.unknowns.len(), &self.system.border);
        match (i >= size, j >= size) {
            (true, true) => border.corner(i - size, j - size),
            (true, false) => border.column(i - size)[j],
            (false, true) => border.column(j - size)[i],
            (false, false) => self.system.matrix.entry(i, j),
        }
    }
}
