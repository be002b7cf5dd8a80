//! Every public workspace can be printed and sent to another thread.

use costate::batch::{Batch, Model, NodeFunction, StepMap};
use costate::configuration::FreeKinematics;
use costate::constraints::{
    ConstrainedHamiltonian, ConstrainedHamiltonianSecondOrder, ConstrainedLagrangian,
    ConstrainedLagrangianSecondOrder, Constraints, Impact,
};
use costate::contacts::{Contact, ContactForces, ForceMap, Margin, Stance};
use costate::derivative::{
    Directional, ForwardDynamics, Hessian, Jacobian, NestedHessian, PhaseVelocity, Routes,
};
use costate::dynamics::{Automatic, AutomaticCost, QuadraticCost, QuaternionDynamics};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use costate::kernels::{Factor, KernelOne, KernelTwo};
use costate::kinematics::{ExternalForces, Kinematics, KinematicsSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder, LegendreTransform};
use costate::matrix::Matrix;
use costate::parameters::{HamiltonianParameters, LagrangianParameters, ParameterSet, Regressor};
use costate::robot::{Robot, Tree};
use costate::step::{
    AutomaticStep, FreeStep, HamiltonianRobot, ImplicitMidpoint, LagrangianRobot, OneStep, RungeKutta4,
    SemiImplicit, SemiImplicitEuler, StepRoutes, StoermerVerlet, Verlet,
};
use costate::tensors::{Christoffel, ChristoffelKernel, IndexSets, MassMatrixDerivatives};
use std::fmt::Debug;

/// What every workspace is.
fn sent_and_printed<T: Send + Debug>() {}

/// What those are that hold no user's function.
fn cloned_and_shared<T: Send + Sync + Debug + Clone>() {}

macro_rules! each {
    ($check:ident: $($type:ty),* $(,)?) => { $($check::<$type>();)* };
}

type Momenta = HamiltonianSecondOrder<f64>;
type Velocities = LagrangianSecondOrder<f64>;

#[test]
fn workspaces_are_sent_shared_cloned_and_printed() {
    each!(cloned_and_shared:
        Tree, Matrix<f64>, KernelOne<f64>, KernelTwo<f64>, Factor<f64>,
        Hamiltonian<f64>, Hamiltonian<f64, Christoffel>, Momenta, DualPass<f64>, DualPass<f64, Christoffel>,
        FullHessian<f64>, ExternalForces<f64>, FreeKinematics<f64>, Kinematics<f64>, KinematicsSecondOrder<f64>, Lagrangian<f64>,
        ParameterSet, Regressor<f64>, HamiltonianParameters<f64>, LagrangianParameters<f64>,
        Constraints<f64>, ConstrainedHamiltonian<f64>, ConstrainedHamiltonianSecondOrder<f64>,
        ConstrainedLagrangian<f64>, ConstrainedLagrangianSecondOrder<f64>, Impact<f64>,
        Contact, Stance, Margin, ForceMap<f64>, ContactForces<f64>,
        Velocities, LegendreTransform<f64>,
        MassMatrixDerivatives<f64>, ChristoffelKernel<f64>, IndexSets, QuadraticCost,
        QuaternionDynamics<f64>, QuaternionDynamics<f64, Velocities>, FreeStep<f64, RungeKutta4<f64, QuaternionDynamics<f64>>>,
        PhaseVelocity, ForwardDynamics, OneStep<HamiltonianRobot, Verlet>, OneStep<LagrangianRobot, SemiImplicit>,
        RungeKutta4<f64, Momenta>, StoermerVerlet<f64, Momenta>, ImplicitMidpoint<f64, Velocities>,
        SemiImplicitEuler<f64, Velocities>, Model<Momenta>, StepMap<RungeKutta4<f64, Momenta>>,
    );
}

#[test]
fn workspaces_of_functions_and_batches_are_sent_and_printed() {
    each!(sent_and_printed:
        Jacobian<PhaseVelocity>, Hessian<PhaseVelocity>, NestedHessian<PhaseVelocity>, Directional<PhaseVelocity>,
        Jacobian<ForwardDynamics>, Routes, StepRoutes,
        Automatic<ForwardDynamics>, AutomaticCost<PhaseVelocity>, AutomaticStep<OneStep<HamiltonianRobot, Verlet>>,
        Batch<f64, Model<Momenta>>, Batch<f64, StepMap<RungeKutta4<f64, Momenta>>>,
        Batch<f64, NodeFunction<fn(&[f64], &mut [f64])>>,
    );
}

#[cfg(feature = "wide")]
#[test]
fn workspaces_of_lanes_are_sent_and_printed() {
    use costate::scalar::{F64x4, F64x8};
    each!(cloned_and_shared: HamiltonianSecondOrder<F64x4>, LagrangianSecondOrder<F64x8>);
    each!(sent_and_printed: Batch<F64x4, Model<HamiltonianSecondOrder<F64x4>>>);
}

/// What the library compiles for the crates that use it.
#[test]
fn all_analytic_routes_run() -> Result<(), Box<dyn std::error::Error>> {
    let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/puma560.toml"))?;
    let figures: Vec<f64> = (0..12).map(|i| (1.3 * i as f64).sin()).collect();
    let state = [&figures[..6], &figures[1..7], &figures[2..8], &figures];
    Ok(costate::instances::for_f64(&robot, state)?)
}
