//! Properties of inverse and forward dynamics: the Coriolis matrix, energy, derivatives, the change of
//! coordinates.

mod coordinates;
mod derivatives;
mod dynamics;
mod routes;

use costate::derivative::largest;
use costate::lagrangian::Lagrangian;
use costate::matrix::Block;
use costate::robot::Robot;
use costate::scalar::Scalar;
use costate_test_support::random_robot::Case;
use nalgebra::{DMatrix, DVector};

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
    let linear = lagrangian.linearise_inverse_dynamics(&case.q, &case.v, acceleration(case)).unwrap();
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
