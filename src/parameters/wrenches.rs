//! What wrenches from outside add to derivatives by lengths: their arms depend on them.
//!
//! A wrench does no work that L contains: its generalised force Q(q) adds to dp/dt and is taken from tau. By
//! a displacement it has the derivative by the coordinate of the still joint, in a tree that has the frames
//! of the wrenches.

use super::layout::{Layout, Source};
use crate::error::EvalError;
use crate::kinematics::ExternalForces;
use crate::matrix::{Matrix, filled};
use crate::scalar::Scalar;

/// The wrenches of a robot, on the extended tree.
#[derive(Clone, Debug)]
pub(super) struct Wrenches<S: Scalar> {
    forces: Box<ExternalForces<S>>,
    /// Column and still joint of each displacement.
    columns: Vec<(usize, usize)>,
    /// The number of each coordinate in the extended tree.
    kept: Vec<usize>,
    /// Weights of the forces of the extended tree; zero for still joints.
    y: Vec<S>,
}

impl<S: Scalar> Wrenches<S> {
    /// `None` if no wrench acts.
    pub fn new(layout: &Layout) -> Option<Self> {
        let still = |&(column, source): &(usize, Source)| match source {
            Source::Still(at) => Some((column, at)),
            _ => None,
        };
        let columns: Vec<_> = layout.sources.iter().filter_map(still).collect();
        let forces = ExternalForces::where_any(&layout.extended)?;
        let y = filled(S::zero(), layout.extended.dof());
        Some(Self { forces, columns, kept: layout.kept.clone(), y })
    }

    /// As [`ExternalForces::set_wrench`].
    pub fn set(&mut self, k: usize, moment: &[S; 3], force: &[S; 3]) -> Result<(), EvalError> {
        self.forces.set_wrench(k, moment, force)
    }

    /// Adds `factor Q_theta`, n x n_theta, to the rows from `first` on; q of the extended tree.
    pub fn add_slopes(&mut self, q: &[S], factor: f64, first: usize, to: &mut Matrix<S>) {
        if self.columns.is_empty() {
            return;
        }
        let slopes = self.forces.slopes(q);
        for &(column, at) in &self.columns {
            for (i, &k) in self.kept.iter().enumerate() {
                let entry = (first + i, column);
                to[entry] = to[entry].plus_times(slopes[(k, at)], factor);
            }
        }
    }

    /// Adds `factor y'Q_theta`, n_theta.
    pub fn add_products(&mut self, q: &[S], factor: f64, y: &[S], to: &mut [S]) {
        if self.columns.is_empty() {
            return;
        }
        let slopes = self.forces.slopes(q);
        for &(column, at) in &self.columns {
            let sum =
                self.kept.iter().zip(y).fold(S::zero(), |sum, (&k, &y)| y.mul_add(slopes[(k, at)], sum));
            to[column] = to[column].plus_times(sum, factor);
        }
    }

    /// Adds `y'Q_q,theta`, to the first n rows.
    pub fn add_curvature(&mut self, q: &[S], y: &[S], to: &mut Matrix<S>) {
        if self.columns.is_empty() {
            return;
        }
        self.kept.iter().zip(y).for_each(|(&k, &y)| self.y[k] = y);
        let curvature = self.forces.curvature(q, &self.y);
        for &(column, at) in &self.columns {
            for (i, &k) in self.kept.iter().enumerate() {
                to[(i, column)] += curvature[(k, at)];
            }
        }
    }
}
