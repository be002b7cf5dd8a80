//! The column of a number in the rows of a motion: limits of tools, clearances, torques that fall with the
//! speed.
//!
//! Such a number is in the value g of a row and in its bound b, so that the distance changes by
//! $d\_\theta = \textrm{sign} (g\_\theta - b\_\theta)$, and its gradient by $g\_{z\theta}$:
//!
//! $$ F\_\theta = \sum \textrm{sign} \\, (\sigma d\_\theta g\_z - \eta g\_{z\theta}) $$
//!
//! $g\_\theta$, $b\_\theta$ and $g\_{z\theta}$ are differences of rows that are built anew.

use super::motion_derivative::MotionParameter;
use super::parameter_columns::Column;
use super::resolve::Resolve;
use super::resolve_error::ResolveError;
use crate::direct::limits::power::Powers;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::limits::tasks::Tasks;
use crate::direct::newton::interval::add_gradient;
use crate::direct::newton::point_terms::{Work, add_row};
use crate::direct::points::values::Points;
use crate::numerics::chain::dot;
use crate::problem::{Kept, MotionLimits, Problem, Shape};
use crate::task::build::TaskRows;

/// Step of differences, in parts of the number.
const STEP: f64 = 1e-4;
/// Numbers count as at least this large (m, rad, m/s, m/s^2).
const SMALLEST: f64 = 1e-2;
/// Factors of the values at 0, 1 and 2 steps in the difference of second order at 0: no number becomes
/// negative.
const FACTORS: [f64; 3] = [-1.5, 2.0, -0.5];

/// The rows along a motion with one value of a number.
struct WithNumber {
    points: Points,
    sides: Vec<Side>,
}

impl Resolve {
    /// Whether a number is one of rows along the motion.
    pub(super) fn is_of_rows(&self, number: &MotionParameter) -> bool {
        use MotionParameter as Of;
        match number {
            Of::KeepMax(_)
            | Of::ObstacleRadius(_)
            | Of::CollisionMargin
            | Of::CornerSpeed(_)
            | Of::NoLoadSpeed(_) => true,
            Of::TorqueMax(joint) => {
                self.limits.get(*joint).is_some_and(|limits| limits.speeds[1].is_finite())
            }
            _ => false,
        }
    }

    /// The column of such a number, from points that are contracted at this iterate.
    ///
    /// # Errors
    /// [`ResolveError::NoNumber`], [`ResolveError::Evaluation`].
    pub(super) fn row_column(
        &mut self,
        number: &MotionParameter,
        column: &mut Column,
    ) -> Result<(), ResolveError> {
        let mut changed = self.problem.clone();
        let value = number_in(&mut changed, number).copied().filter(|value| value.is_finite());
        let value = value.ok_or(no_number(number))?;
        let step = STEP * value.max(SMALLEST);
        let mut with = |steps: f64| -> Result<WithNumber, ResolveError> {
            if let Some(to) = number_in(&mut changed, number) {
                *to = value + steps * step;
            }
            let rows = TaskRows::new(&changed).map_err(|_| no_number(number))?;
            let powers = Powers::new(&changed);
            let mut tasks = Tasks::new(&rows, self.dof(), powers.rows());
            let mut points = self.interior.points.clone();
            if tasks.rows() != self.interior.model.rows() {
                return Err(no_number(number));
            }
            powers.contract(&mut points);
            tasks.contract(&self.interior.spline, &mut points)?;
            Ok(WithNumber { points, sides: powers.sides().iter().copied().chain(tasks.sides()).collect() })
        };
        let all = [with(0.0)?, with(1.0)?, with(2.0)?];
        let own = |at: usize, side: &Side| {
            all[at].sides.iter().find(|other| {
                (other.limited, other.joint, other.sign) == (side.limited, side.joint, side.sign)
            })
        };
        let bounds: Vec<f64> = self
            .interior
            .barrier
            .sides()
            .iter()
            .map(|side| match (number, side.limited) {
                (MotionParameter::TorqueMax(joint), Limited::Torque) if side.joint == *joint => -side.sign,
                (_, Limited::Task | Limited::ToolAcceleration | Limited::TorqueSpeed) => {
                    let bound = |at: usize| own(at, side).map_or(0.0, |other| other.bound);
                    (0..3).map(|at| FACTORS[at] * bound(at)).sum::<f64>() / step
                }
                _ => 0.0,
            })
            .collect();
        let slope = |of: &dyn Fn(&Points) -> f64| -> f64 {
            all.iter().zip(FACTORS).map(|(with, factor)| factor * of(&with.points)).sum::<f64>() / step
        };
        let (spline, points, barrier) =
            (&self.interior.spline, &self.interior.points, &self.interior.barrier);
        let n = spline.dof;
        column.reset(spline.unknowns.len(), spline.times.len());
        let mut work = Work::new(n, [0; 2]);
        for p in 0..points.count() {
            let (k, j) = spline.mesh.interval_of(p);
            work.z[0].fill(0.0);
            for ((at, side), bound) in barrier.at_point(p).zip(barrier.sides()).zip(&bounds) {
                if !barrier.is_on(at) || side.is_equation {
                    continue;
                }
                let row = side.joint;
                let (value, width) = match side.limited {
                    Limited::Torque => (0.0, 0),
                    Limited::Task => (slope(&|points| points.g(p)[row]), 2 * n),
                    Limited::TorqueSpeed | Limited::ToolAcceleration => {
                        (slope(&|points| points.h(p)[row]), 3 * n)
                    }
                    _ => continue,
                };
                let by = side.sign * (value - bound);
                column.cost -= barrier.multiplier[at] * by;
                let factor = -side.sign * barrier.curvature(at) * by;
                add_row(points, p, side, factor, &mut work.z[0]);
                for i in 0..width {
                    let entry = width * row + i;
                    let by_number = match side.limited {
                        Limited::Task => slope(&|points| points.g_x(p)[entry]),
                        _ => slope(&|points| points.h_z(p)[entry]),
                    };
                    work.z[0][i] += side.sign * barrier.multiplier[at] * by_number;
                }
            }
            let factors = spline.basis(k, j).in_time(1.0 / spline.clock(k));
            work.differentiate_in_time(points.z(p), spline, k, &factors);
            add_gradient(spline, k, &factors, &work.z[0], &mut column.unknowns);
            column.times[spline.mesh.phase(k)] += dot(&work.z[0][..3 * n], &work.z_t);
        }
        Ok(())
    }
}

fn no_number(number: &MotionParameter) -> ResolveError {
    let (table, entry) = match *number {
        MotionParameter::KeepMax(entry) => ("keep", entry),
        MotionParameter::ObstacleRadius(entry) => ("obstacle", entry),
        MotionParameter::CollisionMargin => ("collision", 0),
        MotionParameter::CornerSpeed(joint)
        | MotionParameter::NoLoadSpeed(joint)
        | MotionParameter::TorqueMax(joint) => ("limits", joint),
        _ => ("problem", 0),
    };
    ResolveError::NoNumber { table, entry }
}

/// Where a number stands in a problem, if it is positive and finite there; a margin may be zero.
fn number_in<'a>(problem: &'a mut Problem, number: &MotionParameter) -> Option<&'a mut f64> {
    match *number {
        MotionParameter::KeepMax(entry) => {
            let most = match &mut problem.task.keep.get_mut(entry)?.kept {
                Kept::Plane { distance, .. } | Kept::Line { distance, .. } => distance,
                Kept::Axis { angle, .. } | Kept::Orientation { angle, .. } => angle,
                Kept::Speed { max } | Kept::Acceleration { max } => max,
                Kept::Box { .. } => return None,
            };
            (*most > 0.0).then_some(most)
        }
        MotionParameter::ObstacleRadius(entry) => match &mut problem.task.obstacles.get_mut(entry)?.shape {
            Shape::Sphere { radius, .. } | Shape::Capsule { radius, .. } => Some(radius),
            Shape::Box { .. } | Shape::HalfSpace { .. } => None,
        },
        MotionParameter::CollisionMargin => problem.task.collision.as_mut().map(|bodies| &mut bodies.margin),
        MotionParameter::CornerSpeed(joint) => problem.limits.corner_speed.as_mut()?.get_mut(joint),
        MotionParameter::NoLoadSpeed(joint) => problem.limits.no_load_speed.as_mut()?.get_mut(joint),
        MotionParameter::TorqueMax(joint) => {
            // Those of the robot and of bounds too, as one list.
            if problem.limits.from_robot != Some(false) || problem.bounds.is_some() {
                let torques = problem.joint_limits().iter().map(|limits| limits.torque[1]).collect();
                let MotionLimits { torque_max, from_robot, .. } = &mut problem.limits;
                (*torque_max, *from_robot, problem.bounds) = (Some(torques), Some(false), None);
            }
            problem.limits.torque_max.as_mut()?.get_mut(joint)
        }
        _ => None,
    }
}
