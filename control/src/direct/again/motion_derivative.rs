//! How an optimal motion and its cost change with limits and with what the robot carries.

use super::parameter_columns::Column;
use super::resolve::Resolve;
use super::resolve_error::ResolveError;
use crate::direct::points::generic_points::RobotPoints;
use crate::direct::points::phases::PhaseDynamics;
use crate::direct::points::values::PointDynamics;
use crate::numerics::chain::dot;
use crate::problem::Payload;
use costate::robot::{LinkInertia, Robot};

/// A number that an optimal motion depends on. Joints are counted from 0.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(clippy::large_enum_variant, reason = "a parameter is named once for each derivative")]
pub enum MotionParameter {
    /// The least position of a joint (rad, m).
    PositionMin(usize),
    /// The largest position of a joint (rad, m).
    PositionMax(usize),
    /// The largest rate of a joint, in both directions (rad/s, m/s).
    VelocityMax(usize),
    /// The largest acceleration of a joint, in both directions (rad/s^2, m/s^2).
    AccelerationMax(usize),
    /// The largest torque or force of a joint, in both directions (N m, N); where it falls with the speed the
    /// largest one of all speeds.
    TorqueMax(usize),
    /// The speed above which the torque of a joint falls (rad/s, m/s).
    CornerSpeed(usize),
    /// The speed at which a joint has no torque any more (rad/s, m/s).
    NoLoadSpeed(usize),
    /// The largest power of a joint, in both directions (W).
    PowerMax(usize),
    /// The largest power of all joints together, in both directions (W); of a robot with one joint ask for
    /// [`PowerMax`](Self::PowerMax).
    TotalPowerMax,
    /// The largest jerk of a joint, in both directions (rad/s^3, m/s^3).
    JerkMax(usize),
    /// The largest rate of the torque of a joint, in both directions (N m/s, N/s).
    TorqueRateMax(usize),
    /// What an entry of [`Task::keep`](crate::Task::keep) allows at most: a distance, an angle, a speed or an
    /// acceleration (m, rad, m/s, m/s^2). Not a box, nor an equation.
    KeepMax(usize),
    /// The radius of a sphere or capsule of [`Task::obstacles`](crate::Task::obstacles) (m).
    ObstacleRadius(usize),
    /// The distance that bodies keep, [`Collision::margin`](crate::Collision::margin) (m).
    CollisionMargin,
    /// The mass of a body that the robot carries, with its centre and the shape of its inertia (kg).
    PayloadMass(Payload),
}

/// Derivatives of an optimal motion by one of its [numbers](MotionParameter), at the points of
/// [`Feedback`](super::feedback::Feedback); from the factorised equations of Newton's method, without solving
/// again.
///
/// They are those of the barrier problem: the motion that is optimal with -mu times the logarithms of slacks
/// added to its cost, on the same mesh, at the mu with which it was solved. So they belong to a solved
/// motion, and say as much about another one as that has the same mu and mesh:
///
/// - The iteration ends when the sum of all products of slacks and multipliers is small, not when they are
///   equal. The derivatives by limits of torques of a two-link arm are those of solving again to 1e-5 with a
///   [tolerance](crate::SolverOptions::tolerance) of 1e-6; with 1e-4 they are off by up to a tenth.
/// - They hold for changes by which no point reaches or leaves a limit. An arc at a limit of the rate that
///   becomes shorter passes points of the mesh, one after the other: states and torques change in steps that
///   derivatives do not see. With a tolerance of 1e-10 and a change of 1e-4 rad/s they agree to 2e-3, with a
///   tolerance of 1e-6 torques are off by up to 70 %.
/// - The cost hardly sees either of the two: of the same arm its derivative agrees to 1e-4 with a tolerance
///   of 1e-6. Those by masses agree to 1e-4 for torques and to 1e-6 for all else with one of 1e-10.
/// - What tools, obstacles and torques that fall with the speed make of a motion at constant unknowns is
///   differenced, to the second order over a ten thousandth of the number. Where the closest places of two
///   bodies jump to an edge within that, derivatives are in between.
/// - On another mesh torques next to jumps are others: nodes lie where torques jump, and move with limits.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct MotionDerivative {
    /// dJ/dtheta: minus the sum of multipliers times changes of distances; with a mass y_p . tau_m.
    pub cost: f64,
    /// dT/dtheta; zero where it is fixed.
    pub final_time: f64,
    /// Derivatives of the state at each point at the same part of the time of its phase: (q, v), 2n each;
    /// with continuous accelerations (q, v, a), 3n each.
    pub states: Vec<f64>,
    /// The same of the torques and forces, n each.
    pub torques: Vec<f64>,
}

impl Resolve {
    /// The derivatives of the motion by a number. The equations of its last Newton step are factorised anew.
    ///
    /// `None` where the matrix is not positive definite, as [`feedback`](Self::feedback).
    ///
    /// # Errors
    /// [`ResolveError::NotSolved`]; [`ResolveError::NoLimit`]: a joint without this limit;
    /// [`ResolveError::NoNumber`]: nothing kept, or no obstacle, with such a number;
    /// [`ResolveError::Payload`]: a body that the robot does not take, or without mass;
    /// [`ResolveError::Evaluation`].
    pub fn derivative_by(
        &mut self,
        parameter: &MotionParameter,
    ) -> Result<Option<MotionDerivative>, ResolveError> {
        if !self.started {
            return Err(ResolveError::NotSolved);
        }
        self.factorised = self.interior.linearise()?;
        if !self.factorised {
            return Ok(None);
        }
        let mut column = Column::default();
        let mut heavier = None;
        match parameter {
            MotionParameter::PayloadMass(payload) => {
                let unit = one_kilogram(&payload.inertia).ok_or(ResolveError::NoMass)?;
                let heavy = |robot: &Robot| robot.with_payload(&payload.frame, &unit);
                let robots: Result<Vec<Robot>, _> = self.robots.iter().map(heavy).collect();
                let robots = robots.map_err(|error| ResolveError::Payload(error.to_string()))?;
                let mut points = self.interior.points.clone();
                PhaseDynamics::new(&robots, RobotPoints::new).contract(&mut points)?;
                points.evaluate_rates(&self.interior.spline);
                self.interior.mass_column(&points, &mut column);
                heavier = Some(points);
            }
            number if self.is_of_rows(number) => self.row_column(number, &mut column)?,
            limit => {
                let (sides, _) = self.sides_of(limit)?;
                let moves = if matches!(limit, MotionParameter::PositionMin(_)) { -1.0 } else { 1.0 };
                self.interior.limit_column(|side| if sides.has(side) { moves } else { 0.0 }, &mut column);
            }
        }
        self.interior.respond_to(&mut column);
        let mut found = MotionDerivative {
            cost: column.cost,
            final_time: self.interior.time_steps[0].iter().sum(),
            ..MotionDerivative::default()
        };
        let n = self.dof();
        for p in 0..self.interior.points.count() {
            self.interior.change_of_z(p, 0);
            let (dz, points) = (&self.interior.trial.dz, &self.interior.points);
            found.states.extend_from_slice(&dz[..self.interior.spline.node()]);
            for (i, row) in points.tau_z(p).chunks_exact(3 * n).enumerate() {
                let own = heavier.as_ref().map_or(0.0, |heavier| heavier.tau(p)[i] - points.tau(p)[i]);
                found.torques.push(dot(row, dz) + own);
            }
        }
        Ok(Some(found))
    }
}

/// A body of the same shape with a mass of 1 kg.
fn one_kilogram(body: &LinkInertia) -> Option<LinkInertia> {
    let part = 1.0 / body.mass;
    (part > 0.0 && part.is_finite()).then(|| LinkInertia {
        mass: 1.0,
        com: body.com,
        inertia: body.inertia * part,
    })
}
