//! The guesses of a problem, and the solution that each leads to.

use crate::constants::polish::{ROUGH, ROUGH_BOUNDED, STRIDE};
use crate::cubics::Disturbance;
use crate::direct::{Direct, Looseness};
use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::lagrangian::LagrangianExtremal;
use crate::extremal::legendre::OfRobot;
use crate::options::{Coordinates, Method, Polish, SolverOptions, Strategy, Verify};
use crate::parallel::best_of_starts;
use crate::problem::check::CheckedProblem;
use crate::problem::{BoundaryState, MotionLimits, Problem};
use crate::result::limit_use::LimitReport;
use crate::result::motion::{Certificate, ExtremalSolution, Motion};
use crate::result::solution::{CostateStart, RobotNames, Solution};
use crate::result::trajectory::Trajectory;
use crate::search::Search;
use crate::search::guess::{RobotGuess, SavedMotion};
use crate::search::mapped::Mapped;
use crate::solve::Recorder;
use crate::status::Status;
use crate::task::build::TaskRows;
use costate::EvalError;

/// A motion as the start of a search.
pub(crate) fn saved(trajectory: &Trajectory) -> SavedMotion<'_> {
    let Trajectory { t, q, p, u, y_q, y_p, .. } = trajectory;
    SavedMotion { t, parts: [q, p, y_q, y_p], stride: 1, u }
}

/// The motion of the direct method, which has each time once, on the nodes of its mesh.
pub(crate) fn of_direct(trajectory: &Trajectory) -> SavedMotion<'_> {
    SavedMotion { stride: STRIDE, ..saved(trajectory) }
}

/// A problem that is solved from one or several guesses.
pub(crate) struct Starts<'a> {
    pub problem: CheckedProblem<'a>,
    pub options: &'a SolverOptions,
    /// Where the first start begins.
    pub saved: Option<SavedMotion<'a>>,
    /// Whether nothing else is tried if that fails.
    pub alone: bool,
}

impl Starts<'_> {
    /// The best solution of all starts, as [`compare`](crate::verdict::rank::compare) says.
    pub fn solve(&self, recorder: &mut Recorder<'_>) -> Solution {
        let solve = |number, recorder: &mut Recorder<'_>| self.solution_of(number, recorder);
        let missing = || Solution::without_motion(&self.problem, Status::Cancelled);
        best_of_starts(self.options, recorder, solve).unwrap_or_else(missing)
    }

    /// Where a start leads; no motion if the equations of the problem cannot be evaluated.
    fn solution_of(&self, number: usize, recorder: &mut Recorder<'_>) -> Solution {
        self.start(number, recorder).unwrap_or_else(|error| {
            Solution::without_motion(&self.problem, Status::EvaluationFailed(error.into()))
        })
    }

    fn start(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let solution = self.search_from(number, recorder)?;
        let start = &self.problem.start;
        let fixed_start = start.q_free.is_empty() && start.v_free.is_empty();
        if fixed_start || solution.motion.status != Status::Singular {
            return Ok(solution);
        }
        Ok(self.with_fixed_start(number, &solution, recorder)?.unwrap_or(solution))
    }

    /// The solution for the start that the guess has, if it costs nothing and its costates vanish.
    ///
    /// If both ends are free, every motion without control may be optimal. Then the start is not determined
    /// and the equations are singular. A motion with a fixed start whose costates vanish there meets the
    /// conditions of the free start too.
    fn with_fixed_start(
        &self,
        number: usize,
        singular: &Solution,
        recorder: &mut Recorder<'_>,
    ) -> Result<Option<Solution>, EvalError> {
        let start = BoundaryState::fixed(&self.problem.start.q, &self.problem.start.v);
        let problem = self.problem.problem().clone().with_start(start);
        let Ok(problem) = problem.check() else { return Ok(None) };
        let mut found = Starts { problem, ..*self }.search_from(number, recorder)?;
        let CostateStart { y_q, y_p } = found.costate_start();
        let vanishes = |value: f64| value.abs() <= self.options.tolerance;
        let all_vanish = y_q.iter().chain(y_p).all(|&y| vanishes(y)) && vanishes(found.motion.total());
        if !(found.motion.status.is_converged() && all_vanish) {
            return Ok(None);
        }
        // Nothing is known about motions from other starts.
        found.motion.certificate = Certificate::NotChecked;
        (found.motion.conjugate_time, found.motion.conjugate_multiplicity) = (None, 0);
        found.newton_iterations += singular.newton_iterations;
        found.motion.iterations.splice(0..0, singular.motion.iterations.iter().cloned());
        Ok(Some(found))
    }

    /// From a saved motion, or from what the direct method finds.
    pub fn search_from(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let saved = self.saved.filter(|_| number == 0);
        let begun = match saved {
            None if self.options.strategy == Strategy::Full => self.begin(number, recorder)?,
            _ => None,
        };
        let once = begun.as_ref().map(|begun| begun.trajectory.with_each_time_once());
        let saved = (saved.or(once.as_ref().map(of_direct)), begun.is_some());
        let mut momenta = RobotExtremal::new(self.problem, self.options.jacobian)?;
        let found = match self.options.coordinates {
            Coordinates::Hamiltonian => self.search(number, saved, &mut momenta.clone(), &momenta, recorder),
            Coordinates::Lagrangian => {
                let mut extremal = LagrangianExtremal::new(self.problem, self.options.jacobian)?;
                self.search(number, saved, &mut extremal, &momenta, recorder)
            }
        };
        let found = solution(self.problem.problem(), self.options, found, &mut momenta);
        Ok(match begun {
            Some(begun) if found.motion.status.is_far() => unpolished(found, begun),
            _ => found,
        })
    }

    /// The motion of the direct method, roughly; `None` where there is none.
    fn begin(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Option<Solution>, EvalError> {
        let problem = self.problem.problem().clone().with_limits(MotionLimits::none());
        let (Ok(rows), Ok(checked)) = (TaskRows::new(&problem), problem.check_for(Method::Direct)) else {
            return Ok(None);
        };
        let SolverOptions { machine_code, seed, .. } = *self.options;
        let tolerance = rough_tolerance(&problem, self.options);
        let options = SolverOptions {
            tolerance,
            machine_code,
            seed,
            verify: Verify::None,
            polish: Polish::Never,
            starts: Some(1),
            ..SolverOptions::default()
        };
        // Newton's method needs meshes and gaps of tight tolerances.
        let looseness = Looseness::default();
        let direct = Direct { problem: checked, rows: &rows, options: &options, looseness, saved: None };
        let mut found = direct.start(number, recorder)?;
        recorder.iterations.append(&mut found.motion.iterations);
        Ok(found.is_motion().then_some(found))
    }

    /// In the coordinates of `extremal`; the motion is in (q, p, y_q, y_p).
    fn search<E: OfRobot>(
        &self,
        number: usize,
        (saved, begun): (Option<SavedMotion<'_>>, bool),
        extremal: &mut E,
        momenta: &RobotExtremal,
        recorder: &mut Recorder<'_>,
    ) -> ExtremalSolution {
        let guess = RobotGuess {
            problem: self.problem.problem(),
            disturbance: Disturbance::draw(&self.problem, self.options.seed, number),
            saved,
            begun,
            momenta: momenta.clone(),
        };
        let mut guess = Mapped::<E>::new(guess, &self.problem.robot);
        let search = Search { extremal, time: self.problem.time, guess: &mut guess, recorder };
        let found = if self.alone { search.polish(self.options) } else { search.run(self.options) };
        let mut solution = found.into_solution(extremal, recorder, self.options);
        solution.map(|z| E::give(&mut guess.map, z));
        solution
    }
}

/// The tolerance of the direct method where an extremal follows.
pub(crate) fn rough_tolerance(problem: &Problem, options: &SolverOptions) -> f64 {
    let torques = problem.joint_limits();
    let bounded = torques.iter().any(|limits| limits.torque.iter().any(|torque| torque.is_finite()));
    options.tolerance.max(if bounded { ROUGH_BOUNDED } else { ROUGH })
}

/// The motion that the direct method found, in place of an iterate that is far from a solution.
fn unpolished(iterate: Solution, found: Solution) -> Solution {
    let iterations = iterate.motion.iterations;
    let motion = Motion { status: Status::PathOnly, iterations, ..found.motion };
    let Solution { trajectory, verified, .. } = found;
    Solution { motion, trajectory, verified, end_defect: f64::INFINITY, ..iterate }
}

/// The solution of a problem from that of its extremal: adds the velocities at the nodes and the largest
/// error at the end.
pub(crate) fn solution(
    problem: &Problem,
    options: &SolverOptions,
    found: ExtremalSolution,
    extremal: &mut RobotExtremal,
) -> Solution {
    let ExtremalSolution { motion, nodes, verified } = found;
    let n = problem.robot.dof();
    let mut velocities = |x: &[f64]| extremal.velocity(x).map_or_else(|_| vec![f64::NAN; n], <[f64]>::to_vec);
    let v = nodes.z.iter().map(|z| velocities(&z[..2 * n])).collect();
    let end = &problem.end;
    let end_defect = motion.end_state.as_ref().map_or(f64::INFINITY, |x| {
        let v = velocities(x);
        let miss = |j: usize| {
            let q = if end.q_free.contains(&j) { 0.0 } else { (x[j] - end.q[j]).abs() };
            let v = if end.v_free.contains(&j) { 0.0 } else { (v[j] - end.v[j]).abs() };
            q.max(v)
        };
        (0..n).map(miss).fold(0.0, f64::max)
    });
    Solution {
        newton_iterations: motion.iterations.len(),
        end_defect,
        limits: LimitReport::default(),
        constraints: Vec::new(),
        gait: None,
        polish: None,
        verified,
        stage_times: None,
        trajectory: Trajectory::from_nodes(nodes, v),
        starts: Vec::new(),
        options: options.clone(),
        robot: RobotNames::of(&problem.robot),
        motion,
    }
}

#[cfg(test)]
mod tests {
    use super::unpolished;
    use crate::options::{Polish, SolverOptions};
    use crate::problem::Problem;
    use crate::result::solution::Solution;
    use crate::solver::Solver;
    use crate::status::Status;
    use costate::robot::Robot;

    #[test]
    fn a_failed_search_gives_the_motion_of_the_direct_method() {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0; 2], &[1.0, -0.5], 1.0);
        let options = SolverOptions::default().with_tolerance(1e-4).with_polish(Polish::Never);
        let found = Solver::new(&problem, options).unwrap().solve();
        assert!(found.motion.status.is_converged());
        let iterate = Solution::missing(&problem.robot, Status::NewtonFailed, 1.0);
        let given = unpolished(iterate, found.clone());
        assert!(given.motion.status == Status::PathOnly && !given.motion.status.is_solved());
        assert_eq!((given.total(), &given.trajectory), (found.total(), &found.trajectory));
        assert!(given.motion.iterations.is_empty() && given.end_defect == f64::INFINITY);
    }
}
