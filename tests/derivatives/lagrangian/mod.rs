//! Properties of inverse and forward dynamics: the Coriolis matrix, energy, derivatives, the change of
//! coordinates.

mod coordinates;
mod derivatives;
mod dynamics;
mod routes;

use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::matrix::{Block, Matrix, dot};
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate_test_support::random_robot::Case;
use costate_test_support::rounding::{Differences, InverseBounds, apart, close};
use nalgebra::DMatrix;
use proptest::prelude::*;

fn flat(block: Block<'_, f64>) -> Vec<f64> {
    block.iter_rows().flatten().copied().collect()
}

fn dense(block: Block<'_, f64>) -> DMatrix<f64> {
    block.to_nalgebra()
}

/// An acceleration for inverse dynamics: the costate's second half, which is as good as any.
fn acceleration(case: &Case) -> &[f64] {
    &case.y[case.n()..]
}

/// The same robot without friction, armature that couples included.
fn smooth(case: &Case) -> Robot {
    case.robot().without_friction()
}

/// Inverse dynamics, all outputs, for dual numbers of any kind.
pub(crate) fn torques<S: Scalar>(robot: &Robot, q: &[S], v: &[S], a: &[S]) -> Vec<S> {
    Lagrangian::<S>::new(robot).inverse_dynamics(q, v, a).unwrap().to_vec()
}

/// `sum_k w_k d2 tau_k / dz dz`, z = (q, v, a), by hyper-dual numbers.
pub(crate) fn torque_hessian(robot: &Robot, z: &[f64], w: &[f64]) -> DMatrix<f64> {
    use num_dual::HyperDual64;
    let n = w.len();
    DMatrix::from_fn(3 * n, 3 * n, |i, j| {
        let mut dual: Vec<_> = z.iter().map(|&z| HyperDual64::from_re(z)).collect();
        dual[i].eps1 = 1.0;
        dual[j].eps2 = 1.0;
        let tau = torques(robot, &dual[..n], &dual[n..2 * n], &dual[2 * n..]);
        tau.iter().zip(w).map(|(tau, w)| tau.eps1eps2 * w).sum::<f64>()
    })
}

/// Inverse dynamics with both derivatives in one call and by separate calls: whether they agree.
pub(crate) fn separate_calls_agree(robot: &Robot, [q, v, a, w]: [&[f64]; 4]) -> Result<(), TestCaseError> {
    let (mut second, mut first) = (LagrangianSecondOrder::<f64>::new(robot), Lagrangian::<f64>::new(robot));
    let all = second.contract_inverse_dynamics(q, v, a, w).unwrap().inverse_dynamics();
    let tau = first.inverse_dynamics(q, v, a).unwrap().to_vec();
    let linear = first.linearise_inverse_dynamics(q, v, a).unwrap();
    let bounds = InverseBounds::new(robot, [q, v, a, w]);
    close("tau", all.tau, &tau, bounds.tau)?;
    for (name, found, expected) in [
        ("tau_q", all.tau_q, linear.tau_q),
        ("tau_v", all.tau_v, linear.tau_v),
        ("tau_a", all.tau_a, linear.tau_a),
    ] {
        close(name, found.as_slice(), expected.as_slice(), bounds.tau_z)?;
    }
    Ok(())
}

/// Robots a property.
const CASES: u32 = 128;

/// Products of `w'tau_zz` and `y'a_zz` with d, at (q, v, c) with the weights `w = y`, less those with the
/// matrix.
pub(crate) fn apart_from_the_matrix<S: Scalar>(
    robot: &Robot,
    [q, v, c, w]: [Vec<S>; 4],
    d: &[S],
) -> Differences<S> {
    let mut second = LagrangianSecondOrder::<S>::new(robot);
    let product = |matrix: &Matrix<S>| (0..d.len()).map(|i| dot(matrix.row(i), d)).collect::<Vec<S>>();
    let expected = product(second.contract_inverse_dynamics(&q, &v, &c, &w).unwrap().zz());
    let found = second.inverse_dynamics_hessian_product([&q, &v, &c, &w], d).unwrap();
    let of_torque = apart(found, &expected);
    let expected = product(&second.contract_forward_dynamics(&q, &v, &c, &w).unwrap().to_matrix());
    let found = second.forward_dynamics_hessian_product([&q, &v, &c, &w], d).unwrap();
    vec![("w'tau_zz d", of_torque), ("y'a_zz d", apart(found, &expected))]
}
