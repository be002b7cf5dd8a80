//! The derivatives of inverse dynamics as scalar products of pairs of joints.

use super::WorldKernel;
use super::group::{Carried, Group, along_axis, force_lane};
use crate::matrix::Matrix;
use crate::robot::JointKind;
use crate::scalar::{Scalar, inlined};
use crate::spatial::{Force, Motion, Vec3};

/// Derivatives of inverse dynamics without springs, friction and armature, n x n.
#[derive(Debug)]
pub(crate) struct TorqueDerivatives<'a, S> {
    pub by_position: &'a mut Matrix<S>,
    pub by_velocity: &'a mut Matrix<S>,
}

/// The motions of joint i that meet the forces of the joints beyond it, the same in every lane.
struct Meeting<P> {
    axis: Vec3<P>,
    origin: Vec3<P>,
    psi: Motion<P>,
    psi_rate: Motion<P>,
}

impl<S: Scalar> WorldKernel<S> {
    /// `tau_q` and `tau_v` at the motion set last and the composite bodies of its position. Entries of joints
    /// on different branches are left as they are.
    ///
    /// With J', L and N the rate of the inertia matrix, the linear and the angular momentum of the composite
    /// body of joint j about its origin, f the force on it, w and s angular and linear part of a motion, the
    /// Coriolis operator is `2B m = (J' w - N x w ; -2 L x w)`. For i <= j in tree order
    ///
    /// ```text
    /// F_j = IC_j S_j       C_j = 2B S_j + 2 IC_j psi_j        psi_j = v_j x S_j
    /// E_j = (2B)' S_j      A_j = 2B psi_j + IC_j psi'_j + S_j x* f_j     psi'_j = a_j x S_j + v_j x psi_j
    ///
    /// tau_q,ij = S_i . A_j     tau_q,ji = psi_i . E_j + psi'_i . F_j
    /// tau_v,ij = S_i . C_j     tau_v,ji = S_i . E_j + 2 psi_i . F_j
    /// ```
    ///
    /// (S. Singh, R. Russell, P. Wensing, IEEE Robotics and Automation Letters 7 (2022) 1752-1759, in other
    /// terms.) The linear part of E is zero.
    #[inline(never)]
    pub fn torque_derivatives(&mut self, tau: TorqueDerivatives<'_, S>) {
        self.compose_motion();
        for group in &mut self.groups {
            group.carry();
        }
        for k in 0..self.places.len() {
            match self.places[k].kind {
                JointKind::Revolute => self.meet(k, revolute),
                JointKind::Prismatic => self.meet(k, prismatic),
            }
            (0..2).for_each(|matrix| self.clear_beyond(k, matrix));
        }
        self.places.store(&self.upper[0], &self.lower[0], tau.by_position);
        self.places.store(&self.upper[1], &self.lower[1], tau.by_velocity);
    }

    /// Row k of the products.
    #[inline(always)]
    fn meet(&mut self, k: usize, entries: impl Fn(&Meeting<S::Pack>, &Group<S::Pack>) -> [S::Pack; 4]) {
        let (joint, [psi, psi_rate]) = (&self.joints[k], self.psi(k));
        let meeting = Meeting {
            axis: joint.axes[2].splat(),
            origin: joint.origin.splat(),
            psi: psi.splat(),
            psi_rate: psi_rate.splat(),
        };
        let (first, end) = (k / Self::LANES, self.places[k].end.div_ceil(Self::LANES));
        let ([q_upper, v_upper], [q_lower, v_lower]) = (&mut self.upper, &mut self.lower);
        let rows = [q_upper, q_lower, v_upper, v_lower].map(|panel| &mut panel.row_mut(k)[first..end]);
        let [q_row, q_column, v_row, v_column] = rows;
        let upper = q_row.iter_mut().zip(v_row);
        let lower = q_column.iter_mut().zip(v_column);
        for ((group, upper), lower) in self.groups[first..end].iter().zip(upper).zip(lower) {
            [*upper.0, *lower.0, *upper.1, *lower.1] = entries(&meeting, group);
        }
    }

    /// `tau = M a + C v + g`, n, without armature, springs and friction, at the motion set last, after
    /// [`torque_derivatives`](Self::torque_derivatives).
    pub fn torques(&self, tau: &mut [S]) {
        for (k, place) in self.places.iter().enumerate() {
            let force = force_lane(&self.groups[k / Self::LANES].force, k % Self::LANES);
            tau[place.joint] = along_axis(place.kind, self.joints[k].axes[2], &force);
        }
    }
}

impl<P: Scalar> Group<P> {
    /// The forces of all joints of the group, see [`WorldKernel::torque_derivatives`]; F is there.
    #[inline(always)]
    fn carry(&mut self) {
        let (axis, psi, a, v) = (self.axis, self.psi, self.acceleration, self.velocity);
        let psi_rate = Motion {
            angular: a.angular.cross(axis.angular).plus_product(v.angular, psi.angular),
            linear: a
                .linear
                .cross(axis.angular)
                .plus_product(a.angular, axis.linear)
                .plus_product(v.linear, psi.angular)
                .plus_product(v.angular, psi.linear),
        };
        self.psi_rate = psi_rate;
        let Force { moment: angular, force: linear } = self.momentum;
        // J' w and N x w of S and psi.
        let (turned, crossed) = (self.rate.apply(axis.angular), angular.cross(axis.angular));
        let twice = |a: Vec3<P>| a + a;
        let shifted = self.composite.apply(psi);
        let pushed = self.composite.apply(psi_rate);
        let swept = linear.cross(psi.angular);
        let f = self.force;
        self.carried = Carried {
            inertial: self.carried.inertial,
            turning: twice(linear.cross(axis.linear)) + turned + crossed,
            by_velocity: Force {
                moment: twice(shifted.moment) + turned - crossed,
                force: twice(shifted.force - linear.cross(axis.angular)),
            },
            by_position: Force {
                moment: (pushed.moment + self.rate.apply(psi.angular) - angular.cross(psi.angular))
                    .plus_product(axis.angular, f.moment)
                    .plus_product(axis.linear, f.force),
                force: (pushed.force - twice(swept)).plus_product(axis.angular, f.force),
            },
        };
    }
}

/// tau_q and tau_v for joint i, revolute, and each joint of a group: ij, ji of both.
#[inline(always)]
fn revolute<P: Scalar>(i: &Meeting<P>, group: &Group<P>) -> [P; 4] {
    inlined!(P, {
        let Carried { inertial, turning, by_position, by_velocity } = &group.carried;
        let distance = group.origin - i.origin;
        let lever = i.axis.cross(distance);
        let psi = i.psi.linear.plus_product(i.psi.angular, distance);
        let psi_rate = i.psi_rate.linear.plus_product(i.psi_rate.angular, distance);
        let along = i.psi.angular.dot_plus(inertial.moment, psi.dot(inertial.force));
        let inertial = i.psi_rate.angular.dot_plus(inertial.moment, psi_rate.dot(inertial.force));
        [
            i.axis.dot_plus(by_position.moment, lever.dot(by_position.force)),
            i.psi.angular.dot_plus(*turning, inertial),
            i.axis.dot_plus(by_velocity.moment, lever.dot(by_velocity.force)),
            i.axis.dot_plus(*turning, along + along),
        ]
    })
}

/// The same for joint i prismatic: its psi has no angular part.
#[inline(always)]
fn prismatic<P: Scalar>(i: &Meeting<P>, group: &Group<P>) -> [P; 4] {
    inlined!(P, {
        let carried = &group.carried;
        let along = i.psi.linear.dot(carried.inertial.force);
        [
            i.axis.dot(carried.by_position.force),
            i.psi_rate.linear.dot(carried.inertial.force),
            i.axis.dot(carried.by_velocity.force),
            along + along,
        ]
    })
}
