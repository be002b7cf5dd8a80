//! The state equation in (q, v), and the Legendre map between (q, v) and (q, p).

use super::{CASES, dense};
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::{Lagrangian, LegendreTransform};
use costate::scalar::Scalar;
use costate_test_support::random_robot::cases;
use costate_test_support::rounding::{Bounds, apart, close, lift, rows};
use costate_test_support::{properties, rounding};
use nalgebra::DMatrix;
use proptest::prelude::*;

properties! {
    CASES;

    #[test]
    fn state_equation_is_velocity_and_acceleration(case in cases(8)) {
        let (robot, n) = (case.robot(), case.n());
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let f = lagrangian.evaluate(&case.q, &case.v, &case.u).unwrap().to_vec();
        prop_assert_eq!(&f[..n], &case.v[..]);
        let forward = lagrangian.linearise_forward_dynamics(&case.q, &case.v, &case.u).unwrap();
        let bounds = Bounds::new(&robot, [&case.q, &case.v, &case.u, &case.y]);
        close("a", forward.acceleration(), &f[n..], bounds.a)?;
        let (a, a_z) = (forward.acceleration().to_vec(), dense(forward.matrix()));
        let state = lagrangian.linearise(&case.q, &case.v, &case.u).unwrap();
        prop_assert_eq!(&state.f[..n], &case.v[..]);
        prop_assert_eq!(&state.f[n..], &a[..]);
        let (f_x, f_u) = (dense(state.f_x.view()), dense(state.f_u.view()));
        prop_assert_eq!(f_x.view((0, n), (n, n)).clone_owned(), DMatrix::identity(n, n));
        prop_assert!(f_x.view((0, 0), (n, n)).iter().chain(f_u.view((0, 0), (n, n)).iter()).all(|&x| x == 0.0));
        prop_assert_eq!(f_x.view((n, 0), (n, 2 * n)), a_z.view((0, 0), (n, 2 * n)));
        prop_assert_eq!(f_u.view((n, 0), (n, n)), a_z.view((0, 2 * n), (n, n)));
    }

    /// One flow in two coordinates: rates and Jacobians turn into each other, in both directions.
    #[test]
    fn hamiltonian_and_lagrangian_jacobians_are_one_under_the_legendre_map(case in cases(10)) {
        let robot = case.robot();
        // Products with M, M^-1 and their derivatives lie between the two.
        rounding!(|S| {
            let [q, v, u] = [&case.q[..], &case.v, &case.u].map(lift::<S>);
            let mut coordinates = LegendreTransform::<S>::new(&robot);
            let mut map = coordinates.at(&q, &v, &u).unwrap();
            let p = map.momentum().to_vec();
            let mut hamiltonian = Hamiltonian::<S>::new(&robot);
            let phase = hamiltonian.linearise(&q, &p, &u).unwrap();
            let changed = map.hamiltonian();
            let mut blocks = vec![("F", apart(changed.f, phase.f()))];
            blocks.push(("F_x", apart(changed.f_x.as_slice(), &rows(phase.matrix()))));
            let g_z = map.lagrangian().f_x.clone();
            let found = map.jacobian_to_hamiltonian(g_z.view()).unwrap();
            blocks.push(("F_x from g_z", apart(found.as_slice(), &rows(phase.matrix()))));
            let mut map = coordinates.at_momentum(&q, &p, &u).unwrap();
            blocks.push(("v", apart(map.velocity(), &v)));
            let found = map.jacobian_to_lagrangian(phase.matrix()).unwrap();
            blocks.push(("g_z from F_x", apart(found.as_slice(), g_z.as_slice())));
            blocks
        })?;
        let mut coordinates = LegendreTransform::<f64>::new(&robot);
        let mut map = coordinates.at(&case.q, &case.v, &case.u).unwrap();
        prop_assert!(map.hamiltonian().f_u[(case.n(), 0)] == 1.0);
    }

    /// `y.dx` is the same number in both coordinates: gradients of the energy go over into each other.
    #[test]
    fn costates_change_with_the_transposed_legendre_map(case in cases(10)) {
        let robot = case.robot();
        rounding!(|S| {
            let [q, v, u, given] = [&case.q[..], &case.v, &case.u, &case.y].map(lift::<S>);
            let mut coordinates = LegendreTransform::<S>::new(&robot);
            let mut map = coordinates.at(&q, &v, &u).unwrap();
            let mut y = given.clone();
            map.costate_to_lagrangian(&mut y).unwrap();
            let (rate_q, rate_p) = (map.hamiltonian().f.to_vec(), map.lagrangian().f.to_vec());
            let of = |y: &[S], f: &[S]| y.iter().zip(f).fold(S::zero(), |sum, (&y, &f)| sum + y * f);
            let mut blocks = vec![("y.dx", vec![of(&given, &rate_q) - of(&y, &rate_p)])];
            map.costate_to_hamiltonian(&mut y).unwrap();
            blocks.push(("y there and back", apart(&y, &given)));
            blocks
        })?;
        let mut coordinates = LegendreTransform::<f64>::new(&robot);
        let mut map = coordinates.at(&case.q, &case.v, &case.u).unwrap();
        prop_assert!(map.costate_to_hamiltonian(&mut case.y.clone()[..case.n()]).is_err());
    }
}
