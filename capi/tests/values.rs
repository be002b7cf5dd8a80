//! What C receives is what the library computes, for a real robot in both coordinates.

#![allow(clippy::unwrap_used, clippy::panic, reason = "tests fail by panicking")]

use costate::Coordinates;
use costate::dynamics::Dynamics;
use costate::robot::Robot;
use costate::step::{RungeKutta4, Step};
use costate_c::dynamics::{
    costate_contract, costate_dynamics, costate_dynamics_delete, costate_dynamics_new, costate_f,
    costate_hessian, costate_jacobian,
};
use costate_c::quantities::costate_rnea_jacobian;
use costate_c::robot::{costate_robot, costate_robot_delete, costate_robot_from_file};
use costate_c::status::costate_last_error;
use costate_c::step::{
    costate_step_contract, costate_step_delete, costate_step_f, costate_step_jacobian, costate_step_new,
};
use costate_jit::JitModel;
use std::ffi::{CStr, CString};
use std::ptr::null_mut;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../robots/ur5.urdf");
const N: usize = 6;

fn numbers(count: usize, seed: f64) -> Vec<f64> {
    (0..count).map(|k| (seed + 1.7 * k as f64).sin()).collect()
}

fn robot() -> *mut costate_robot {
    let (mut robot, path) = (null_mut(), CString::new(FILE).unwrap());
    assert_eq!(unsafe { costate_robot_from_file(path.as_ptr(), 0, &mut robot) }, 0);
    robot
}

#[test]
fn dynamics_are_those_of_the_library() {
    let handle = robot();
    for (number, coordinates) in [(0, Coordinates::Lagrangian), (1, Coordinates::Hamiltonian)] {
        let (q, v, tau, y) = (numbers(N, 0.3), numbers(N, 1.1), numbers(N, 2.0), numbers(2 * N, 0.7));
        let mut dynamics: *mut costate_dynamics = null_mut();
        let (mut f, mut jacobian, mut hessian) = (vec![0.0; 12], vec![0.0; 216], vec![0.0; 324]);
        let mut others = (f.clone(), jacobian.clone(), hessian.clone());
        let z = [q.as_ptr(), v.as_ptr(), tau.as_ptr()];
        unsafe {
            assert_eq!(costate_dynamics_new(handle, number, &mut dynamics), 0);
            let results = (f.as_mut_ptr(), jacobian.as_mut_ptr(), hessian.as_mut_ptr());
            let code =
                costate_contract(dynamics, N, z[0], z[1], z[2], y.as_ptr(), results.0, results.1, results.2);
            assert_eq!(code, 0);
            assert_eq!(costate_f(dynamics, N, z[0], z[1], z[2], others.0.as_mut_ptr()), 0);
            assert_eq!(costate_jacobian(dynamics, N, z[0], z[1], z[2], null_mut(), others.1.as_mut_ptr()), 0);
            assert_eq!(costate_hessian(dynamics, N, z[0], z[1], z[2], y.as_ptr(), others.2.as_mut_ptr()), 0);
            costate_dynamics_delete(dynamics);
        }
        let mut model = JitModel::new(&Robot::from_file(FILE).unwrap(), coordinates).unwrap();
        let second = model.contract(&[q, v].concat(), &tau, &y).unwrap();
        let in_z = |i: usize, j: usize| {
            if j < 12 { second.first.f_x[(i, j)] } else { second.first.f_u[(i, j - 12)] }
        };
        assert_eq!(f, second.first.f);
        for (i, row) in jacobian.chunks(18).enumerate() {
            assert!((0..18).all(|j| row[j] == in_z(i, j)));
        }
        for i in 0..18 {
            assert!((0..18).all(|j| hessian[i * 18 + j] == hessian[j * 18 + i]));
        }
        for i in 0..12 {
            assert!((0..12).all(|j| hessian[i * 18 + j] == second.xx[(i, j)]));
        }
        assert_eq!(second.ux.is_some(), coordinates == Coordinates::Lagrangian);
        for (i, row) in second.ux.iter().flat_map(|ux| ux.iter_rows()).enumerate() {
            assert!((0..row.len()).all(|j| hessian[(12 + i) * 18 + j] == row[j]));
        }
        let close =
            |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12 * (1.0 + b.abs()));
        assert!(close(&others.0, &f) && close(&others.1, &jacobian) && others.2 == hessian);
    }
    unsafe { costate_robot_delete(handle) };
}

#[test]
fn steps_are_those_of_the_library() {
    let (handle, mut step) = (robot(), null_mut());
    let (q, v, tau, y) = (numbers(N, 0.3), numbers(N, 1.1), numbers(N, 2.0), numbers(2 * N, 0.7));
    let z = [q.as_ptr(), v.as_ptr(), tau.as_ptr()];
    let (mut next, mut jacobian, mut hessian) = (vec![0.0; 12], vec![0.0; 216], vec![0.0; 324]);
    let (mut again, mut first) = (next.clone(), jacobian.clone());
    unsafe {
        assert_eq!(costate_step_new(handle, 0, 0, &mut step), 0);
        let (a, b, c) = (next.as_mut_ptr(), jacobian.as_mut_ptr(), hessian.as_mut_ptr());
        assert_eq!(costate_step_contract(step, N, z[0], z[1], z[2], 0.01, y.as_ptr(), a, b, c), 0);
        assert_eq!(costate_step_f(step, N, z[0], z[1], z[2], 0.01, again.as_mut_ptr()), 0);
        assert_eq!(costate_step_jacobian(step, N, z[0], z[1], z[2], 0.01, null_mut(), first.as_mut_ptr()), 0);
        assert_eq!(costate_step_f(step, N, z[0], z[1], z[2], f64::NAN, again.as_mut_ptr()), 6);
        assert_eq!(costate_step_new(handle, 0, 2, &mut null_mut()), 2);
        assert!(CStr::from_ptr(costate_last_error()).to_str().unwrap().contains("COSTATE_QP"));
        costate_step_delete(step);
        costate_robot_delete(handle);
    }
    let robot = Robot::from_file(FILE).unwrap();
    let mut own = RungeKutta4::new(JitModel::new(&robot, Coordinates::Lagrangian).unwrap());
    let second = own.contract(&[q, v].concat(), &tau, 0.01, &y).unwrap();
    assert_eq!(next, second.first.next);
    assert!((0..12).all(|i| (0..12).all(|j| jacobian[i * 18 + j] == second.first.phi_x[(i, j)])));
    assert!((0..12).all(|i| (0..12).all(|j| hessian[i * 18 + j] == second.xx[(i, j)])));
    let uu = second.uu.unwrap();
    assert!((0..6).all(|i| (0..6).all(|j| hessian[(12 + i) * 18 + 12 + j] == uu[(i, j)])));
    assert!(next.iter().zip(&again).all(|(a, b)| (a - b).abs() < 1e-14 * (1.0 + a.abs())));
    assert!(jacobian.iter().zip(&first).all(|(a, b)| (a - b).abs() < 1e-12 * (1.0 + a.abs())));
}

#[test]
fn results_may_overlap_with_arguments() {
    let (handle, mut dynamics) = (robot(), null_mut());
    let (q, v, a) = (numbers(N, 0.3), numbers(N, 1.1), numbers(N, 2.0));
    let (mut apart, mut over) = (vec![0.0; 108], vec![0.0; 108]);
    over[..N].copy_from_slice(&q);
    unsafe {
        assert_eq!(costate_dynamics_new(handle, 0, &mut dynamics), 0);
        let call = |q, to| costate_rnea_jacobian(dynamics, N, q, v.as_ptr(), a.as_ptr(), to);
        assert_eq!(call(q.as_ptr(), apart.as_mut_ptr()), 0);
        assert_eq!(call(over.as_ptr(), over.as_mut_ptr()), 0);
        costate_dynamics_delete(dynamics);
        costate_robot_delete(handle);
    }
    assert_eq!(apart, over);
}
