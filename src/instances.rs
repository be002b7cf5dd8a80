//! The pipeline for `f64`, compiled with this crate.
//!
//! A generic function that is marked `#[inline(never)]` is compiled once for each number type: crates use the
//! one that a crate below them has compiled. The large steps of the pipeline are marked, and [`for_f64`] uses
//! all of them, so that no other crate compiles the pipeline for `f64` again.

use crate::error::EvalError;
use crate::hamiltonian::{DualPass, FullHessian, HamiltonianSecondOrder};
use crate::kinematics::{Kinematics, ReferenceFrame};
use crate::lagrangian::{LagrangianSecondOrder, LegendreTransform};
use crate::parameters::{HamiltonianParameters, LagrangianParameters, ParameterSet};
use crate::robot::{Robot, Tree};
use crate::spatial::Force;
use crate::tensors::Christoffel;
use nalgebra::Rotation3;

/// Every quantity by every analytic route, at (q, p) and (q, v = p) with u, and y of length 2n.
///
/// # Errors
/// Those of the quantities.
#[doc(hidden)]
pub fn for_f64(robot: &Robot, [q, p, u, y]: [&[f64]; 4]) -> Result<(), EvalError> {
    let half = &y[..robot.dof()];

    let mut hamiltonian = HamiltonianSecondOrder::<f64>::new(robot);
    hamiltonian.contract(q, p, u, y)?;
    hamiltonian.hessian_product(q, p, y, y)?;
    let first = hamiltonian.first();
    first.evaluate(q, p, u)?;
    first.linearise(q, p, u)?;
    first.adjoint(q, p, u, y)?;
    first.energy(q, p)?;
    first.momentum(q, p)?;
    first.inverse_mass_matrix(q)?;
    FullHessian::<f64>::new(robot).hessian_tensor(q, p)?;

    DualPass::<f64>::new(robot).contract(q, p, u, y)?;
    let mut tensors = DualPass::<f64, _>::with_route(Tree::from(robot), Christoffel);
    tensors.contract(q, p, u, y)?;
    tensors.first().linearise(q, p, u)?;
    tensors.first().energy(q, p)?;

    let mut lagrangian = LagrangianSecondOrder::<f64>::new(robot);
    lagrangian.contract(q, p, u, y)?;
    lagrangian.contract_inverse_dynamics(q, p, u, half)?;
    let direction = [y, half].concat();
    lagrangian.inverse_dynamics_hessian_product([q, p, u, half], &direction)?;
    lagrangian.forward_dynamics_hessian_product([q, p, u, half], &direction)?;
    let first = lagrangian.first();
    first.inverse_dynamics(q, p, u)?;
    first.linearise_inverse_dynamics(q, p, u)?;
    first.linearise_forward_dynamics(q, p, u)?;
    first.forward_dynamics(q, p, u)?;
    first.energy(q, p)?;
    LegendreTransform::<f64>::new(robot).at(q, p, u)?;

    let set = ParameterSet::new(robot).model();
    HamiltonianParameters::<f64>::new(&set).contract(q, p, y)?;
    let mut parameters = LagrangianParameters::<f64>::new(&set);
    parameters.linearise_forward_dynamics(q, p, u)?;
    parameters.adjoint_forward_dynamics(q, p, u, half)?;
    kinematics(robot, [q, p, u, half])
}

/// All of the kinematics of the first joint frame, at (q, v = p, a = u) with weights from y.
fn kinematics(robot: &Robot, [q, p, u, y]: [&[f64]; 4]) -> Result<(), EvalError> {
    const FRAME: usize = 1;
    let (weights, local) = ([y[0]; 3], ReferenceFrame::Local);
    let wrench = Force { moment: weights.into(), force: weights.into() };
    let mut kinematics = Kinematics::<f64>::new(robot);
    kinematics.set_motion(q, p, u)?;
    kinematics.twist(FRAME, local)?;
    kinematics.acceleration(FRAME, local)?;
    kinematics.jacobian(FRAME, local)?;
    kinematics.jacobian_rate(FRAME, local)?;
    kinematics.twist_jacobian(FRAME, local)?;
    kinematics.force_jacobian(FRAME, local, &wrench)?;
    kinematics.twist_hessian(FRAME, local, &wrench)?;
    kinematics.position_hessian(FRAME, &weights)?;
    kinematics.rotation_hessian(FRAME, &[weights; 3])?;
    kinematics.contract_orientation_error(FRAME, &Rotation3::identity(), &weights)?;
    kinematics.momentum()?;
    kinematics.momentum_hessian(&weights, &weights)?;
    kinematics.centre_of_mass()?;
    kinematics.centre_of_mass_hessian(&weights)?;
    Ok(())
}
