//! Constraints.

use crate::robot;
use costate::Coordinates;
use costate::constraints::{
    ConstrainedHamiltonianSecondOrder, ConstrainedLagrangianSecondOrder, Constraints, Impact, ImpactWeights,
};
use costate::contacts::{Contact, ContactForces, Stance};
use costate::robot::{JointSpec, LinkInertia, Robot};
use costate_test_support::allocations::allocations;

#[test]
fn constraints_do_not_allocate() {
    for name in ["four_bar.toml", "delta.toml"] {
        let robot = robot(name);
        let n = robot.dof();
        let (q, p, y) = (vec![0.3; n], vec![0.7; n], vec![0.4; 2 * n]);
        let mut second = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
        let mut rows = Constraints::<f64>::new(&robot);
        let mu = vec![0.2; rows.count()];
        let count = allocations(|| {
            second.contract(&q, &p, &p, &y).unwrap();
            second.hessian_product(&q, &p, &y, &y).unwrap();
            let first = second.first();
            first.evaluate(&q, &p, &p).unwrap();
            first.linearise(&q, &p, &p).unwrap();
            first.adjoint(&q, &p, &p, &y).unwrap();
            first.energy(&q, &p).unwrap();
            first.velocity(&q, &p).unwrap();
            first.momentum(&q, &p).unwrap();
            first.drift(&q, &p).unwrap();
            first.constraint_rate(&q, &p).unwrap();
            rows.set_position(&q).unwrap();
            rows.hessian(&mu).unwrap();
            rows.wrench(0, &mu).unwrap();
        });
        assert_eq!(count, 0, "{name}");
    }
}

#[test]
fn contacts_and_impacts_do_not_allocate() {
    let ankle = |name: &str| Contact::foot(name, name).friction(0.6).torsion(0.1);
    let stance = Stance::new(&robot("biped.toml"), &[ankle("swing_ankle_roll")]).unwrap();
    let n = stance.robot().dof();
    let (q, p, y) = (vec![0.3; n], vec![0.7; n], vec![0.4; n]);
    let (w, e) = (vec![0.2; stance.margins().len()], vec![0.5; stance.count()]);
    let weights = ImpactWeights { velocity: &y[..], momentum: &p[..], impulse: &e[..] };
    let mut lagrangian = ConstrainedLagrangianSecondOrder::<f64>::new(stance.robot());
    let mut impact = Impact::<f64>::new(stance.robot());
    let mut forces = Coordinates::ALL.map(|coordinates| ContactForces::<f64>::new(&stance, coordinates));
    let count = allocations(|| {
        lagrangian.contract([&q, &p, &y], &y, &e).unwrap();
        lagrangian.first().evaluate(&q, &p, &y).unwrap();
        impact.evaluate(&q, &p).unwrap();
        impact.linearise(&q, &p).unwrap();
        impact.contract(&q, &p, weights).unwrap();
        for forces in &mut forces {
            forces.evaluate(&q, &p, &y).unwrap();
            forces.linearise(&q, &p, &y).unwrap();
            forces.contract([&q, &p, &y], &w, &e).unwrap();
        }
    });
    assert_eq!(count, 0);
}

#[test]
fn constraints_with_floating_joints_do_not_allocate() {
    let body = LinkInertia::about_com(2.0, [0.1, 0.0, 0.2], nalgebra::Matrix3::identity());
    let robot = Robot::builder("leg")
        .joint(JointSpec::floating("trunk").carrying(body))
        .joint(JointSpec::revolute("hip").on("trunk").axis([0.0, 1.0, 0.0]).carrying(body))
        .build()
        .unwrap();
    let stance = Stance::new(&robot, &[Contact::point("toe", "hip")]).unwrap();
    let (q, p, y) = ([0.3, 0.1, 0.5, 0.0, 0.6, 0.0, 0.8, 0.2], [0.7; 7], [0.4; 14]);
    let mut second = ConstrainedHamiltonianSecondOrder::<f64>::new(stance.robot());
    let mut impact = Impact::<f64>::new(stance.robot());
    let count = allocations(|| {
        second.contract(&q, &p, &p, &y).unwrap();
        second.hessian_product(&q, &p, &y, &y).unwrap();
        let first = second.first();
        first.evaluate(&q, &p, &p).unwrap();
        first.linearise(&q, &p, &p).unwrap();
        first.adjoint(&q, &p, &p, &y).unwrap();
        first.energy(&q, &p).unwrap();
        first.velocity(&q, &p).unwrap();
        first.momentum(&q, &p).unwrap();
        first.drift(&q, &q).unwrap();
        first.constraint_rate(&q, &p).unwrap();
        impact.evaluate(&q, &p).unwrap();
    });
    assert_eq!(count, 0);
}
