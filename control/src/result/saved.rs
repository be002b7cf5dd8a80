//! The JSON form of a solution: what the command line prints and saves, and what a warm start reads.

use crate::options::SolverOptions;
use crate::result::motion::{Certificate, Motion};
use crate::result::solution::{RobotNames, Solution, StartResult};
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::{TrajectoryError, VERSION};
use crate::status::Status;
use costate::robot::Robot;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::marker::PhantomData;

/// Units of the numbers in the file.
#[derive(Serialize)]
struct Units {
    time: &'static str,
    revolute: &'static str,
    prismatic: &'static str,
}

const UNITS: Units = Units { time: "s", revolute: "rad, rad/s, N m", prismatic: "m, m/s, N" };

#[derive(Default, Serialize, Deserialize)]
struct CostateStart {
    y_q: Vec<f64>,
    y_p: Vec<f64>,
}

/// One row per node; y = (y_q, y_p).
#[derive(Serialize, Deserialize)]
struct Rows {
    #[serde(deserialize_with = "limited")]
    t: Vec<f64>,
    #[serde(deserialize_with = "limited")]
    q: Vec<Vec<f64>>,
    #[serde(deserialize_with = "limited")]
    v: Vec<Vec<f64>>,
    #[serde(deserialize_with = "limited")]
    p: Vec<Vec<f64>>,
    #[serde(deserialize_with = "limited")]
    u: Vec<Vec<f64>>,
    #[serde(deserialize_with = "limited")]
    y: Vec<Vec<f64>>,
}

/// Most nodes of a motion; empty rows of a short text would fill the memory otherwise.
const MOST_NODES: usize = 100_000;

/// A list of at most [`MOST_NODES`] entries.
fn limited<'de, T: Deserialize<'de>, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<T>, D::Error> {
    struct List<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for List<T> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a list of at most {MOST_NODES} entries")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut entries: A) -> Result<Vec<T>, A::Error> {
            let mut list = Vec::new();
            while let Some(entry) = entries.next_element()? {
                if list.len() == MOST_NODES {
                    return Err(A::Error::invalid_length(MOST_NODES + 1, &self));
                }
                list.push(entry);
            }
            Ok(list)
        }
    }
    deserializer.deserialize_seq(List(PhantomData))
}

#[derive(Serialize, Deserialize)]
struct SavedStart {
    total: Option<f64>,
    status: Status,
}

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
    cost: Option<f64>,
    #[serde(default)]
    penalty_cost: Option<f64>,
    #[serde(default)]
    smoothing: f64,
    final_time: f64,
    hamiltonian: Option<f64>,
    hamiltonian_drift: Option<f64>,
    #[serde(default)]
    costate_start: CostateStart,
    end_defect: Option<f64>,
    shooting_defect: Option<f64>,
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
    starts: Vec<SavedStart>,
    #[serde(default)]
    options: SolverOptions,
    trajectory: Rows,
}

fn units() -> Units {
    UNITS
}

fn not_checked() -> Certificate {
    Certificate::NotChecked
}

/// What a warm start needs of the same document.
#[derive(Deserialize)]
struct StartDocument {
    format: Option<u32>,
    robot: Option<String>,
    joints: Option<Vec<String>>,
    trajectory: Rows,
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

fn finite(x: f64) -> Option<f64> {
    x.is_finite().then_some(x)
}

impl From<&Solution> for Document {
    fn from(solution: &Solution) -> Self {
        let motion = &solution.motion;
        let (y_q, y_p) = solution.costate_start();
        let start =
            |start: &StartResult| SavedStart { total: finite(start.total), status: start.status.clone() };
        Self {
            format: VERSION,
            costate: env!("CARGO_PKG_VERSION").into(),
            robot: solution.robot.robot.clone(),
            joints: Some(solution.robot.joints.clone()),
            units: UNITS,
            status: motion.status.clone(),
            cost: finite(motion.cost),
            penalty_cost: finite(motion.penalty_cost),
            smoothing: motion.smoothing,
            final_time: motion.final_time,
            hamiltonian: finite(motion.hamiltonian),
            hamiltonian_drift: finite(motion.hamiltonian_drift),
            costate_start: CostateStart { y_q: y_q.to_vec(), y_p: y_p.to_vec() },
            end_defect: finite(solution.end_defect),
            shooting_defect: finite(motion.shooting_defect),
            newton_iterations: solution.newton_iterations,
            nodes: solution.nodes(),
            conjugate_time: motion.conjugate_time,
            conjugate_multiplicity: motion.conjugate_multiplicity,
            certificate: motion.certificate,
            switches: motion.switches.clone(),
            starts: solution.starts.iter().map(start).collect(),
            options: solution.options.clone(),
            trajectory: Rows::from(&solution.trajectory),
        }
    }
}

impl TryFrom<Document> for Solution {
    type Error = TrajectoryError;

    /// Errors of components, the iterations and the values between nodes are not in the document.
    fn try_from(document: Document) -> Result<Self, TrajectoryError> {
        check_version(document.format)?;
        let n = document.trajectory.q.first().map_or(0, Vec::len);
        if !document.trajectory.is_empty() {
            document.trajectory.check(n)?;
        }
        let motion = Motion {
            cost: document.cost.unwrap_or(f64::INFINITY),
            penalty_cost: document.penalty_cost.unwrap_or(0.0),
            smoothing: document.smoothing,
            hamiltonian: document.hamiltonian.unwrap_or(f64::NAN),
            hamiltonian_drift: document.hamiltonian_drift.unwrap_or(f64::INFINITY),
            shooting_defect: document.shooting_defect.unwrap_or(f64::INFINITY),
            conjugate_time: document.conjugate_time,
            conjugate_multiplicity: document.conjugate_multiplicity,
            certificate: document.certificate,
            switches: document.switches,
            ..Motion::missing(document.status, document.final_time)
        };
        let start = |start: SavedStart| StartResult {
            total: start.total.unwrap_or(f64::INFINITY),
            status: start.status,
        };
        Ok(Self {
            motion,
            end_defect: document.end_defect.unwrap_or(f64::INFINITY),
            newton_iterations: document.newton_iterations,
            trajectory: document.trajectory.into_trajectory(n),
            starts: document.starts.into_iter().map(start).collect(),
            options: document.options,
            robot: RobotNames { robot: document.robot, joints: document.joints.unwrap_or_default() },
        })
    }
}

fn check_version(found: u32) -> Result<(), TrajectoryError> {
    if found > VERSION { Err(TrajectoryError::Version { found }) } else { Ok(()) }
}

impl From<&Trajectory> for Rows {
    fn from(trajectory: &Trajectory) -> Self {
        let Trajectory { t, q, v, p, u, y_q, y_p, .. } = trajectory.clone();
        let y = y_q.into_iter().zip(y_p).map(|(y_q, y_p)| [y_q, y_p].concat()).collect();
        Self { t, q, v, p, u, y }
    }
}

impl Rows {
    /// Of a robot of n joints; the rows must have been checked.
    fn into_trajectory(self, n: usize) -> Trajectory {
        let Self { t, q, v, p, u, y } = self;
        let (y_q, y_p) = y.iter().map(|y| (y[..n].to_vec(), y[n..].to_vec())).unzip();
        Trajectory::from_rows(t, [q, v, p, u, y_q, y_p])
    }

    /// Whether nothing was saved, as for a problem without a motion.
    fn is_empty(&self) -> bool {
        let Self { t, q, v, p, u, y } = self;
        t.is_empty() && [q, v, p, u, y].into_iter().all(Vec::is_empty)
    }

    fn check(&self, n: usize) -> Result<(), TrajectoryError> {
        let count = self.t.len();
        let rising = self.t.windows(2).all(|pair| pair[0] <= pair[1]);
        if count < 2 || !rising || self.t[count - 1] <= self.t[0] || self.t.iter().any(|t| !t.is_finite()) {
            return Err(TrajectoryError::BadTimes);
        }
        let lists = [("q", &self.q, n), ("v", &self.v, n), ("p", &self.p, n), ("u", &self.u, n)];
        for (key, rows, expected) in lists.into_iter().chain([("y", &self.y, 2 * n)]) {
            if rows.len() != count {
                return Err(TrajectoryError::WrongRows { key, found: rows.len(), expected: count });
            }
            for (row, entries) in rows.iter().enumerate() {
                if entries.len() != expected {
                    return Err(TrajectoryError::WrongLength { key, row, found: entries.len(), expected });
                }
                if entries.iter().any(|entry| !entry.is_finite()) {
                    return Err(TrajectoryError::NotFinite { key, row });
                }
            }
        }
        Ok(())
    }
}

impl Trajectory {
    /// Longest text of a saved solution that is read: 16 MiB. Reading it takes less than 256 MB.
    pub const MOST_BYTES: usize = 16 << 20;

    /// Reads the trajectory of a saved solution, as a warm start for this robot.
    ///
    /// # Errors
    /// [`TrajectoryError`]: no saved solution, more than 16 MiB or 100 000 nodes, a newer version, a motion of another robot (by the names of its joints,
    /// where the file holds them), or lists whose lengths do not fit.
    pub fn from_json(text: &str, robot: &Robot) -> Result<Self, TrajectoryError> {
        if text.len() > Self::MOST_BYTES {
            return Err(TrajectoryError::TooLong { most: Self::MOST_BYTES });
        }
        let read: StartDocument = serde_json::from_str(text).map_err(TrajectoryError::NotASolution)?;
        check_version(read.format.unwrap_or(0))?;
        let names = RobotNames::of(robot);
        if let Some(found_joints) = read.joints.filter(|found| *found != names.joints) {
            let found = read.robot.unwrap_or_default();
            return Err(TrajectoryError::OtherRobot { found, found_joints, joints: names.joints });
        }
        read.trajectory.check(names.joints.len())?;
        Ok(read.trajectory.into_trajectory(names.joints.len()))
    }

    /// Whether the trajectory can be a warm start for this robot.
    ///
    /// # Errors
    /// [`TrajectoryError`]: lists whose lengths do not fit, or numbers that are not finite.
    pub fn check(&self, robot: &Robot) -> Result<(), TrajectoryError> {
        Rows::from(self).check(robot.joints().len())
    }
}

#[cfg(test)]
#[path = "saved_tests.rs"]
mod tests;
