//! The values of a trajectory in files: one row per node.

use crate::result::free_entries::FreeEntries;
use crate::result::solution::RobotNames;
use crate::result::trajectory::Trajectory;
use crate::result::trajectory_error::{TrajectoryError, VERSION, check_version};
use crate::status::Status;
use costate::robot::Robot;
use serde::de::{Error, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;
use std::marker::PhantomData;

/// One row per node; y = (y_q, y_p). `y_tau` where it is not y_p.
#[derive(Serialize, Deserialize)]
pub(crate) struct Rows {
    #[serde(deserialize_with = "limited")]
    pub t: Vec<f64>,
    #[serde(deserialize_with = "limited")]
    pub q: Vec<Vec<f64>>,
    #[serde(deserialize_with = "limited")]
    pub v: Vec<Vec<f64>>,
    #[serde(deserialize_with = "limited")]
    pub p: Vec<Vec<f64>>,
    #[serde(deserialize_with = "limited")]
    pub u: Vec<Vec<f64>>,
    #[serde(deserialize_with = "limited")]
    pub y: Vec<Vec<f64>>,
    #[serde(default, skip_serializing_if = "Vec::is_empty", deserialize_with = "limited")]
    pub y_tau: Vec<Vec<f64>>,
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

/// What a warm start needs of the same document.
#[derive(Deserialize)]
struct StartDocument {
    format: Option<u32>,
    robot: Option<String>,
    joints: Option<Vec<String>>,
    status: Option<Status>,
    #[serde(default)]
    via_times: Vec<f64>,
    free_joints: Option<Vec<FreeEntries>>,
    trajectory: Rows,
}

/// The same, to be written.
#[derive(Serialize)]
struct WrittenStart<'a> {
    format: u32,
    robot: &'a str,
    joints: &'a [String],
    via_times: &'a [f64],
    free_joints: &'a [FreeEntries],
    trajectory: Rows,
}

impl From<&Trajectory> for Rows {
    fn from(trajectory: &Trajectory) -> Self {
        let Trajectory { t, q, v, p, u, y_q, y_p, y_tau, .. } = trajectory.clone();
        let y = y_q.into_iter().zip(y_p).map(|(y_q, y_p)| [y_q, y_p].concat()).collect();
        Self { t, q, v, p, u, y, y_tau }
    }
}

impl Rows {
    /// Of a robot of n joints; the rows must have been checked.
    pub fn into_trajectory(self, n: usize) -> Trajectory {
        let Self { t, q, v, p, u, y, y_tau } = self;
        let (y_q, y_p) = y.iter().map(|y| (y[..n].to_vec(), y[n..].to_vec())).unzip();
        Trajectory::from_rows(t, [q, v, p, u, y_q, y_p]).with_y_tau(y_tau)
    }

    /// Whether nothing was saved, as for a problem without a motion.
    pub fn is_empty(&self) -> bool {
        let Self { t, q, v, p, u, y, y_tau } = self;
        t.is_empty() && [q, v, p, u, y, y_tau].into_iter().all(Vec::is_empty)
    }

    /// Vias are passed one after the other, at times of nodes.
    pub fn check_vias(&self, times: &[f64]) -> Result<(), TrajectoryError> {
        let inside =
            |time: &f64| self.t.first() < Some(time) && Some(time) < self.t.last() && self.t.contains(time);
        let rising = times.windows(2).all(|pair| pair[0] < pair[1]);
        if rising && times.iter().all(inside) { Ok(()) } else { Err(TrajectoryError::BadTimes) }
    }

    /// Lists of a motion with n degrees of freedom and nq positions.
    pub fn check(&self, n: usize, nq: usize) -> Result<(), TrajectoryError> {
        let count = self.t.len();
        let rising = self.t.windows(2).all(|pair| pair[0] <= pair[1]);
        if count < 2 || !rising || self.t[count - 1] <= self.t[0] || self.t.iter().any(|t| !t.is_finite()) {
            return Err(TrajectoryError::BadTimes);
        }
        let lists = [("q", &self.q, nq), ("v", &self.v, n), ("p", &self.p, n), ("u", &self.u, n)];
        let by_torques = (!self.y_tau.is_empty()).then_some(("y_tau", &self.y_tau, n));
        for (key, rows, expected) in lists.into_iter().chain([("y", &self.y, 2 * n)]).chain(by_torques) {
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
    /// [`TrajectoryError`]: no saved solution, one without a motion, more than 16 MiB or 100 000 nodes, a
    /// newer version, a motion of another robot (by the names of its joints, where the file holds them), or
    /// lists whose lengths do not fit.
    pub fn from_json(text: &str, robot: &Robot) -> Result<Self, TrajectoryError> {
        if text.len() > Self::MOST_BYTES {
            return Err(TrajectoryError::TooLong { most: Self::MOST_BYTES });
        }
        let read: StartDocument =
            serde_json::from_str(text).map_err(|error| TrajectoryError::unreadable(text, error))?;
        let missing =
            || TrajectoryError::NotASolution { problem: "the key `format` is missing".into(), source: None };
        check_version(read.format.ok_or_else(missing)?)?;
        let names = RobotNames::of(robot);
        if let Some(found_joints) = read.joints.filter(|found| *found != names.joints) {
            let found = read.robot.unwrap_or_default();
            return Err(TrajectoryError::OtherRobot { found, found_joints, joints: names.joints });
        }
        if read.trajectory.is_empty() {
            let status = read.status.map_or("unknown".into(), |status| status.name().to_owned());
            return Err(TrajectoryError::NoMotion { status });
        }
        let n = names.joints.len();
        if let Some(found) = &read.free_joints {
            FreeEntries::check_robot(found, read.robot.as_deref().unwrap_or_default(), robot)?;
        }
        read.trajectory.check(n, robot.nq())?;
        read.trajectory.check_vias(&read.via_times)?;
        let trajectory = read.trajectory.into_trajectory(n).with_via_times(read.via_times);
        Ok(trajectory.with_free_joints(FreeEntries::of(robot)))
    }

    /// The motion as [`from_json`](Self::from_json) reads it, for a robot with these names.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn to_json(&self, names: &RobotNames) -> Result<String, serde_json::Error> {
        serde_json::to_string(&WrittenStart {
            format: VERSION,
            robot: &names.robot,
            joints: &names.joints,
            via_times: &self.via_times,
            free_joints: &self.free_joints,
            trajectory: Rows::from(self),
        })
    }

    /// The name of the robot in a saved solution, where it holds one.
    ///
    /// Joints of the same names do not make the same robot: a caller can warn about another name.
    pub fn saved_robot(text: &str) -> Option<String> {
        #[derive(Deserialize)]
        struct Named {
            robot: Option<String>,
        }
        serde_json::from_str::<Named>(text).ok()?.robot
    }

    /// Whether the trajectory can be a warm start for this robot.
    ///
    /// # Errors
    /// [`TrajectoryError`]: lists whose lengths do not fit, or numbers that are not finite.
    pub fn check(&self, robot: &Robot) -> Result<(), TrajectoryError> {
        Rows::from(self).check(robot.dof(), robot.nq())
    }
}
