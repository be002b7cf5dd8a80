//! No allocation after a workspace is built.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

#[path = "allocation/constraints.rs"]
mod constraints;
#[path = "allocation/quaternions.rs"]
mod quaternions;

use costate_test_support::allocations::{Counting, allocations};

#[cfg(feature = "rayon")]
use costate::batch::Native;
use costate::batch::{Batch, FirstOrderArrays, Model, SecondOrderArrays, StepArrays, StepMap};
use costate::derivative::{ForwardDynamics, Hessian, Jacobian, NestedHessian, PhaseVelocity};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use costate::kinematics::{Kinematics, KinematicsSecondOrder, ReferenceFrame};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder, LegendreTransform};
use costate::matrix::Matrix;
use costate::parameters::{HamiltonianParameters, LagrangianParameters, ParameterSet, Regressor};
use costate::robot::{Robot, Tree, Wrench, WrenchAxes};
use costate::spatial::Force;
use costate::step::{
    AutomaticStep, HamiltonianRobot, ImplicitMidpoint, OneStep, RungeKutta4, SemiImplicitEuler, Step,
    StoermerVerlet, Verlet,
};
use costate::tensors::{Christoffel, MassMatrixDerivatives};
use nalgebra::Rotation3;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

pub(crate) fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| drop(vec![0_u8; 100])), 1);
}

#[test]
fn kinematics_do_not_allocate() {
    for name in ["panda.urdf", "biped.toml", "cart_pole.toml"] {
        let robot = robot(name);
        let n = robot.dof();
        let (q, v, a) = (vec![0.3; n], vec![0.7; n], vec![0.1; n]);
        let (frame, w, mut product) = (robot.frames().len() - 1, [0.2, -1.0, 0.5], vec![0.0; n]);
        let wrench = Force { moment: w.into(), force: w.into() };
        let mut kinematics = Kinematics::<f64>::new(&robot);
        let mut second = KinematicsSecondOrder::<f64>::new(&robot);
        let desired = Rotation3::identity();
        let count = allocations(|| {
            second.set_motion(&q, &v, &a).unwrap();
            second.acceleration_hessian(frame, ReferenceFrame::Local, &wrench).unwrap();
            second.acceleration_jacobian(frame, ReferenceFrame::Local).unwrap();
            kinematics.set_position(&q).unwrap();
            kinematics.set_state(&q, &v).unwrap();
            kinematics.set_motion(&q, &v, &a).unwrap();
            for axes in ReferenceFrame::ALL {
                kinematics.jacobian(frame, axes).unwrap();
                kinematics.jacobian_rate(frame, axes).unwrap();
                kinematics.twist_jacobian(frame, axes).unwrap();
                kinematics.force_jacobian(frame, axes, &wrench).unwrap();
                kinematics.twist_hessian(frame, axes, &wrench).unwrap();
            }
            kinematics.position_hessian(frame, &w).unwrap();
            kinematics.position_hessian_product(frame, &w, &v, &mut product).unwrap();
            kinematics.rotation_hessian(frame, &[w; 3]).unwrap();
            kinematics.contract_orientation_error(frame, &desired, &w).unwrap();
            kinematics.orientation_error_hessian_product(frame, &desired, &w, &v, &mut product).unwrap();
            kinematics.momentum().unwrap();
            kinematics.momentum_hessian(&w, &w).unwrap();
            kinematics.centre_of_mass().unwrap();
            kinematics.centre_of_mass_hessian(&w).unwrap();
            kinematics.centre_of_mass_hessian_product(&w, &v, &mut product).unwrap();
        });
        assert_eq!(count, 0, "{name}");
    }
}

#[test]
fn wrenches_do_not_allocate() {
    let robot = robot("panda.urdf");
    let pull = Wrench { force: [1.0, 2.0, -3.0], axes: WrenchAxes::Aligned, ..Wrench::default() };
    let robot = robot.with_wrench("panda_link8", pull).unwrap();
    let (q, v, u, y) = ([0.3; 7], [0.7; 7], [0.1; 7], [0.4; 14]);
    let mut hamiltonian = HamiltonianSecondOrder::<f64>::new(&robot);
    let mut lagrangian = LagrangianSecondOrder::<f64>::new(&robot);
    let count = allocations(|| {
        hamiltonian.set_wrench(0, &[0.1; 3], &[2.0; 3]).unwrap();
        hamiltonian.contract(&q, &v, &u, &y).unwrap();
        hamiltonian.hessian_product(&q, &v, &y, &y).unwrap();
        hamiltonian.first().adjoint(&q, &v, &u, &y).unwrap();
        lagrangian.set_wrench(0, &[0.1; 3], &[2.0; 3]).unwrap();
        lagrangian.contract(&q, &v, &u, &y).unwrap();
        lagrangian.first().inverse_dynamics(&q, &v, &u).unwrap();
    });
    assert_eq!(count, 0);
}

#[test]
fn analytic_derivatives_do_not_allocate() {
    for name in ["panda.urdf", "biped.toml", "manutec_r3.toml", "cart_pole.toml"] {
        let robot = robot(name);
        let n = robot.dof();
        let (q, p, u, y) = (vec![0.3; n], vec![0.7; n], vec![0.1; n], vec![0.4; 2 * n]);
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let (mut dual_pass, mut full) = (DualPass::<f64>::new(&robot), FullHessian::<f64>::new(&robot));
        let mut contracted = Matrix::zeros(2 * n, 2 * n);
        let mut x = p.clone();
        let count = allocations(|| {
            hamiltonian.evaluate(&q, &p, &u).unwrap();
            hamiltonian.linearise(&q, &p, &u).unwrap();
            hamiltonian.energy(&q, &p).unwrap();
            hamiltonian.momentum(&q, &p).unwrap();
            hamiltonian.linearise_momentum(&q, &p).unwrap();
            hamiltonian.linearise_velocity(&q, &p).unwrap();
            hamiltonian.inverse_mass_matrix(&q).unwrap();
            hamiltonian.solve_mass_matrix(&q, &mut x).unwrap();
            second.contract(&q, &p, &u, &y).unwrap();
            second.hessian_product(&q, &p, &y, &y).unwrap();
            second.first().adjoint(&q, &p, &u, &y).unwrap();
            dual_pass.contract(&q, &p, &u, &y).unwrap();
            full.hessian_tensor(&q, &p).unwrap().contract(&y, &mut contracted).unwrap();
        });
        assert_eq!(count, 0, "{name}");
    }
}

#[test]
fn derivatives_by_parameters_do_not_allocate() {
    for name in ["panda.urdf", "biped.toml", "cart_pole.toml"] {
        let robot = robot(name);
        let (n, first) = (robot.dof(), robot.joints()[0].name.clone());
        let set = ParameterSet::new(&robot).model().friction().stiffness().payload("tool", &first).unwrap();
        let (q, p, u, y) = (vec![0.3; n], vec![0.7; n], vec![0.1; n], vec![0.4; 2 * n]);
        let mut regressor = Regressor::<f64>::new(&set);
        let mut in_q_p = HamiltonianParameters::<f64>::new(&set);
        let mut in_q_v = LagrangianParameters::<f64>::new(&set);
        let count = allocations(|| {
            regressor.inverse_dynamics(&q, &p, &u).unwrap();
            regressor.adjoint(&q, &p, &u, &q).unwrap();
            regressor.momentum(&q, &p).unwrap();
            regressor.energy(&q, &p).unwrap();
            in_q_p.linearise(&q, &p).unwrap();
            in_q_p.adjoint(&q, &p, &y).unwrap();
            in_q_p.contract(&q, &p, &y).unwrap();
            in_q_v.linearise_forward_dynamics(&q, &p, &u).unwrap();
            in_q_v.adjoint_forward_dynamics(&q, &p, &u, &q).unwrap();
        });
        assert_eq!(count, 0, "{name}");
    }
}

#[test]
fn christoffel_coefficients_do_not_allocate() {
    for name in ["panda.urdf", "manutec_r3.toml", "cart_pole.toml"] {
        let robot = robot(name);
        let (tree, n) = (Tree::from(&robot), robot.dof());
        let (q, p, u, y) = (vec![0.3; n], vec![0.7; n], vec![0.1; n], vec![0.4; 2 * n]);
        let mut first = Hamiltonian::<f64, _>::with_route(tree.clone(), Christoffel);
        let mut second = DualPass::<f64, _>::with_route(tree.clone(), Christoffel);
        let mut coefficients = MassMatrixDerivatives::<f64>::new(&tree);
        let count = allocations(|| {
            first.linearise(&q, &p, &u).unwrap();
            second.contract(&q, &p, &u, &y).unwrap();
            coefficients.update(&tree, &q).unwrap();
            coefficients.christoffel_symbol(0, n - 1, n / 2);
        });
        assert_eq!(count, 0, "{name}");
    }
}

#[test]
fn lagrangian_derivatives_do_not_allocate() {
    for name in ["panda.urdf", "biped.toml", "manutec_r3.toml", "cart_pole.toml"] {
        let robot = robot(name);
        let n = robot.dof();
        let (q, v, u, y) = (vec![0.3; n], vec![0.7; n], vec![0.1; n], vec![0.4; n]);
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let mut second = LagrangianSecondOrder::<f64>::new(&robot);
        let mut coordinates = LegendreTransform::<f64>::new(&robot);
        let (mut costate, d) = (vec![0.4; 2 * n], vec![0.6; 3 * n]);
        let f_x = Hamiltonian::<f64>::new(&robot).linearise(&q, &v, &u).unwrap().matrix().to_nalgebra();
        let f_x = Matrix::from_rows(2 * n, f_x.transpose().as_slice());
        let count = allocations(|| {
            lagrangian.inverse_dynamics(&q, &v, &u).unwrap();
            lagrangian.forward_dynamics(&q, &v, &u).unwrap();
            lagrangian.evaluate(&q, &v, &u).unwrap();
            lagrangian.gravity(&q).unwrap();
            lagrangian.mass_matrix(&q).unwrap();
            lagrangian.mass_matrix_rate(&q, &v).unwrap();
            lagrangian.coriolis_matrix(&q, &v).unwrap();
            lagrangian.energy(&q, &v).unwrap();
            lagrangian.linearise_inverse_dynamics(&q, &v, &u).unwrap();
            lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
            lagrangian.linearise(&q, &v, &u).unwrap();
            second.contract_inverse_dynamics(&q, &v, &u, &y).unwrap();
            second.contract_forward_dynamics(&q, &v, &u, &y).unwrap();
            second.inverse_dynamics_hessian_product([&q, &v, &u, &y], &d).unwrap();
            second.forward_dynamics_hessian_product([&q, &v, &u, &y], &d).unwrap();
            let mut map = coordinates.at_momentum(&q, &v, &u).unwrap();
            map.hamiltonian();
            map.jacobian_to_lagrangian(f_x.view()).unwrap();
            map.jacobian_to_hamiltonian(f_x.view()).unwrap();
            map.costate_to_lagrangian(&mut costate).unwrap();
            map.costate_to_hamiltonian(&mut costate).unwrap();
        });
        assert_eq!(count, 0, "{name}");
    }
}

#[test]
fn automatic_derivatives_do_not_allocate() {
    let robot = robot("ur5.urdf");
    let (x, y, z) = ([0.3; 12], [0.4; 12], [0.3; 18]);
    let forward = || ForwardDynamics::new(&robot);
    let mut forward_dual: Jacobian<_> = Jacobian::new(forward());
    let mut forward_hyperdual = Hessian::new(forward());
    let function = || PhaseVelocity::new(&robot);
    let mut dual: Jacobian<_> = Jacobian::new(function());
    let mut nested = NestedHessian::new(function());
    let mut hyperdual = Hessian::new(function());
    let count = allocations(|| {
        dual.linearise(&x).unwrap();
        forward_dual.linearise(&z).unwrap();
        forward_hyperdual.contract(&z, &y[..6]).unwrap();
        nested.contract(&x, &y).unwrap();
        hyperdual.contract(&x, &y).unwrap();
    });
    assert_eq!(count, 0);
}

#[test]
fn steps_do_not_allocate() {
    for name in ["panda.urdf", "biped.toml", "manutec_r3.toml", "cart_pole.toml"] {
        let robot = robot(name);
        let n = robot.dof();
        let (x, u, y) = (vec![0.3; 2 * n], vec![0.1; n], vec![0.4; 2 * n]);
        let momenta = || HamiltonianSecondOrder::<f64>::new(&robot);
        let mut rk4 = RungeKutta4::new(momenta());
        let mut verlet = StoermerVerlet::new(momenta());
        let mut midpoint = ImplicitMidpoint::new(momenta());
        let mut euler = SemiImplicitEuler::new(LagrangianSecondOrder::<f64>::new(&robot));
        let mut automatic: AutomaticStep<_> =
            AutomaticStep::new(OneStep::<_, Verlet>::new(HamiltonianRobot::from(&robot)));
        let steps: [&mut dyn Step<f64, Error = _>; 4] = [&mut rk4, &mut verlet, &mut midpoint, &mut euler];
        for (i, step) in steps.into_iter().enumerate() {
            let count = allocations(|| {
                step.evaluate(&x, &u, 1e-3).unwrap();
                step.linearise(&x, &u, 1e-3).unwrap();
                step.contract(&x, &u, 1e-3, &y).unwrap();
                let is_explicit = i == 0 || i == 3;
                assert!(is_explicit || step.evaluate(&x, &u, 1e300).is_err());
            });
            assert_eq!(count, 0, "{name}, scheme {i}");
        }
        let count = allocations(|| {
            automatic.linearise(&x, &u, 1e-3).unwrap();
        });
        assert_eq!(count, 0, "{name}, automatic");
    }
}

#[test]
fn a_refusal_allocates_but_the_next_call_does_not() {
    let robot = robot("ur5.urdf");
    let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
    assert!(hamiltonian.evaluate(&[f64::NAN; 6], &[0.0; 6], &[0.0; 6]).is_err());
    assert_eq!(allocations(|| drop(hamiltonian.evaluate(&[0.0; 6], &[1.0; 6], &[0.0; 6]))), 0);
}

#[test]
fn batches_do_not_allocate() {
    let robot = robot("ur5.urdf");
    let nodes = 21;
    let (x, u, y) = (vec![0.3; nodes * 12], vec![0.1; nodes * 6], vec![0.4; nodes * 12]);
    let h = vec![0.01; nodes];
    let (mut f, mut f_x, mut xx) = (vec![0.0; nodes * 12], vec![0.0; nodes * 144], vec![0.0; nodes * 144]);
    let mut models = Batch::<f64, _>::new(Model(HamiltonianSecondOrder::new(&robot)));
    let mut steps = Batch::<f64, _>::new(StepMap(RungeKutta4::new(HamiltonianSecondOrder::new(&robot))));
    let count = allocations(|| {
        assert!(models.evaluate(&x, &u, &mut f).unwrap().is_empty());
        let first = FirstOrderArrays { f: &mut f, f_x: &mut f_x, ..Default::default() };
        let second = SecondOrderArrays { xx: &mut xx, ..Default::default() };
        assert!(models.contract([&x, &u, &y], first, second).unwrap().is_empty());
        let first = StepArrays { phi_x: &mut f_x, ..Default::default() };
        let second = SecondOrderArrays { xx: &mut xx, ..Default::default() };
        assert!(steps.contract([&x, &u, &h, &y], first, second).unwrap().is_empty());
    });
    assert_eq!(count, 0);
}

/// From within a pool: what this thread does of a batch that all threads share, in lanes where there are any.
#[cfg(feature = "rayon")]
#[test]
fn batches_over_threads_do_not_allocate() {
    let robot = robot("ur5.urdf");
    let nodes = 500;
    let (x, u) = (vec![0.3; nodes * 12], vec![0.1; nodes * 6]);
    let mut f = vec![0.0; nodes * 12];
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let count = pool.install(|| {
        let mut batch = Batch::<Native, _>::parallel(|| Model(HamiltonianSecondOrder::new(&robot)));
        batch.evaluate(&x, &u, &mut f).unwrap();
        allocations(|| assert!(batch.evaluate(&x, &u, &mut f).unwrap().is_empty()))
    });
    assert_eq!(count, 0);
}
