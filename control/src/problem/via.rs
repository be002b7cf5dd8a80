//! Places on the way, and what the robot carries from there on.

use super::obstacles::Shape;
use super::parts::BoundaryState;
use super::tools::ToolPose;
use costate::robot::LinkInertia;

/// A place that the motion passes between its start and its end. Needs
/// [`Method::Direct`](crate::Method::Direct).
///
/// Positions, rates and the time are those that are given; what is not given is free, and chosen so that the
/// whole motion costs the least. Vias divide the motion into phases, and the robot may carry something else
/// in each of them. Positions and rates do not jump at a via; where the payload does, the torques do too.
///
/// ```
/// use costate::robot::Robot;
/// use costate_control::{FinalTime, Objective, Payload, Problem, Solver, SolverOptions, Via};
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let tip = Payload::point("joint:elbow", 1.0, [1.0, 0.0, 0.0]);
/// let problem = Problem::rest_to_rest(robot, &[0.0, 0.0], &[1.5, 1.5], 2.0)
///     .with_time(FinalTime::Free { guess: 2.0 })
///     .with_cost(Objective::new(20.0, vec![1.0, 1.0]))
///     .with_via(Via::at(&[1.0, 0.2]).stopping().with_payload(tip));
/// let solution = Solver::new(&problem, SolverOptions::default())?.solve();
/// assert!(solution.motion.status.is_converged() && solution.trajectory.via_times.len() == 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Via {
    /// Positions (rad, m), n entries; those of free joints only shape the first guess. `None`: all are free,
    /// and the guess is between the places before and after.
    pub q: Option<Vec<f64>>,
    /// Rates (rad/s, m/s), n entries; `None`: all are free.
    pub v: Option<Vec<f64>>,
    /// Joints whose position is free.
    pub q_free: Vec<usize>,
    /// Joints whose rate is free.
    pub v_free: Vec<usize>,
    /// Whether the robot stops here: all rates are zero.
    pub stop: bool,
    /// The time from the start of the motion (s); `None` for a free one.
    pub time: Option<f64>,
    /// Where tools are. The joints must be free for it.
    pub tools: Vec<ToolPose>,
    /// What the robot carries from here on, beside what it has from the start; empty for nothing. `None`: the
    /// same as before.
    pub payload: Option<Vec<Payload>>,
}

impl Via {
    /// At these positions, n entries; with any rates, at any time.
    pub fn at(q: &[f64]) -> Self {
        Self { q: Some(q.to_vec()), ..Self::default() }
    }

    /// With a tool here; all joints are free.
    pub fn of_tool(pose: ToolPose) -> Self {
        Self { tools: vec![pose], ..Self::default() }
    }

    /// With the positions of these joints free.
    #[must_use]
    pub fn with_q_free(self, joints: &[usize]) -> Self {
        Self { q_free: joints.to_vec(), ..self }
    }

    /// With these rates, n entries.
    #[must_use]
    pub fn with_v(self, v: &[f64]) -> Self {
        Self { v: Some(v.to_vec()), ..self }
    }

    /// With the rates of these joints free.
    #[must_use]
    pub fn with_v_free(self, joints: &[usize]) -> Self {
        Self { v_free: joints.to_vec(), ..self }
    }

    /// The robot stops here.
    #[must_use]
    pub fn stopping(self) -> Self {
        Self { stop: true, ..self }
    }

    /// At this time from the start of the motion (s).
    #[must_use]
    pub fn with_time(self, time: f64) -> Self {
        Self { time: Some(time), ..self }
    }

    /// With one more tool here.
    #[must_use]
    pub fn with_tool(mut self, pose: ToolPose) -> Self {
        self.tools.push(pose);
        self
    }

    /// With this, and what was added before, to be carried from here on.
    #[must_use]
    pub fn with_payload(mut self, payload: Payload) -> Self {
        self.payload.get_or_insert_default().push(payload);
        self
    }

    /// With nothing to be carried from here on.
    #[must_use]
    pub fn without_payload(self) -> Self {
        Self { payload: Some(Vec::new()), ..self }
    }

    /// What is given and what is free, with zeros for what is free and has no guess.
    pub(crate) fn state(&self, n: usize) -> BoundaryState {
        let all = || (0..n).collect();
        let rates = if self.stop { Some(vec![0.0; n]) } else { self.v.clone() };
        BoundaryState {
            q: self.q.clone().unwrap_or_else(|| vec![0.0; n]),
            v: rates.clone().unwrap_or_else(|| vec![0.0; n]),
            a: None,
            q_free: if self.q.is_some() { self.q_free.clone() } else { all() },
            v_free: if rates.is_some() { self.v_free.clone() } else { all() },
        }
    }
}

/// A body that is fixed to a frame of the robot.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Payload {
    /// The frame.
    pub frame: String,
    /// Mass, centre of mass and inertia in the axes of the frame.
    pub inertia: LinkInertia,
    /// Its body, in the axes of the frame: it keeps away from obstacles, and from bodies of the robot where
    /// these are asked for. `None`: it is not checked for collisions.
    pub shape: Option<Shape>,
}

impl Payload {
    /// This body, fixed to a frame.
    pub fn new(frame: impl Into<String>, inertia: LinkInertia) -> Self {
        Self { frame: frame.into(), inertia, shape: None }
    }

    /// With this body in the axes of the frame: a sphere, a capsule or a box. It is called
    /// [`name`](Self::name).
    ///
    /// Clearances are those of spheres and capsules. Corners of a box count exactly with half-spaces; for all
    /// else capsules along its longest edge contain it, which protrude by less than a fifth of its second
    /// longest edge.
    #[must_use]
    pub fn with_shape(self, shape: Shape) -> Self {
        Self { shape: Some(shape), ..self }
    }

    /// The name of its body, for pairs and exceptions of [`Collision`](crate::Collision): "payload of tool0".
    pub fn name(&self) -> String {
        format!("payload of {}", self.frame)
    }

    /// A point mass (kg) at a place in a frame (m).
    pub fn point(frame: impl Into<String>, mass: f64, com: [f64; 3]) -> Self {
        Self::new(frame, LinkInertia::from_entries(mass, com, [0.0; 6]))
    }
}
