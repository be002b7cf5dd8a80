//! The algorithms for long chains and large trees agree with those for short ones.

use super::{acceleration, dense, force, off, separate_calls_agree};
use costate::derivative::{ForwardDynamics, Jacobian, largest};
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::{Lagrangian, LegendreTransform};
use costate_test_support::properties;
use costate_test_support::random_robot::{all_cases, cases, difference, tolerance};
use proptest::prelude::*;

/// Robots a property.
const LARGE: u32 = 64;

properties! {
    LARGE;

    /// Articulated bodies and M with its factors; products of pairs in the axes of the world and kernels one
    /// and two, which serve the Legendre map.
    #[test]
    fn large_trees_have_the_same_dynamics_by_every_route(case in cases(32)) {
        let (robot, n) = (case.robot(), case.n());
        let bound = 10.0 * tolerance(&robot, &case.q);
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let a = lagrangian.forward_dynamics(&case.q, &case.v, &case.u).unwrap().to_vec();
        let mut coordinates = LegendreTransform::<f64>::new(&robot);
        let map = coordinates.at(&case.q, &case.v, &case.u).unwrap();
        let kernels = map.lagrangian();
        prop_assert!(difference(&a, &kernels.f[n..]) <= bound);

        let linear = lagrangian.linearise(&case.q, &case.v, &case.u).unwrap();
        prop_assert!(difference(linear.f, kernels.f) <= bound);
        prop_assert!(difference(linear.f_x.as_slice(), kernels.f_x.as_slice()) <= bound);
        prop_assert!(difference(linear.f_u.as_slice(), kernels.f_u.as_slice()) <= bound);
        let tau = lagrangian.inverse_dynamics(&case.q, &case.v, &a).unwrap().to_vec();
        prop_assert!(off(&tau, &case.u, force(&robot, &case)) <= bound);

        let linear = lagrangian.linearise_inverse_dynamics(&case.q, &case.v, &a).unwrap();
        prop_assert!(off(linear.tau, &tau, force(&robot, &case)) <= 1e-12);
        let mass_matrix = Hamiltonian::<f64>::new(&robot).mass_matrix(&case.q).unwrap().clone();
        prop_assert!(difference(linear.tau_a.as_slice(), mass_matrix.as_slice()) <= 1e-12);
        let inverse = dense(linear.tau_a.view()).try_inverse().unwrap();
        // Terms of this size may cancel each other: without gravity a single joint has a_q = 0.
        let terms = largest(&inverse) * force(&robot, &case);
        let a_q = -inverse * dense(linear.tau_q.view());
        let expected = dense(kernels.f_x.view()).view((n, 0), (n, n)).into_owned();
        prop_assert!(largest(&(&a_q - &expected)) <= bound * largest(&expected).max(terms));
    }

    /// Derivatives of inverse dynamics in one call, by kernels, and by separate calls, which work in the axes
    /// of the world unless joints mimic others.
    #[test]
    fn inverse_dynamics_has_the_same_derivatives_in_one_call(case in all_cases(26)) {
        let inputs = [&case.q[..], &case.v, acceleration(&case), &case.u];
        separate_calls_agree(&case.robot(), inputs)?;
    }

    /// The derivatives of one algorithm, by dual numbers, are what the other computes.
    #[test]
    fn jacobians_of_large_trees_are_those_of_dual_numbers(case in cases(26)) {
        let robot = case.robot();
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let linear = lagrangian.linearise_forward_dynamics(&case.q, &case.v, &case.u).unwrap();
        let z = [case.q.as_slice(), &case.v, &case.u].concat();
        let mut dual: Jacobian<_> = Jacobian::new(ForwardDynamics::new(&robot));
        let expected = dual.linearise(&z).unwrap();
        let bound = 10.0 * tolerance(&robot, &case.q);
        prop_assert!(difference(linear.acceleration(), expected.value) <= bound);
        let found = difference(&super::flat(linear.matrix()), expected.jacobian.as_slice());
        prop_assert!(found <= bound, "{found:.1e} is above {bound:.1e}");
    }
}
