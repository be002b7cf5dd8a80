//! Properties of the second derivatives of the phase velocities.

use costate::derivative::{Hessian, PhaseVelocity, largest};
use costate::dynamics::Dynamics;
use costate::hamiltonian::{FullHessian, HamiltonianSecondOrder};
use costate::lagrangian::LagrangianSecondOrder;
use costate::matrix::Matrix;
use costate::robot::Robot;
use costate::{EvalError, LengthError};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, cases, tolerance};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

/// Robots a property.
const CASES: u32 = 320;

fn vector(values: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(values)
}

/// Size of the terms of y'F_xx, to which rounding is relative where y'F_xx vanishes.
fn natural(case: &Case, second: &mut HamiltonianSecondOrder<f64>, x: &[f64]) -> f64 {
    let linear = second.first().linearise(&case.q, &x[case.n()..], &case.u).unwrap();
    largest(&case.y) * largest(linear.matrix().to_nalgebra().as_slice()).max(1.0)
}

properties! {
    CASES;

    #[test]
    fn contracted_hessian_is_symmetric_and_linear_in_y(case in cases(10)) {
        let robot = case.robot();
        let x = case.x(&robot);
        let p = &x[case.n()..];
        let other: Vec<f64> = case.y.iter().rev().map(|y| 0.7 - y).collect();
        let both: Vec<f64> = case.y.iter().zip(&other).map(|(a, b)| 2.0 * a - 3.0 * b).collect();
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let mut of = |y: &[f64]| second.contract(&case.q, p, &case.u, y).unwrap().matrix().to_nalgebra();
        let (h_one, h_other, h_both) = (of(&case.y), of(&other), of(&both));
        prop_assert_eq!(&h_one, &h_one.transpose());
        let size = h_one.amax().max(h_other.amax()).max(natural(&case, &mut second, &x));
        let off = (2.0 * h_one - 3.0 * h_other - h_both).amax();
        prop_assert!(off <= 10.0 * tolerance(&robot, &case.q) * size, "{:.1e}", off / size);
    }

    /// y'F_x beside F_x, y'F_xx d beside y'F_xx, and both through the trait.
    #[test]
    fn products_are_those_with_the_matrices(case in cases(10)) {
        let (robot, n) = (case.robot(), case.n());
        let (x, y) = (case.x(&robot), &case.y);
        let p = &x[n..];
        let d: Vec<f64> = y.iter().map(|y| (5.0 * y).sin()).collect();
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let all = second.contract(&case.q, p, &case.u, y).unwrap();
        let linear = all.linearisation();
        let by_f_x = linear.matrix().to_nalgebra().transpose() * vector(y);
        let by_y_f_xx = all.matrix().to_nalgebra() * vector(&d);
        let (f, largest_second) = (linear.f().to_vec(), all.matrix().to_nalgebra().amax());
        let bound = tolerance(&robot, &case.q);
        let size = natural(&case, &mut second, &x);
        let adjoint = second.first().adjoint(&case.q, p, &case.u, y).unwrap();
        prop_assert_eq!(adjoint.f, &f[..]);
        let y_f_x = adjoint.y_f_x.to_vec();
        prop_assert!((vector(&y_f_x) - &by_f_x).amax() <= bound * size, "{y_f_x:?} {by_f_x}");
        let product = second.hessian_product(&case.q, p, y, &d).unwrap().to_vec();
        let size = size.max(largest_second);
        prop_assert!((vector(&product) - &by_y_f_xx).amax() <= bound * size, "{product:?} {by_y_f_xx}");
        let (mut in_x, mut in_u) = (vec![f64::NAN; 2 * n], vec![f64::NAN; n]);
        second.adjoint(&x, &case.u, y, &mut in_x, &mut in_u).unwrap();
        prop_assert_eq!((&in_x, &in_u[..]), (&y_f_x, &y[n..]));
        Dynamics::hessian_product(&mut second, &x, &case.u, y, [&d, &case.u], [&mut in_x, &mut in_u]).unwrap();
        prop_assert_eq!((&in_x, &in_u), (&product, &vec![0.0; n]));
    }

    /// Every index order of the packed tensor, and what it says of F beside hyper-dual numbers.
    #[test]
    fn packed_tensor_has_every_entry(case in cases(5)) {
        let (robot, n) = (case.robot(), case.n());
        let x = case.x(&robot);
        let mut full = FullHessian::<f64>::new(&robot);
        let tensor = full.hessian_tensor(&case.q, &x[n..]).unwrap();
        prop_assert_eq!(tensor.packed().len(), (2 * n) * (2 * n + 1) * (2 * n + 2) / 6 - n * (n + 1) * (n + 2) / 6);
        let mut hyperdual = Hessian::new(PhaseVelocity::new(&robot).under(&case.u));
        let expected = hyperdual.hessian_tensor(&x).unwrap();
        let size = largest(expected.jacobian().as_slice()).max(1.0);
        let size_of = 2 * n;
        let triples = || (0..size_of.pow(3)).map(move |t| (t / size_of / size_of, t / size_of % size_of, t % size_of));
        let entries = |of: &dyn Fn(usize, usize, usize) -> f64| {
            triples().map(|(k, i, j)| of(k, i, j)).collect::<Vec<f64>>()
        };
        let ours = entries(&|k, i, j| tensor.entry(k, i, j));
        let theirs = entries(&|k, i, j| expected.entry(k, i, j));
        let size = size.max(largest(&theirs));
        let off = (vector(&ours) - vector(&theirs)).amax() / size;
        prop_assert!(off <= tolerance(&robot, &case.q), "{off:.1e}");
        let without_friction = robot.joints().iter().all(|joint| joint.friction.is_none());
        for (a, b, c) in triples() {
            let entry = tensor.third(a, b, c);
            for order in [[a, c, b], [b, a, c], [b, c, a], [c, a, b], [c, b, a]] {
                prop_assert_eq!(tensor.third(order[0], order[1], order[2]), entry);
            }
            prop_assert_eq!(tensor.entry(a, b, c), tensor.entry(a, c, b));
            prop_assert!(a.min(b).min(c) < n || entry == 0.0, "three momenta");
            if without_friction {
                let row = if a < n { -tensor.entry(n + a, b, c) } else { tensor.entry(a - n, b, c) };
                prop_assert_eq!(row, entry, "F = J grad H");
            }
        }
    }

    /// u-derivatives that are zero by structure do not exist.
    #[test]
    fn what_is_zero_by_structure_is_not_stored(case in cases(4)) {
        let (robot, n) = (case.robot(), case.n());
        let x = case.x(&robot);
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let structure = second.structure();
        prop_assert!(structure.constant_f_u && structure.affine_in_u && structure.f_u_depends_on == 0);
        let all = Dynamics::contract(&mut second, &x, &case.u, &case.y).unwrap();
        prop_assert!(all.ux.is_none() && all.uu.is_none());
        let expected = DMatrix::from_fn(2 * n, n, |i, j| f64::from(u8::from(i == n + j)));
        prop_assert_eq!(all.first.f_u.to_nalgebra(), expected);
        let mut lagrangian = LagrangianSecondOrder::<f64>::new(&robot);
        let structure = lagrangian.structure();
        prop_assert!(!structure.constant_f_u && structure.affine_in_u && structure.f_u_depends_on == n);
        let x = [case.q.as_slice(), &case.v].concat();
        let all = Dynamics::contract(&mut lagrangian, &x, &case.u, &case.y).unwrap();
        prop_assert!(all.uu.is_none());
        prop_assert_eq!(all.ux.map(|ux| (ux.rows(), ux.columns())), Some((n, n)));
    }
}

#[test]
fn wrong_lengths_and_numbers_are_named() {
    let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/two_link.toml")).unwrap();
    let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
    let (two, four, bad) = ([0.1; 2], [0.2; 4], [0.1, f64::NAN, 0.3, 0.4]);
    let wrong = |what, expected, found| EvalError::WrongLength(LengthError { what, expected, found });
    assert_eq!(second.contract(&two, &two, &two, &two).unwrap_err(), wrong("y", 4, 2));
    assert_eq!(second.hessian_product(&two, &two, &four, &two).unwrap_err(), wrong("d", 4, 2));
    assert_eq!(second.hessian_product(&two, &four, &four, &four).unwrap_err(), wrong("p", 2, 4));
    assert_eq!(second.first().adjoint(&two, &two, &two, &two).map(drop).unwrap_err(), wrong("y", 4, 2));
    assert!(matches!(
        second.hessian_product(&two, &two, &bad, &four),
        Err(EvalError::NonFinite { what: "y", .. })
    ));
    assert!(matches!(
        second.hessian_product(&two, &two, &four, &bad),
        Err(EvalError::NonFinite { what: "d", .. })
    ));
    let mut full = FullHessian::<f64>::new(&robot);
    assert_eq!(full.hessian_tensor(&four, &two).map(drop).unwrap_err(), wrong("q", 2, 4));
    let tensor = full.hessian_tensor(&two, &two).unwrap();
    assert_eq!(tensor.contract(&two, &mut Matrix::zeros(4, 4)).unwrap_err(), wrong("y", 4, 2));
    assert_eq!(
        tensor.contract(&four, &mut Matrix::zeros(4, 3)).unwrap_err(),
        wrong("a row of contracted", 4, 3)
    );
    assert_eq!(second.evaluate(&two, &two).map(drop).unwrap_err(), wrong("x", 4, 2));
}
