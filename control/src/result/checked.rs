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
        let optimality = check(segments.as_ref().copied());
        let (cost, penalty) = self.found.costs(extremal);
        let integrated = self.integrated_cost(extremal, OF_COST * bound, &mut stops);
        let difference = integrated
            .as_ref()
            .map(|found| (found.cost + found.penalty - cost - penalty).abs() / found.size + found.error);
        let found = integrated.as_ref().ok();
        let verification = Verification {
            integrated_cost: found.map(|found| found.cost),
            quadrature_error: found.map(|found| found.error),
            cost: check(difference),
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
