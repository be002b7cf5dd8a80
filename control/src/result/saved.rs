//! The JSON form of a solution: what the command line prints and saves.

use crate::options::{SolverOptions, Verify};
use crate::result::constraint_forces::ConstraintForces;
use crate::result::free_entries::FreeEntries;
use crate::result::gait::GaitReport;
use crate::result::limit_use::LimitReport;
use crate::result::motion::{Certificate, Motion};
use crate::result::polish_report::PolishReport;
use crate::result::rows::Rows;
use crate::result::saved_parts::{SavedCostates, SavedStart, SavedViolation, UNITS, Units, finite};
use crate::result::solution::{CostateStart, RobotNames, Solution};
use crate::result::start::StartResult;
use crate::result::trajectory_error::{TrajectoryError, VERSION, check_version};
use crate::result::verification::Verification;
use crate::status::Status;
use serde::de::Error;
use serde::{Deserialize, Deserializer, Serialize};

/// A solution. A number that is not finite is null.
#[derive(Serialize, Deserialize)]
struct Document {
    #[serde(default)]
    format: u32,
    #[serde(default)]
    costate: String,
    #[serde(default)]
    robot: String,
    joints: Option<Vec<String>>,
    #[serde(skip_deserializing, default = "units")]
    units: Units,
    status: Status,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    bounds: Option<SavedViolation>,
    cost: Option<f64>,
    #[serde(default)]
    penalty_cost: Option<f64>,
    #[serde(default)]
    smoothing: f64,
    #[serde(default)]
    smoothing_bound: f64,
    final_time: Option<f64>,
    hamiltonian: Option<f64>,
    hamiltonian_drift: Option<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    via_times: Vec<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    phase_hamiltonians: Vec<f64>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    free_joints: Vec<FreeEntries>,
    #[serde(default)]
    costate_start: SavedCostates,
    end_defect: Option<f64>,
    shooting_defect: Option<f64>,
    #[serde(default)]
    cost_error: Option<f64>,
    #[serde(default)]
    finer_mesh: Option<f64>,
    #[serde(default)]
    duality_gap: Option<f64>,
    #[serde(default)]
    newton_decrement: Option<f64>,
    #[serde(default)]
    stationarity: Option<f64>,
    #[serde(default = "not_verified")]
    verification: Verify,
    #[serde(default)]
    conditioning: Option<f64>,
    #[serde(default)]
    newton_iterations: usize,
    #[serde(default)]
    nodes: usize,
    #[serde(default)]
    conjugate_time: Option<f64>,
    #[serde(default)]
    conjugate_multiplicity: usize,
    #[serde(default = "not_checked")]
    certificate: Certificate,
    #[serde(default)]
    switches: Vec<f64>,
    #[serde(default)]
    limits: LimitReport,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    constraints: Vec<ConstraintForces>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    gait: Option<GaitReport>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    polish: Option<PolishReport>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    verified: Option<Verification>,
    #[serde(default)]
    starts: Vec<SavedStart>,
    #[serde(default)]
    options: SolverOptions,
    trajectory: Rows,
}

fn units() -> Units {
    UNITS
}

fn not_verified() -> Verify {
    Verify::None
}

fn not_checked() -> Certificate {
    Certificate::NotChecked
}

impl Serialize for Solution {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Document::from(self).serialize(serializer)
    }
}

impl<'de> Deserialize<'de> for Solution {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Document::deserialize(deserializer)?.try_into().map_err(Error::custom)
    }
}

impl From<&Solution> for Document {
    fn from(solution: &Solution) -> Self {
        let motion = &solution.motion;
        let CostateStart { y_q, y_p } = solution.costate_start();
        Self {
            format: VERSION,
            costate: env!("CARGO_PKG_VERSION").into(),
            robot: solution.robot.robot.clone(),
            joints: Some(solution.robot.joints.clone()),
            units: UNITS,
            status: motion.status.clone(),
            bounds: motion
                .bound_violation
                .map(|violation| SavedViolation::new(violation, &solution.robot.joints)),
            cost: finite(motion.cost),
            penalty_cost: finite(motion.penalty_cost),
            smoothing: motion.smoothing,
            smoothing_bound: motion.smoothing_bound,
            final_time: finite(motion.final_time),
            hamiltonian: finite(motion.hamiltonian),
            hamiltonian_drift: finite(motion.hamiltonian_drift),
            via_times: solution.trajectory.via_times.clone(),
            free_joints: solution.trajectory.free_joints.clone(),
            phase_hamiltonians: match solution.trajectory.via_times.is_empty() {
                true => Vec::new(),
                false => motion.phase_hamiltonians.clone(),
            },
            costate_start: SavedCostates { y_q: y_q.to_vec(), y_p: y_p.to_vec() },
            end_defect: finite(solution.end_defect),
            shooting_defect: finite(motion.shooting_defect),
            cost_error: solution.cost_error(),
            finer_mesh: finite(motion.finer_mesh),
            duality_gap: finite(motion.duality_gap),
            newton_decrement: finite(motion.newton_decrement),
            stationarity: finite(motion.stationarity),
            verification: motion.verification,
            conditioning: finite(motion.conditioning),
            newton_iterations: solution.newton_iterations,
            nodes: solution.nodes(),
            conjugate_time: motion.conjugate_time,
            conjugate_multiplicity: motion.conjugate_multiplicity,
            certificate: motion.certificate,
            switches: motion.switches.clone(),
            limits: solution.limits.clone(),
            constraints: solution.constraints.clone(),
            gait: solution.gait.clone(),
            polish: solution.polish.clone(),
            verified: solution.verified.clone(),
            starts: solution.starts.iter().map(SavedStart::from).collect(),
            options: solution.options.clone(),
            trajectory: Rows::from(&solution.trajectory),
        }
    }
}

impl TryFrom<Document> for Solution {
    type Error = TrajectoryError;

    /// Errors of components of extremals, the iterations, the values between nodes and the times of stages
    /// are not in the document.
    fn try_from(document: Document) -> Result<Self, TrajectoryError> {
        check_version(document.format)?;
        let n = document.trajectory.v.first().map_or(0, Vec::len);
        if !document.trajectory.is_empty() {
            if !FreeEntries::fit(&document.free_joints, n) {
                return Err(TrajectoryError::FreeJoints);
            }
            document.trajectory.check(n, n + document.free_joints.len())?;
            document.trajectory.check_vias(&document.via_times)?;
        }
        let joints = document.joints.unwrap_or_default();
        let violation = document.bounds.map(|bounds| bounds.into_violation(&joints)).transpose()?;
        let motion = Motion {
            cost: document.cost.unwrap_or(f64::INFINITY),
            penalty_cost: document.penalty_cost.unwrap_or(0.0),
            smoothing: document.smoothing,
            smoothing_bound: document.smoothing_bound,
            hamiltonian: document.hamiltonian.unwrap_or(f64::NAN),
            hamiltonian_drift: document.hamiltonian_drift.unwrap_or(f64::INFINITY),
            phase_hamiltonians: document.phase_hamiltonians,
            shooting_defect: document.shooting_defect.unwrap_or(f64::INFINITY),
            finer_mesh: document.finer_mesh.unwrap_or(f64::NAN),
            duality_gap: document.duality_gap.unwrap_or(f64::NAN),
            newton_decrement: document.newton_decrement.unwrap_or(f64::NAN),
            stationarity: document.stationarity.unwrap_or(f64::NAN),
            verification: document.verification,
            conditioning: document.conditioning.unwrap_or(f64::NAN),
            conjugate_time: document.conjugate_time,
            conjugate_multiplicity: document.conjugate_multiplicity,
            certificate: document.certificate,
            switches: document.switches,
            errors: document.cost_error.into_iter().collect(),
            bound_violation: violation,
            ..Motion::missing(document.status, document.final_time.unwrap_or(f64::NAN))
        };
        let trajectory = document.trajectory.into_trajectory(n).with_via_times(document.via_times);
        let trajectory = trajectory.with_free_joints(document.free_joints);
        Ok(Self {
            motion,
            end_defect: document.end_defect.unwrap_or(f64::INFINITY),
            newton_iterations: document.newton_iterations,
            trajectory,
            starts: document.starts.into_iter().map(StartResult::from).collect(),
            limits: document.limits,
            constraints: document.constraints,
            gait: document.gait,
            polish: document.polish,
            verified: document.verified,
            stage_times: None,
            options: document.options,
            robot: RobotNames { robot: document.robot, joints },
        })
    }
}

#[cfg(test)]
#[path = "saved_tests.rs"]
mod tests;
