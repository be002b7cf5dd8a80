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
use super::row_differences::RowDifference;
use crate::direct::limits::power::Powers;
use crate::direct::limits::side::{Limited, Side};
use crate::direct::limits::tasks::Tasks;
use crate::direct::newton::interval::add_gradient;
use crate::direct::newton::point_terms::Work;
use crate::direct::newton::side_terms::add_row;
use crate::direct::points::values::Points;
use crate::numerics::chain::dot;
use crate::problem::{Kept, MotionLimits, Problem, Shape};
use costate::matrix::add_scaled;

/// Derivatives of the rows along a motion, and of the bounds of limits, by a number.
struct Slopes {
    /// One for each limit at a point.
    bounds: Vec<f64>,
    g: Vec<f64>,
    g_x: Vec<f64>,
    h: Vec<f64>,
    h_z: Vec<f64>,
}

impl Slopes {
    fn new(points: &Points, limits: usize) -> Self {
        let like = |values: &[f64]| vec![0.0; values.len()];
        let (g, g_x) = (like(&points.g), like(&points.g_x));
        Self { bounds: vec![0.0; limits], g, g_x, h: like(&points.h), h_z: like(&points.h_z) }
    }

    /// Adds a multiple of rows with another value of the number, and of their bounds.
    fn add(&mut self, factor: f64, points: &Points, bounds: impl Iterator<Item = f64>) {
        let lists = [
            (&mut self.g, &points.g),
            (&mut self.g_x, &points.g_x),
            (&mut self.h, &points.h),
            (&mut self.h_z, &points.h_z),
        ];
        for (sums, values) in lists {
            add_scaled(sums, factor, values);
        }
        self.bounds.iter_mut().zip(bounds).for_each(|(sum, bound)| *sum += factor * bound);
    }

    /// What the value that a side limits at a point, and its gradient by (q, v) or z, change by; `None` for
    /// what does not depend on such a number.
    fn of_side(&self, side: &Side, points: &Points, p: usize) -> Option<(f64, &[f64])> {
        let n = points.dof;
        let (values, gradients, row, width) = match side.limited {
            Limited::Torque => return Some((0.0, &[])),
            Limited::Task => (&self.g, &self.g_x, points.rows * p + side.joint, 2 * n),
            Limited::TorqueSpeed | Limited::ToolAcceleration => {
                (&self.h, &self.h_z, points.powers * p + side.joint, 3 * n)
            }
            _ => return None,
        };
        Some((values[row], &gradients[width * row..][..width]))
    }
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
        let slopes = self.row_slopes(number)?;
        let (spline, points, barrier) =
            (&self.interior.spline, &self.interior.points, &self.interior.barrier);
        column.reset(spline.unknowns.len(), spline.times.len());
        let mut work = Work::new(spline.dof, [0; 2]);
        for p in 0..points.count() {
            let (k, j) = spline.mesh.interval_of(p);
            work.z[0].fill(0.0);
            for ((at, side), bound) in barrier.at_point(p).zip(barrier.sides()).zip(&slopes.bounds) {
                if !barrier.is_on(at) || side.is_equation {
                    continue;
                }
                let Some((value, gradient)) = slopes.of_side(side, points, p) else { continue };
                let by = side.sign * (value - bound);
                column.cost -= barrier.multiplier[at] * by;
                let factor = -side.sign * barrier.curvature(at) * by;
                add_row(points, p, side, factor, &mut work.z[0]);
                add_scaled(&mut work.z[0], side.sign * barrier.multiplier[at], gradient);
            }
            let factors = spline.factors(k, j);
            work.differentiate_in_time(points.z(p), spline, k, &factors);
            add_gradient(spline, k, &factors, &work.z[0], &mut column.unknowns);
            column.times[spline.mesh.phase(k)] += dot(&work.z[0][..3 * spline.dof], &work.z_t);
        }
        Ok(())
    }

    /// The derivatives of rows and bounds by a number.
    fn row_slopes(&self, number: &MotionParameter) -> Result<Slopes, ResolveError> {
        let mut problem = self.problem.clone();
        if let MotionParameter::TorqueMax(_) = number {
            list_torques(&mut problem);
        }
        let (interior, barrier) = (&self.interior, &self.interior.barrier);
        let value = number_in(&mut problem, number).copied().filter(|value| value.is_finite());
        let value = value.ok_or(no_number(number))?;
        let mut points = interior.points.clone();
        let mut slopes = Slopes::new(&points, barrier.sides().len());
        RowDifference::above(value).take_rows(
            problem,
            |problem, by| {
                *number_in(problem, number).ok_or(no_number(number))? = value + by;
                Ok(())
            },
            |_, _| no_number(number),
            |problem, rows, factor| {
                let powers = Powers::new(problem);
                let mut tasks = Tasks::new(&rows, self.dof(), powers.rows());
                if tasks.rows() != interior.model.rows() {
                    return Ok(false);
                }
                powers.contract(&mut points);
                tasks.contract(&interior.spline, &mut points)?;
                let sides: Vec<Side> = powers.sides().iter().copied().chain(tasks.sides()).collect();
                let key = |side: &Side| (side.limited, side.joint, side.sign);
                let bound = |side: &Side| {
                    let own = sides.iter().find(|other| key(other) == key(side));
                    own.map_or(0.0, |own| own.bound)
                };
                slopes.add(factor, &points, barrier.sides().iter().map(bound));
                Ok(true)
            },
        )?;
        if let MotionParameter::TorqueMax(joint) = number {
            for (slope, side) in slopes.bounds.iter_mut().zip(barrier.sides()) {
                if side.limited == Limited::Torque && side.joint == *joint {
                    *slope = -side.sign;
                }
            }
        }
        Ok(slopes)
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
        MotionParameter::TorqueMax(joint) => problem.limits.torque_max.as_mut()?.get_mut(joint),
        _ => None,
    }
}

/// Writes the largest torques of all joints into the problem as one list, those of the robot and of bounds
/// too.
fn list_torques(problem: &mut Problem) {
    if problem.limits.from_robot != Some(false) || problem.bounds.is_some() {
        let torques = problem.joint_limits().iter().map(|limits| limits.torque[1]).collect();
        let MotionLimits { torque_max, from_robot, .. } = &mut problem.limits;
        (*torque_max, *from_robot, problem.bounds) = (Some(torques), Some(false), None);
    }
}
