//! Inverse and forward dynamics: the equations of motion, energy, the Coriolis matrix.

use super::{CASES, acceleration, smooth, torques};
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::Lagrangian;
use costate::scalar::{Scalar, Tangent};
use costate_test_support::random_robot::{all_cases, cases};
use costate_test_support::rounding::{apart, lift, moving, times};
use costate_test_support::{properties, rounding};
use proptest::prelude::*;

/// The derivatives along each coordinate: of `function`, whose values are `outputs` numbers.
fn slopes<S: Scalar>(q: &[S], mut function: impl FnMut(&[Tangent<S>]) -> Vec<Tangent<S>>) -> Vec<Vec<S>> {
    let along = |k: usize| -> Vec<Tangent<S>> {
        q.iter()
            .enumerate()
            .map(|(i, &q)| Tangent::new(q, if i == k { S::one() } else { S::zero() }))
            .collect()
    };
    (0..q.len()).map(|k| function(&along(k)).iter().map(|value| value.eps).collect()).collect()
}

/// Values that stay.
fn still<S: Scalar>(values: &[S]) -> Vec<Tangent<S>> {
    values.iter().map(|&value| Tangent::new(value, S::zero())).collect()
}

properties! {
    CASES;

    #[test]
    fn mass_matrix_rate_minus_twice_coriolis_is_skew(case in all_cases(10)) {
        let (robot, n) = (case.robot(), case.n());
        rounding!(|S| {
            let [q, v] = [&case.q[..], &case.v].map(lift::<S>);
            let mut lagrangian = Lagrangian::<S>::new(&robot);
            let rate = lagrangian.mass_matrix_rate(&q, &v).unwrap().clone();
            let c = lagrangian.coriolis_matrix(&q, &v).unwrap();
            let entry = |i: usize, j: usize| (rate[(i, j)] - c[(i, j)].times(2.0)) + (rate[(j, i)] - c[(j, i)].times(2.0));
            vec![("S + S'", (0..n * n).map(|k| entry(k / n, k % n)).collect())]
        })?;
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let rate = lagrangian.mass_matrix_rate(&case.q, &case.v).unwrap().view().to_nalgebra();
        prop_assert_eq!(&rate, &rate.transpose());
    }

    /// `C_ij = 1/2 sum_k (M_ij,k + M_ik,j - M_jk,i) v_k`, M,k by dual numbers.
    #[test]
    fn coriolis_matrix_is_made_of_christoffel_symbols(case in all_cases(6)) {
        let (robot, n) = (case.robot(), case.n());
        rounding!(|S| {
            let [q, v] = [&case.q[..], &case.v].map(lift::<S>);
            let mut dual = Lagrangian::<Tangent<S>>::new(&robot);
            let slope = slopes(&q, |q| dual.mass_matrix(q).unwrap().as_slice().to_vec());
            let at = |i: usize, j: usize, k: usize| slope[k][i * n + j];
            let christoffel = |i: usize, j: usize| {
                (0..n).fold(S::zero(), |sum, k| sum + (at(i, j, k) + at(i, k, j) - at(j, k, i)).times(0.5) * v[k])
            };
            let expected: Vec<S> = (0..n * n).map(|k| christoffel(k / n, k % n)).collect();
            let mut lagrangian = Lagrangian::<S>::new(&robot);
            vec![("C", apart(lagrangian.coriolis_matrix(&q, &v).unwrap().as_slice(), &expected))]
        })?;
    }

    /// The Coriolis matrix by kernel two, inverse dynamics by the Newton-Euler recursion.
    #[test]
    fn coriolis_times_velocity_plus_gravity_is_inverse_dynamics_without_acceleration(case in all_cases(10)) {
        let robot = smooth(&case);
        rounding!(|S| {
            let [q, v] = [&case.q[..], &case.v].map(lift::<S>);
            let mut lagrangian = Lagrangian::<S>::new(&robot);
            let c_v = times(lagrangian.coriolis_matrix(&q, &v).unwrap().as_slice(), &v);
            let g = lagrangian.gravity(&q).unwrap().to_vec();
            let tau = lagrangian.inverse_dynamics(&q, &v, &vec![S::zero(); case.n()]).unwrap();
            vec![("C v + g", apart(&apart(tau, &c_v), &g))]
        })?;
    }

    #[test]
    fn gravity_is_the_gradient_of_the_potential(case in all_cases(10)) {
        let robot = case.robot();
        rounding!(|S| {
            let q = lift::<S>(&case.q);
            let rest = still(&vec![S::zero(); case.n()]);
            let mut dual = Lagrangian::<Tangent<S>>::new(&robot);
            let gradient = slopes(&q, |q| vec![dual.energy(q, &rest).unwrap().potential]).concat();
            vec![("g", apart(Lagrangian::<S>::new(&robot).gravity(&q).unwrap(), &gradient))]
        })?;
    }

    /// `tau = d/dt L_v - L_q - D`: momenta differentiated along the motion.
    #[test]
    fn inverse_dynamics_is_the_equation_of_lagrange(case in all_cases(10)) {
        let (robot, a) = (case.robot(), acceleration(&case));
        let smooth = robot.without_friction();
        rounding!(|S| {
            let [q, v, a] = [&case.q[..], &case.v, a].map(lift::<S>);
            let mut dual = Hamiltonian::<Tangent<S>>::new(&robot);
            let rate: Vec<S> = dual.momentum(&moving(&q, &v), &moving(&v, &a)).unwrap().iter().map(|p| p.eps).collect();
            let (mut dual, at_v) = (Lagrangian::<Tangent<S>>::new(&robot), still(&v));
            let l_q = slopes(&q, |q| {
                let energy = dual.energy(q, &at_v).unwrap();
                vec![energy.kinetic - energy.potential]
            });
            vec![("d/dt L_v - L_q", apart(&torques(&smooth, &q, &v, &a), &apart(&rate, &l_q.concat())))]
        })?;
        let friction = torques(&robot, &case.q, &case.v, a);
        let without = torques(&smooth, &case.q, &case.v, a);
        let power: f64 = (0..case.n()).map(|i| (friction[i] - without[i]) * case.v[i]).sum();
        prop_assert!(power >= 0.0, "friction brakes");
    }

    #[test]
    fn forward_dynamics_undoes_inverse_dynamics(case in cases(10)) {
        let (robot, a) = (case.robot(), acceleration(&case));
        rounding!(|S| {
            let [q, v, a] = [&case.q[..], &case.v, a].map(lift::<S>);
            let mut lagrangian = Lagrangian::<S>::new(&robot);
            let tau = lagrangian.inverse_dynamics(&q, &v, &a).unwrap().to_vec();
            let found = lagrangian.forward_dynamics(&q, &v, &tau).unwrap().to_vec();
            let again = lagrangian.inverse_dynamics(&q, &v, &found).unwrap();
            vec![("a", apart(&found, &a)), ("tau", apart(again, &tau))]
        })?;
    }

    /// `d/dt (1/2 v'Mv + V) = v.(u + D)` along (v, a).
    #[test]
    fn energy_changes_by_what_actuation_and_friction_do(case in cases(10)) {
        let robot = case.robot();
        let smooth = robot.without_friction();
        rounding!(|S| {
            let [q, v, u] = [&case.q[..], &case.v, &case.u].map(lift::<S>);
            let mut lagrangian = Lagrangian::<S>::new(&robot);
            let a = lagrangian.forward_dynamics(&q, &v, &u).unwrap().to_vec();
            let tau = lagrangian.inverse_dynamics(&q, &v, &a).unwrap().to_vec();
            let without = Lagrangian::<S>::new(&smooth).inverse_dynamics(&q, &v, &a).unwrap().to_vec();
            let mut dual = Lagrangian::<Tangent<S>>::new(&robot);
            let energy = dual.energy(&moving(&q, &v), &moving(&v, &a)).unwrap();
            let work = |rest: S, i: usize| rest - v[i] * (u[i] + without[i] - tau[i]);
            vec![("dE/dt", vec![(0..case.n()).fold((energy.kinetic + energy.potential).eps, work)])]
        })?;
    }
}
