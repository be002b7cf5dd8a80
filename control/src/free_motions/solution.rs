//! A motion of the robot with its figures.

use super::task::FreeTask;
use super::{rows, uses, verify};
use crate::constants::direct::VERIFIED;
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
        verified: verifies.then(|| Verification {
            // The end, or the sum over parts, as the status was found.
            dynamics: Check::of(found.end_error, VERIFIED * options.tolerance.sqrt()),
            ..Verification::skipped("floating and spherical joints: verified by their integration alone")
        }),
        stage_times: None,
        trajectory,
        starts: Vec::new(),
        options: options.clone(),
        robot: RobotNames::of(&problem.robot),
    })
}
