//! The derivative of the least cost by parameters of the robot: the envelope theorem.
//!
//! At a solution the derivative of the cost is that of the Lagrange function L at constant unknowns and
//! multipliers. A parameter is in the torques, in the rows g of tools and clearances, and in what tools cost,
//!
//! $$ \frac{dJ}{d\theta} = \sum_p \left( w_p \cdot \tau_\theta + w_{g,p} \cdot g_\theta + T_p \omega_p
//!    l_\theta \right) + \sum_{ends} w_g \cdot g_\theta $$
//!
//! with the weights w of torques and rows in L at each point p, which have the multipliers. Nothing else
//! depends on theta: states of joints are given, not momenta. $\tau_\theta$ is the regressor of the robot of
//! each phase. $g_\theta$ and $l_\theta$ are the differences of fourth order of rows that are built anew:
//! what a length does to bodies along links and to frames is then what the problem says.

use super::resolve::Resolve;
use super::row_differences::RowDifference;
use super::sensitivity_error::SensitivityError;
use crate::constants::checks::cost_by_robot::STILL;
use crate::numerics::chain::dot;
use crate::task::build::TaskRows;
use crate::task::costs::ToolCosts;
use crate::task::functions::{PathFunction, TaskFunctions};
use crate::task::references::References;
use costate::EvalError;
use costate::parameters::{Parameter, ParameterSet, Regressor};

impl Resolve {
    /// dJ/dtheta at the last iterate, for each parameter of the robot of the problem.
    ///
    /// # Errors
    /// [`SensitivityError::OtherRobot`], [`Displaced`](SensitivityError::Displaced),
    /// [`Evaluation`](SensitivityError::Evaluation).
    pub(crate) fn cost_by_robot(&mut self, set: &ParameterSet) -> Result<Vec<f64>, SensitivityError> {
        self.interior.refresh()?;
        self.factorised = false;
        let mut found = self.by_torques(set)?;
        if self.problem.asks_for_links() {
            for (j, parameter) in set.parameters().iter().enumerate() {
                if moves_links(parameter) {
                    found[j] += self.by_rows(set, j)?;
                }
            }
        }
        Ok(found)
    }

    /// The sum of w . tau_theta.
    fn by_torques(&self, set: &ParameterSet) -> Result<Vec<f64>, SensitivityError> {
        let (spline, points) = (&self.interior.spline, &self.interior.points);
        let (n, mut sums) = (spline.dof, vec![0.0; set.len()]);
        let other = SensitivityError::OtherRobot { what: "parameters are those" };
        let mut regressors = Vec::with_capacity(self.robots.len());
        for robot in &self.robots {
            let own = set.of_robot(robot).ok_or_else(|| other.clone())?;
            regressors.push(Regressor::<f64>::new(&own));
        }
        for p in 0..points.count() {
            let phase = spline.mesh.phase(spline.mesh.interval_of(p).0);
            let (z, w) = (points.z(p), &points.weights[n * p..][..n]);
            let row = regressors[phase].adjoint(&z[..n], &z[n..2 * n], &z[2 * n..], w)?;
            sums.iter_mut().zip(row).for_each(|(sum, entry)| *sum += entry);
        }
        Ok(sums)
    }

    /// Whether given positions at the ends of phases keep the equations along the motion with other
    /// parameters too, where they alone keep them.
    ///
    /// # Errors
    /// [`SensitivityError::GivenEnd`]: with another value no motion is near.
    pub(crate) fn check_given_ends(&mut self, set: &ParameterSet) -> Result<(), SensitivityError> {
        if !self.problem.asks_for_links() {
            return Ok(());
        }
        let (n, names) = (self.dof(), TaskRows::new(&self.problem)?);
        let mut state = vec![0.0; 2 * n];
        for end in 0..self.states.len() {
            let interior = &mut self.interior;
            interior.spline.end(end, &mut state);
            let [along, _] = interior.model.tasks.gradients(end, &state)?;
            let (given, settled) = (&interior.ends.given[end], &interior.ends.settled[end]);
            let is_held = |row: usize| {
                let mut slopes = along[2 * n * row..].iter().zip(&given[..n]);
                settled.place.get(row).is_some_and(|settled| *settled)
                    && names.along.bounds()[row].is_equation()
                    && slopes.all(|(slope, given)| *given || slope.abs() < STILL)
            };
            let held: Vec<usize> = (0..names.along.rows()).filter(|&row| is_held(row)).collect();
            for j in (0..set.len()).filter(|&j| moves_links(&set.parameters()[j]) && !held.is_empty()) {
                let mut slopes = vec![0.0; names.along.rows()];
                self.differences(set, j, |rows, factor| {
                    let (mut along, mut g) = (rows.along, vec![0.0; slopes.len()]);
                    if along.rows() == g.len() {
                        // Held rows are equations, which count in all phases, as their gradients do above.
                        along.enter(None);
                        along.values(&state[..n], &state[n..], &mut g)?;
                    }
                    slopes.iter_mut().zip(&g).for_each(|(slope, g)| *slope += factor * g);
                    Ok(true)
                })?;
                if let Some(&row) = held.iter().find(|&&row| slopes[row].abs() > STILL) {
                    let row = names.along.bounds()[row].name.clone();
                    return Err(SensitivityError::GivenEnd { name: set.names()[j].clone(), row });
                }
            }
        }
        Ok(())
    }

    /// What rows and tools make of a parameter that moves links.
    fn by_rows(&self, set: &ParameterSet, j: usize) -> Result<f64, SensitivityError> {
        let mut slope = 0.0;
        self.differences(set, j, |rows, factor| {
            let found = self.of_rows(rows)?;
            slope += factor * found.unwrap_or(0.0);
            Ok(found.is_some())
        })?;
        Ok(slope)
    }

    /// Hands over the rows with other values of a parameter, each with its factor in the derivative; whether
    /// they are those of the problem comes back.
    fn differences(
        &self,
        set: &ParameterSet,
        j: usize,
        mut take: impl FnMut(TaskRows, f64) -> Result<bool, EvalError>,
    ) -> Result<(), SensitivityError> {
        let displaced = |step: f64, cause: String| SensitivityError::Displaced {
            name: set.names()[j].clone(),
            step,
            cause,
        };
        let values = set.values();
        RowDifference::by_displacement().take_rows(
            self.problem.clone(),
            |problem, step| {
                let mut values = values.to_vec();
                values[j] += step;
                let robot = set.robot_with(&values);
                problem.robot = robot.map_err(|error| displaced(step, error.to_string()))?;
                Ok(())
            },
            displaced,
            |_, rows, factor| take(rows, factor),
        )
    }

    /// The rows along the motion with their weights; `None` if these are others than those of the problem.
    fn of_rows(&self, rows: TaskRows) -> Result<Option<f64>, EvalError> {
        let (spline, points) = (&self.interior.spline, &self.interior.points);
        let (n, first) = (spline.dof, self.interior.model.powers.rows());
        let mut at_ends: Vec<TaskFunctions> = rows.at_ends().cloned().collect();
        let TaskRows { mut along, mut accelerations, costs, weights, references, .. } = rows;
        let (mut g, mut h) = (vec![0.0; along.rows()], vec![0.0; accelerations.bounds().len()]);
        let of_ends: usize = at_ends.iter().map(PathFunction::rows).sum();
        let same =
            [g.len(), first + h.len(), of_ends] == [points.rows, points.powers, points.ends.weights.len()];
        if !same {
            return Ok(None);
        }
        let mut tools = ToolCosts::new(costs, weights, n);
        let mut tracks = References::new(&self.problem.task.references, references, n);
        tracks.start = self.interior.running.references.start;
        let mut sum = 0.0;
        for p in 0..points.count() {
            let (z, weight) = (points.z(p), spline.weight(p));
            let (q, v) = (&z[..n], &z[n..2 * n]);
            if !along.is_empty() {
                along.enter(Some(spline.mesh.phase(spline.mesh.interval_of(p).0)));
                along.values(q, v, &mut g)?;
                sum += dot(&g, &points.g_weights[points.rows * p..][..points.rows]);
            }
            accelerations.values(z, &mut h)?;
            sum += dot(&h, &points.h_weights[points.powers * p + first..]);
            if tools.any() {
                sum += weight * tools.evaluate(q, v)?;
            }
            if tracks.any() {
                sum += weight * tracks.evaluate(spline.time_of(p), q)?;
            }
        }
        let (mut state, mut first) = (vec![0.0; 2 * n], 0);
        for (end, functions) in at_ends.iter_mut().enumerate() {
            let mut own = vec![0.0; functions.rows()];
            spline.end(end, &mut state);
            functions.values(&state[..n], &state[n..], &mut own)?;
            sum += dot(&own, &points.ends.weights[first..]);
            first += own.len();
        }
        Ok(Some(sum))
    }
}

/// Whether frames of links depend on a parameter.
pub(crate) fn moves_links(parameter: &Parameter) -> bool {
    matches!(
        parameter,
        Parameter::Translation { .. } | Parameter::Rotation { .. } | Parameter::Displacement { .. }
    )
}
