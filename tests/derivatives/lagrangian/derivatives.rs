//! First and second derivatives of inverse and forward dynamics, judged by dual and hyper-dual numbers.

use super::{CASES, acceleration, dense, flat, force, off, torque_hessian, torques};
use costate::derivative::{ForwardDynamics, Hessian, Jacobian, NestedHessian, largest};
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate_test_support::properties;
use costate_test_support::random_robot::{all_cases, cases, difference, tolerance};
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
        let natural = force(&robot, &case);
        for (block, found) in [linear.tau_q, linear.tau_v, linear.tau_a].into_iter().enumerate() {
            let mut expected = DMatrix::zeros(n, n);
            for k in 0..n {
                let mut dual: Vec<_> = z.iter().map(|&z| Dual64::from_re(z)).collect();
                dual[block * n + k].eps = 1.0;
                let tau = torques(&robot, &dual[..n], &dual[n..2 * n], &dual[2 * n..]);
                (0..n).for_each(|i| expected[(i, k)] = tau[i].eps);
            }
            let worst = largest(&(dense(found.view()) - &expected)) / natural;
            prop_assert!(worst <= 1e-12, "block {block}: {worst:.2e}");
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
        let bound = tolerance(&robot, &case.q);
        prop_assert!(difference(linear.acceleration(), expected.value) <= bound);
        prop_assert!(difference(&flat(linear.matrix()), expected.jacobian.as_slice()) <= bound);
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
        let bound = tolerance(&robot, &case.q);
        let natural = 1e-3 * largest(y) * largest(&flat(found.forward_dynamics().matrix()));
        prop_assert!(off(found.to_matrix().as_slice(), &expected, natural) <= bound);
        prop_assert!(off(found.to_matrix().as_slice(), nested.contract(&z, y).unwrap().as_slice(), natural) <= bound);
        let linear = hyperdual.last();
        prop_assert!(difference(found.forward_dynamics().acceleration(), linear.value()) <= bound);
        prop_assert!(difference(&flat(found.forward_dynamics().matrix()), linear.jacobian().as_slice()) <= bound);
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
        let natural = largest(&expected).max(largest(w) * force(&robot, &case));
        prop_assert!(largest(&(found - expected)) <= 1e-12 * natural);
    }

    #[test]
    fn contracted_hessian_is_symmetric_linear_in_y_and_without_curvature_in_u(case in cases(8)) {
        let (robot, n) = (case.robot(), case.n());
        let (one, other) = case.y.split_at(n);
        let both: Vec<f64> = one.iter().zip(other).map(|(a, b)| 2.0 * a - 3.0 * b).collect();
        let mut second = LagrangianSecondOrder::<f64>::new(&robot);
        let mut of = |y: &[f64]| dense(second.contract_forward_dynamics(&case.q, &case.v, &case.u, y).unwrap().to_matrix().view());
        let (h_one, h_other, h_both) = (of(one), of(other), of(&both));
        let size = largest(&h_one).max(largest(&h_other));
        prop_assert!(largest(&(2.0 * h_one - 3.0 * h_other - &h_both)) <= 10.0 * tolerance(&robot, &case.q) * size);
        prop_assert_eq!(&h_both, &h_both.transpose());
        let in_u = h_both.view((2 * n, n), (n, 2 * n));
        prop_assert!(in_u.iter().all(|&entry| entry == 0.0), "y'a_uv = y'a_uu = 0");
        let inverse = dense(Hamiltonian::<f64>::new(&robot).inverse_mass_matrix(&case.q).unwrap().view());
        let h = second.contract_forward_dynamics(&case.q, &case.v, &case.u, one).unwrap();
        let off_inverse = largest(&(dense(h.forward_dynamics().a_u()) - &inverse));
        prop_assert!(off_inverse <= tolerance(&robot, &case.q) * largest(&inverse));
        let whole = dense(h.to_matrix().view());
        prop_assert_eq!(dense(h.xx()), whole.view((0, 0), (2 * n, 2 * n)).clone_owned());
        prop_assert_eq!(dense(h.uq()), whole.view((2 * n, 0), (n, n)).clone_owned());
    }
}
