//! First moments of links and of what they carry.

use super::body::Body;
use crate::scalar::Scalar;
use crate::spatial::Vec3;

/// First moment of a link and all that it carries, about the origin of its frame, with two derivatives in
/// time (kg m, kg m/s, kg m/s^2).
#[derive(Clone, Copy, Debug)]
pub(super) struct Moment<S> {
    pub value: Vec3<S>,
    pub rate: Vec3<S>,
    pub second: Vec3<S>,
}

impl<S: Scalar> Moment<S> {
    pub fn zero() -> Self {
        Self { value: Vec3::zero(), rate: Vec3::zero(), second: Vec3::zero() }
    }

    /// Of one link, with the first moment h in its frame: `h`, `w x h`, `w' x h + w x (w x h)`.
    pub fn of_link(body: &Body<S>, first_moment: [f64; 3]) -> Self {
        let value = body.constant_in_world(first_moment);
        let rate = body.angular.cross(value);
        Self { value, rate, second: body.angular_rate.cross(value) + body.angular.cross(rate) }
    }

    /// Adds that of a child with this mass, from its origin to that of `body`.
    pub fn add(&mut self, child: &Self, mass: f64, from: &Body<S>, body: &Body<S>) {
        self.value = self.value + child.value + (from.position - body.position).times(mass);
        self.rate = self.rate + child.rate + (from.linear - body.linear).times(mass);
        self.second = self.second + child.second + (from.linear_rate - body.linear_rate).times(mass);
    }
}

impl<S: Scalar> Moment<S> {
    /// Position, velocity and acceleration of the centre of mass of `mass`, where the sum is about the origin
    /// of the world.
    pub fn centre(&self, mass: f64) -> [Vec3<S>; 3] {
        [self.value, self.rate, self.second].map(|sum| sum.times(mass.recip()))
    }
}
