//! Least time where the problem itself is too hard: with a cost of torques that becomes smaller and smaller.
//!
//! Torques without a cost jump from limit to limit, and where a joint has time to spare anything that keeps
//! the end is optimal: meshes follow jumps that mean nothing. A little cost of torques decides. What that can
//! cost in time is bounded. With the weight w, prices `p_i = 2 c / h_i^2` (c the price of a second, h_i half
//! the range of a torque) and `E = integral of 1/2 sum p_i tau_i^2`, a motion of time T that minimises
//! `c T + w E` is worse than any other one nearby by at most
//!
//! $$ c \, (T - T^\ast) \le w \, (E(T^\ast) - E) \le w \, \Bigl( T \sum_i \frac12 p_i \max \tau_i^2 - E
//! \Bigr). $$

use super::first::First;
use super::meshes::refine;
use super::prepare::{Dynamics, interior_on};
use super::refined::Refined;
use super::refinement::Start;
use crate::constants::direct as constants;
use crate::direct::interior::iterate::Interior;
use crate::direct::interior::looseness::Looseness;
use crate::direct::limits::side::Limited;
use crate::direct::motion::spline::Spline;
use crate::direct::refine::resolution::Resolution;
use crate::options::SolverOptions;
use crate::problem::Problem;
use crate::solve::Recorder;
use crate::status::Status;
use crate::task::build::TaskRows;
use costate::EvalError;

/// A motion of a problem with a little cost of torques.
pub(super) struct WithEffort {
    pub interior: Interior<Dynamics>,
    pub resolution: Resolution,
    pub refined: Refined,
    pub smoothing: Smoothing,
}

/// What the cost of torques changes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Smoothing {
    /// The weight w.
    pub weight: f64,
    /// By how much the cost without it may be above the least one nearby, relative to it.
    pub bound: f64,
}

/// The motion with the smallest weight for which the problem is solved; from the guess of a start.
///
/// # Errors
/// A motion that cannot be evaluated.
pub(super) fn with_effort(
    (problem, rows): (&Problem, &TaskRows),
    (options, looseness): (&SolverOptions, Looseness),
    guess: &Spline,
    recorder: &mut Recorder<'_>,
) -> Result<Option<WithEffort>, EvalError> {
    let (mut spline, mut best) = (guess.clone(), None);
    let eased =
        SolverOptions { tolerance: options.tolerance.max(constants::EFFORT_TOLERANCE), ..options.clone() };
    let mut weight = 1.0;
    let mut iterations = 0;
    let first = First::new(problem, rows, options, 0, None);
    while weight >= constants::LEAST_EFFORT * eased.tolerance {
        let mut interior = interior_on(problem, rows, options, &first, &spline.mesh.nodes);
        interior.spline.copy_from(&spline);
        interior.looseness = looseness;
        let (own, prices) = (interior.running.effort.clone(), interior.smooth_effort());
        let added: Vec<f64> = prices.iter().zip(&own).map(|(price, own)| weight * (price - own)).collect();
        interior.running.effort = own.iter().zip(&added).map(|(own, added)| own + added).collect();
        interior.figures.iterations = iterations;
        let mut resolution = Resolution::default();
        let refined = refine(problem, &eased, Start::Saved, &mut interior, &mut resolution, recorder)?;
        iterations = interior.figures.iterations;
        let unverified = refined.status == Status::NotVerified && resolution.cost.is_finite();
        if !refined.status.is_converged() && !unverified {
            break;
        }
        // Costates and H* remain those of the smoothed problem.
        let all = resolution.cost;
        let smoothed = std::mem::replace(&mut interior.running.effort, own);
        resolution.measure_cost(&mut interior);
        interior.running.effort = smoothed;
        let cost = all - resolution.cost;
        let largest = |joint: usize| {
            let sides = interior.barrier.sides().iter();
            let own = sides.filter(|side| side.limited == Limited::Torque && side.joint == joint);
            own.map(|side| side.bound * side.bound).fold(0.0, f64::max)
        };
        let most: f64 = added.iter().enumerate().map(|(i, price)| 0.5 * price * largest(i)).sum();
        let bound = (interior.spline.duration() * most - cost).max(0.0) / resolution.cost;
        spline = interior.spline.clone();
        let smoothing = Smoothing { weight, bound };
        best = Some(WithEffort {
            interior,
            resolution,
            refined: refined.smoothed(bound + eased.tolerance, options),
            smoothing,
        });
        if bound <= eased.tolerance {
            break;
        }
        weight *= constants::LESS_EFFORT;
    }
    Ok(best)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direct::solve::prepare::interior;
    use crate::options::Verify;
    use crate::problem::{Bounds, FinalTime, MotionLimits, Objective};
    use costate::robot::Robot;

    /// The unit two-link arm, whose least time is known: what a cost of torques makes of it is above that, by
    /// less than the bound.
    #[test]
    fn the_bound_holds_and_the_time_comes_near() {
        let robot = Robot::from_file("../robots/two_link.toml").unwrap();
        let problem = Problem::rest_to_rest(robot, &[0.0, 0.5], &[0.522, 0.5], 3.0)
            .with_time(FinalTime::Free { guess: 3.0 })
            .with_cost(Objective::new(1.0, vec![0.0; 2]))
            .with_bounds(Bounds::symmetric(vec![1.0; 2]))
            .with_limits(MotionLimits::none());
        let options = SolverOptions::default().with_tolerance(1e-3).with_verify(Verify::Factors);
        let rows = TaskRows::new(&problem).unwrap();
        let guess = interior(&problem, &rows, &options, 0, None).spline;
        let mut recorder = Recorder::default();
        let found = with_effort((&problem, &rows), (&options, Looseness::default()), &guess, &mut recorder)
            .unwrap()
            .unwrap();
        let Smoothing { weight, bound } = found.smoothing;
        let time = found.interior.spline.duration();
        assert!(weight < 0.1 && found.refined.status.is_solved(), "{weight} {}", found.refined.status);
        let above = time / 2.98228 - 1.0;
        assert!(above > -1e-3 && above < bound + 1e-3 && bound < 0.01, "{above} {bound}");
        assert!((found.resolution.cost / time - 1.0).abs() < 1e-9, "the cost without torques is the time");
        let lower = found.refined.smoothed(0.5, &options).status;
        assert_eq!(lower, Status::MeshLimit, "a bound of one half is no solution");
    }
}
