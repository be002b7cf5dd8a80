//! Evaluations of extremals do not allocate.

#![expect(clippy::unwrap_used, reason = "helpers of tests fail by panicking")]

use costate::hamiltonian::HamiltonianSecondOrder;
use costate::lagrangian::LagrangianSecondOrder;
use costate::robot::{JointSpec, LinkInertia, Robot};
use costate::scalar::Scalar;
use costate_control::{
    BoundSide, Bounds, ControlLaw, DirectDynamics, DynamicsProblem, EndState, Extremal, FinalTime,
    LagrangianExtremal, Penalty, Problem, RobotExtremal, RunningCost, SideChange, SolverOptions, UserTerm,
};
use costate_test_support::allocations::{Counting, allocations};
use nalgebra::Matrix3;

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn robot(name: &str) -> Robot {
    Robot::from_file(format!("{}/../robots/{name}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// A running cost of positions and rates.
struct Swing;

impl RunningCost for Swing {
    fn evaluate<S: Scalar>(&self, q: &[S], v: &[S]) -> S {
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
        problem.bounds = Some(Bounds::new(vec![-0.5; n], vec![f64::INFINITY; n]));
        problem.penalty = Some(Penalty::new(10.0).with_q_max(vec![0.1; n]).with_v_max(vec![0.1; n]));
        let z: Vec<f64> = (0..4 * n).map(|i| 0.7 * (1.3 * i as f64).sin()).collect();
        let (mut g, mut jacobian, mut u) = (vec![0.0; 4 * n], vec![0.0; 16 * n * n], vec![0.0; n]);
        let mut count = |extremal: &mut dyn Extremal| {
            allocations(|| {
                extremal.evaluate(&z, ControlLaw::Maximal, &mut g).unwrap();
                extremal.linearise(&z, ControlLaw::Maximal, &mut g, &mut jacobian).unwrap();
                extremal.start(&z, &mut g[..2 * n], &mut jacobian[..8 * n * n]).unwrap();
                extremal.end(&z, &mut g[..2 * n], &mut jacobian[..8 * n * n]).unwrap();
                extremal.controls_at(&z, ControlLaw::Maximal, &mut u);
                let change = SideChange::new(BoundSide::Inside, BoundSide::High);
                extremal.switching(0, change, &z, &mut g);
            })
        };
        use costate_control::JacobianRoute::{Differences, Exact, WithoutHessian};
        for matrix in [Exact, Differences, WithoutHessian] {
            assert_eq!(
                count(&mut RobotExtremal::new(problem.check().unwrap(), matrix).unwrap()),
                0,
                "{file}"
            );
            assert_eq!(
                count(&mut LagrangianExtremal::new(problem.check().unwrap(), matrix).unwrap()),
                0,
                "{file}"
            );
        }
    }
}

#[test]
fn newton_steps_of_the_direct_method_for_models_allocate_nothing() {
    let robot = robot("two_link.toml");
    let (start, end) = (EndState::fixed(&[0.0; 4]), EndState::fixed(&[1.5, 1.5, 0.0, 0.0]));
    let problem = DynamicsProblem::new(start, end, FinalTime::Fixed(1.0), 2);
    let none = [f64::INFINITY; 4];
    let mut task = DirectDynamics::new(LagrangianSecondOrder::new(&robot), &problem)
        .unwrap()
        .with_state_limits(&none.map(|none| -none), &[none[0], none[1], none[2], 7.0])
        .unwrap();
    let mut count = |steps: usize| {
        let mut options = SolverOptions::default().with_tolerance(1e-6);
        options.max_iterations = steps;
        let mut motion = None;
        let all = allocations(|| motion = Some(task.solve(&options).unwrap()));
        let motion = motion.unwrap();
        assert_eq!((motion.steps.len(), motion.status.name()), (steps, "iteration_limit"));
        all
    };
    // What is left is the set-up and the report.
    assert_eq!(count(3), count(6));
}

/// In (q, p), and of inverse and forward dynamics in (q, v).
#[test]
fn second_derivatives_of_floating_robots_allocate_nothing() {
    let body = || LinkInertia::about_com(1.0, [0.1, 0.0, 0.2], Matrix3::identity());
    let robot = Robot::builder("drone")
        .joint(JointSpec::floating("root").carrying(body()))
        .joint(JointSpec::revolute("arm").on("root").carrying(body()))
        .build()
        .unwrap();
    let q = [0.1, -0.2, 0.3, 0.0, 0.0, 0.6, 0.8, 0.4];
    let (v, y) = ([0.3; 7], [0.4; 14]);
    let mut hamiltonian = HamiltonianSecondOrder::<f64>::new(&robot);
    let mut lagrangian = LagrangianSecondOrder::<f64>::new(&robot);
    let count = allocations(|| {
        hamiltonian.contract(&q, &v, &v, &y).unwrap();
        lagrangian.contract_inverse_dynamics(&q, &v, &v, &v).unwrap();
        lagrangian.contract_forward_dynamics(&q, &v, &v, &v).unwrap();
    });
    assert_eq!(count, 0);
}
