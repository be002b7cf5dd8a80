//! How a motion uses its hard limits.

use super::infeasibility::Infeasibility;
use serde::{Deserialize, Serialize};

/// The name of the power of all joints together.
pub(crate) const ALL_JOINTS: &str = "all joints";

/// How a motion uses its hard limits, by what is limited; `None` where nothing is.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
#[non_exhaustive]
pub struct LimitReport {
    /// q (rad, m).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<LimitUse>,
    /// v (rad/s, m/s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<LimitUse>,
    /// a (rad/s^2, m/s^2).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub acceleration: Option<LimitUse>,
    /// tau (N m, N).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque: Option<LimitUse>,
    /// The jerk (rad/s^3, m/s^3).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub jerk: Option<LimitUse>,
    /// d tau/dt (N m/s, N/s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_rate: Option<LimitUse>,
    /// tau v (W); that of all joints together has the name "all joints".
    #[serde(skip_serializing_if = "Option::is_none")]
    pub power: Option<LimitUse>,
    /// tau where a motor drives fast (N m, N): its limit depends on v.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub torque_speed: Option<LimitUse>,
    /// Forces of the ground on the feet of a gait along the edges of their friction cones (N), of soles
    /// torques about the toe (N m) and the load of the toe (N); in space by how much the wrench on a foot is
    /// within each side of its cone (N, N m). None is negative.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ground_force: Option<LimitUse>,
    /// The same of the impulses of the landing (N s, N m s).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub landing_impulse: Option<LimitUse>,
    /// Tools (m, rad, m/s) and clearances (m), at the ends too.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub task: Option<LimitUse>,
    /// Why no motion keeps all limits, with [`Status::Infeasible`](crate::Status::Infeasible), or which ones
    /// are exceeded, with [`Status::LocallyInfeasible`](crate::Status::LocallyInfeasible).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub infeasible: Option<Infeasibility>,
}

/// How a motion uses the limits of one kind.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct LimitUse {
    /// Largest violation at the points of the motion, in the unit of the limit.
    pub at_points: f64,
    /// Largest violation between them, the ends of intervals included. Where an acceleration, a torque, a
    /// power, a jerk or the rate of a torque jumps inside of an interval it may overshoot there, the shorter
    /// the finer the mesh. Torques are cut to their limits in the trajectory; this is how much more the
    /// polynomial would need.
    pub between: f64,
    /// The largest violation at the points, if there is any beyond rounding: 1e-7 of the distance between
    /// lower and upper limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst: Option<LimitViolation>,
    /// The largest violation between the points, if it is more than 1e-4 of the distance between lower and
    /// upper limit. That of a torque is what the polynomial would need; the torque itself is cut to its
    /// limit.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub worst_between: Option<LimitViolation>,
    /// Where the motion is at a limit: within 1e-4 of the distance between lower and upper limit.
    pub active: Vec<ActiveLimit>,
}

/// Where a limit is exceeded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct LimitViolation {
    /// Name of the joint, "all joints", or the name of what a tool or a body does not keep.
    /// In JSON its key is `joint`.
    #[serde(rename = "joint")]
    pub name: String,
    /// When (s).
    pub time: f64,
    /// By how much it is exceeded.
    pub excess: f64,
    /// The same relative to its range, the distance between lower and upper limit.
    #[serde(default)]
    pub part: f64,
    /// Whether what is limited may jump along the motion, as accelerations do where torques are not limited
    /// in their rates: between the points its polynomial overshoots beside a jump.
    #[serde(default)]
    pub jumps: bool,
    /// The unit of `excess`, and of the other two where joints are limited.
    pub unit: String,
    /// The value there; of a tool or a clearance that of the function that is limited.
    pub value: f64,
    /// The limit. Of a motor that drives beyond its no-load speed, where it has no torque left, 0.
    pub limit: f64,
    /// The rate of the joint, where the torque of its motor is limited by it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<f64>,
}

/// A span of time in which a joint, a tool or a body is at a limit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct ActiveLimit {
    /// Name of the joint, "all joints", or the name of what a tool or a body keeps.
    /// In JSON its key is `joint`.
    #[serde(rename = "joint")]
    pub name: String,
    /// "min" or "max".
    pub side: String,
    /// Start (s).
    pub from: f64,
    /// End (s).
    pub to: f64,
}

impl ActiveLimit {
    /// The spans in which a limit is active, from times in their order and whether it is so then.
    pub(crate) fn spans(name: &str, side: &str, times: impl Iterator<Item = (f64, bool)>) -> Vec<Self> {
        let (mut spans, mut open): (Vec<Self>, bool) = (Vec::new(), false);
        for (t, active) in times {
            match spans.last_mut().filter(|_| open && active) {
                Some(span) => span.to = t,
                None if active => spans.push(Self { name: name.into(), side: side.into(), from: t, to: t }),
                None => {}
            }
            open = active;
        }
        spans
    }
}

impl LimitReport {
    /// The kinds with a limit that is exceeded, and where it is exceeded most.
    pub fn violations(&self) -> impl Iterator<Item = (&'static str, &LimitViolation)> {
        self.kinds().filter_map(|(name, usage)| Some((name, usage?.worst.as_ref()?)))
    }

    /// The kinds with a limit that is exceeded between the points, by more than 1e-4 of its range, and where
    /// it is exceeded most. Torques are not among them: they are cut to their limits, which
    /// [`worst_cut`](Self::worst_cut) tells.
    pub fn violations_between(&self) -> impl Iterator<Item = (&'static str, &LimitViolation)> {
        let kinds = self.kinds().filter(|(name, _)| *name != "torque");
        kinds.filter_map(|(name, usage)| Some((name, usage?.worst_between.as_ref()?)))
    }

    /// Where the torque of a motion would have to be beyond its limit most, between the points, by more than
    /// 1e-4 of its range; it is cut to the limit there.
    pub fn worst_cut(&self) -> Option<&LimitViolation> {
        self.torque.as_ref()?.worst_between.as_ref()
    }

    /// Whether something is limited and all of it is kept, at the points and between them.
    pub fn are_kept(&self) -> bool {
        !self.is_empty() && self.violations().next().is_none() && self.violations_between().next().is_none()
    }

    /// Whether nothing is limited.
    pub fn is_empty(&self) -> bool {
        self.kinds().all(|(_, usage)| usage.is_none())
    }

    /// Name and use of each kind.
    pub fn kinds(&self) -> impl Iterator<Item = (&'static str, Option<&LimitUse>)> {
        let kinds = [
            ("position", &self.position),
            ("rate", &self.rate),
            ("acceleration", &self.acceleration),
            ("torque", &self.torque),
            ("jerk", &self.jerk),
            ("torque_rate", &self.torque_rate),
            ("power", &self.power),
            ("torque_speed", &self.torque_speed),
            ("ground_force", &self.ground_force),
            ("landing_impulse", &self.landing_impulse),
            ("task", &self.task),
        ];
        kinds.into_iter().map(|(name, usage)| (name, usage.as_ref()))
    }
}
