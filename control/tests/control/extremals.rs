//! The equations of an extremal: the canonical equations of H*, and their Jacobian.

use crate::equations::{assert_canonical, assert_jacobians_agree};
use costate::robot::{Friction, JointSpec, LinkInertia, Placement, Robot};
use costate_control::{Bounds, Homotopy, JacobianRoute, Penalty, Problem, Relaxation, RobotExtremal};

fn arm_with_friction() -> Robot {
    let friction = Friction { viscous: 0.3, coulomb: 0.5, coulomb_velocity: 0.4 };
    let link = LinkInertia::point(1.3, [0.2, 0.1, -0.7]);
    let place = Placement::from_xyz_rpy([0.1, 0.0, -0.8], [0.4, 0.2, -0.3]);
    Robot::builder("arm")
        .joint(JointSpec::revolute("a").axis([0.0, 1.0, 0.0]).carrying(link).friction(friction))
        .joint(JointSpec::revolute("b").on("a").placed(place).axis([0.3, 1.0, 0.2]).carrying(link))
        .joint(JointSpec::prismatic("c").on("b").placed(place).carrying(link).friction(friction))
        .build()
        .unwrap()
}

/// Problems and their relaxations.
pub fn problems() -> Vec<(Problem, Relaxation)> {
    let mut problems = Vec::new();
    let files = [
        "../robots/two_link.toml",
        "../robots/cart_pole.toml",
        "../robots/manutec_r3.toml",
        "../robots/puma560.toml",
    ];
    let robots = files.iter().map(|file| Robot::from_file(file).unwrap());
    for robot in robots.chain([arm_with_friction()]) {
        let n = robot.dof();
        let mut problem = Problem::rest_to_rest(robot, &vec![0.0; n], &vec![0.7; n], 1.0);
        problem.cost.time = 0.3;
        problem.cost.effort = (0..n).map(|i| 0.5 + 0.2 * i as f64).collect();
        problem.gain = (0..n).map(|i| 1.6 - 0.3 * i as f64).collect();
        problems.push((problem.clone(), Relaxation::NONE));
        problem.bounds = Some(Bounds::new(vec![-0.4; n], vec![0.5; n]));
        problem.penalty = Some(
            Penalty::new(30.0).with_q_min(vec![-0.1; n]).with_q_max(vec![0.2; n]).with_v_max(vec![0.3; n]),
        );
        problems.push((problem.clone(), Relaxation::NONE));
        problem.cost.effort[0] = 0.0;
        for bounds in [1.0, 1.7, f64::INFINITY] {
            problems.push((
                problem.clone(),
                Relaxation { penalty: 0.5, effort: 0.8, bounds, ..Relaxation::NONE },
            ));
        }
    }
    problems
}

pub fn point(n: usize, random: &mut fastrand::Rng) -> Vec<f64> {
    (0..4 * n).map(|_| 2.0 * random.f64() - 1.0).collect()
}

#[test]
fn the_equations_are_those_of_the_maximised_hamiltonian() {
    let mut random = fastrand::Rng::with_seed(5);
    for (problem, relaxation) in problems() {
        let mut extremal = RobotExtremal::new(problem.check().unwrap(), JacobianRoute::Exact).unwrap();
        extremal.set_relaxation(relaxation);
        let z = point(problem.robot.dof(), &mut random);
        assert_canonical(&mut extremal, &z, 1e-7, problem.robot.name());
    }
}

#[test]
fn the_exact_jacobian_agrees_with_differences() {
    let mut random = fastrand::Rng::with_seed(6);
    for (problem, relaxation) in problems() {
        let z = point(problem.robot.dof(), &mut random);
        let [mut exact, mut differences] = [JacobianRoute::Exact, JacobianRoute::Differences].map(|route| {
            let mut extremal = RobotExtremal::new(problem.check().unwrap(), route).unwrap();
            extremal.set_relaxation(relaxation);
            extremal
        });
        assert_jacobians_agree(&mut exact, &mut differences, &z, problem.robot.name());
    }
}

#[test]
fn extremals_and_errors_can_change_threads() {
    fn is_send<T: Send>() {}
    is_send::<RobotExtremal>();
    is_send::<costate_control::LagrangianExtremal>();
    is_send::<costate_control::DynamicsExtremal<costate::hamiltonian::HamiltonianSecondOrder<f64>>>();
    is_send::<costate_control::ProblemFile>();
    is_send::<costate_control::ProblemFileError>();
    is_send::<costate_control::DynamicsProblemError>();
}
