//! Properties of inverse and forward dynamics: the Coriolis matrix, energy, derivatives, the change of coordinates.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

#[path = "common/random_robot.rs"]
mod random_robot;

use costate::derivative::{ForwardDynamics, Hessian, Jacobian, NestedHessian, largest};
use costate::hamiltonian::Hamiltonian;
use costate::lagrangian::{Coordinates, Lagrangian, SecondOrder};
use costate::matrix::Block;
use costate::robot::Robot;
use costate::scalar::Scalar;
use nalgebra::{DMatrix, DVector};
use num_dual::Dual64;
use proptest::prelude::*;
use random_robot::{Case, all_cases, cases, difference, tolerance};

fn flat(block: Block<'_, f64>) -> Vec<f64> {
    block.iter_rows().flatten().copied().collect()
}

fn dense(block: Block<'_, f64>) -> DMatrix<f64> {
    block.to_nalgebra()
}

fn column(x: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(x)
}

/// `a - b` in relation to b or, where b vanishes, to the size of the terms it is made of.
fn off(a: &[f64], b: &[f64], natural: f64) -> f64 {
    largest(&(column(a) - column(b))) / largest(b).max(natural).max(f64::MIN_POSITIVE)
}

/// An acceleration for inverse dynamics: the costate's second half, which is as good as any.
fn acceleration(case: &Case) -> &[f64] {
    &case.y[case.n()..]
}

/// The size of the forces on this robot: those of an acceleration, of velocities, weight and springs.
fn force(robot: &Robot, case: &Case) -> f64 {
    let mut lagrangian = Lagrangian::<f64>::new(robot);
    let linear = lagrangian.inverse_dynamics_jacobian(&case.q, &case.v, acceleration(case)).unwrap();
    let sizes = [linear.tau, linear.tau_q.as_slice(), linear.tau_v.as_slice(), linear.tau_a.as_slice()];
    sizes.into_iter().map(largest).fold(0.0, f64::max)
}

/// The same robot without friction, armature that couples included.
fn smooth(case: &Case) -> Robot {
    case.robot().without_friction()
}

/// Inverse dynamics, all outputs, for dual numbers of any kind.
fn torques<S: Scalar>(robot: &Robot, q: &[S], v: &[S], a: &[S]) -> Vec<S> {
    Lagrangian::<S>::new(robot).inverse_dynamics(q, v, a).unwrap().to_vec()
}

/// Robots a property.
const CASES: u32 = 128;

proptest! {
    #![proptest_config(ProptestConfig { cases: CASES, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn mass_matrix_rate_minus_twice_coriolis_is_skew(case in all_cases(10)) {
        let mut lagrangian = Lagrangian::<f64>::new(&case.robot());
        let rate = dense(lagrangian.mass_matrix_rate(&case.q, &case.v).unwrap().view());
        let c = dense(lagrangian.coriolis_matrix(&case.q, &case.v).unwrap().view());
        prop_assert_eq!(&rate, &rate.transpose());
        let skew = &rate - 2.0 * &c;
        prop_assert!(largest(&(&skew + skew.transpose())) <= 1e-14 * largest(&c).max(largest(&rate)));
    }

    /// `C_ij = 1/2 sum_k (M_ij,k + M_ik,j - M_jk,i) v_k`, M,k by dual numbers.
    #[test]
    fn coriolis_matrix_is_made_of_christoffel_symbols(case in all_cases(6)) {
        let (robot, n) = (case.robot(), case.n());
        let mut dual = Lagrangian::<Dual64>::new(&robot);
        let slope: Vec<DMatrix<f64>> = (0..n).map(|k| {
            let q: Vec<_> = (0..n).map(|i| Dual64::new(case.q[i], f64::from(u8::from(i == k)))).collect();
            let m = dual.mass_matrix(&q).unwrap();
            DMatrix::from_fn(n, n, |i, j| m[(i, j)].eps)
        }).collect();
        let christoffel = DMatrix::from_fn(n, n, |i, j| {
            (0..n).map(|k| 0.5 * (slope[k][(i, j)] + slope[j][(i, k)] - slope[i][(j, k)]) * case.v[k]).sum()
        });
        let c = dense(Lagrangian::<f64>::new(&robot).coriolis_matrix(&case.q, &case.v).unwrap().view());
        let natural = slope.iter().map(largest).fold(0.0, f64::max) * largest(&case.v);
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

    #[test]
    fn jacobian_of_inverse_dynamics_is_that_of_dual_numbers(case in all_cases(8)) {
        let (robot, a, n) = (case.robot(), acceleration(&case), case.n());
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let linear = lagrangian.inverse_dynamics_jacobian(&case.q, &case.v, a).unwrap();
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
        let linear = lagrangian.forward_dynamics_jacobian(&case.q, &case.v, &case.u).unwrap();
        let z = [case.q.as_slice(), &case.v, &case.u].concat();
        let mut dual: Jacobian<_> = Jacobian::new(ForwardDynamics::new(&robot));
        let expected = dual.evaluate(&z).unwrap();
        let bound = tolerance(&robot, &case.q);
        prop_assert!(difference(linear.acceleration(), expected.value) <= bound);
        prop_assert!(difference(&flat(linear.matrix()), expected.jacobian.as_slice()) <= bound);
        prop_assert_eq!(dense(linear.a_u()), dense(linear.a_u()).transpose());
    }

    #[test]
    fn contracted_hessian_of_forward_dynamics_is_that_of_hyper_dual_numbers(case in cases(6)) {
        let (robot, n) = (case.robot(), case.n());
        let (z, y) = ([case.q.as_slice(), &case.v, &case.u].concat(), &case.y[n..]);
        let mut second = SecondOrder::<f64>::new(&robot);
        let found = second.contracted_hessian(&case.q, &case.v, &case.u, y).unwrap();
        let mut hyperdual = Hessian::new(ForwardDynamics::new(&robot));
        let expected = hyperdual.contracted(&z, y).unwrap().as_slice().to_vec();
        let mut nested = NestedHessian::new(ForwardDynamics::new(&robot));
        let bound = tolerance(&robot, &case.q);
        let natural = 1e-3 * largest(y) * largest(&flat(found.linearisation().matrix()));
        prop_assert!(off(found.to_matrix().as_slice(), &expected, natural) <= bound);
        prop_assert!(off(found.to_matrix().as_slice(), nested.contracted(&z, y).unwrap().as_slice(), natural) <= bound);
        let linear = hyperdual.last();
        prop_assert!(difference(found.linearisation().acceleration(), linear.value()) <= bound);
        prop_assert!(difference(&flat(found.linearisation().matrix()), linear.jacobian().as_slice()) <= bound);
    }

    #[test]
    fn contracted_hessian_of_inverse_dynamics_is_that_of_hyper_dual_numbers(case in all_cases(4)) {
        use num_dual::HyperDual64;
        let (robot, a, n) = (case.robot(), acceleration(&case), case.n());
        let (z, w) = ([case.q.as_slice(), &case.v, a].concat(), &case.u);
        let mut second = SecondOrder::<f64>::new(&robot);
        let found = dense(second.inverse_dynamics_hessian(&case.q, &case.v, a, w).unwrap().view());
        let expected = DMatrix::from_fn(3 * n, 3 * n, |i, j| {
            let mut dual: Vec<_> = z.iter().map(|&z| HyperDual64::from_re(z)).collect();
            dual[i].eps1 = 1.0;
            dual[j].eps2 = 1.0;
            let tau = torques(&robot, &dual[..n], &dual[n..2 * n], &dual[2 * n..]);
            tau.iter().zip(w).map(|(tau, w)| tau.eps1eps2 * w).sum::<f64>()
        });
        prop_assert_eq!(&found, &found.transpose());
        let natural = largest(&expected).max(largest(w) * force(&robot, &case));
        prop_assert!(largest(&(found - expected)) <= 1e-12 * natural);
    }

    #[test]
    fn contracted_hessian_is_symmetric_linear_in_y_and_without_curvature_in_u(case in cases(8)) {
        let (robot, n) = (case.robot(), case.n());
        let (one, other) = case.y.split_at(n);
        let both: Vec<f64> = one.iter().zip(other).map(|(a, b)| 2.0 * a - 3.0 * b).collect();
        let mut second = SecondOrder::<f64>::new(&robot);
        let mut of = |y: &[f64]| dense(second.contracted_hessian(&case.q, &case.v, &case.u, y).unwrap().to_matrix().view());
        let (h_one, h_other, h_both) = (of(one), of(other), of(&both));
        let size = largest(&h_one).max(largest(&h_other));
        prop_assert!(largest(&(2.0 * h_one - 3.0 * h_other - &h_both)) <= 10.0 * tolerance(&robot, &case.q) * size);
        prop_assert_eq!(&h_both, &h_both.transpose());
        let in_u = h_both.view((2 * n, n), (n, 2 * n));
        prop_assert!(in_u.iter().all(|&entry| entry == 0.0), "y'a_uv = y'a_uu = 0");
        let inverse = dense(Hamiltonian::<f64>::new(&robot).inverse_mass_matrix(&case.q).unwrap().view());
        let h = second.contracted_hessian(&case.q, &case.v, &case.u, one).unwrap();
        prop_assert_eq!(dense(h.linearisation().a_u()), inverse);
        let whole = dense(h.to_matrix().view());
        prop_assert_eq!(dense(h.xx()), whole.view((0, 0), (2 * n, 2 * n)).clone_owned());
        prop_assert_eq!(dense(h.uq()), whole.view((2 * n, 0), (n, n)).clone_owned());
    }

    #[test]
    fn state_equation_is_velocity_and_acceleration(case in cases(8)) {
        let (robot, n) = (case.robot(), case.n());
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let f = lagrangian.state_equation(&case.q, &case.v, &case.u).unwrap().to_vec();
        prop_assert_eq!(&f[..n], &case.v[..]);
        let forward = lagrangian.forward_dynamics_jacobian(&case.q, &case.v, &case.u).unwrap();
        prop_assert_eq!(&f[n..], forward.acceleration());
        let a_z = dense(forward.matrix());
        let state = lagrangian.state_jacobian(&case.q, &case.v, &case.u).unwrap();
        prop_assert_eq!(state.f, &f[..]);
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
        let mut coordinates = Coordinates::<f64>::new(&robot);
        let mut map = coordinates.at(&case.q, &case.v, &case.u).unwrap();
        let p = map.momentum().to_vec();
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let phase = hamiltonian.jacobian(&case.q, &p, &case.u).unwrap();
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
        let mut coordinates = Coordinates::<f64>::new(&robot);
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
