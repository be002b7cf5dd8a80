//! Derivatives of the cost of a motion by parameters of the robot.

use crate::direct::{PLACES, POINTS, Resolve, SensitivityError, WEIGHTS, moves_links};
use crate::options::Method;
use crate::problem::Problem;
use crate::result::solution::Solution;
use crate::result::trajectory::Trajectory;
use crate::status::Status;
use costate::EvalError;
use costate::lagrangian::Lagrangian;
use costate::parameters::{ParameterSet, Regressor};
use serde::Serialize;

/// What the cost of a motion changes by with a parameter of the robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct CostDerivative {
    /// The parameter, such as `elbow.mass`.
    pub name: String,
    /// Its value in the model, in its own unit; 0 for payloads and displacements, which add to the model.
    pub value: f64,
    /// dJ/dtheta: cost per unit of the parameter.
    pub derivative: f64,
}

impl Problem {
    /// The parameters of the model, by which the cost of its optimal motion can be differentiated.
    pub fn parameters(&self) -> ParameterSet {
        ParameterSet::new(&self.robot).model()
    }
}

/// dJ/dtheta of an optimal motion for each parameter of a set, by the envelope theorem: no problem with
/// another parameter is solved.
///
/// With `y_tau` the derivative of the running cost by the torques, less limits with their multipliers,
///
/// $$ \frac{dJ}{d\theta} = \int_0^T y_\tau \cdot \frac{\partial \tau}{\partial \theta}(q, v, a) \\, dt $$
///
/// along the motion, for fixed and free final times. It is the costate of the momenta, y_p, unless
/// accelerations are limited: then it is [`Trajectory::y_tau`]. Positions and rates at the ends, weights of
/// the cost and limits do not change with theta. Of a motion of the direct method the integral is the sum
/// over its points: the derivative of the least cost on that mesh, exact up to the tolerance that it was
/// solved with. Of an extremal the points of Gauss between its nodes are summed; of one that was read from a
/// file only the nodes are known, and y_p is linear between them.
///
/// A solution does not have the multipliers of tools, clearances, jerks and rates of torques, nor what is
/// carried in each phase. With vias, periodic motions, continuous accelerations and limits on accelerations
/// of tools, and for lengths where anything is asked of tools or bodies, it is solved once more on its mesh
/// ([`Resolve::near`]), which takes a few steps. Poses and clearances are differenced then, to the fourth
/// order over 1 mm and 1 mrad; where the closest places of two bodies jump to an edge within that, the
/// derivative is in between.
///
/// `problem` is the one that was solved. The derivative is that of [`Solution::total`].
///
/// # Errors
/// [`SensitivityError`]: a motion that is not optimal or not found again, another robot, a parameter on which
/// an equation at given positions depends.
///
/// ```
/// use costate::{parameters::ParameterSet, robot::Robot};
/// use costate_control::{MotionLimits, Problem, Solver, SolverOptions, cost_by_parameters};
/// # std::env::set_current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))?;
/// let robot = Robot::from_file("robots/two_link.toml")?;
/// let quarter = std::f64::consts::FRAC_PI_2;
/// let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[quarter; 2], 1.0);
/// let problem = problem.with_limits(MotionLimits::none());
/// let solution = Solver::new(&problem, SolverOptions::default())?.solve();
/// let set = ParameterSet::new(&problem.robot).named("elbow.x")?;
/// let found = cost_by_parameters(&problem, &solution, &set)?;
/// assert_eq!((found[0].name.as_str(), found[0].value), ("elbow.x", 1.0));
/// assert!(found[0].derivative > 0.0, "a longer arm costs more");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn cost_by_parameters(
    problem: &Problem,
    solution: &Solution,
    parameters: &ParameterSet,
) -> Result<Vec<CostDerivative>, SensitivityError> {
    check(problem, solution, parameters)?;
    if needs_multipliers(problem, parameters) {
        let options = solution.options.clone();
        Resolve::near(problem, options, &solution.trajectory)?.check_given_ends(parameters)?;
        let motion = Resolve::solved_near::<SensitivityError>(problem, solution)?;
        let mut motion = motion.ok_or(SensitivityError::NotSolved)?;
        return Ok(rows(parameters, motion.cost_by_robot(parameters)?));
    }
    let trajectory = &solution.trajectory;
    let polished = solution.polish.as_ref().is_some_and(|polish| polish.outcome.is_polished());
    let on_points = solution.options.method == Method::Direct && !polished;
    let mut points = Points { problem, model: Lagrangian::new(&problem.robot), found: Vec::new() };
    if on_points && trajectory.t.len().is_multiple_of(POINTS + 2) {
        points.take_points(trajectory)?;
    } else {
        points.take_places(trajectory)?;
    }
    let mut regressor = Regressor::<f64>::new(parameters);
    let mut sums = vec![0.0; parameters.len()];
    for Point { weight, q, v, a, by_torques } in &points.found {
        let row = regressor.adjoint(q, v, a, by_torques)?;
        sums.iter_mut().zip(row).for_each(|(sum, entry)| *sum += weight * entry);
    }
    Ok(rows(parameters, sums))
}

fn rows(parameters: &ParameterSet, derivatives: Vec<f64>) -> Vec<CostDerivative> {
    let rows = parameters.names().iter().zip(parameters.values()).zip(derivatives);
    rows.map(|((name, &value), derivative)| CostDerivative { name: name.clone(), value, derivative })
        .collect()
}

/// Whether a solution does not tell all that the derivative needs.
fn needs_multipliers(problem: &Problem, parameters: &ParameterSet) -> bool {
    let moves = || parameters.parameters().iter().any(moves_links);
    let phases = problem.first_of_rates().or(problem.first_of_phases()).is_some();
    phases || problem.task.limits_accelerations() || (problem.asks_for_links() && moves())
}

fn check(problem: &Problem, solution: &Solution, parameters: &ParameterSet) -> Result<(), SensitivityError> {
    problem.refuse_free_joints().map_err(|error| SensitivityError::Problem(Box::new(error)))?;
    if problem.gait.is_some() {
        return Err(SensitivityError::Gait);
    }
    let status = &solution.motion.status;
    let optimal = status.is_solved() || matches!(status, Status::NotVerified | Status::MeshLimit);
    let motion = &solution.trajectory;
    if !optimal || motion.t.len() < 2 {
        return Err(SensitivityError::NotOptimal(status.clone()));
    }
    if motion.q[0].len() != problem.robot.dof() {
        return Err(SensitivityError::OtherRobot { what: "motion is that" });
    }
    if *parameters.robot() != problem.robot {
        return Err(SensitivityError::OtherRobot { what: "parameters are those" });
    }
    Ok(())
}

/// A point of the integral.
struct Point {
    /// In the integral over time (s).
    weight: f64,
    q: Vec<f64>,
    v: Vec<f64>,
    a: Vec<f64>,
    by_torques: Vec<f64>,
}

/// The points of a motion.
struct Points<'a> {
    problem: &'a Problem,
    model: Lagrangian<f64>,
    found: Vec<Point>,
}

impl Points<'_> {
    /// Those of the direct method: between two nodes that have one row each for each interval.
    fn take_points(&mut self, motion: &Trajectory) -> Result<(), EvalError> {
        for (k, t) in motion.t.chunks_exact(POINTS + 2).enumerate() {
            for (j, weight) in WEIGHTS.iter().enumerate() {
                let row = (POINTS + 2) * k + 1 + j;
                let (q, v) = (motion.q[row].clone(), motion.v[row].clone());
                let a = match motion.accelerations() {
                    Some(accelerations) => accelerations[row].clone(),
                    None => self.acceleration(&q, &v, &motion.u[row])?,
                };
                let weight = weight * (t[POINTS + 1] - t[0]);
                self.found.push(Point { weight, q, v, a, by_torques: motion.by_torques(row).to_vec() });
            }
        }
        Ok(())
    }

    /// Gauss's between the nodes.
    fn take_places(&mut self, motion: &Trajectory) -> Result<(), EvalError> {
        for ends in motion.t.windows(2) {
            let length = ends[1] - ends[0];
            for (place, weight) in PLACES.iter().zip(WEIGHTS) {
                let Some(point) = motion.at(ends[0] + place * length).filter(|_| length > 0.0) else {
                    continue;
                };
                let a = self.acceleration(&point.q, &point.v, &point.u)?;
                let (weight, by_torques) = (weight * length, point.y_p);
                self.found.push(Point { weight, q: point.q, v: point.v, a, by_torques });
            }
        }
        Ok(())
    }

    /// By forward dynamics.
    fn acceleration(&mut self, q: &[f64], v: &[f64], u: &[f64]) -> Result<Vec<f64>, EvalError> {
        let tau: Vec<f64> = u.iter().zip(&self.problem.gain).map(|(u, gain)| u * gain).collect();
        Ok(self.model.forward_dynamics(q, v, &tau)?.to_vec())
    }
}
