//! Kinematics in the tangent space against dual and hyper-dual numbers through the retraction.

use super::samples::{robots, state};
use super::{ConfigurationSpace, FreeKinematics};
use crate::kinematics::{Kinematics, ReferenceFrame};
use crate::matrix::Matrix;
use crate::robot::{JointSpec, LinkInertia, Robot};
use crate::scalar::Scalar;
use crate::spatial::Motion;
use num_dual::{Dual64, HyperDual64};

const AXES: [ReferenceFrame; 3] =
    [ReferenceFrame::Local, ReferenceFrame::World, ReferenceFrame::LocalWorldAligned];

fn lift<S: Scalar>(a: &[f64]) -> Vec<S> {
    a.iter().map(|&a| S::from_f64(a)).collect()
}

fn moved<S: Scalar>(space: &ConfigurationSpace, q: &[f64], d: &[S]) -> Vec<S> {
    let mut to = lift(q);
    space.integrate(&lift::<S>(q), d, &mut to).unwrap();
    to
}

fn close(robot: &Robot, what: &str, found: f64, expected: f64) {
    let error = (found - expected).abs();
    assert!(error < 1e-12 * expected.abs().max(10.0), "{}: {what}: {found} {expected}", robot.name());
}

#[test]
fn twists_accelerations_and_rates_are_derivatives_in_time() {
    for robot in robots() {
        let space = ConfigurationSpace::new(&robot);
        let [q, v, a, _] = state(&space);
        let n = v.len();
        let mut kinematics = FreeKinematics::<f64>::new(&robot);
        kinematics.set_motion(&q, &v, &a).unwrap();
        let along = |a: &[f64], rate: &[f64]| -> Vec<Dual64> {
            a.iter().zip(rate).map(|(&a, &rate)| Dual64::new(a, rate)).collect()
        };
        let step = along(&vec![0.0; n], &v);
        let mut in_time = FreeKinematics::<Dual64>::new(&robot);
        in_time.set_state(&moved(&space, &q, &step), &along(&v, &a)).unwrap();
        // Parts of a free joint have no frames of their own in time: their chart is centred anew at each q.
        let is_inner = |joint: usize| {
            robot.joints()[joint].free.as_ref().is_some_and(|part| part.place + 1 < part.kind.dof())
        };
        for frame in (0..robot.frames().len()).filter(|&k| !robot.frames()[k].joint.is_some_and(is_inner)) {
            let (pose, rate) = (kinematics.pose(frame).unwrap(), in_time.pose(frame).unwrap());
            for axes in AXES {
                let (now, dual) =
                    (kinematics.twist(frame, axes).unwrap(), in_time.twist(frame, axes).unwrap());
                let found = kinematics.acceleration(frame, axes).unwrap();
                let pairs = [(found.angular, dual.angular), (found.linear, dual.linear)];
                for (found, dual) in
                    pairs.iter().flat_map(|(f, d)| f.to_array().into_iter().zip(d.to_array()))
                {
                    close(&robot, "acceleration", found, dual.eps);
                }
                let jacobian = kinematics.jacobian(frame, axes).unwrap().clone();
                let now = [now.angular.to_array(), now.linear.to_array()].concat();
                for (i, now) in now.iter().enumerate() {
                    let product = (0..n).map(|j| jacobian[(i, j)] * v[j]).sum();
                    close(&robot, "J v", product, *now);
                }
                let expected = in_time.jacobian(frame, axes).unwrap();
                let found = kinematics.jacobian_rate(frame, axes).unwrap();
                for (found, expected) in found.as_slice().iter().zip(expected.as_slice()) {
                    close(&robot, "dJ/dt", *found, expected.eps);
                }
            }
            let twist = kinematics.twist(frame, ReferenceFrame::LocalWorldAligned).unwrap();
            for (k, linear) in twist.linear.to_array().into_iter().enumerate() {
                close(&robot, "velocity", linear, rate.position[k].eps);
            }
            // w x of the first axis of the frame.
            let [wx, wy, wz] = twist.angular.to_array();
            let [x, y, z] = [0, 1, 2].map(|k| pose.rotation[k][0]);
            for (k, turned) in [wy * z - wz * y, wz * x - wx * z, wx * y - wy * x].into_iter().enumerate() {
                close(&robot, "turning", turned, rate.rotation[k][0].eps);
            }
        }
        let (centre, of_time) = (kinematics.centre_of_mass().unwrap(), in_time.centre_of_mass().unwrap());
        for k in 0..3 {
            close(&robot, "velocity of the centre", centre.velocity[k], of_time.position[k].eps);
            close(&robot, "its acceleration", centre.acceleration[k], of_time.velocity[k].eps);
            let product = (0..n).map(|j| centre.jacobian[(k, j)] * v[j]).sum();
            close(&robot, "its Jacobian", product, centre.velocity[k]);
        }
        let rates = centre.jacobian_rate.as_slice().iter().zip(of_time.jacobian.as_slice());
        rates.for_each(|(found, expected)| close(&robot, "rate of its Jacobian", *found, expected.eps));
        let momentum = kinematics.momentum().unwrap();
        let of_time = in_time.momentum().unwrap();
        for k in 0..3 {
            close(&robot, "force", momentum.linear_rate[k], of_time.linear[k].eps);
            let product = (0..n).map(|j| momentum.matrix[(3 + k, j)] * v[j]).sum();
            close(&robot, "A v", product, momentum.linear[k]);
        }
    }
}

#[test]
fn jacobians_and_hessians_of_positions_are_those_of_hyper_dual_numbers() {
    for robot in robots() {
        let space = ConfigurationSpace::new(&robot);
        let [q, ..] = state(&space);
        let (n, w) = (space.dof(), [0.7, -1.1, 0.4]);
        let mut kinematics = FreeKinematics::<f64>::new(&robot);
        kinematics.set_position(&q).unwrap();
        let mut hyper = FreeKinematics::<HyperDual64>::new(&robot);
        let frame = robot.frames().len() - 1;
        let jacobian = kinematics.jacobian(frame, ReferenceFrame::LocalWorldAligned).unwrap().clone();
        let hessian = kinematics.position_hessian(frame, &w).unwrap();
        for i in 0..n {
            for j in 0..n {
                let one = |k: usize, of: usize| f64::from(u8::from(k == of));
                let d: Vec<_> = (0..n).map(|k| HyperDual64::new(0.0, one(k, i), one(k, j), 0.0)).collect();
                hyper.set_position(&moved(&space, &q, &d)).unwrap();
                let x = hyper.pose(frame).unwrap().position;
                let second = (0..3).map(|k| w[k] * x[k].eps1eps2).sum();
                close(&robot, "w'x_qq", hessian[(i, j)], second);
                (0..3).for_each(|k| close(&robot, "x_q", jacobian[(3 + k, i)], x[k].eps1));
            }
        }
    }
}

/// Bit for bit: without free joints nothing is computed in another way.
#[test]
fn joints_of_one_degree_of_freedom_have_the_numbers_of_kinematics() {
    let link = || LinkInertia::about_com(1.5, [0.1, -0.2, 0.3], nalgebra::Matrix3::identity() * 0.2);
    let robot = Robot::builder("arm")
        .joint(JointSpec::revolute("base").axis([0.6, 0.0, 0.8]).carrying(link()))
        .joint(JointSpec::prismatic("rail").on("base").axis([0.0, 1.0, 0.0]).carrying(link()))
        .joint(JointSpec::revolute("wrist").on("rail").axis([1.0, 0.0, 0.0]).carrying(link()))
        .build()
        .unwrap();
    let (q, v, a, w) = ([0.3, -0.7, 1.9], [1.1, 0.4, -2.3], [0.2, -5.0, 0.9], [0.7, -1.1, 0.4]);
    let frame = robot.frames().len() - 1;
    let (mut free, mut plain) = (FreeKinematics::<f64>::new(&robot), Kinematics::<f64>::new(&robot));
    free.set_motion(&q, &v, &a).unwrap();
    plain.set_motion(&q, &v, &a).unwrap();
    let same =
        |found: &Matrix<f64>, expected: &Matrix<f64>| assert_eq!(found.as_slice(), expected.as_slice());
    let same_motion = |found: Motion<f64>, expected: Motion<f64>| {
        assert_eq!(found.angular.to_array(), expected.angular.to_array());
        assert_eq!(found.linear.to_array(), expected.linear.to_array());
    };
    for axes in AXES {
        same_motion(free.acceleration(frame, axes).unwrap(), plain.acceleration(frame, axes).unwrap());
        same(free.jacobian(frame, axes).unwrap(), plain.jacobian(frame, axes).unwrap());
        same(free.jacobian_rate(frame, axes).unwrap(), plain.jacobian_rate(frame, axes).unwrap());
    }
    same(free.momentum().unwrap().matrix, plain.momentum().unwrap().matrix);
    let (ours, theirs) = (free.centre_of_mass().unwrap(), plain.centre_of_mass().unwrap());
    assert_eq!(ours.position, theirs.position);
    same(ours.jacobian_rate, theirs.jacobian_rate);
    free.set_state(&q, &v).unwrap();
    plain.set_state(&q, &v).unwrap();
    same_motion(free.twist(frame, AXES[2]).unwrap(), plain.twist(frame, AXES[2]).unwrap());
    free.set_position(&q).unwrap();
    plain.set_position(&q).unwrap();
    same(free.position_hessian(frame, &w).unwrap(), plain.position_hessian(frame, &w).unwrap());
}
