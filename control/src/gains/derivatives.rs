//! How a motion changes with its limits, in tables over time.

use super::error::GainError;
use crate::direct::{MotionDerivative, MotionParameter, Resolve, ResolveError};
use crate::problem::{Kept, Payload, Problem};
use serde::{Deserialize, Serialize};

/// Rows of a matrix.
pub(super) type Rows = Vec<Vec<f64>>;

/// How a motion changes with its limits.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct LimitDerivatives {
    /// Times of the rows (s): the points of the motion.
    pub t: Vec<f64>,
    /// One for each limit of each joint, for the power of all, for what tools keep, obstacles and the margin,
    /// and for each payload.
    pub parameters: Vec<LimitDerivative>,
}

/// How a motion changes with a limit, or with the mass of a payload; rows are at the same part of the time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct LimitDerivative {
    /// The limit as the key of a problem file, such as `limits.torque_max`, `keep.speed`, `obstacle.radius`,
    /// `collision.margin`; `robot.payload.mass` for a payload.
    pub name: String,
    /// Name of the joint, `all joints` for the power of all and the margin; of what a tool keeps, and of a
    /// payload, the frame; of an obstacle its name.
    pub joint: String,
    /// dJ/dtheta.
    pub cost: f64,
    /// dT/dtheta.
    pub final_time: f64,
    /// Derivatives of positions.
    pub q: Rows,
    /// Derivatives of velocities.
    pub v: Rows,
    /// Derivatives of torques and forces.
    pub tau: Rows,
}

/// Derivatives by all limits that the joints have, by the power of all, and by masses.
pub(super) fn parameters(
    problem: &Problem,
    payloads: &[Payload],
    motion: &mut Resolve,
) -> Result<Vec<LimitDerivative>, GainError> {
    type Limit = (&'static str, fn(usize) -> MotionParameter);
    const LIMITS: [Limit; 10] = [
        ("limits.q_min", MotionParameter::PositionMin),
        ("limits.q_max", MotionParameter::PositionMax),
        ("limits.v_max", MotionParameter::VelocityMax),
        ("limits.a_max", MotionParameter::AccelerationMax),
        ("limits.torque_max", MotionParameter::TorqueMax),
        ("limits.power_max", MotionParameter::PowerMax),
        ("limits.jerk_max", MotionParameter::JerkMax),
        ("limits.torque_rate_max", MotionParameter::TorqueRateMax),
        ("limits.corner_speed", MotionParameter::CornerSpeed),
        ("limits.no_load_speed", MotionParameter::NoLoadSpeed),
    ];
    let mut asked: Vec<(&'static str, String, MotionParameter)> = Vec::new();
    for (index, joint) in problem.robot.independent_joints().enumerate() {
        asked.extend(LIMITS.map(|(name, parameter)| (name, joint.name.clone(), parameter(index))));
    }
    asked.push(("limits.total_power_max", "all joints".into(), MotionParameter::TotalPowerMax));
    for (k, keep) in problem.task.keep.iter().enumerate() {
        let name = match keep.kept {
            Kept::Plane { .. } | Kept::Line { .. } => "keep.distance",
            Kept::Axis { .. } | Kept::Orientation { .. } => "keep.angle",
            Kept::Speed { .. } => "keep.speed",
            Kept::Acceleration { .. } => "keep.acceleration",
            Kept::Box { .. } => continue,
        };
        asked.push((name, keep.tool.frame.clone(), MotionParameter::KeepMax(k)));
    }
    for (k, obstacle) in problem.task.obstacles.iter().enumerate() {
        asked.push(("obstacle.radius", obstacle.name.clone(), MotionParameter::ObstacleRadius(k)));
    }
    if problem.task.collision.is_some() {
        asked.push(("collision.margin", "all joints".into(), MotionParameter::CollisionMargin));
    }
    let mass =
        |of: &Payload| ("robot.payload.mass", of.frame.clone(), MotionParameter::PayloadMass(of.clone()));
    asked.extend(payloads.iter().map(mass));
    let mut all = Vec::new();
    for (name, joint, parameter) in asked {
        let MotionDerivative { cost, final_time, states, torques, .. } =
            match motion.derivative_by(&parameter) {
                Ok(Some(found)) => found,
                // Nor where no joint moves a payload, or where it has no mass, nor of boxes and equations.
                Ok(None)
                | Err(
                    ResolveError::NoLimit { .. }
                    | ResolveError::NoNumber { .. }
                    | ResolveError::Payload(_)
                    | ResolveError::NoMass,
                ) => continue,
                Err(error) => return Err(error.into()),
            };
        let n = motion.dof();
        let m = n * states.len() / torques.len();
        let rows = |first: usize| states.chunks_exact(m).map(|x| x[first..first + n].to_vec()).collect();
        all.push(LimitDerivative {
            name: name.into(),
            joint,
            cost,
            final_time,
            q: rows(0),
            v: rows(n),
            tau: torques.chunks_exact(n).map(<[f64]>::to_vec).collect(),
        });
    }
    Ok(all)
}
