//! The columns of the inertial parameters of bodies.

use super::bodies::{Ancestor, Seen, UnitBodies};
use super::layout::Body;
use super::unit::{added, less, seen_from, turned_back, unit_products};
use crate::matrix::Matrix;
use crate::robot::scaled;
use crate::scalar::Scalar;
use crate::spatial::{Motion, Vec3};

impl<S: Scalar> UnitBodies<S> {
    /// The pairs of the joint of a body: ancestor and what is seen of its axis.
    fn pairs(&self, body: &Body) -> impl Iterator<Item = (&Ancestor, &Seen<S>)> {
        let range = self.starts[body.joint]..self.starts[body.joint + 1];
        self.ancestors[range.clone()].iter().zip(&self.axes[range])
    }

    /// Columns of p_theta and L_q,theta.
    #[inline(never)]
    pub fn gradients(&self, bodies: &[Body], p: &mut Matrix<S>, l_q: &mut Matrix<S>) {
        for body in bodies {
            let link = &self.links[body.joint];
            let [velocity, gravity] = [link.velocity, link.gravity].map(|m| seen_from(&body.frame, m));
            for (ancestor, seen) in self.pairs(body) {
                let [axis, rate] = [seen.axis, seen.rate].map(|m| seen_from(&body.frame, m));
                add(body, p, ancestor, unit_products(axis, velocity));
                let force = added(unit_products(rate, velocity), unit_products(axis, gravity));
                add(body, l_q, ancestor, force);
            }
        }
    }

    /// Columns of D p_theta and D L_q,theta along the direction.
    #[inline(never)]
    pub fn changes(&self, bodies: &[Body], d_p: &mut Matrix<S>, d_l_q: &mut Matrix<S>) {
        for body in bodies {
            let link = &self.links[body.joint];
            let seen_here = |m| seen_from(&body.frame, m);
            let [velocity, gravity] = [link.velocity, link.gravity].map(seen_here);
            let [dv, dg] = [link.velocity_change, link.gravity_change].map(seen_here);
            for (ancestor, seen) in self.pairs(body) {
                let [axis, rate] = [seen.axis, seen.rate].map(seen_here);
                let [d_axis, d_rate] = [seen.axis_change, seen.rate_change].map(seen_here);
                add(body, d_p, ancestor, added(unit_products(d_axis, velocity), unit_products(axis, dv)));
                let inertial = added(unit_products(d_rate, velocity), unit_products(rate, dv));
                let weight = added(unit_products(d_axis, gravity), unit_products(axis, dg));
                add(body, d_l_q, ancestor, added(inertial, weight));
            }
        }
    }

    /// `D L_theta` along the direction, O(n).
    #[inline(never)]
    pub fn values_along(&self, bodies: &[Body], d_l: &mut [S]) {
        for body in bodies {
            let link = &self.links[body.joint];
            let seen_here = |m| seen_from(&body.frame, m);
            let kinetic = unit_products(seen_here(link.velocity), seen_here(link.velocity_change));
            let weight = unit_products(seen_here(link.displacement), seen_here(link.gravity));
            put(body, d_l, added(kinetic, weight));
        }
    }

    /// `L_theta`, after [`set_heights`](Self::set_heights), O(n).
    pub fn values(&self, bodies: &[Body], l: &mut [S]) {
        for body in bodies {
            let link = &self.links[body.joint];
            let velocity = seen_from(&body.frame, link.velocity);
            let mut value = unit_products(velocity, velocity).map(|twice| twice.times(0.5));
            let arm = link.gravity.linear.dot_constant(body.frame.translation.into());
            let Vec3 { x, y, z } = turned_back(&body.frame, link.gravity.linear);
            for (value, weight) in value.iter_mut().zip([link.height + arm, x, y, z]) {
                *value += weight;
            }
            put(body, l, value);
        }
    }

    /// Columns of tau_theta, the direction being (v, a): the equations of Newton and Euler.
    #[inline(never)]
    pub fn torques(&self, bodies: &[Body], tau: &mut Matrix<S>) {
        for body in bodies {
            let (velocity, acceleration) = self.motion(body);
            for (ancestor, seen) in self.pairs(body) {
                add(body, tau, ancestor, power(seen_from(&body.frame, seen.axis), velocity, acceleration));
            }
        }
    }

    /// `w . tau_theta` along joint rates w: for the motion of each link with them, `motions`, that of one
    /// axis in [`torques`](Self::torques). O(n).
    #[inline(never)]
    pub fn powers(&self, bodies: &[Body], motions: &[Motion<S>], w_tau: &mut [S]) {
        for body in bodies {
            let (velocity, acceleration) = self.motion(body);
            let along = seen_from(&body.frame, motions[body.joint]);
            put(body, w_tau, power(along, velocity, acceleration));
        }
    }

    /// Velocity of a body, and its acceleration against gravity for the direction (v, a).
    fn motion(&self, body: &Body) -> (Motion<S>, Motion<S>) {
        let link = &self.links[body.joint];
        let mut acceleration = link.velocity_change;
        acceleration.linear = acceleration.linear - link.gravity.linear;
        (seen_from(&body.frame, link.velocity), seen_from(&body.frame, acceleration))
    }
}

/// `m . (I a + v x* I v)`.
#[inline(always)]
fn power<S: Scalar>(m: Motion<S>, velocity: Motion<S>, acceleration: Motion<S>) -> [S; 10] {
    less(unit_products(m, acceleration), unit_products(velocity.cross(m), velocity))
}

/// Writes products to the columns of a body.
#[inline(always)]
fn put<S: Scalar>(body: &Body, row: &mut [S], products: [S; 10]) {
    for (column, product) in body.columns.iter().zip(products) {
        if let Some(column) = *column {
            row[column] = product;
        }
    }
}

/// Adds products of an ancestor of the body to the row of its coordinate.
#[inline(always)]
fn add<S: Scalar>(body: &Body, to: &mut Matrix<S>, ancestor: &Ancestor, products: [S; 10]) {
    let row = to.row_mut(ancestor.coordinate);
    for (column, product) in body.columns.iter().zip(products) {
        if let Some(column) = *column {
            let term = scaled(ancestor.ratio, product);
            row[column] = if ancestor.is_first { term } else { row[column] + term };
        }
    }
}
