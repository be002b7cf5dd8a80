//! What is evaluated along a motion: torques, powers, rows of tasks.

use super::power::Powers;
use super::tasks::Tasks;
use crate::direct::motion::spline::Spline;
use crate::direct::points::values::{PointDynamics, Points};
use costate::EvalError;

/// The dynamics of a robot, the powers that matter, and the functions of its task.
#[derive(Clone, Debug)]
pub(crate) struct Model<D> {
    pub dynamics: D,
    pub tasks: Tasks,
    pub powers: Powers,
}

impl<D> Model<D> {
    /// Numbers of rows g(q, v) and h(q, v, a) at a point.
    pub fn rows(&self) -> [usize; 2] {
        self.tasks.rows()
    }
}

impl<D: PointDynamics> Model<D> {
    /// Room for the values along a motion.
    pub fn resize_values(&self, spline: &Spline, points: &mut Points) {
        points.resize_values(spline.dof, self.rows(), spline.mesh.ends_of_points());
        let rows = [self.tasks.end_rows(), self.tasks.rows_of_both_ends()];
        points.ends.resize(spline.dof, rows, spline.mesh.ends().len());
    }

    /// Room for values and derivatives.
    pub fn resize(&self, spline: &Spline, points: &mut Points) {
        points.resize(spline.dof, self.rows(), spline.mesh.ends_of_points());
        let rows = [self.tasks.end_rows(), self.tasks.rows_of_both_ends()];
        points.ends.resize(spline.dof, rows, spline.mesh.ends().len());
    }

    /// Torques, powers and rows at points whose states are known.
    ///
    /// # Errors
    /// States at which they cannot be evaluated.
    pub fn evaluate_at(&mut self, points: &mut Points) -> Result<(), EvalError> {
        self.dynamics.evaluate(points)?;
        self.powers.evaluate(points);
        self.tasks.evaluate(points)
    }

    /// All values along a motion, those at the ends of phases and rates of torques too.
    ///
    /// # Errors
    /// As [`evaluate_at`](Self::evaluate_at).
    pub fn evaluate(&mut self, spline: &Spline, points: &mut Points) -> Result<(), EvalError> {
        spline.evaluate(&mut points.z);
        self.evaluate_at(points)?;
        self.tasks.evaluate_ends(spline, points)?;
        points.evaluate_rates(spline);
        Ok(())
    }

    /// Derivatives of what was evaluated, second ones contracted with the weights of the points.
    ///
    /// # Errors
    /// As [`evaluate_at`](Self::evaluate_at).
    pub fn contract(&mut self, spline: &Spline, points: &mut Points) -> Result<(), EvalError> {
        self.powers.weigh_torques(points);
        self.dynamics.contract(points)?;
        self.powers.contract(points);
        self.tasks.contract(spline, points)
    }
}
