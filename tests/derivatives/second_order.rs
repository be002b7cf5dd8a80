//! Properties of the second derivatives of the phase velocities.

use costate::derivative::{Hessian, PhaseVelocity, largest};
use costate::dynamics::Dynamics;
use costate::hamiltonian::{FullHessian, HamiltonianSecondOrder};
use costate::lagrangian::LagrangianSecondOrder;
use costate::matrix::Matrix;
use costate::robot::Robot;
use costate::scalar::{Count, Scalar};
use costate::{EvalError, LengthError};
use costate_test_support::random_robot::cases;
use costate_test_support::rounding::{apart, bound, close, lift, of_inverse, rows, times, transposed_times};
use costate_test_support::{properties, rounding};
use nalgebra::DMatrix;
use proptest::prelude::*;

/// Robots a property.
const CASES: u32 = 320;

properties! {
    CASES;

    #[test]
    fn contracted_hessian_is_symmetric_and_linear_in_y(case in cases(10)) {
        let robot = case.robot();
        rounding!(|S| {
            let [q, v, u, y] = [&case.q[..], &case.v, &case.u, &case.y].map(lift::<S>);
            let combine = |a: S, b: S| a.times(2.0) - b.times(3.0);
            let other: Vec<S> = y.iter().rev().map(|&y| S::from_f64(0.7) - y).collect();
            let both: Vec<S> = y.iter().zip(&other).map(|(&a, &b)| combine(a, b)).collect();
            let mut second = HamiltonianSecondOrder::<S>::new(&robot);
            let p = second.first().momentum(&q, &v).unwrap().to_vec();
            let mut of = |y: &[S]| rows(second.contract(&q, &p, &u, y).unwrap().matrix());
            let (h_one, h_other, h_both) = (of(&y), of(&other), of(&both));
            vec![("linear in y", (0..h_both.len()).map(|k| combine(h_one[k], h_other[k]) - h_both[k]).collect())]
        })?;
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let h = second.contract(&case.q, &case.p(&robot), &case.u, &case.y).unwrap().matrix().to_nalgebra();
        prop_assert_eq!(&h, &h.transpose());
    }

    /// y'F_x beside F_x, y'F_xx d beside y'F_xx, and both through the trait.
    #[test]
    fn products_are_those_with_the_matrices(case in cases(10)) {
        let (robot, n) = (case.robot(), case.n());
        let (x, y) = (case.x(&robot), &case.y);
        let p = &x[n..];
        let d: Vec<f64> = y.iter().map(|y| (5.0 * y).sin()).collect();
        rounding!(|S| {
            let [q, v, u, y, d] = [&case.q[..], &case.v, &case.u, y, &d].map(lift::<S>);
            let mut second = HamiltonianSecondOrder::<S>::new(&robot);
            let p = second.first().momentum(&q, &v).unwrap().to_vec();
            let all = second.contract(&q, &p, &u, &y).unwrap();
            let by_f_x = transposed_times(&rows(all.linearisation().matrix()), &y);
            let by_y_f_xx = times(&rows(all.matrix()), &d);
            let y_f_x = second.first().adjoint(&q, &p, &u, &y).unwrap().y_f_x.to_vec();
            let product = second.hessian_product(&q, &p, &y, &d).unwrap();
            vec![("y'F_x", apart(&y_f_x, &by_f_x)), ("y'F_xx d", apart(product, &by_y_f_xx))]
        })?;
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let f = second.contract(&case.q, p, &case.u, y).unwrap().linearisation().f().to_vec();
        let adjoint = second.first().adjoint(&case.q, p, &case.u, y).unwrap();
        prop_assert_eq!(adjoint.f, &f[..]);
        let y_f_x = adjoint.y_f_x.to_vec();
        let product = second.hessian_product(&case.q, p, y, &d).unwrap().to_vec();
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
        let size_of = 2 * n;
        let triples = || (0..size_of.pow(3)).map(move |t| (t / size_of / size_of, t / size_of % size_of, t % size_of));
        let entries = |of: &dyn Fn(usize, usize, usize) -> f64| {
            triples().map(|(k, i, j)| of(k, i, j)).collect::<Vec<f64>>()
        };
        let ours = entries(&|k, i, j| tensor.entry(k, i, j));
        let theirs = entries(&|k, i, j| expected.entry(k, i, j));
        let [q, p] = [&case.q[..], &x[n..]].map(lift::<Count>);
        let mut rounded = FullHessian::<Count>::new(&robot);
        // Entries, with friction. Hyper-dual numbers leave products with M^-1 of the size of F_x and F_xx
        // where the tensor has none.
        let rounded = rounded.hessian_tensor(&q, &p).unwrap();
        let counted = bound(&triples().map(|(k, i, j)| rounded.entry(k, i, j)).collect::<Vec<Count>>());
        let size = largest(expected.jacobian().as_slice()).max(largest(&theirs)).max(1.0);
        close("F_xx", &ours, &theirs, 2.0 * counted + of_inverse(&robot, &case.q) * size)?;
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
