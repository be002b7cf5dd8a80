//! What a verification of an extremal finds.

use crate::constants::checks::verify::OF_COST;
use crate::extremal::Extremal;
use crate::numerics::dormand_prince::Stopped;
use crate::options::SolverOptions;
use crate::result::verification::{Check, Verification};
use crate::result::verify::{integration_tolerance, verification_bound};
use crate::solve::{Recorder, Solved};

/// A solved extremal, integrated again.
pub(crate) struct Checked {
    /// x(T); `None` where the integration stopped.
    pub end_state: Option<Vec<f64>>,
    /// That of [`Solved::shooting_defect`]; infinite where the integration stopped.
    pub shooting_defect: f64,
    pub verification: Verification,
    /// Whether it was not stopped.
    pub is_complete: bool,
}

impl Solved {
    /// Verifies a solved extremal: the state equation integrated to the end, state and costates over
    /// segments, the cost by quadrature. It ends early where the search is to stop.
    pub(crate) fn checked(
        &mut self,
        extremal: &mut dyn Extremal,
        recorder: &mut Recorder<'_>,
        options: &SolverOptions,
    ) -> Checked {
        let bound = verification_bound(options.tolerance);
        let mut is_complete = true;
        let mut check = |found: Result<f64, &Stopped>| match found {
            Ok(value) => Check::of(value, bound),
            Err(Stopped::Interrupted) => {
                is_complete = false;
                Check::skipped("the search was stopped")
            }
            Err(Stopped::Evaluation(_) | Stopped::TooManySteps) => Check::of(f64::INFINITY, bound),
        };
        let end = self.integrated_or_sharper(extremal, recorder, options);
        let dynamics = check(end.as_ref().map(|end| self.end_defect(extremal, Some(end))));
        let mut stops = || recorder.ended().is_some();
        let tolerance = integration_tolerance(options.tolerance);
        let segments = self.shooting_defect(extremal, [tolerance, bound], &mut stops);
        let (cost, penalty) = self.found.costs(extremal);
        // Controls below the tolerance of their costates cost its square: cost and costates are errors.
        let is_nothing = cost.abs() + penalty.abs() <= options.tolerance * options.tolerance;
        let nothing = || Check::skipped("the motion costs nothing: its cost and costates are rounding");
        let optimality = if is_nothing { nothing() } else { check(segments.as_ref().copied()) };
        let integrated = self.integrated_cost(extremal, OF_COST * bound, &mut stops);
        let difference = integrated
            .as_ref()
            .map(|found| (found.cost + found.penalty - cost - penalty).abs() / found.size + found.error);
        let of_cost = if is_nothing { nothing() } else { check(difference) };
        let found = integrated.as_ref().ok();
        let verification = Verification {
            integrated_cost: found.map(|found| found.cost),
            quadrature_error: found.map(|found| found.error),
            cost: of_cost,
            dynamics,
            limits: Check::skipped("extremals: nothing is limited but controls, which their law bounds"),
            overshoot: Check::skipped("extremals: their controls do not overshoot"),
            optimality,
            costate_defect: segments.as_ref().ok().copied(),
            ..Verification::default()
        };
        Checked {
            end_state: end.ok(),
            shooting_defect: segments.unwrap_or(f64::INFINITY),
            verification,
            is_complete,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extremal::hamiltonian::RobotExtremal;
    use crate::options::{JacobianRoute, Method, Verify};
    use crate::problem::{FinalTime, Problem};
    use crate::result::motion::Certificate;
    use crate::search::Search;
    use crate::search::guess::Plain;
    use crate::solve::recorder::Stop;
    use crate::status::Status;
    use costate::robot::Robot;
    use std::time::Duration;

    const TIME: f64 = 1.0;

    /// A pendulum that rises, as an extremal.
    fn solved(run: impl FnOnce(Solved, &mut RobotExtremal, &SolverOptions)) {
        let robot = Robot::from_file("../robots/pendulum.toml").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0], &[std::f64::consts::PI], TIME);
        let options = SolverOptions::of(Method::Collocation);
        let mut extremal = RobotExtremal::new(problem.check().unwrap(), JacobianRoute::Exact).unwrap();
        let mut recorder = Recorder::default();
        let mut guess = Plain(|s: f64, z: &mut [f64]| z[0] = std::f64::consts::PI * s);
        let time = FinalTime::Fixed(TIME);
        let search = Search { extremal: &mut extremal, time, guess: &mut guess, recorder: &mut recorder };
        let found = search.run(&options);
        assert!(found.is_converged());
        run(found, &mut extremal, &options);
    }

    #[test]
    fn an_extremal_passes_and_a_costate_that_is_wrong_does_not() {
        solved(|mut found, extremal, options| {
            let exact = found.checked(extremal, &mut Recorder::default(), options);
            let Verification { cost, dynamics, optimality, .. } = &exact.verification;
            assert!(cost.passes() && dynamics.passes() && optimality.passes(), "{:?}", exact.verification);
            assert!(exact.is_complete && exact.shooting_defect < 1e-7, "{}", exact.shooting_defect);
            // A costate at one node is off by a thousandth of the largest one: no segment leads through it.
            let (m, node) = (found.found.equations.m, found.found.equations.mesh.nodes() / 2);
            found.found.equations.current.nodes[m * node + 3] += 1e-3 * found.found.equations.scale[3];
            let defect = found.shooting_defect(extremal, [1e-10, 1e-4], &mut || false).unwrap();
            assert!((0.99e-3..2.5e-3).contains(&defect), "{defect}");
        });
    }

    /// A search that is over ends the verification, and the motion is not converged.
    #[test]
    fn what_is_stopped_is_neither_verified_nor_converged() {
        let late = || Recorder::new(None, Stop::new(None, Some(Duration::ZERO)));
        solved(|mut found, extremal, options| {
            assert!(!found.checked(extremal, &mut late(), options).is_complete);
            let (conjugate, certificate) = found.second_variation(extremal, &mut || true);
            assert_eq!((conjugate, certificate), (None, Certificate::NotChecked));
            let motion = found.into_solution(extremal, &mut late(), options).motion;
            assert_eq!((motion.status, motion.verification), (Status::TimeLimit, Verify::None));
        });
    }
}
