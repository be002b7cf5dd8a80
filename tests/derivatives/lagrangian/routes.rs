//! The algorithms for long chains and large trees agree with those for short ones.

use super::{acceleration, flat, separate_calls_agree};
use costate::derivative::{ForwardDynamics, Jacobian};
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::{Lagrangian, LegendreTransform};
use costate_test_support::random_robot::{all_cases, cases};
use costate_test_support::rounding::{Bounds, apart, close, lift};
use costate_test_support::{properties, rounding};

/// Robots a property.
const LARGE: u32 = 64;

properties! {
    LARGE;

    /// Articulated bodies and M with its factors; products of pairs in the axes of the world and kernels one
    /// and two, which serve the Legendre map.
    #[test]
    fn large_trees_have_the_same_dynamics_by_every_route(case in cases(32)) {
        let (robot, n) = (case.robot(), case.n());
        rounding!(|S| {
            let [q, v, u] = [&case.q[..], &case.v, &case.u].map(lift::<S>);
            let mut lagrangian = Lagrangian::<S>::new(&robot);
            let a = lagrangian.forward_dynamics(&q, &v, &u).unwrap().to_vec();
            let mut coordinates = LegendreTransform::<S>::new(&robot);
            let map = coordinates.at(&q, &v, &u).unwrap();
            let kernels = map.lagrangian();
            let mut blocks = vec![("a", apart(&a, &kernels.f[n..]))];
            let linear = lagrangian.linearise(&q, &v, &u).unwrap();
            blocks.push(("f", apart(linear.f, kernels.f)));
            blocks.push(("f_x", apart(linear.f_x.as_slice(), kernels.f_x.as_slice())));
            blocks.push(("f_u", apart(linear.f_u.as_slice(), kernels.f_u.as_slice())));
            let tau = lagrangian.inverse_dynamics(&q, &v, &a).unwrap().to_vec();
            blocks.push(("tau", apart(&tau, &u)));
            let linear = lagrangian.linearise_inverse_dynamics(&q, &v, &a).unwrap();
            blocks.push(("tau beside tau_z", apart(linear.tau, &tau)));
            let (tau_q, tau_a) = (linear.tau_q.clone(), linear.tau_a.clone());
            let mass_matrix = Hamiltonian::<S>::new(&robot).mass_matrix(&q).unwrap().clone();
            blocks.push(("M", apart(tau_a.as_slice(), mass_matrix.as_slice())));
            // M a_q + tau_q = 0.
            let a_q = |i: usize, j: usize| kernels.f_x[(n + i, j)];
            let entry = |i: usize, j: usize| (0..n).fold(tau_q[(i, j)], |sum, k| sum + tau_a[(i, k)] * a_q(k, j));
            blocks.push(("M a_q + tau_q", (0..n * n).map(|k| entry(k / n, k % n)).collect()));
            blocks
        })?;
    }

    /// Derivatives of inverse dynamics beside its contracted Hessian, and alone.
    #[test]
    fn inverse_dynamics_has_the_same_derivatives_in_one_call(case in all_cases(26)) {
        let inputs = [&case.q[..], &case.v, acceleration(&case), &case.u];
        separate_calls_agree(&case.robot(), inputs)?;
    }

    /// Dual numbers take M in body frames, or articulated bodies; derivatives are pairs of joints.
    #[test]
    fn jacobians_of_large_trees_are_those_of_dual_numbers(case in cases(26)) {
        let robot = case.robot();
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let linear = lagrangian.linearise_forward_dynamics(&case.q, &case.v, &case.u).unwrap();
        let z = [case.q.as_slice(), &case.v, &case.u].concat();
        let mut dual: Jacobian<_> = Jacobian::new(ForwardDynamics::new(&robot));
        let expected = dual.linearise(&z).unwrap();
        let bounds = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]);
        close("a", linear.acceleration(), expected.value, bounds.a)?;
        close("a_z", &flat(linear.matrix()), expected.jacobian.as_slice(), bounds.a_z)?;
    }
}
