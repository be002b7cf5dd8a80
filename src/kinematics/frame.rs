//! Pose, twist, acceleration and Jacobian of a frame.

use super::body::Body;
use super::columns::{Column, Point};
use super::{Kinematics, ReferenceFrame, put};
use crate::error::EvalError;
use crate::matrix::Matrix;
use crate::robot::TreeFrame;
use crate::scalar::Scalar;
use crate::spatial::{Force, Motion, Vec3};

/// Orientation and position of a frame in the world.
#[derive(Clone, Copy, Debug)]
pub struct Pose<S> {
    /// R, row by row: its columns are the axes of the frame, seen in the world.
    pub rotation: [[S; 3]; 3],
    /// Origin (m).
    pub position: [S; 3],
}

/// The rotation of a frame, by rows, its origin, and the motion of its link.
#[derive(Clone, Copy, Debug)]
pub(super) struct Placed<S> {
    pub frame: Body<S>,
    pub point: Point<S>,
}

impl<S: Scalar> Kinematics<S> {
    /// A frame, its axes and its origin; the position and motion of the body are those of its link.
    pub(super) fn placed(&self, frame: usize) -> Result<(TreeFrame, Placed<S>), EvalError> {
        let frame = self.frame(frame)?;
        Ok((frame, self.locate(&frame)))
    }

    /// The same of a frame of the tree.
    pub(super) fn locate(&self, frame: &TreeFrame) -> Placed<S> {
        let body = self.carrier(frame).copied().unwrap_or_else(Body::still);
        let (rotation, translation) = (&frame.placement.rotation, frame.placement.translation);
        let axes = [0, 1, 2].map(|k| [rotation[(0, k)], rotation[(1, k)], rotation[(2, k)]]);
        let rows = body.rows.map(|row| {
            let [x, y, z] = axes.map(|axis| row.dot_constant(axis));
            Vec3::new(x, y, z)
        });
        let point = Point::on(&body, body.constant_in_world(translation.into()));
        Placed { frame: Body { rows, ..body }, point }
    }

    /// Orientation and position of a frame in the world.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn pose(&self, frame: usize) -> Result<Pose<S>, EvalError> {
        let (_, Placed { frame, point }) = self.placed(frame)?;
        Ok(Pose { rotation: frame.rows.map(Vec3::to_array), position: point.position.to_array() })
    }

    /// Angular and linear velocity of a frame (rad/s, m/s): `V = J v`.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn twist(&self, frame: usize, axes: ReferenceFrame) -> Result<Motion<S>, EvalError> {
        let (_, Placed { frame, point }) = self.placed(frame)?;
        let (angular, linear) = (frame.angular, point.velocity);
        Ok(match axes {
            ReferenceFrame::Local => {
                Motion { angular: frame.in_frame(angular), linear: frame.in_frame(linear) }
            }
            ReferenceFrame::World => Motion { angular, linear: linear - angular.cross(point.position) },
            ReferenceFrame::LocalWorldAligned => Motion { angular, linear },
        })
    }

    /// The derivative in time of the [`twist`](Self::twist) (rad/s^2, m/s^2): `J a + Jdot v`.
    ///
    /// After [`set_state`](Self::set_state) it is the bias `Jdot v`. Only for
    /// [`LocalWorldAligned`](ReferenceFrame::LocalWorldAligned) is the linear part the acceleration of the
    /// origin of the frame; for the other two it is a spatial acceleration.
    ///
    /// # Errors
    /// See [`Kinematics`].
    pub fn acceleration(&self, frame: usize, axes: ReferenceFrame) -> Result<Motion<S>, EvalError> {
        let (_, Placed { frame, point }) = self.placed(frame)?;
        let (turning, angular, linear) = (frame.angular, frame.angular_rate, point.acceleration);
        let carried = turning.cross(point.velocity);
        Ok(match axes {
            ReferenceFrame::Local => {
                Motion { angular: frame.in_frame(angular), linear: frame.in_frame(linear - carried) }
            }
            ReferenceFrame::World => {
                Motion { angular, linear: linear - angular.cross(point.position) - carried }
            }
            ReferenceFrame::LocalWorldAligned => Motion { angular, linear },
        })
    }

    /// The Jacobian J, 6 x n: rows of the angular velocity, then of the linear one. `V = J v`.
    ///
    /// # Errors
    /// See [`Kinematics`].
    #[inline(never)]
    pub fn jacobian(&mut self, frame: usize, axes: ReferenceFrame) -> Result<&Matrix<S>, EvalError> {
        let (placed, frame) = self.see(frame, axes)?;
        self.jacobian.all.fill_zero();
        for j in self.tree.path(placed.joint) {
            let Motion { angular, linear } = seen(&self.columns[j], axes, &frame).motion;
            put(&mut self.jacobian.all, 0, j, angular);
            put(&mut self.jacobian.all, 3, j, linear);
        }
        self.jacobian.sum_columns(&self.tree);
        Ok(self.jacobian.get())
    }

    /// The derivative of J in time, 6 x n.
    ///
    /// # Errors
    /// See [`Kinematics`].
    #[inline(never)]
    pub fn jacobian_rate(&mut self, frame: usize, axes: ReferenceFrame) -> Result<&Matrix<S>, EvalError> {
        let (placed, frame) = self.see(frame, axes)?;
        self.jacobian_rate.all.fill_zero();
        for j in self.tree.path(placed.joint) {
            let Motion { angular, linear } = seen(&self.columns[j], axes, &frame).rate;
            put(&mut self.jacobian_rate.all, 0, j, angular);
            put(&mut self.jacobian_rate.all, 3, j, linear);
        }
        self.jacobian_rate.sum_columns(&self.tree);
        Ok(self.jacobian_rate.get())
    }

    /// Fills the columns of the joints that move link `k`, for this point.
    fn fill_columns(&mut self, k: Option<usize>, point: &Point<S>) {
        let Self { tree, columns, bodies, .. } = self;
        for j in tree.path(k) {
            columns[j] = Column::new(tree, bodies, j, point);
        }
    }

    /// Fills the columns for the point that the convention refers to, in axes of the world.
    pub(super) fn see(
        &mut self,
        frame: usize,
        axes: ReferenceFrame,
    ) -> Result<(TreeFrame, Placed<S>), EvalError> {
        let frame = self.frame(frame)?;
        Ok((frame, self.look(&frame, axes)))
    }

    /// The same of a frame of the tree.
    pub(super) fn look(&mut self, frame: &TreeFrame, axes: ReferenceFrame) -> Placed<S> {
        let placed = self.locate(frame);
        let point = match axes {
            ReferenceFrame::World => Point::origin(),
            ReferenceFrame::Local | ReferenceFrame::LocalWorldAligned => placed.point,
        };
        self.fill_columns(frame.joint, &point);
        placed
    }
}

impl<S: Scalar> Placed<S> {
    /// A wrench in the axes of the convention, now in those of the world.
    pub fn seen_from_world(&self, axes: ReferenceFrame, wrench: &Force<S>) -> Force<S> {
        match axes {
            ReferenceFrame::Local => {
                Force { moment: self.frame.in_world(wrench.moment), force: self.frame.in_world(wrench.force) }
            }
            ReferenceFrame::World | ReferenceFrame::LocalWorldAligned => *wrench,
        }
    }
}

/// The column in the axes of the convention: `(R'J)' = R'(J' - w x J)` in those of the frame.
fn seen<S: Scalar>(column: &Column<S>, axes: ReferenceFrame, placed: &Placed<S>) -> Column<S> {
    let Column { motion, rate } = *column;
    if axes != ReferenceFrame::Local {
        return Column { motion, rate };
    }
    let (frame, turning) = (&placed.frame, placed.frame.angular);
    let local =
        |a: Motion<S>| Motion { angular: frame.in_frame(a.angular), linear: frame.in_frame(a.linear) };
    let carried = Motion { angular: turning.cross(motion.angular), linear: turning.cross(motion.linear) };
    Column { motion: local(motion), rate: local(rate - carried) }
}
