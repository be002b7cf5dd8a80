//! Floating and spherical joints in the rows of a trajectory.

use crate::result::trajectory_error::TrajectoryError;
use costate::robot::{FreeJoint, FreeKind, Robot};
use serde::{Deserialize, Serialize};

/// Where the entries of a floating or spherical joint are in the rows of a
/// [`Trajectory`](crate::Trajectory).
///
/// In q, from [`position`](Self::position) on: (x, y, z, qx, qy, qz, qw) of a floating joint, the quaternion
/// alone of a spherical one. In v, p, u and costates, from [`coordinate`](Self::coordinate) on: (linear,
/// angular) in the axes of the moved frame, angular alone. So costates of q are those in the tangent space:
/// `y_q = -dJ/dxi`, where `q exp(xi)` is the position.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct FreeEntries {
    /// Name of the joint.
    pub name: String,
    /// Whether it moves too: (x, y, z) come first.
    pub floating: bool,
    /// Index of its first entry of q.
    pub position: usize,
    /// Index of its first entry of v.
    pub coordinate: usize,
}

impl From<&FreeJoint> for FreeEntries {
    fn from(free: &FreeJoint) -> Self {
        let FreeJoint { name, kind, position, coordinate, .. } = free;
        let (name, floating) = (name.clone(), *kind == FreeKind::Floating);
        Self { name, floating, position: *position, coordinate: *coordinate }
    }
}

impl FreeEntries {
    /// Those of a robot.
    pub(crate) fn of(robot: &Robot) -> Vec<Self> {
        robot.free_joints().iter().map(Self::from).collect()
    }

    /// The list is that of a robot: [`TrajectoryError::OtherFreeJoints`] with the name of its own otherwise.
    pub(crate) fn check_robot(all: &[Self], of: &str, robot: &Robot) -> Result<(), TrajectoryError> {
        let expected = Self::of(robot);
        if all == expected {
            return Ok(());
        }
        let names = |all: &[Self]| all.iter().map(|free| free.name.clone()).collect();
        let (found_joints, joints) = (names(all), names(&expected));
        Err(TrajectoryError::OtherFreeJoints { found: of.to_owned(), found_joints, joints })
    }

    /// Whether lists fit rows of q and v where v has n entries.
    pub(crate) fn fit(all: &[Self], n: usize) -> bool {
        let (mut least, mut extra) = (0, 0);
        all.iter().all(|free| {
            let fits = free.coordinate >= least && free.position == free.coordinate + extra;
            let Some(end) = free.coordinate.checked_add(free.slides() + 3).filter(|end| fits && *end <= n)
            else {
                return false;
            };
            (least, extra) = (end, extra + 1);
            true
        })
    }

    fn slides(&self) -> usize {
        if self.floating { 3 } else { 0 }
    }

    /// Index of the first entry of its quaternion.
    fn quaternion(&self) -> usize {
        self.position + self.slides()
    }

    /// Names of the entries of q, from those of the coordinates.
    pub(crate) fn names(all: &[Self], joints: &[String]) -> Vec<String> {
        let mut names = Vec::with_capacity(joints.len() + all.len());
        let mut i = 0;
        for free in all {
            names.extend_from_slice(joints.get(i..free.coordinate).unwrap_or_default());
            let own = ["x", "y", "z", "qx", "qy", "qz", "qw"];
            names.extend(own[3 - free.slides()..].iter().map(|entry| format!("{}_{entry}", free.name)));
            i = free.coordinate + free.slides() + 3;
        }
        names.extend_from_slice(joints.get(i..).unwrap_or_default());
        names
    }

    /// For each entry of q that is no part of a free joint, its coordinate.
    fn each_plain(all: &[Self], n: usize, mut take: impl FnMut(usize, usize)) {
        let mut start = 0;
        let ends = all.iter().map(|free| (free.coordinate, free.coordinate + free.slides() + 3));
        for (before, (end, next)) in ends.chain([(n, n)]).enumerate() {
            (start..end).for_each(|i| take(i + before, i));
            start = next;
        }
    }

    /// dq/dt of the entries of q.
    pub(crate) fn rates(all: &[Self], q: &[f64], v: &[f64]) -> Vec<f64> {
        let mut rates = vec![0.0; q.len()];
        Self::each_plain(all, v.len(), |at, i| rates[at] = v[i]);
        for free in all {
            let a = free.entries(q);
            let angular = free.coordinate + free.slides();
            let omega = [v[angular], v[angular + 1], v[angular + 2]];
            // Half of the product with (omega, 0).
            let [[wx, wy, wz], scalar] = [cross(&a, &omega), [a[3], 0.0, 0.0]];
            let turned = [
                wx + scalar[0] * omega[0],
                wy + scalar[0] * omega[1],
                wz + scalar[0] * omega[2],
                -(a[0] * omega[0] + a[1] * omega[1] + a[2] * omega[2]),
            ];
            let at = free.quaternion();
            rates[at..at + 4].iter_mut().zip(turned).for_each(|(rate, turned)| *rate = 0.5 * turned);
            if free.floating {
                let linear = [0, 1, 2].map(|k| v[free.coordinate + k]);
                let moved = rotated(&a, &linear);
                rates[free.position..free.position + 3].copy_from_slice(&moved);
            }
        }
        rates
    }

    /// Quaternions of length 1 and the velocities that belong to dq/dt, for quaternions near that.
    pub(crate) fn velocities(all: &[Self], q: &mut [f64], rates: &[f64]) -> Vec<f64> {
        let n = q.len() - all.len();
        let mut v = vec![0.0; n];
        Self::each_plain(all, n, |at, i| v[i] = rates[at]);
        for free in all {
            let (a, at) = (free.entries(q), free.quaternion());
            let square: f64 = a.iter().map(|entry| entry * entry).sum();
            let rate = [rates[at], rates[at + 1], rates[at + 2], rates[at + 3]];
            // Twice the vector of conj(a) o a', divided by the square of the length.
            let turned = cross(&a, &[rate[0], rate[1], rate[2]]);
            for k in 0..3 {
                v[free.coordinate + free.slides() + k] =
                    2.0 * (a[3] * rate[k] - rate[3] * a[k] - turned[k]) / square;
            }
            let unit = a.map(|entry| entry / square.sqrt());
            q[at..at + 4].copy_from_slice(&unit);
            if free.floating {
                let moved = [0, 1, 2].map(|k| rates[free.position + k]);
                let back = [-unit[0], -unit[1], -unit[2], unit[3]];
                v[free.coordinate..free.coordinate + 3].copy_from_slice(&rotated(&back, &moved));
            }
        }
        v
    }

    fn entries(&self, q: &[f64]) -> [f64; 4] {
        let at = self.quaternion();
        [q[at], q[at + 1], q[at + 2], q[at + 3]]
    }
}

fn cross(a: &[f64], b: &[f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// `R(a) b` for a of length 1: `b + 2 w (a x b) + 2 a x (a x b)`.
fn rotated(a: &[f64; 4], b: &[f64; 3]) -> [f64; 3] {
    let once = cross(a, b);
    let twice = cross(a, &once);
    [0, 1, 2].map(|k| b[k] + 2.0 * (a[3] * once[k] + twice[k]))
}

#[cfg(test)]
mod tests {
    use super::FreeEntries;

    fn joint(name: &str, floating: bool, position: usize, coordinate: usize) -> FreeEntries {
        FreeEntries { name: name.into(), floating, position, coordinate }
    }

    #[test]
    fn rates_and_velocities_belong_to_each_other() {
        let all = [joint("a", true, 1, 1), joint("b", false, 9, 8)];
        assert!(FreeEntries::fit(&all, 11) && FreeEntries::fit(&all, 12) && !FreeEntries::fit(&all, 10));
        assert!(!FreeEntries::fit(&[joint("a", true, 2, 1)], 9));
        let mut q = vec![0.3, 1.0, 2.0, 3.0, 0.5, -0.5, 0.5, 0.5, 0.1, -0.7, 0.1, 0.5, 0.5];
        let v: Vec<f64> = (0..11).map(|i| (0.7 * i as f64).sin()).collect();
        let rates = FreeEntries::rates(&all, &q, &v);
        assert_eq!((rates[0], rates[8]), (v[0], v[7]));
        let back = FreeEntries::velocities(&all, &mut q, &rates);
        assert!(v.iter().zip(&back).all(|(v, back)| (v - back).abs() < 1e-15), "{v:?} {back:?}");
        // Against a small step of the retraction.
        let robot = costate::robot::Robot::builder("r")
            .joint(costate::robot::JointSpec::revolute("p"))
            .joint(costate::robot::JointSpec::floating("a").on("p"))
            .joint(costate::robot::JointSpec::revolute("c").on("a"))
            .joint(costate::robot::JointSpec::spherical("b").on("c"));
        let robot = robot.build().unwrap();
        assert_eq!(FreeEntries::of(&robot), all);
        let space = costate::configuration::ConfigurationSpace::new(&robot);
        let mut moved = q.clone();
        let step: Vec<f64> = v.iter().map(|v| 1e-6 * v).collect();
        space.integrate(&q, &step, &mut moved).unwrap();
        for (k, rate) in rates.iter().enumerate() {
            assert!(((moved[k] - q[k]) / 1e-6 - rate).abs() < 1e-5, "{k}");
        }
        let joints: Vec<String> = robot.independent_joints().map(|joint| joint.name.clone()).collect();
        let names = FreeEntries::names(&all, &joints);
        assert_eq!(names.len(), 13);
        assert_eq!(
            [&names[0], &names[1], &names[7], &names[8], &names[9]],
            ["p", "a_x", "a_qw", "c", "b_qx"]
        );
    }
}
