//! Inverse and forward dynamics: the equations of motion, energy, the Coriolis matrix.

use super::{CASES, acceleration, column, dense, force, off, smooth, torques};
use costate::derivative::largest;
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::Lagrangian;
use costate_test_support::properties;
use costate_test_support::random_robot::{all_cases, cases, tolerance};
use nalgebra::DMatrix;
use num_dual::Dual64;
use proptest::prelude::*;

properties! {
    CASES;

    #[test]
    fn mass_matrix_rate_minus_twice_coriolis_is_skew(case in all_cases(10)) {
        let mut lagrangian = Lagrangian::<f64>::new(&case.robot());
        let rate = dense(lagrangian.mass_matrix_rate(&case.q, &case.v).unwrap().view());
        let c = dense(lagrangian.coriolis_matrix(&case.q, &case.v).unwrap().view());
        prop_assert_eq!(&rate, &rate.transpose());
        let skew = &rate - 2.0 * &c;
        prop_assert!(largest(&(&skew + skew.transpose())) <= 1e-14 * largest(&c).max(largest(&rate)));
    }

    /// `C_ij = 1/2 sum_k (M_ij,k + M_ik,j - M_jk,i) v_k`, M,k by dual numbers. Rounding is in proportion to
    /// the entries of M where its derivatives almost cancel.
    #[test]
    fn coriolis_matrix_is_made_of_christoffel_symbols(case in all_cases(6)) {
        let (robot, n) = (case.robot(), case.n());
        let mut dual = Lagrangian::<Dual64>::new(&robot);
        let mut mass = 0.0_f64;
        let slope: Vec<DMatrix<f64>> = (0..n).map(|k| {
            let q: Vec<_> = (0..n).map(|i| Dual64::new(case.q[i], f64::from(u8::from(i == k)))).collect();
            let m = dual.mass_matrix(&q).unwrap();
            mass = mass.max(largest(&DMatrix::from_fn(n, n, |i, j| m[(i, j)].re)));
            DMatrix::from_fn(n, n, |i, j| m[(i, j)].eps)
        }).collect();
        let christoffel = DMatrix::from_fn(n, n, |i, j| {
            (0..n).map(|k| 0.5 * (slope[k][(i, j)] + slope[j][(i, k)] - slope[i][(j, k)]) * case.v[k]).sum()
        });
        let c = dense(Lagrangian::<f64>::new(&robot).coriolis_matrix(&case.q, &case.v).unwrap().view());
        let natural = slope.iter().map(largest).fold(mass, f64::max) * largest(&case.v);
        prop_assert!(largest(&(c - christoffel)) <= 1e-13 * natural);
    }

    /// The Coriolis matrix by kernel two, inverse dynamics by the Newton-Euler recursion.
    #[test]
    fn coriolis_times_velocity_plus_gravity_is_inverse_dynamics_without_acceleration(case in all_cases(10)) {
        let robot = smooth(&case);
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let c = dense(lagrangian.coriolis_matrix(&case.q, &case.v).unwrap().view());
        let g = column(lagrangian.gravity(&case.q).unwrap());
        let expected = &c * column(&case.v) + &g;
        let found = lagrangian.inverse_dynamics(&case.q, &case.v, &vec![0.0; case.n()]).unwrap();
        let natural = largest(&c) * largest(&case.v) + largest(&g);
        prop_assert!(off(found, expected.as_slice(), natural) <= 1e-13);
    }

    #[test]
    fn gravity_is_the_gradient_of_the_potential(case in all_cases(10)) {
        let robot = case.robot();
        let mut dual = Lagrangian::<Dual64>::new(&robot);
        let rest = vec![Dual64::from_re(0.0); case.n()];
        let gradient: Vec<f64> = (0..case.n()).map(|k| {
            let mut q: Vec<_> = case.q.iter().map(|&q| Dual64::from_re(q)).collect();
            q[k].eps = 1.0;
            dual.energy(&q, &rest).unwrap().potential.eps
        }).collect();
        let weight = largest(&case.gravity) * robot.joints().iter().map(|j| j.inertia.mass).sum::<f64>();
        let found = Lagrangian::<f64>::new(&robot).gravity(&case.q).unwrap().to_vec();
        prop_assert!(off(&found, &gradient, weight) <= 1e-13);
    }

    /// `tau = d/dt L_v - L_q - D`: momenta differentiated along the motion.
    #[test]
    fn inverse_dynamics_is_the_equation_of_lagrange(case in all_cases(10)) {
        let (robot, a) = (case.robot(), acceleration(&case));
        let along = |x: &[f64], d: &[f64]| -> Vec<_> { x.iter().zip(d).map(|(&x, &d)| Dual64::new(x, d)).collect() };
        let (q, v) = (along(&case.q, &case.v), along(&case.v, a));
        let mut dual = Hamiltonian::<Dual64>::new(&robot);
        let rate: Vec<f64> = dual.momentum(&q, &v).unwrap().iter().map(|p| p.eps).collect();
        let mut l_q = Vec::new();
        for k in 0..case.n() {
            let mut q: Vec<_> = case.q.iter().map(|&q| Dual64::from_re(q)).collect();
            let v: Vec<_> = case.v.iter().map(|&v| Dual64::from_re(v)).collect();
            q[k].eps = 1.0;
            let energy = Lagrangian::<Dual64>::new(&robot).energy(&q, &v).unwrap();
            l_q.push((energy.kinetic - energy.potential).eps);
        }
        let friction = torques(&robot, &case.q, &case.v, a);
        let without = torques(&robot.without_friction(), &case.q, &case.v, a);
        let expected: Vec<f64> = (0..case.n()).map(|i| rate[i] - l_q[i]).collect();
        prop_assert!(off(&without, &expected, force(&robot, &case)) <= 1e-13);
        let power: f64 = (0..case.n()).map(|i| (friction[i] - without[i]) * case.v[i]).sum();
        prop_assert!(power >= 0.0, "friction brakes");
    }

    #[test]
    fn forward_dynamics_undoes_inverse_dynamics(case in cases(10)) {
        let (robot, a) = (case.robot(), acceleration(&case));
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let tau = lagrangian.inverse_dynamics(&case.q, &case.v, a).unwrap().to_vec();
        let found = lagrangian.forward_dynamics(&case.q, &case.v, &tau).unwrap().to_vec();
        let accelerated = largest(lagrangian.forward_dynamics(&case.q, &case.v, &vec![0.0; case.n()]).unwrap());
        prop_assert!(off(&found, a, accelerated) <= tolerance(&robot, &case.q));
        let again = lagrangian.inverse_dynamics(&case.q, &case.v, &found).unwrap();
        prop_assert!(off(again, &tau, force(&robot, &case)) <= tolerance(&robot, &case.q));
    }

    /// `d/dt (1/2 v'Mv + V) = v.(u + D)` along (v, a).
    #[test]
    fn energy_changes_by_what_actuation_and_friction_do(case in cases(10)) {
        let robot = case.robot();
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let a = lagrangian.forward_dynamics(&case.q, &case.v, &case.u).unwrap().to_vec();
        let tau = lagrangian.inverse_dynamics(&case.q, &case.v, &a).unwrap().to_vec();
        let smooth = Lagrangian::<f64>::new(&robot.without_friction())
            .inverse_dynamics(&case.q, &case.v, &a).unwrap().to_vec();
        let along = |x: &[f64], d: &[f64]| -> Vec<_> { x.iter().zip(d).map(|(&x, &d)| Dual64::new(x, d)).collect() };
        let mut dual = Lagrangian::<Dual64>::new(&robot);
        let energy = dual.energy(&along(&case.q, &case.v), &along(&case.v, &a)).unwrap();
        let rate = (energy.kinetic + energy.potential).eps;
        let power: f64 = (0..case.n()).map(|i| case.v[i] * (case.u[i] + smooth[i] - tau[i])).sum();
        let moved = dense(lagrangian.mass_matrix(&case.q).unwrap().view()).abs() * column(&a).abs();
        let size = moved.dot(&column(&case.v).abs()) + largest(&case.v) * force(&robot, &case);
        prop_assert!((rate - power).abs() <= tolerance(&robot, &case.q) * size, "{rate} {power}");
    }
}
