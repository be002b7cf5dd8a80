//! An optimal motion of a robot, as it is saved.

use super::error::ProblemError;
use super::motion::{Certificate, Motion};
use super::options::Iteration;
use super::problem::Problem;
use super::search::PATH;
use super::status::Status;
use serde::{Deserialize, Serialize};

/// What solving a [`Problem`] gave; with a status other than [`Status::Converged`] the best iterate.
///
/// Saved and loaded by serde; errors, iterations and other starts are written, but not read again.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Solution {
    /// How it ended.
    pub status: Status,
    /// `c_t T + integral of 1/2 sum r_i u_i^2`, without penalties.
    pub cost: f64,
    /// Integral of the penalties.
    #[serde(default)]
    pub penalty_cost: f64,
    /// Weight of the effort of controls that cost nothing that is still there, in parts of one that makes it matter: 0 where
    /// the switches of a motion of least time were found; else cost and penalties are those of a control that is nearly so.
    #[serde(default)]
    pub smoothing: f64,
    /// T (s).
    pub final_time: f64,
    /// Mean of H* along the motion; `dJ/dT = -H*`.
    pub hamiltonian: f64,
    /// `max |H* - mean| / max (|y'f| + |l|)`: zero for an exact solution.
    pub hamiltonian_drift: f64,
    /// (y_q, y_p) at the start: `y(0) = -dJ/dx(0)`.
    pub costate_start: (Vec<f64>, Vec<f64>),
    /// Largest miss of a position or rate that is fixed at the end, when the motion is integrated again with the control that
    /// was found, by an adaptive integrator (rad, m, rad/s, m/s); infinite where that was not possible.
    #[serde(default = "infinite", deserialize_with = "infinite_or_number")]
    pub end_defect: f64,
    /// Largest mismatch at the borders of at most 20 segments of each arc when (q, p, y_q, y_p) is integrated again over each of
    /// them from the values found at its start, in parts of the size of the component; infinite where that was not possible.
    #[serde(default = "infinite", deserialize_with = "infinite_or_number")]
    pub shooting_defect: f64,
    /// Newton steps on extremals, all meshes and starts together.
    pub newton_iterations: usize,
    /// Nodes of the last mesh.
    pub nodes: usize,
    /// First conjugate time (s), if there is one before T.
    #[serde(default)]
    pub conjugate_time: Option<f64>,
    /// What follows from it.
    #[serde(default = "not_checked")]
    pub certificate: Certificate,
    /// Estimated error of each component (q, p, y_q, y_p), or (q, v, y_q, y_v) where these were the coordinates of the search,
    /// in parts of its largest value.
    #[serde(default, skip_deserializing)]
    pub errors: Vec<f64>,
    /// The Newton steps, and those on the way to a path.
    #[serde(default, skip_deserializing)]
    pub iterations: Vec<Iteration>,
    /// The motion.
    pub trajectory: Trajectory,
    /// Times (s) at which a control reaches or leaves a bound.
    #[serde(default)]
    pub switches: Vec<f64>,
    /// Cost, penalties included, and status of each start, in their order; the best of them is this solution.
    #[serde(default, skip_deserializing)]
    pub others: Vec<(f64, Status)>,
}

fn infinite() -> f64 {
    f64::INFINITY
}

/// JSON writes an infinite number as null.
fn infinite_or_number<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    Ok(Option::<f64>::deserialize(deserializer)?.unwrap_or(f64::INFINITY))
}

fn not_checked() -> Certificate {
    Certificate::NotChecked
}

/// A motion at the nodes of its mesh; at a switch two nodes have the same time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Trajectory {
    /// Times (s).
    pub t: Vec<f64>,
    /// Positions (rad, m).
    pub q: Vec<Vec<f64>>,
    /// Rates (rad/s, m/s).
    pub v: Vec<Vec<f64>>,
    /// Momenta.
    pub p: Vec<Vec<f64>>,
    /// Controls (N m, N; before the gain).
    pub u: Vec<Vec<f64>>,
    /// Costates of q.
    pub y_q: Vec<Vec<f64>>,
    /// Costates of p.
    pub y_p: Vec<Vec<f64>>,
    /// H*.
    #[serde(default)]
    pub hamiltonian: Vec<f64>,
}

impl Trajectory {
    /// Number of joints, where all arrays agree about it and about the number of nodes, which must be two or more.
    pub fn joints(&self) -> Option<usize> {
        let (nodes, n) = (self.t.len(), self.q.first()?.len());
        let arrays = [&self.q, &self.p, &self.y_q, &self.y_p];
        let agree = arrays.iter().all(|array| array.len() == nodes && array.iter().all(|row| row.len() == n));
        let finite = arrays.iter().all(|array| array.iter().flatten().all(|value| value.is_finite()));
        let rising = self.t.windows(2).all(|pair| pair[0] <= pair[1]);
        (nodes > 1 && n > 0 && agree && finite && rising).then_some(n)
    }
}

impl Solution {
    /// Cost and penalties together: what was minimised.
    pub fn total(&self) -> f64 {
        self.cost + self.penalty_cost
    }

    /// From a motion in (q, p), the rates at its nodes, and the miss at its end.
    pub(super) fn from_motion(motion: Motion, v: Vec<Vec<f64>>, end_defect: f64) -> Self {
        let n = v.first().map_or(0, Vec::len);
        let part = |k: usize| motion.z.iter().map(|z| z[k * n..(k + 1) * n].to_vec()).collect::<Vec<_>>();
        let (y_q, y_p) = (part(2), part(3));
        let first = |part: &[Vec<f64>]| part.first().cloned().unwrap_or_default();
        Self {
            status: motion.status,
            cost: motion.cost,
            penalty_cost: motion.penalty_cost,
            smoothing: motion.smoothing,
            final_time: motion.final_time,
            hamiltonian: motion.hamiltonian,
            hamiltonian_drift: motion.hamiltonian_drift,
            costate_start: (first(&y_q), first(&y_p)),
            end_defect,
            shooting_defect: motion.shooting_defect.unwrap_or(f64::INFINITY),
            newton_iterations: motion.iterations.iter().filter(|step| step.phase != PATH).count(),
            nodes: motion.t.len(),
            conjugate_time: motion.conjugate_time,
            certificate: motion.certificate,
            errors: motion.errors,
            iterations: motion.iterations,
            switches: motion.switches,
            others: Vec::new(),
            trajectory: Trajectory {
                t: motion.t,
                q: part(0),
                v,
                p: part(1),
                u: motion.u,
                y_q,
                y_p,
                hamiltonian: motion.hamiltonians,
            },
        }
    }
}

impl Problem {
    /// Whether a saved solution can be a start for this problem.
    ///
    /// # Errors
    /// [`ProblemError::OtherRobot`] where its trajectory is that of another robot, or not whole.
    pub fn check_start(&self, start: &Solution) -> Result<(), ProblemError> {
        let (expected, found) = (self.robot.dof(), start.trajectory.joints().unwrap_or(0));
        if found == expected { Ok(()) } else { Err(ProblemError::OtherRobot { expected, found }) }
    }

    /// What the motion does beyond the limits of the robot's joints, which are not enforced; one sentence each.
    pub fn limit_warnings(&self, solution: &Solution) -> Vec<String> {
        let trajectory = &solution.trajectory;
        let range = |rows: &[Vec<f64>], i: usize, factor: f64| {
            let values = rows.iter().map(|row| factor * row[i]);
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let mut warnings = Vec::new();
        for (i, joint) in self.robot.joints().iter().enumerate() {
            let limits = &joint.limits;
            let ranges = [
                ("position", range(&trajectory.q, i, 1.0), (limits.lower, limits.upper)),
                ("rate", range(&trajectory.v, i, 1.0), (-limits.velocity, limits.velocity)),
                ("effort", range(&trajectory.u, i, self.gain[i]), (-limits.effort, limits.effort)),
            ];
            for (what, (low, high), (least, most)) in ranges {
                let slack = 1e-9 * (high - low).abs().max(high.abs());
                if low < least - slack || high > most + slack {
                    warnings.push(format!(
                        "{what} of joint '{}' runs from {low:.4} to {high:.4}, beyond its limits {least} to {most}",
                        joint.name
                    ));
                }
            }
        }
        warnings
    }
}
