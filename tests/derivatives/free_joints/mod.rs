//! Floating and spherical joints anywhere in random trees: derivatives in the tangent space against
//! hyper-dual numbers through the retraction, F against the gradient of H.

mod invariance;

use crate::lagrangian::apart_from_the_matrix;
use costate::configuration::ConfigurationSpace;
use costate::derivative::{ForwardDynamics, Hessian, PhaseVelocity, largest};
use costate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::LagrangianSecondOrder;
use costate::robot::{FreeKind, Robot};
use costate::scalar::Scalar;
use costate_test_support::random_robot::free_cases;
use costate_test_support::reference::flat;
use costate_test_support::rounding::{At, Bounds, InverseBounds, close, lift_rounded};
use costate_test_support::{properties, rounding};
use nalgebra::Vector3;
use num_dual::Dual64;

/// Row or column `x`, of as many entries as the square matrix has rows, times the matrix.
fn product(rows: &[f64], x: &[f64], transposed: bool) -> Vec<f64> {
    let n = x.len();
    let width = rows.len() / n;
    if transposed {
        return (0..width).map(|j| (0..n).map(|i| x[i] * rows[i * width + j]).sum()).collect();
    }
    rows.chunks(n).map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect()
}

/// q (+) d, q rounded once.
pub(crate) fn retracted<S: Scalar>(robot: &Robot, q: &[f64], d: &[S]) -> Vec<S> {
    let q = lift_rounded::<S>(q);
    let mut moved = q.clone();
    ConfigurationSpace::new(robot).integrate(&q, d, &mut moved).unwrap();
    moved
}

/// Values that move at these rates.
pub(crate) fn moving(values: &[f64], rates: &[f64]) -> Vec<Dual64> {
    values.iter().zip(rates).map(|(&value, &rate)| Dual64::new(value, rate)).collect()
}

properties! {
    48;

    #[test]
    fn in_momenta_derivatives_are_those_of_hyper_dual_numbers(case in free_cases(3)) {
        let (robot, n) = (case.robot(), case.n());
        let (q, p, u, y) = (&case.q, &case.p(&robot), &case.u, &case.y);
        let d: Vec<f64> = y.iter().map(|y| (5.0 * y).sin()).collect();
        let bounds = Bounds::at(&robot, At { q, v: &case.v, u, y, d: &d });
        let mut function = PhaseVelocity::new(&robot).under(u);
        function.set_centre(q).unwrap();
        let mut judge = Hessian::new(function);
        let at = [vec![0.0; n], p.clone()].concat();
        let y_f_xx = judge.contract(&at, y).unwrap().as_slice().to_vec();
        let (f, f_x) = (judge.last().value(), judge.last().jacobian().as_slice());
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let all = second.contract(q, p, u, y).unwrap();
        let linear = all.linearisation();
        close("F", linear.f(), f, bounds.f)?;
        close("F_x", &flat(linear.matrix()), f_x, bounds.f_x)?;
        close("y'F_xx", &flat(all.matrix()), &y_f_xx, bounds.y_f_xx)?;
        let linear = second.first().linearise(q, p, u).unwrap();
        close("F of F_x", linear.f(), f, bounds.f)?;
        close("F_x alone", &flat(linear.matrix()), f_x, bounds.f_x)?;
        close("F alone", second.first().evaluate(q, p, u).unwrap(), f, bounds.f)?;
        // Entries of y and d are at most 1: each of the 2n terms of a product rounds as an entry of the
        // matrix.
        let terms = 2.0 * n as f64;
        let adjoint = second.first().adjoint(q, p, u, y).unwrap().y_f_x;
        close("y'F_x", adjoint, &product(f_x, y, true), bounds.y_f_x.max(terms * bounds.f_x))?;
        let found = second.hessian_product(q, p, y, &d).unwrap();
        close("y'F_xx d", found, &product(&y_f_xx, &d, false), bounds.product.max(terms * bounds.y_f_xx))?;
    }

    #[test]
    fn in_velocities_derivatives_are_those_of_hyper_dual_numbers(case in free_cases(3)) {
        let (robot, n) = (case.robot(), case.n());
        let (q, v, u, y) = (&case.q, &case.v, &case.u, &case.y[case.n()..]);
        let bounds = Bounds::new(&robot, [q, v, u, &case.y]);
        let mut function = ForwardDynamics::new(&robot);
        function.set_centre(q).unwrap();
        let mut judge = Hessian::new(function);
        let z = [&vec![0.0; n][..], v, u].concat();
        let y_a_zz = judge.contract(&z, y).unwrap().as_slice().to_vec();
        let (a, a_z) = (judge.last().value(), judge.last().jacobian().as_slice());
        let mut second = LagrangianSecondOrder::<f64>::new(&robot);
        let all = second.contract_forward_dynamics(q, v, u, y).unwrap();
        let linear = all.forward_dynamics();
        close("a", linear.acceleration(), a, bounds.a)?;
        close("a_z", &flat(linear.matrix()), a_z, bounds.a_z)?;
        close("y'a_zz", all.to_matrix().as_slice(), &y_a_zz, bounds.y_a_zz)?;
        let linear = second.first().linearise_forward_dynamics(q, v, u).unwrap();
        close("a of a_z", linear.acceleration(), a, bounds.a)?;
        close("a_z alone", &flat(linear.matrix()), a_z, bounds.a_z)?;
        close("a alone", second.first().forward_dynamics(q, v, u).unwrap(), a, bounds.a)?;
        // The error of a comes back as M times it.
        let torque = second.first().inverse_dynamics(q, v, a).unwrap().to_vec();
        let mass = largest(Hamiltonian::<f64>::new(&robot).mass_matrix(q).unwrap().as_slice());
        let of_tau = InverseBounds::new(&robot, [q, v, a, u]).tau;
        close("tau(q, v, a)", &torque, u, of_tau + n as f64 * mass * bounds.a)?;
    }

    #[test]
    fn in_velocities_products_are_those_with_the_matrix(case in free_cases(3)) {
        let (robot, n) = (case.robot(), case.n());
        let d = [&case.y[..], &case.y[..n]].concat();
        rounding!(|S| {
            let [q, v, u, y] = [&case.q[..], &case.v, &case.u, &case.y[n..]].map(lift_rounded::<S>);
            apart_from_the_matrix::<S>(&robot, [q, v, u, y], &lift_rounded(&d))
        })?;
    }

    /// `F = (H_p, ad*_v p - H_d + u)` at q (+) d, d = 0, without friction (Euler, Poincare).
    #[test]
    fn the_state_equation_is_that_of_h(case in free_cases(6)) {
        let (robot, n) = (case.robot().without_friction(), case.n());
        let (q, p) = (&case.q, case.p(&robot));
        let mut hamiltonian = Hamiltonian::<Dual64>::new(&robot);
        let mut slope = |i: usize| {
            let along: Vec<f64> = (0..2 * n).map(|k| f64::from(u8::from(k == i))).collect();
            let moved = retracted(&robot, q, &moving(&vec![0.0; n], &along[..n]));
            hamiltonian.hamiltonian(&moved, &moving(&p, &along[n..])).unwrap().eps
        };
        let v: Vec<f64> = (n..2 * n).map(&mut slope).collect();
        let mut rate: Vec<f64> = (0..n).map(|i| case.u[i] - slope(i)).collect();
        for free in robot.free_joints() {
            let (at, turn) = (free.coordinate, free.coordinate + free.kind.slides());
            let vector = |x: &[f64], k: usize| Vector3::new(x[k], x[k + 1], x[k + 2]);
            let (k, w) = (vector(&p, turn), vector(&v, turn));
            let mut add = |k: usize, by: Vector3<f64>| (0..3).for_each(|i| rate[k + i] += by[i]);
            add(turn, k.cross(&w));
            if free.kind == FreeKind::Floating {
                let l = vector(&p, at);
                add(at, l.cross(&w));
                add(turn, l.cross(&vector(&v, at)));
            }
        }
        let f = Hamiltonian::<f64>::new(&robot).evaluate(q, &p, &case.u).unwrap().to_vec();
        let bound = Bounds::new(&robot, [q, &case.v, &case.u, &case.y]).f;
        close("H_p", &f[..n], &v, bound)?;
        close("dp/dt", &f[n..], &rate, bound)?;
    }
}
