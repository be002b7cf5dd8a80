//! The orientation error by the logarithm, near 0 and near a half turn.

use super::judge::{Judged, ORIENTATION, Quantities};
use super::weight;
use costate::kinematics::{Kinematics, ReferenceFrame};
use costate::robot::{JointSpec, LinkInertia, Robot};
use costate::scalar::{Count, Scalar, Tangent};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, all_cases};
use costate_test_support::reach::weights;
use costate_test_support::rounding::{bound, close, lift};
use nalgebra::{DMatrix, Matrix3, Rotation3, Vector3};
use proptest::prelude::*;
use std::f64::consts::PI;

/// The desired orientation that leaves the frame of these quantities the error e.
fn with_error(mut quantities: Quantities, case: &Case, e: Vector3<f64>) -> Quantities {
    let rotation = quantities.kinematics(&case.q, &case.v).pose(quantities.frame).unwrap().rotation;
    let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_fn(|i, j| rotation[i][j]));
    quantities.desired = rotation * Rotation3::from_scaled_axis(e).inverse();
    quantities
}

/// Compares value, Jacobian, contracted Hessian and product with hyper-dual numbers, each with twice the
/// bound of the method by hand: near a half turn derivatives are large, and round so. Terms of directions
/// that cancel, where all turns are about one axis, are zero by hand only.
fn judge(quantities: &Quantities, case: &Case) -> Result<(), TestCaseError> {
    let judged = Judged::at(quantities, &case.q, &case.v);
    let (n, w) = (case.n(), weight(&case.y));
    let (found, rounded) = (errors::<f64>(quantities, case), errors::<Count>(quantities, case));
    let reach = quantities.reach(case);
    let of_w = weights(&w) * reach.position(2);
    let cancelling = [reach.position(0), reach.position(1), of_w, weights(&case.u) * of_w];
    let bounds: Vec<f64> =
        rounded.iter().zip(cancelling).map(|(block, floor)| 2.0 * bound(block) + floor).collect();
    close("e", &found[0], judged.value(ORIENTATION, 3), bounds[0])?;
    // Row by row.
    close("e_q", &found[1], judged.by_q(ORIENTATION, 3).transpose().as_slice(), bounds[1])?;
    close("w'e_qq", &found[2], judged.contracted_q(ORIENTATION, &w).as_slice(), bounds[2])?;
    let product = DMatrix::from_column_slice(n, n, &found[2]) * DMatrix::from_column_slice(n, 1, &case.u);
    close("w'e_qq d", &found[3], product.as_slice(), bounds[3].max(weights(&case.u) * bounds[2]))?;
    Ok(())
}

/// The orientation error, its Jacobian, its Hessian contracted with weights, and that times u.
fn errors<S: Scalar>(quantities: &Quantities, case: &Case) -> [Vec<S>; 4] {
    let mut kinematics = Kinematics::<S>::new(&quantities.robot);
    kinematics.set_state(&lift(&case.q), &lift(&case.v)).unwrap();
    let (frame, desired, w) = (quantities.frame, &quantities.desired, weight(&case.y).map(S::from_f64));
    let found = kinematics.contract_orientation_error(frame, desired, &w).unwrap();
    let (error, jacobian, hessian) = (found.error.vector, found.jacobian.clone(), found.hessian.clone());
    let mut product = vec![S::zero(); case.n()];
    kinematics.orientation_error_hessian_product(frame, desired, &w, &lift(&case.u), &mut product).unwrap();
    [error.to_vec(), jacobian.as_slice().to_vec(), hessian.as_slice().to_vec(), product]
}

/// Bound of a rotation vector: up to a half turn the logarithm grows errors of rotations by `angle / (2 sin
/// (angle / 2))` at most.
fn of_logarithm(quantities: &Quantities, case: &Case) -> f64 {
    0.5 * PI * quantities.reach(case).position(0)
}

properties! {
    64;

    #[test]
    fn derivatives_are_those_of_hyper_dual_numbers(case in all_cases(5)) {
        judge(&Quantities::new(&case), &case)?;
    }

    /// The slope of `W . R` along each joint is `W . (w_i x R)`, and dual numbers differentiate that again.
    #[test]
    fn second_derivatives_of_rotations_are_those_of_dual_numbers(case in all_cases(5)) {
        let quantities = Quantities::new(&case);
        let (n, frame, w) = (case.n(), quantities.frame, weight(&case.y));
        let weights = [w, [w[2], -0.3, w[0]], [0.8, w[1] * w[2], 0.1]];
        let mut kinematics = quantities.kinematics(&case.q, &case.v);
        let found = kinematics.rotation_hessian(frame, &weights).unwrap().view().to_nalgebra();
        let mut dual = Kinematics::<Tangent<f64>>::new(&quantities.robot);
        let mut expected = DMatrix::zeros(n, n);
        for j in 0..n {
            let moved = |(i, &q): (usize, &f64)| Tangent::new(q, if i == j { 1.0 } else { 0.0 });
            dual.set_position(&case.q.iter().enumerate().map(moved).collect::<Vec<_>>()).unwrap();
            let rotation = dual.pose(frame).unwrap().rotation;
            let jacobian = dual.jacobian(frame, ReferenceFrame::LocalWorldAligned).unwrap();
            for i in 0..n {
                let axis = [0, 1, 2].map(|k| jacobian[(k, i)]);
                for (k, l) in (0..9).map(|entry| (entry / 3, entry % 3)) {
                    let [after, last] = [(k + 1) % 3, (k + 2) % 3];
                    let slope = axis[after] * rotation[last][l] - axis[last] * rotation[after][l];
                    expected[(i, j)] += weights[k][l] * slope.eps;
                }
            }
        }
        let bound = weights.as_flattened().iter().map(|w| w.abs()).sum::<f64>() * quantities.reach(&case).position(2);
        close("W.R_qq", found.as_slice(), expected.as_slice(), bound)?;
    }

    #[test]
    fn derivatives_hold_at_zero_and_near_it(case in all_cases(4)) {
        for size in [0.0, 1e-300, 1e-9, 1e-4, 1e-2] {
            let e = Vector3::new(case.y[0], -0.4, case.u[0]) * size;
            let quantities = with_error(Quantities::new(&case), &case, e);
            judge(&quantities, &case)?;
            let error = quantities.kinematics(&case.q, &case.v);
            let error = error.orientation_error(quantities.frame, &quantities.desired).unwrap();
            close("e", &error.vector, e.as_slice(), of_logarithm(&quantities, &case))?;
            prop_assert!(!error.at_jump);
        }
    }

    #[test]
    fn the_error_is_the_rotation_vector_up_to_a_half_turn(case in all_cases(3)) {
        let axis = Vector3::new(case.y[0], 0.5, case.u[0]).normalize();
        for short in [3.0, 1.0, 1e-2, 1e-4, 3e-6] {
            let e = axis * (PI - short);
            let quantities = with_error(Quantities::new(&case), &case, e);
            judge(&quantities, &case)?;
            let kinematics = quantities.kinematics(&case.q, &case.v);
            let error = kinematics.orientation_error(quantities.frame, &quantities.desired).unwrap();
            close("e", &error.vector, e.as_slice(), of_logarithm(&quantities, &case))?;
            prop_assert!(!error.at_jump);
        }
        let quantities = with_error(Quantities::new(&case), &case, axis * (PI - 1e-7));
        let kinematics = quantities.kinematics(&case.q, &case.v);
        let error = kinematics.orientation_error(quantities.frame, &quantities.desired).unwrap();
        prop_assert!(error.at_jump && (Vector3::from(error.vector).norm() - PI).abs() < 1e-6);
    }
}

#[test]
fn a_half_turn_about_each_axis_is_told() {
    let body = LinkInertia::point(1.0, [0.1, 0.0, 0.0]);
    for axis in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.6, 0.0, -0.8]] {
        let hinge = JointSpec::revolute("hinge").axis(axis).carrying(body);
        let robot = Robot::builder("hinge").joint(hinge).build().unwrap();
        let frame = robot.frame_index("hinge").unwrap();
        let mut kinematics = Kinematics::<f64>::new(&robot);
        let desired = Rotation3::identity();
        kinematics.set_position(&[PI]).unwrap();
        let (error, slope) = kinematics.linearise_orientation_error(frame, &desired).unwrap();
        assert!(error.at_jump && (Vector3::from(error.vector).norm() - PI).abs() < 1e-15);
        let along = (0..3).map(|k| slope[(k, 0)] * axis[k]).sum::<f64>();
        assert!((along - 1.0).abs() < 1e-14, "the derivative of the angle is {along}");
        kinematics.set_position(&[3.0]).unwrap();
        let (error, _) = kinematics.linearise_orientation_error(frame, &desired).unwrap();
        assert!(!error.at_jump && (Vector3::from(error.vector) - Vector3::from(axis) * 3.0).amax() < 1e-14);
        kinematics.set_position(&[4.0]).unwrap();
        let beyond = kinematics.orientation_error(frame, &desired).unwrap();
        let expected = Vector3::from(axis) * (4.0 - 2.0 * PI);
        assert!((Vector3::from(beyond.vector) - expected).amax() < 1e-14);
        assert!(kinematics.jacobian(frame, ReferenceFrame::Local).is_ok());
    }
}
