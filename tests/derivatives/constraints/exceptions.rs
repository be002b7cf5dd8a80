//! Constraints that say nothing, and computations that do not take any.

use costate::constraints::ConstrainedHamiltonian;
use costate::derivative::{Jacobian, PhaseVelocity};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian};
use costate::lagrangian::{LagrangianSecondOrder, LegendreTransform};
use costate::parameters::{HamiltonianParameters, ParameterSet, Regressor};
use costate::robot::{ConstraintSpec, Placement, Robot};
use nalgebra::Matrix3;

/// The origin of a joint stays at its distance from the link before it, whatever J says by rounding.
#[test]
fn constraints_that_no_motion_changes_are_left_out() {
    let tilted = Placement::from_xyz_rpy([0.3, -0.7, 0.2], [0.4, -1.1, 0.8]);
    let body = costate::robot::LinkInertia::about_com(1.0, [0.2, 0.1, -0.3], Matrix3::identity());
    let joint = |name: &str| costate::robot::JointSpec::revolute(name).placed(tilted).axis([0.6, -0.3, 0.9]);
    let robot =
        Robot::builder("arm").joint(joint("a").carrying(body)).joint(joint("b").on("a").carrying(body));
    let rod = ConstraintSpec::distance("rod", "a", "b", 0.5).placed(tilted.then(&tilted));
    let robot = robot.build().unwrap().with_constraint(rod).unwrap();
    let mut closed = ConstrainedHamiltonian::<f64>::new(&robot);
    let mut open = Hamiltonian::<f64>::new(&robot.without_constraints());
    for q in [[0.0, 0.0], [0.7, -1.3], [2.1, 0.4]] {
        let (found, expected) = (closed.evaluate(&q, &q, &q).unwrap().f, open.evaluate(&q, &q, &q).unwrap());
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} {expected:?}");
        assert_eq!((closed.rank(), closed.redundant().collect::<Vec<_>>()), (0, vec!["rod"]));
    }
}

/// What would ignore a constraint names it.
#[test]
fn other_computations_refuse_constraints_by_name() {
    let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/four_bar.toml")).unwrap();
    let (q, y, x) = ([0.1; 3], [0.2; 6], [0.1; 6]);
    let expected = costate::EvalError::Constrained { constraint: "rocker_pivot".into() };
    let set = ParameterSet::new(&robot).links();
    let refusals = [
        Hamiltonian::<f64>::new(&robot).momentum(&q, &q).map(drop),
        Hamiltonian::<f64>::new(&robot).mass_matrix(&q).map(drop),
        DualPass::<f64>::new(&robot).contract(&q, &q, &q, &y).map(drop),
        FullHessian::<f64>::new(&robot).hessian_tensor(&q, &q).map(drop),
        LagrangianSecondOrder::<f64>::new(&robot).contract_forward_dynamics(&q, &q, &q, &q).map(drop),
        LegendreTransform::<f64>::new(&robot).at(&q, &q, &q).map(drop),
        Regressor::<f64>::new(&set).inverse_dynamics(&q, &q, &q).map(drop),
        HamiltonianParameters::<f64>::new(&set).linearise(&q, &q).map(drop),
    ];
    for (k, refusal) in refusals.into_iter().enumerate() {
        assert_eq!(refusal.unwrap_err(), expected, "{k}");
    }
    let mut dual: Jacobian<_> = Jacobian::new(PhaseVelocity::new(&robot));
    let message = dual.linearise(&x).map(drop).unwrap_err().to_string();
    assert!(message.contains("'rocker_pivot'"), "{message}");
}
