//! Where the quaternions of a robot are.

use crate::robot::{Robot, UNIT};
use crate::spatial::Quaternion;

/// Where the quaternions of a robot are in q, for what must know whether they have length 1 and runs no check
/// of [`ConfigurationSpace`](super::ConfigurationSpace).
///
/// ```
/// use costate::configuration::Quaternions;
/// use costate::robot::{JointSpec, LinkInertia, Robot};
///
/// let body = LinkInertia::about_com(1.0, [0.0; 3], nalgebra::Matrix3::identity());
/// let drone = Robot::builder("drone").joint(JointSpec::floating("root").carrying(body)).build()?;
/// let (quaternions, q) = (Quaternions::of(&drone), [0.0, 0.0, 1.0, 0.0, 0.0, 0.6, 0.9]);
/// assert_eq!(quaternions.first_not_unit(|k| q[k]), Some(0));
/// assert!((quaternions.length(0, |k| q[k]) - 1.17_f64.sqrt()).abs() < 1e-15);
/// assert_eq!(quaternions.first_without_direction(|k| q[k]), None);
/// assert_eq!(quaternions.first_without_direction(|_| 0.0), Some(0));
/// # Ok::<(), costate::robot::RobotError>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Quaternions {
    /// The first entry of each.
    places: Vec<usize>,
}

impl Quaternions {
    /// Those of the [free joints](Robot::free_joints) of a robot, in their order.
    pub fn of(robot: &Robot) -> Self {
        Self { places: robot.free_joints().iter().map(|free| free.quaternion()).collect() }
    }

    /// Length of quaternion `k`, of q given by its entries.
    pub fn length(&self, k: usize, q: impl Fn(usize) -> f64) -> f64 {
        quaternion(self.places[k], q).length()
    }

    /// The first one whose length is not 1: its square differs from 1 by 1e-9 or more, or is no number.
    pub fn first_not_unit(&self, q: impl Fn(usize) -> f64) -> Option<usize> {
        let is_unit = |&place: &usize| (quaternion(place, &q).square() - 1.0).abs() < UNIT.value();
        self.places.iter().position(|place| !is_unit(place))
    }

    /// The first one without a direction, which [`normalize`](super::ConfigurationSpace::normalize) cannot
    /// give length 1: its entries are all zero, or one of them is no finite number.
    pub fn first_without_direction(&self, q: impl Fn(usize) -> f64) -> Option<usize> {
        self.places.iter().position(|&place| !quaternion(place, &q).unit().square().is_finite())
    }
}

fn quaternion(place: usize, q: impl Fn(usize) -> f64) -> Quaternion<f64> {
    Quaternion::new([0, 1, 2, 3].map(|k| q(place + k)))
}
