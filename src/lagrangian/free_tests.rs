//! Second derivatives in (q, v) against hyper-dual numbers through the retraction.

use crate::configuration::ConfigurationSpace;
use crate::configuration::samples::{robots, state};
use crate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use crate::robot::Robot;
use crate::scalar::Scalar;
use nalgebra::{DMatrix, DVector};
use num_dual::HyperDual64;

type Map = fn(&mut Lagrangian<HyperDual64>, [&[HyperDual64]; 3]) -> Vec<HyperDual64>;

/// Values, Jacobian and contracted Hessian of a map of (q (+) xi, v + dv, c + dc).
fn by_hyper_duals(robot: &Robot, [q, v, c, y]: [&[f64]; 4], map: Map) -> (Vec<f64>, [DMatrix<f64>; 2]) {
    let space = ConfigurationSpace::new(robot);
    let mut lagrangian = Lagrangian::<HyperDual64>::new(robot);
    let n = v.len();
    let (mut value, mut jacobian) = (Vec::new(), DMatrix::zeros(n, 3 * n));
    let mut hessian = DMatrix::zeros(3 * n, 3 * n);
    let lift = |a: &[f64]| a.iter().map(|&a| HyperDual64::from_re(a)).collect::<Vec<_>>();
    for i in 0..3 * n {
        for j in 0..=i {
            let one = |k: usize, of: usize| f64::from(u8::from(k == of));
            let z: Vec<_> = (0..3 * n).map(|k| HyperDual64::new(0.0, one(k, i), one(k, j), 0.0)).collect();
            let mut moved = lift(q);
            space.integrate(&lift(q), &z[..n], &mut moved).unwrap();
            let sum = |a: &[f64], d: &[HyperDual64]| -> Vec<_> {
                a.iter().zip(d).map(|(&a, d)| d.plus(a)).collect()
            };
            let found = map(&mut lagrangian, [&moved, &sum(v, &z[n..2 * n]), &sum(c, &z[2 * n..])]);
            let contracted = found.iter().zip(y).map(|(f, y)| y * f.eps1eps2).sum();
            (hessian[(i, j)], hessian[(j, i)]) = (contracted, contracted);
            found.iter().enumerate().for_each(|(k, f)| jacobian[(k, i)] = f.eps1);
            value = found.iter().map(|f| f.re).collect();
        }
    }
    (value, [jacobian, hessian])
}

fn assert_close(name: &str, robot: &Robot, found: &DMatrix<f64>, expected: &DMatrix<f64>, tolerance: f64) {
    let (error, size) = ((found - expected).amax(), expected.amax());
    assert!(error < tolerance * size, "{}: {name}: {error} of {size}", robot.name());
}

/// g, `M w = y` and `y'a_x` against inverse dynamics, M and f_x.
#[test]
fn gravity_and_adjoint_products_take_free_joints() {
    for robot in robots() {
        let [q, v, u, y] = state(&ConfigurationSpace::new(&robot));
        let (n, y) = (v.len(), &y[..v.len()]);
        let column = |values: &[f64]| DMatrix::from_column_slice(values.len(), 1, values);
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let zero = vec![0.0; n];
        let expected = lagrangian.inverse_dynamics(&q, &zero, &zero).unwrap().to_vec();
        let found = lagrangian.gravity(&q).unwrap().to_vec();
        assert_close("g", &robot, &column(&found), &column(&expected), 1e-13);
        let mut w = y.to_vec();
        lagrangian.solve_mass_matrix(&q, &mut w).unwrap();
        let (mut f, mut y_a_x) = (vec![0.0; 2 * n], vec![0.0; 2 * n]);
        lagrangian.adjoint_factored([&q, &v, &u, &w], &mut f, &mut y_a_x).unwrap();
        let mass_matrix = lagrangian.mass_matrix(&q).unwrap().view().to_nalgebra();
        assert_close("M w", &robot, &(mass_matrix * column(&w)), &column(y), 1e-10);
        let state = lagrangian.linearise(&q, &v, &u).unwrap();
        let rows = state.f_x.view().to_nalgebra().rows(n, n).into_owned();
        assert_close("y'a_x", &robot, &column(&y_a_x), &(rows.transpose() * column(y)), 1e-10);
        assert_close("f", &robot, &column(&f), &column(state.f), 1e-13);
    }
}

/// Where a robot floats changes none of its accelerations and their derivatives, to the last digits.
#[test]
fn far_from_the_world_nothing_is_lost() {
    for robot in robots().iter().filter(|robot| robot.joints()[0].parent.is_none()) {
        let Some(root) =
            robot.free_joints().iter().find(|free| free.kind.slides() > 0 && free.coordinate == 0)
        else {
            continue;
        };
        let [mut q, v, u, y] = state(&ConfigurationSpace::new(robot));
        let mut second = LagrangianSecondOrder::<f64>::new(robot);
        let mut at = |place: [f64; 3], q: &mut Vec<f64>| {
            q[root.position..root.position + 3].copy_from_slice(&place);
            let found = second.contract_forward_dynamics(q, &v, &u, &y[..v.len()]).unwrap();
            found.to_matrix().view().to_nalgebra()
        };
        let (near, far) = (at([0.0; 3], &mut q), at([3e4, 1e4, -1e4], &mut q));
        assert_close("y'a_zz far away", robot, &far, &near, 1e-13);
    }
}

#[test]
fn hessians_are_those_of_hyper_dual_numbers_through_the_retraction() {
    for robot in robots() {
        let [q, v, u, y] = state(&ConfigurationSpace::new(&robot));
        let n = v.len();
        let y = &y[..n];
        let mut second = LagrangianSecondOrder::<f64>::new(&robot);
        let (tau, [tau_z, w_tau_zz]) = by_hyper_duals(&robot, [&q, &v, &u, y], |lagrangian, [q, v, a]| {
            lagrangian.inverse_dynamics(q, v, a).unwrap().to_vec()
        });
        let all = second.contract_inverse_dynamics(&q, &v, &u, y).unwrap();
        let linear = all.inverse_dynamics();
        let column = |values: &[f64]| DMatrix::from_column_slice(values.len(), 1, values);
        assert_close("tau", &robot, &column(linear.tau), &column(&tau), 1e-12);
        for (k, block) in [linear.tau_q, linear.tau_v, linear.tau_a].into_iter().enumerate() {
            let expected = tau_z.columns(k * n, n).into_owned();
            assert_close("tau_z", &robot, &block.view().to_nalgebra(), &expected, 1e-11);
        }
        assert_close("w'tau_zz", &robot, &all.zz().view().to_nalgebra(), &w_tau_zz, 1e-11);
        let first = second.first().linearise_inverse_dynamics(&q, &v, &u).unwrap();
        let expected = tau_z.columns(0, n).into_owned();
        assert_close("tau_q alone", &robot, &first.tau_q.view().to_nalgebra(), &expected, 1e-11);

        let (a, [a_z, y_a_zz]) = by_hyper_duals(&robot, [&q, &v, &u, y], |lagrangian, [q, v, u]| {
            lagrangian.forward_dynamics(q, v, u).unwrap().to_vec()
        });
        let whole = [vec![0.0; n], y.to_vec()].concat();
        let all = second.contract(&q, &v, &u, &whole).unwrap();
        let forward = all.forward_dynamics();
        assert_close("a", &robot, &column(forward.acceleration()), &column(&a), 1e-11);
        assert_close("a_z", &robot, &forward.matrix().to_nalgebra(), &a_z, 1e-10);
        assert_close("y'a_zz", &robot, &all.to_matrix().view().to_nalgebra(), &y_a_zz, 1e-10);
        let state = all.linearisation();
        assert_eq!(state.f[..n], v);
        assert_eq!(state.f_x.view().to_nalgebra().view((n, 0), (n, n)), forward.a_q().to_nalgebra());
        let by_kernels = DVector::from_column_slice(second.first().evaluate(&q, &v, &u).unwrap());
        assert!((by_kernels.rows(n, n) - DVector::from_vec(a)).amax() < 1e-10 * y_a_zz.amax().max(1.0));
    }
}
