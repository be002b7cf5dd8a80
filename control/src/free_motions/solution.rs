//! A motion of the robot with its figures.

use super::task::FreeTask;
use super::{rows, uses, verify};
use crate::constants::direct::{GAP, VERIFIED};
use crate::constants::states::EXCESS;
use crate::direct_states::solution::StateMotion;
use crate::options::{SolverOptions, Verify};
use crate::result::motion::Motion;
use crate::result::solution::{RobotNames, Solution};
use crate::result::verification::{Check, Verification};
use crate::result::verify::verification_bound;
use costate::EvalError;

/// The motion of the robot with its figures.
pub(super) fn solution(
    task: &FreeTask<'_>,
    options: &SolverOptions,
    found: &StateMotion,
) -> Result<Solution, EvalError> {
    let problem = task.problem;
    let trajectory = rows::trajectory(task, found)?;
    let verifies = options.verify == Verify::Full && !found.status.is_interruption();
    let end_state = if verifies { verify::integrated_again(task, found) } else { None };
    let end_defect = end_state.as_ref().map_or(f64::INFINITY, |end| verify::missed(problem, end));
    let bound = verification_bound(options.tolerance).sqrt();
    // The integration of the whole misses the end, that of its parts does not: the motion is unstable.
    let by_parts = end_defect > bound && found.end_error.is_finite();
    let figures = rows::figures(task, found);
    let motion = Motion {
        cost: found.cost,
        hamiltonian: figures.hamiltonian,
        phase_hamiltonians: vec![figures.hamiltonian],
        hamiltonian_drift: figures.drift,
        end_state: end_state.clone(),
        verification: if verifies { Verify::Full } else { Verify::None },
        shooting_defect: if by_parts { found.end_error } else { f64::INFINITY },
        stationarity: found.residual,
        certificate: found.certificate,
        // That of the mesh before, whose intervals are twice as wide.
        errors: if found.cost_change.is_finite() { vec![found.cost_change] } else { Vec::new() },
        ..Motion::missing(found.status.clone(), found.final_time)
    };
    Ok(Solution {
        motion,
        end_defect,
        newton_iterations: found.steps.len(),
        limits: uses::limits(task, found),
        constraints: Vec::new(),
        gait: None,
        polish: None,
        verified: verifies.then(|| verification(task, options, found)),
        stage_times: None,
        trajectory,
        starts: Vec::new(),
        options: options.clone(),
        robot: RobotNames::of(&problem.robot),
    })
}

/// What was found between the points of the solver; of a motion that did not converge its integration alone.
fn verification(task: &FreeTask<'_>, options: &SolverOptions, found: &StateMotion) -> Verification {
    let (between, tolerance) = (&found.verified, options.tolerance);
    // The end, or the sum over parts, as the status was found.
    let dynamics = Check::of(found.end_error, VERIFIED * tolerance.sqrt());
    if !found.status.is_converged() && between.cost.is_nan() {
        return Verification { dynamics, ..Verification::skipped("the motion did not converge") };
    }
    let (robot, names) = (&task.problem.robot, task.problem.named_coordinates().0);
    let position = |entry: usize| robot.plain_entries().find(|(at, _)| *at == entry).map(|(_, i)| i);
    let at = |place: Option<(f64, usize)>, coordinate: &dyn Fn(usize) -> Option<usize>| {
        let name = place.and_then(|(_, k)| coordinate(k)).map(|i| names[i].clone());
        (place.map(|(time, _)| time), name)
    };
    let (limit_time, limited) = at(between.excess_at, &position);
    let (gap_time, driven) = at(between.stationarity_at, &|k| task.driven.get(k).copied());
    Verification {
        integrated_cost: between.cost.is_finite().then_some(between.cost),
        cost: Check::of(between.cost_difference, tolerance),
        dynamics,
        limits: Check::of(between.excess, EXCESS).at(limit_time, limited),
        overshoot: Check::skipped("torques are controls, which are cut to their limits"),
        optimality: Check::of(between.gap, GAP * tolerance).at(gap_time, driven),
        stationarity: Some(between.stationarity).filter(|_| between.gap.is_finite()),
        costate_defect: Some(between.costate_defect).filter(|_| between.gap.is_finite()),
        ..Verification::default()
    }
}
