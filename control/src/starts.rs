//! The starts of a solver, and solutions from motions.

use crate::extremal::hamiltonian::RobotExtremal;
use crate::extremal::lagrangian::LagrangianExtremal;
use crate::extremal::legendre::OfRobot;
use crate::options::{Coordinates, Options};
use crate::path::cubics::Disturbance;
use crate::problem::{Problem, Start};
use crate::result::motion::{Certificate, Motion};
use crate::result::solution::{Solution, Trajectory};
use crate::search::Search;
use crate::search::guess::{RobotGuess, SavedMotion};
use crate::search::mapped::Mapped;
use crate::solve::Recorder;
use crate::status::Status;
use costate::EvalError;

/// A motion as the start of a search.
pub(crate) fn saved(trajectory: &Trajectory) -> SavedMotion<'_> {
    let Trajectory { t, q, p, y_q, y_p, .. } = trajectory;
    SavedMotion { t, parts: [q, p, y_q, y_p] }
}

/// A problem that is solved from one or several guesses.
pub(crate) struct Starts<'a> {
    pub problem: &'a Problem,
    pub options: &'a Options,
    /// Where the first start begins.
    pub saved: Option<SavedMotion<'a>>,
}

impl Starts<'_> {
    /// The best solution of all starts: the cheapest converged one if there is any.
    pub fn solve(&self, recorder: &mut Recorder<'_>) -> Solution {
        let mut best: Option<Solution> = None;
        let (mut others, mut steps) = (Vec::new(), 0);
        for number in 0..self.options.starts {
            let solution = self
                .start(number, recorder)
                .unwrap_or_else(|error| failed(self.problem, Status::EvaluationFailed(error.into())));
            steps += solution.newton_iterations;
            others.push((solution.total(), solution.status.clone()));
            let better = best.as_ref().is_none_or(|best| {
                let rank = |solution: &Solution| !solution.status.is_converged();
                (rank(&solution), solution.total()) < (rank(best), best.total())
            });
            if better {
                best = Some(solution);
            }
            if recorder.interruption().is_some() {
                break;
            }
        }
        let mut best = best.unwrap_or_else(|| failed(self.problem, Status::NewtonFailed));
        best.newton_iterations = steps;
        best.others = others;
        best
    }

    fn start(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let solution = self.search_from(number, recorder)?;
        let start = &self.problem.start;
        let fixed_start = start.q_free.is_empty() && start.v_free.is_empty();
        if fixed_start || solution.status != Status::Singular {
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
        let start = Start::fixed(&self.problem.start.q, &self.problem.start.v);
        let problem = Problem { start, ..self.problem.clone() };
        let mut found = Starts { problem: &problem, ..*self }.search_from(number, recorder)?;
        let (y_q, y_p) = &found.costate_start;
        let vanishes = |value: f64| value.abs() <= self.options.tolerance;
        let all_vanish = y_q.iter().chain(y_p).all(|&y| vanishes(y)) && vanishes(found.total());
        if !(found.status.is_converged() && all_vanish) {
            return Ok(None);
        }
        // Nothing is known about motions from other starts.
        (found.conjugate_time, found.certificate) = (None, Certificate::NotChecked);
        found.newton_iterations += singular.newton_iterations;
        found.iterations.splice(0..0, singular.iterations.iter().cloned());
        Ok(Some(found))
    }

    fn search_from(&self, number: usize, recorder: &mut Recorder<'_>) -> Result<Solution, EvalError> {
        let mut momenta = RobotExtremal::new(self.problem, self.options.jacobian)?;
        let motion = match self.options.coordinates {
            Coordinates::Hamiltonian => self.search(number, &mut momenta.clone(), &momenta, recorder),
            Coordinates::Lagrangian => {
                let mut extremal = LagrangianExtremal::new(self.problem, self.options.jacobian)?;
                self.search(number, &mut extremal, &momenta, recorder)
            }
        };
        Ok(solution(self.problem, motion, &mut momenta))
    }

    /// In the coordinates of `extremal`; the motion is in (q, p, y_q, y_p).
    fn search<E: OfRobot>(
        &self,
        number: usize,
        extremal: &mut E,
        momenta: &RobotExtremal,
        recorder: &mut Recorder<'_>,
    ) -> Motion {
        let guess = RobotGuess {
            problem: self.problem,
            disturbance: Disturbance::draw(self.problem, self.options.seed, number),
            saved: self.saved.filter(|_| number == 0),
            momenta: momenta.clone(),
            path: None,
        };
        let mut guess = Mapped::<E>::new(guess, &self.problem.robot);
        let search = Search { extremal, time: self.problem.time, guess: &mut guess, recorder };
        let found = search.run(self.options);
        let mut motion = found.into_motion(extremal, std::mem::take(&mut recorder.iterations));
        for z in motion.z.iter_mut().chain(&mut motion.end_state) {
            if E::give(&mut guess.map, z).is_err() {
                z.fill(f64::NAN);
            }
        }
        motion
    }
}

/// A solution from a motion: adds the rates at the nodes and the largest error at the end.
pub(crate) fn solution(problem: &Problem, motion: Motion, extremal: &mut RobotExtremal) -> Solution {
    let n = problem.robot.len();
    let mut rates = |x: &[f64]| extremal.velocity(x).map_or_else(|_| vec![f64::NAN; n], <[f64]>::to_vec);
    let v = motion.z.iter().map(|z| rates(&z[..2 * n])).collect();
    let end = &problem.end;
    let end_defect = motion.end_state.as_ref().map_or(f64::INFINITY, |x| {
        let v = rates(x);
        let miss = |j: usize| {
            let q = if end.q_free.contains(&j) { 0.0 } else { (x[j] - end.q[j]).abs() };
            let v = if end.v_free.contains(&j) { 0.0 } else { (v[j] - end.v[j]).abs() };
            q.max(v)
        };
        (0..n).map(miss).fold(0.0, f64::max)
    });
    Solution::from_motion(motion, v, end_defect)
}

/// A solution without a motion.
pub(crate) fn failed(problem: &Problem, status: Status) -> Solution {
    let n = problem.robot.len();
    Solution {
        status,
        cost: f64::INFINITY,
        penalty_cost: 0.0,
        smoothing: 0.0,
        final_time: problem.time.value(),
        hamiltonian: 0.0,
        hamiltonian_drift: 0.0,
        costate_start: (vec![0.0; n], vec![0.0; n]),
        end_defect: f64::INFINITY,
        shooting_defect: f64::INFINITY,
        newton_iterations: 0,
        nodes: 0,
        conjugate_time: None,
        certificate: Certificate::NotChecked,
        errors: Vec::new(),
        iterations: Vec::new(),
        trajectory: Trajectory::default(),
        switches: Vec::new(),
        others: Vec::new(),
    }
}
