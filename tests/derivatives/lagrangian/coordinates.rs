//! The state equation in (q, v), and the Legendre map between (q, v) and (q, p).

use super::{CASES, dense, flat, force, off};
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::{Lagrangian, LegendreTransform};
use costate_test_support::properties;
use costate_test_support::random_robot::{cases, difference, tolerance};
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
        let bound = tolerance(&robot, &case.q);
        prop_assert!(difference(forward.acceleration(), &f[n..]) <= bound);
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
        let mut coordinates = LegendreTransform::<f64>::new(&robot);
        let mut map = coordinates.at(&case.q, &case.v, &case.u).unwrap();
        let p = map.momentum().to_vec();
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let phase = hamiltonian.linearise(&case.q, &p, &case.u).unwrap();
        let bound = 10.0 * tolerance(&robot, &case.q);
        let changed = map.hamiltonian();
        prop_assert!(difference(changed.f, phase.f()) <= bound);
        prop_assert!(difference(changed.f_x.as_slice(), &flat(phase.matrix())) <= bound);
        prop_assert!(changed.f_u[(case.n(), 0)] == 1.0);
        let g_z = map.lagrangian().f_x.clone();
        let found = map.jacobian_to_hamiltonian(g_z.view()).unwrap();
        prop_assert!(difference(found.as_slice(), &flat(phase.matrix())) <= bound);
        let mut map = coordinates.at_momentum(&case.q, &p, &case.u).unwrap();
        prop_assert!(difference(map.velocity(), &case.v) <= bound);
        let found = map.jacobian_to_lagrangian(phase.matrix()).unwrap();
        prop_assert!(difference(found.as_slice(), g_z.as_slice()) <= bound);
    }

    /// `y.dx` is the same number in both coordinates: gradients of the energy go over into each other.
    #[test]
    fn costates_change_with_the_transposed_legendre_map(case in cases(10)) {
        let (robot, n) = (case.robot(), case.n());
        let mut coordinates = LegendreTransform::<f64>::new(&robot);
        let mut map = coordinates.at(&case.q, &case.v, &case.u).unwrap();
        let mut y = case.y.clone();
        map.costate_to_lagrangian(&mut y).unwrap();
        let (rate_q, rate_p) = (map.hamiltonian().f.to_vec(), map.lagrangian().f.to_vec());
        let of = |y: &[f64], f: &[f64]| y.iter().zip(f).map(|(y, f)| y * f).sum::<f64>();
        let size: f64 = case.y.iter().zip(&rate_q).map(|(y, f)| (y * f).abs()).sum::<f64>()
            + y.iter().zip(&rate_p).map(|(y, f)| (y * f).abs()).sum::<f64>();
        prop_assert!((of(&case.y, &rate_q) - of(&y, &rate_p)).abs() <= 1e-13 * size);
        map.costate_to_hamiltonian(&mut y).unwrap();
        prop_assert!(off(&y, &case.y, 0.0) <= 10.0 * tolerance(&robot, &case.q) * force(&robot, &case).max(1.0));
        prop_assert!(map.costate_to_hamiltonian(&mut y[..n]).is_err());
    }
}
