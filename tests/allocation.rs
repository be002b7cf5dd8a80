//! No allocation after a workspace is built.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

#[cfg(feature = "rayon")]
use costate::batch::Native;
use costate::batch::{Batch, FirstOrderArrays, Model, SecondOrderArrays, StepArrays, StepMap};
use costate::control::{
    Bounds, Extremal, LagrangianExtremal, Law, Penalty, Problem, RobotExtremal, RunningCost, Side, UserTerm,
};
use costate::derivative::{ForwardDynamics, Hessian, Jacobian, NestedHessian, PhaseVelocity};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian, SecondOrder};
use costate::lagrangian::{self, Coordinates, Lagrangian};
use costate::matrix::Matrix;
use costate::robot::{Robot, Tree};
use costate::scalar::Scalar;
use costate::step::{
    AutomaticStep, HamiltonianRobot, ImplicitMidpoint, OneStep, RungeKutta4, SemiImplicitEuler, Step,
    StoermerVerlet, Verlet,
};
use costate::tensors::{Christoffel, MassMatrixDerivatives};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    static ALLOCATIONS: Cell<usize> = const { Cell::new(0) };
}

/// Counts what this thread asks of the system's allocator.
struct Counting;

#[expect(unsafe_code, reason = "an allocator is unsafe by nature; this one only counts and forwards")]
// SAFETY: every call is forwarded to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        ALLOCATIONS.set(ALLOCATIONS.get() + 1);
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }
    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// How often `work` allocates.
fn allocations(work: impl FnOnce()) -> usize {
    let before = ALLOCATIONS.get();
    work();
    ALLOCATIONS.get() - before
}

fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

#[test]
fn the_counter_counts() {
    assert_eq!(allocations(|| drop(vec![0_u8; 100])), 1);
}

#[test]
fn analytic_derivatives_do_not_allocate() {
    for name in ["panda.urdf", "biped.toml", "manutec_r3.toml", "cart_pole.toml"] {
        let robot = robot(name);
        let n = robot.dof();
        let (q, p, u, y) = (vec![0.3; n], vec![0.7; n], vec![0.1; n], vec![0.4; 2 * n]);
        let mut hamiltonian = Hamiltonian::<f64>::new(&robot);
        let mut second = SecondOrder::<f64>::new(&robot);
        let (mut dual_pass, mut full) = (DualPass::<f64>::new(&robot), FullHessian::<f64>::new(&robot));
        let mut contracted = Matrix::zeros(2 * n, 2 * n);
        let mut x = p.clone();
        let count = allocations(|| {
            hamiltonian.phase_velocity(&q, &p, &u).unwrap();
            hamiltonian.jacobian(&q, &p, &u).unwrap();
            hamiltonian.energy(&q, &p).unwrap();
            hamiltonian.momentum(&q, &p).unwrap();
            hamiltonian.momentum_jacobian(&q, &p).unwrap();
            hamiltonian.velocity_jacobian(&q, &p).unwrap();
            hamiltonian.inverse_mass_matrix(&q).unwrap();
            hamiltonian.solve_mass_matrix(&q, &mut x).unwrap();
            second.contracted_hessian(&q, &p, &u, &y).unwrap();
            second.hessian_product(&q, &p, &y, &y).unwrap();
            second.first().adjoint(&q, &p, &u, &y).unwrap();
            dual_pass.contracted_hessian(&q, &p, &u, &y).unwrap();
            full.evaluate(&q, &p).unwrap().contract(&y, &mut contracted).unwrap();
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
            first.jacobian(&q, &p, &u).unwrap();
            second.contracted_hessian(&q, &p, &u, &y).unwrap();
            coefficients.evaluate(&tree, &q).unwrap();
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
        let mut second = lagrangian::SecondOrder::<f64>::new(&robot);
        let mut coordinates = Coordinates::<f64>::new(&robot);
        let mut costate = vec![0.4; 2 * n];
        let f_x = Hamiltonian::<f64>::new(&robot).jacobian(&q, &v, &u).unwrap().matrix().to_nalgebra();
        let f_x = Matrix::from_rows(2 * n, f_x.transpose().as_slice());
        let count = allocations(|| {
            lagrangian.inverse_dynamics(&q, &v, &u).unwrap();
            lagrangian.forward_dynamics(&q, &v, &u).unwrap();
            lagrangian.state_equation(&q, &v, &u).unwrap();
            lagrangian.gravity(&q).unwrap();
            lagrangian.mass_matrix(&q).unwrap();
            lagrangian.mass_matrix_rate(&q, &v).unwrap();
            lagrangian.coriolis_matrix(&q, &v).unwrap();
            lagrangian.energy(&q, &v).unwrap();
            lagrangian.inverse_dynamics_jacobian(&q, &v, &u).unwrap();
            lagrangian.forward_dynamics_jacobian(&q, &v, &u).unwrap();
            lagrangian.state_jacobian(&q, &v, &u).unwrap();
            second.inverse_dynamics_hessian(&q, &v, &u, &y).unwrap();
            second.contracted_hessian(&q, &v, &u, &y).unwrap();
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
        dual.evaluate(&x).unwrap();
        forward_dual.evaluate(&z).unwrap();
        forward_hyperdual.contracted(&z, &y[..6]).unwrap();
        nested.contracted(&x, &y).unwrap();
        hyperdual.contracted(&x, &y).unwrap();
    });
    assert_eq!(count, 0);
}

#[test]
fn steps_do_not_allocate() {
    for name in ["panda.urdf", "biped.toml", "manutec_r3.toml", "cart_pole.toml"] {
        let robot = robot(name);
        let n = robot.dof();
        let (x, u, y) = (vec![0.3; 2 * n], vec![0.1; n], vec![0.4; 2 * n]);
        let momenta = || SecondOrder::<f64>::new(&robot);
        let mut rk4 = RungeKutta4::new(momenta());
        let mut verlet = StoermerVerlet::new(momenta());
        let mut midpoint = ImplicitMidpoint::new(momenta());
        let mut euler = SemiImplicitEuler::new(lagrangian::SecondOrder::<f64>::new(&robot));
        let mut automatic: AutomaticStep<_> =
            AutomaticStep::new(OneStep::<_, Verlet>::new(HamiltonianRobot::from(&robot)));
        let steps: [&mut dyn Step<f64, Error = _>; 4] = [&mut rk4, &mut verlet, &mut midpoint, &mut euler];
        for (i, step) in steps.into_iter().enumerate() {
            let count = allocations(|| {
                step.advance(&x, &u, 1e-3).unwrap();
                step.linearise(&x, &u, 1e-3).unwrap();
                step.contract(&x, &u, 1e-3, &y).unwrap();
                let is_explicit = i == 0 || i == 3;
                assert!(is_explicit || step.advance(&x, &u, 1e300).is_err());
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
    assert!(hamiltonian.phase_velocity(&[f64::NAN; 6], &[0.0; 6], &[0.0; 6]).is_err());
    assert_eq!(allocations(|| drop(hamiltonian.phase_velocity(&[0.0; 6], &[1.0; 6], &[0.0; 6]))), 0);
}

#[test]
fn batches_do_not_allocate() {
    let robot = robot("ur5.urdf");
    let nodes = 21;
    let (x, u, y) = (vec![0.3; nodes * 12], vec![0.1; nodes * 6], vec![0.4; nodes * 12]);
    let h = vec![0.01; nodes];
    let (mut f, mut f_x, mut xx) = (vec![0.0; nodes * 12], vec![0.0; nodes * 144], vec![0.0; nodes * 144]);
    let mut models = Batch::<f64, _>::new(Model(SecondOrder::new(&robot)));
    let mut steps = Batch::<f64, _>::new(StepMap(RungeKutta4::new(SecondOrder::new(&robot))));
    let count = allocations(|| {
        assert!(models.value(&x, &u, &mut f).unwrap().is_empty());
        let first = FirstOrderArrays { f: &mut f, f_x: &mut f_x, ..Default::default() };
        let second = SecondOrderArrays { xx: &mut xx, ..Default::default() };
        assert!(models.contract([&x, &u, &y], first, second).unwrap().is_empty());
        let first = StepArrays { phi_x: &mut f_x, ..Default::default() };
        let second = SecondOrderArrays { xx: &mut xx, ..Default::default() };
        assert!(steps.contract_steps([&x, &u, &h, &y], first, second).unwrap().is_empty());
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
        let mut batch = Batch::<Native, _>::parallel(|| Model(SecondOrder::new(&robot)));
        batch.value(&x, &u, &mut f).unwrap();
        allocations(|| assert!(batch.value(&x, &u, &mut f).unwrap().is_empty()))
    });
    assert_eq!(count, 0);
}

/// A running cost of positions and rates.
struct Swing;

impl RunningCost for Swing {
    fn eval<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
        q.iter().zip(v).fold(S::zero(), |sum, (&q, &v)| sum + q.sin_cos().1 * v * v)
    }
}

#[test]
fn the_equations_and_ends_of_an_extremal_allocate_nothing() {
    for file in ["two_link.toml", "puma560.toml"] {
        let robot = robot(file);
        let n = robot.dof();
        let mut problem = Problem::rest_to_rest(robot, &vec![0.0; n], &vec![0.5; n], 1.0);
        (problem.start.v_free, problem.end.q_free) = (vec![0], vec![1]);
        problem.terms = vec![UserTerm::new(Swing)];
        problem.bounds = Some(Bounds { u_min: vec![-0.5; n], u_max: vec![f64::INFINITY; n] });
        problem.penalty =
            Some(Penalty { weight: 10.0, q_min: None, q_max: Some(vec![0.1; n]), v_max: Some(vec![0.1; n]) });
        let z: Vec<f64> = (0..4 * n).map(|i| 0.7 * (1.3 * i as f64).sin()).collect();
        let (mut g, mut jacobian, mut u) = (vec![0.0; 4 * n], vec![0.0; 16 * n * n], vec![0.0; n]);
        let mut count = |extremal: &mut dyn Extremal| {
            allocations(|| {
                extremal.rate(&z, Law::Maximal, &mut g).unwrap();
                extremal.linear(&z, Law::Maximal, &mut g, &mut jacobian).unwrap();
                extremal.start(&z, &mut g[..2 * n], &mut jacobian[..8 * n * n]).unwrap();
                extremal.end(&z, &mut g[..2 * n], &mut jacobian[..8 * n * n]).unwrap();
                extremal.controls_at(&z, Law::Maximal, &mut u);
                extremal.switching(0, (Side::Inside, Side::High), &z, &mut g);
            })
        };
        use costate::control::Jacobian::{Differences, Exact, WithoutHessian};
        for matrix in [Exact, Differences, WithoutHessian] {
            assert_eq!(count(&mut RobotExtremal::new(&problem, matrix).unwrap()), 0, "{file}");
            assert_eq!(count(&mut LagrangianExtremal::new(&problem, matrix).unwrap()), 0, "{file}");
        }
    }
}
