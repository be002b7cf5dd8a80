//! First and second derivatives of inverse and forward dynamics, judged by dual and hyper-dual numbers.

use super::{CASES, acceleration, apart_from_the_matrix, dense, flat, torque_hessian, torques};
use costate::derivative::{ForwardDynamics, Hessian, Jacobian, NestedHessian};
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::scalar::Scalar;
use costate_test_support::random_robot::{all_cases, cases};
use costate_test_support::rounding::{Bounds, InverseBounds, apart, close, lift, rows};
use costate_test_support::{properties, rounding};
use nalgebra::DMatrix;
use num_dual::Dual64;
use proptest::prelude::*;

properties! {
    CASES;

    #[test]
    fn jacobian_of_inverse_dynamics_is_that_of_dual_numbers(case in all_cases(8)) {
        let (robot, a, n) = (case.robot(), acceleration(&case), case.n());
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let linear = lagrangian.linearise_inverse_dynamics(&case.q, &case.v, a).unwrap();
        let z = [case.q.as_slice(), &case.v, a].concat();
        let bound = InverseBounds::new(&robot, [&case.q, &case.v, a, &case.u]).tau_z;
        for (block, found) in [linear.tau_q, linear.tau_v, linear.tau_a].into_iter().enumerate() {
            let mut expected = DMatrix::zeros(n, n);
            for k in 0..n {
                let mut dual: Vec<_> = z.iter().map(|&z| Dual64::from_re(z)).collect();
                dual[block * n + k].eps = 1.0;
                let tau = torques(&robot, &dual[..n], &dual[n..2 * n], &dual[2 * n..]);
                (0..n).for_each(|i| expected[(i, k)] = tau[i].eps);
            }
            close(&format!("block {block}"), dense(found.view()).as_slice(), expected.as_slice(), bound)?;
        }
    }

    #[test]
    fn jacobian_of_forward_dynamics_is_that_of_dual_numbers(case in cases(10)) {
        let robot = case.robot();
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let linear = lagrangian.linearise_forward_dynamics(&case.q, &case.v, &case.u).unwrap();
        let z = [case.q.as_slice(), &case.v, &case.u].concat();
        let mut dual: Jacobian<_> = Jacobian::new(ForwardDynamics::new(&robot));
        let expected = dual.linearise(&z).unwrap();
        let bounds = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]);
        close("a", linear.acceleration(), expected.value, bounds.a)?;
        close("a_z", &flat(linear.matrix()), expected.jacobian.as_slice(), bounds.a_z)?;
        prop_assert_eq!(dense(linear.a_u()), dense(linear.a_u()).transpose());
    }

    #[test]
    fn contracted_hessian_of_forward_dynamics_is_that_of_hyper_dual_numbers(case in cases(6)) {
        let (robot, n) = (case.robot(), case.n());
        let (z, y) = ([case.q.as_slice(), &case.v, &case.u].concat(), &case.y[n..]);
        let mut second = LagrangianSecondOrder::<f64>::new(&robot);
        let found = second.contract_forward_dynamics(&case.q, &case.v, &case.u, y).unwrap();
        let mut hyperdual = Hessian::new(ForwardDynamics::new(&robot));
        let expected = hyperdual.contract(&z, y).unwrap().as_slice().to_vec();
        let mut nested = NestedHessian::new(ForwardDynamics::new(&robot));
        let bounds = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]);
        close("y'a_zz", found.to_matrix().as_slice(), &expected, bounds.y_a_zz)?;
        close("y'a_zz, nested", found.to_matrix().as_slice(), nested.contract(&z, y).unwrap().as_slice(), bounds.y_a_zz)?;
        let linear = hyperdual.last();
        close("a", found.forward_dynamics().acceleration(), linear.value(), bounds.a)?;
        close("a_z", &flat(found.forward_dynamics().matrix()), linear.jacobian().as_slice(), bounds.a_z)?;
    }

    #[test]
    fn contracted_hessian_of_inverse_dynamics_is_that_of_hyper_dual_numbers(case in all_cases(4)) {
        let (robot, a, n) = (case.robot(), acceleration(&case), case.n());
        let (z, w) = ([case.q.as_slice(), &case.v, a].concat(), &case.u);
        let mut second = LagrangianSecondOrder::<f64>::new(&robot);
        let all = second.contract_inverse_dynamics(&case.q, &case.v, a, w).unwrap();
        let found = dense(all.zz().view());
        prop_assert_eq!(dense(all.xx()), found.view((0, 0), (2 * n, 2 * n)).clone_owned());
        prop_assert_eq!(dense(all.aq()), found.view((2 * n, 0), (n, n)).clone_owned());
        prop_assert!(found.view((2 * n, n), (n, 2 * n)).iter().all(|&entry| entry == 0.0), "w'tau_av = w'tau_aa = 0");
        let expected = torque_hessian(&robot, &z, w);
        prop_assert_eq!(&found, &found.transpose());
        let bounds = InverseBounds::new(&robot, [&case.q, &case.v, a, w]);
        close("w'tau_zz", found.as_slice(), expected.as_slice(), bounds.w_tau_zz)?;
    }

    #[test]
    fn products_with_a_direction_are_those_with_the_matrix(case in cases(8)) {
        let (robot, a) = (case.robot(), acceleration(&case));
        let d = [&case.y[..], a].concat();
        rounding!(|S| apart_from_the_matrix::<S>(&robot, [&case.q[..], &case.v, &case.u, a].map(lift), &lift(&d)))?;
    }

    #[test]
    fn contracted_hessian_is_symmetric_linear_in_y_and_without_curvature_in_u(case in cases(8)) {
        let (robot, n) = (case.robot(), case.n());
        let (one, other) = case.y.split_at(n);
        rounding!(|S| {
            let [q, v, u, one, other] = [&case.q[..], &case.v, &case.u, one, other].map(lift::<S>);
            let combine = |a: S, b: S| a.times(2.0) - b.times(3.0);
            let both: Vec<S> = one.iter().zip(&other).map(|(&a, &b)| combine(a, b)).collect();
            let mut second = LagrangianSecondOrder::<S>::new(&robot);
            let mut of = |y: &[S]| second.contract_forward_dynamics(&q, &v, &u, y).unwrap().to_matrix().as_slice().to_vec();
            let (h_one, h_other, h_both) = (of(&one), of(&other), of(&both));
            let off = (0..h_both.len()).map(|k| combine(h_one[k], h_other[k]) - h_both[k]);
            let mut block = vec![("2 one'a_zz - 3 other'a_zz - both'a_zz", off.collect())];
            let inverse = Hamiltonian::<S>::new(&robot).inverse_mass_matrix(&q).unwrap().as_slice().to_vec();
            let linear = second.first().linearise_forward_dynamics(&q, &v, &u).unwrap();
            block.push(("a_u - M^-1", apart(&rows(linear.a_u()), &inverse)));
            block
        })?;
        let mut second = LagrangianSecondOrder::<f64>::new(&robot);
        let h = second.contract_forward_dynamics(&case.q, &case.v, &case.u, one).unwrap();
        let whole = dense(h.to_matrix().view());
        prop_assert_eq!(&whole, &whole.transpose());
        let in_u = whole.view((2 * n, n), (n, 2 * n));
        prop_assert!(in_u.iter().all(|&entry| entry == 0.0), "y'a_uv = y'a_uu = 0");
        prop_assert_eq!(dense(h.xx()), whole.view((0, 0), (2 * n, 2 * n)).clone_owned());
        prop_assert_eq!(dense(h.uq()), whole.view((2 * n, 0), (n, n)).clone_owned());
    }
}
