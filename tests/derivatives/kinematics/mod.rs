//! Poses, Jacobians and contracted second derivatives of kinematics, judged by hyper-dual numbers and by
//! poses from the description.

mod edges;
mod judge;
mod orientation;

use costate::derivative::{ByCalls, Hessian};
use costate::kinematics::{Kinematics, KinematicsSecondOrder, ReferenceFrame};
use costate::scalar::Tangent;
use costate::spatial::{Force, Vec3};
use costate_test_support::properties;
use costate_test_support::random_robot::all_cases;
use costate_test_support::reach::{Reach, weights};
use judge::{ANGULAR, Accelerations, CENTRE, CENTRE_VELOCITY, Judged, LINEAR, POSITION, Quantities, TWISTS};
use nalgebra::{DMatrix, Matrix3, Vector3};
use proptest::prelude::*;

/// `max |a - b|`.
fn apart(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    (a - b).amax()
}

/// The same of vectors.
fn far(a: &[f64], b: &[f64]) -> f64 {
    apart(&DMatrix::from_column_slice(a.len(), 1, a), &DMatrix::from_column_slice(b.len(), 1, b))
}

/// Three weights that differ from robot to robot.
fn weight(y: &[f64]) -> [f64; 3] {
    [y[0], 0.7 - y[1], y[y.len() - 1]]
}

properties! {
    96;

    #[test]
    fn poses_are_those_of_the_description(case in all_cases(6)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let kinematics = quantities.kinematics(&case.q, &case.v);
        let poses = quantities.robot.poses(&case.q).unwrap();
        for (k, frame) in quantities.robot.frames().iter().enumerate() {
            let expected = frame.joint.map_or(frame.placement, |i| poses[i].then(&frame.placement));
            let found = kinematics.pose(k).unwrap();
            let rotation = Matrix3::from_fn(|i, j| found.rotation[i][j]);
            prop_assert!((rotation - expected.rotation).amax() < reach.position(0), "{}", frame.name);
            prop_assert!((Vector3::from(found.position) - expected.translation).amax() < reach.position(0));
        }
    }

    #[test]
    fn jacobians_are_the_derivatives_of_twists_and_of_poses(case in all_cases(5)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let judged = Judged::at(&quantities, &case.q, &case.v);
        let mut kinematics = quantities.kinematics(&case.q, &case.v);
        let position_q = judged.by_q(POSITION, 3);
        for (k, axes) in ReferenceFrame::ALL.into_iter().enumerate() {
            let by_v = judged.by_v(TWISTS + 6 * k, 6);
            let jacobian = kinematics.jacobian(quantities.frame, axes).unwrap().view().to_nalgebra();
            prop_assert!(apart(&jacobian, &by_v) < reach.position(1), "{axes:?}");
            let by_q = judged.by_q(TWISTS + 6 * k, 6);
            let slope = kinematics.twist_jacobian(quantities.frame, axes).unwrap().view().to_nalgebra();
            prop_assert!(apart(&slope, &by_q) < reach.velocity(1), "{axes:?}");
            if axes == ReferenceFrame::LocalWorldAligned {
                prop_assert!(apart(&jacobian.rows(3, 3).into_owned(), &position_q) < reach.position(1));
            }
        }
    }

    #[test]
    fn angular_rows_turn_the_axes_of_the_frame(case in all_cases(4)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let mut kinematics = quantities.kinematics(&case.q, &case.v);
        let jacobian = kinematics.jacobian(quantities.frame, ReferenceFrame::World).unwrap().clone();
        let mut dual = Kinematics::<Tangent<f64>>::new(&quantities.robot);
        for i in 0..case.n() {
            let q: Vec<_> =
                case.q.iter().enumerate().map(|(j, &q)| Tangent::new(q, f64::from(u8::from(i == j)))).collect();
            dual.set_position(&q).unwrap();
            let rotation = dual.pose(quantities.frame).unwrap().rotation;
            let axis = Vector3::from_fn(|row, _| jacobian[(row, i)]);
            let r = Matrix3::from_fn(|i, j| rotation[i][j].re);
            let slope = Matrix3::from_fn(|i, j| rotation[i][j].eps);
            prop_assert!((axis.cross_matrix() * r - slope).amax() < reach.position(1), "joint {i}");
        }
    }

    #[test]
    fn rates_and_accelerations_are_derivatives_along_the_motion(case in all_cases(5)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let a = &case.u;
        let mut dual = Kinematics::<Tangent<f64>>::new(&quantities.robot);
        let along = |x: &[f64], rate: &[f64]| -> Vec<Tangent<f64>> {
            x.iter().zip(rate).map(|(&x, &rate)| Tangent::new(x, rate)).collect()
        };
        dual.set_state(&along(&case.q, &case.v), &along(&case.v, a)).unwrap();
        let mut kinematics = quantities.kinematics(&case.q, &case.v);
        kinematics.set_motion(&case.q, &case.v, a).unwrap();
        let frame = quantities.frame;
        for axes in ReferenceFrame::ALL {
            let moved = dual.jacobian(frame, axes).unwrap();
            let expected = DMatrix::from_fn(6, case.n(), |i, j| moved[(i, j)].eps);
            let rate = kinematics.jacobian_rate(frame, axes).unwrap().view().to_nalgebra();
            prop_assert!(apart(&rate, &expected) < reach.velocity(1), "{axes:?}");
            let (moved, found) = (dual.twist(frame, axes).unwrap(), kinematics.acceleration(frame, axes).unwrap());
            let expected = [moved.angular, moved.linear].map(|part| part.to_array().map(|entry| entry.eps)).concat();
            let found = [found.angular, found.linear].map(Vec3::to_array).concat();
            prop_assert!(far(&found, &expected) < reach.acceleration(0), "{axes:?}");
        }
        let (moved, found) = (dual.momentum().unwrap(), kinematics.momentum().unwrap());
        for (moved, found) in
            [(moved.linear, found.linear_rate), (moved.angular, found.angular_rate)]
        {
            prop_assert!(far(&found, &moved.map(|entry| entry.eps)) < reach.mass * reach.length * reach.acceleration(0));
        }
        let (moved, found) = (dual.centre_of_mass().unwrap(), kinematics.centre_of_mass().unwrap());
        let expected = DMatrix::from_fn(3, case.n(), |i, j| moved.jacobian[(i, j)].eps);
        prop_assert!(apart(&found.jacobian_rate.view().to_nalgebra(), &expected) < reach.velocity(1));
        prop_assert!(far(&found.acceleration, &moved.velocity.map(|entry| entry.eps)) < reach.acceleration(0));
    }

    #[test]
    fn contracted_hessians_are_those_of_hyper_dual_numbers(case in all_cases(5)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let judged = Judged::at(&quantities, &case.q, &case.v);
        let mut kinematics = quantities.kinematics(&case.q, &case.v);
        let (n, frame, w) = (case.n(), quantities.frame, weight(&case.y));
        let d = &case.u;
        let mut product = vec![0.0; n];
        let bound = weights(&w) * reach.position(2);
        let along = weights(d) * bound;
        let hessian = kinematics.position_hessian(frame, &w).unwrap().view().to_nalgebra();
        prop_assert!(apart(&hessian, &judged.contracted_q(POSITION, &w)) < bound);
        kinematics.position_hessian_product(frame, &w, d, &mut product).unwrap();
        let expected = hessian * DMatrix::from_column_slice(n, 1, d);
        prop_assert!(apart(&DMatrix::from_column_slice(n, 1, &product), &expected) < along);
        let hessian = kinematics.centre_of_mass_hessian(&w).unwrap().view().to_nalgebra();
        prop_assert!(apart(&hessian, &judged.contracted_q(CENTRE, &w)) < bound);
        kinematics.centre_of_mass_hessian_product(&w, d, &mut product).unwrap();
        let expected = hessian * DMatrix::from_column_slice(n, 1, d);
        prop_assert!(apart(&DMatrix::from_column_slice(n, 1, &product), &expected) < along);
    }

    #[test]
    fn contracted_twists_are_those_of_hyper_dual_numbers(case in all_cases(5)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let judged = Judged::at(&quantities, &case.q, &case.v);
        let mut kinematics = quantities.kinematics(&case.q, &case.v);
        let (n, frame) = (case.n(), quantities.frame);
        let (moment, force) = (weight(&case.y), weight(&case.u.repeat(2)));
        let wrench = Force { moment: Vec3::from(moment), force: Vec3::from(force) };
        for (k, axes) in ReferenceFrame::ALL.into_iter().enumerate() {
            let expected = judged.contracted(TWISTS + 6 * k, &[moment, force].concat());
            let bound = weights(&[moment, force].concat()) * reach.velocity(2);
            let whole = kinematics.twist_hessian(frame, axes, &wrench).unwrap().view().to_nalgebra();
            prop_assert!((whole - &expected).amax() < bound, "{axes:?}");
            let rows = kinematics.force_jacobian(frame, axes, &wrench).unwrap().view().to_nalgebra();
            let expected = expected.view((n, 0), (n, n)).into_owned();
            prop_assert!(apart(&rows, &expected) < bound, "{axes:?}");
        }
    }

    #[test]
    fn contracted_accelerations_are_those_of_hyper_dual_numbers(case in all_cases(4)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let (n, frame) = (case.n(), quantities.frame);
        let (moment, force) = (weight(&case.y), weight(&case.u.repeat(2)));
        let wrench = Force { moment: Vec3::from(moment), force: Vec3::from(force) };
        let bound = weights(&[moment, force].concat()) * reach.acceleration(2);
        let mut second = KinematicsSecondOrder::<f64>::new(&quantities.robot);
        second.set_motion(&case.q, &case.v, &case.u).unwrap();
        for axes in ReferenceFrame::ALL {
            let accelerations = Accelerations { robot: quantities.robot.clone(), frame, axes };
            let mut judge = Hessian::new(ByCalls(accelerations));
            let z = [&case.q[..], &case.v, &case.u].concat();
            let expected = judge.contract(&z, &[moment, force].concat()).unwrap().view().to_nalgebra();
            let found = second.acceleration_hessian(frame, axes, &wrench).unwrap().view().to_nalgebra();
            prop_assert!(found.shape() == (3 * n, 3 * n) && apart(&found, &expected) < bound, "{axes:?}");
        }
    }

    #[test]
    fn derivatives_of_accelerations_are_those_along_any_direction(case in all_cases(5)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let (n, frame) = (case.n(), quantities.frame);
        let mut second = KinematicsSecondOrder::<f64>::new(&quantities.robot);
        second.set_motion(&case.q, &case.v, &case.u).unwrap();
        // By a dual number along a direction of (q, v, a).
        let mut along = Kinematics::<Tangent<f64>>::new(&quantities.robot);
        let direction: Vec<f64> = (0..3 * n).map(|i| (1.0 + 2.3 * i as f64).sin()).collect();
        let z = [&case.q[..n], &case.v[..n], &case.u[..n]].concat();
        let z: Vec<_> = z.iter().zip(&direction).map(|(&z, &d)| Tangent::new(z, d)).collect();
        along.set_motion(&z[..n], &z[n..2 * n], &z[2 * n..]).unwrap();
        for axes in ReferenceFrame::ALL {
            let (value, judge) = (second.acceleration(frame, axes).unwrap(), along.acceleration(frame, axes).unwrap());
            let values = [value.angular.to_array(), value.linear.to_array()].concat();
            let judged = [judge.angular.to_array(), judge.linear.to_array()].concat();
            let jacobian = second.acceleration_jacobian(frame, axes).unwrap();
            for (i, judged) in judged.iter().enumerate() {
                let terms: Vec<f64> = (0..3 * n).map(|j| jacobian[(i, j)] * direction[j]).collect();
                let slope = terms.iter().sum::<f64>();
                prop_assert!((values[i] - judged.re).abs() < reach.acceleration(0), "{axes:?}");
                prop_assert!((slope - judged.eps).abs() < weights(&direction) * reach.acceleration(1), "{axes:?} {i}");
            }
        }
    }

    #[test]
    fn contracted_momentum_is_that_of_hyper_dual_numbers(case in all_cases(5)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let judged = Judged::at(&quantities, &case.q, &case.v);
        let (k, l) = (weight(&case.y), weight(&case.u.repeat(2)));
        let expected = judged.contracted(ANGULAR, &[k, l].concat());
        // Angular momentum has two arms.
        let bound = weights(&[k, l].concat()) * reach.mass * reach.length * reach.velocity(2);
        let mut kinematics = quantities.kinematics(&case.q, &case.v);
        let found = kinematics.momentum_hessian(&k, &l).unwrap().view().to_nalgebra();
        prop_assert!(apart(&found, &expected) < bound, "{found} is not {expected}");
    }

    #[test]
    fn momentum_is_its_matrix_times_v_and_the_linear_part_that_of_the_centre(case in all_cases(5)) {
        let quantities = Quantities::new(&case);
        let reach = quantities.reach(&case);
        let judged = Judged::at(&quantities, &case.q, &case.v);
        let mut kinematics = quantities.kinematics(&case.q, &case.v);
        let (mass, velocity) = {
            let centre = kinematics.centre_of_mass().unwrap();
            prop_assert!(apart(&centre.jacobian.view().to_nalgebra(), &judged.by_q(CENTRE, 3)) < reach.position(1));
            let slope = judged.by_q(CENTRE_VELOCITY, 3);
            prop_assert!(apart(&centre.jacobian_rate.view().to_nalgebra(), &slope) < reach.velocity(1));
            (centre.mass, centre.velocity)
        };
        let bound = reach.mass * reach.length * reach.velocity(1);
        let momentum = kinematics.momentum().unwrap();
        let matrix = momentum.matrix.view().to_nalgebra();
        let by_v = DMatrix::from_fn(6, case.n(), |i, j| if i < 3 {
            judged.by_v(ANGULAR, 3)[(i, j)]
        } else {
            judged.by_v(LINEAR, 3)[(i - 3, j)]
        });
        prop_assert!(apart(&matrix, &by_v) < bound);
        let (linear, angular) = (momentum.linear, momentum.angular);
        let expected = &matrix * DMatrix::from_column_slice(case.n(), 1, &case.v);
        prop_assert!(far(&[angular, linear].concat(), expected.as_slice()) < bound);
        for (linear, velocity) in linear.into_iter().zip(velocity) {
            prop_assert!((linear - mass * velocity).abs() < mass * reach.velocity(0));
        }
    }

    #[test]
    fn the_centre_of_mass_is_where_the_poses_put_it(case in all_cases(6)) {
        let robot = case.robot();
        let mut kinematics = Kinematics::<f64>::new(&robot);
        kinematics.set_position(&case.q).unwrap();
        let poses = robot.poses(&case.q).unwrap();
        let moment = robot.joints().iter().zip(&poses).fold(Vector3::zeros(), |sum, (joint, pose)| {
            sum + (pose.rotation * joint.inertia.com + pose.translation) * joint.inertia.mass
        });
        let mass: f64 = robot.joints().iter().map(|joint| joint.inertia.mass).sum();
        let centre = kinematics.centre_of_mass().unwrap();
        prop_assert!((Vector3::from(centre.position) - moment / mass).amax() < Reach::of_case(&robot, &case).position(0));
    }
}
