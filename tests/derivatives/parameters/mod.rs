//! Derivatives by parameters of the model on random trees.

mod inputs;
mod judges;
mod relations;
mod wrenches;

use costate::matrix::Matrix;
use costate::parameters::{
    DisplacedIn, Displacement, HamiltonianParameters, LagrangianParameters, ParameterSet, Regressor,
};
use costate::robot::{FrameSpec, Placement, Robot, Wrench, WrenchAxes};
use costate::scalar::{Count, Scalar};
use costate_test_support::random_robot::Case;
use costate_test_support::rounding::{bound, lift, of_inverse, of_joints, size};

/// Bounds of the regressors of a set, each twice that of the method by hand: tau_theta, w'tau_theta, p_theta,
/// the force, E_theta. Columns that are zero by hand are sums of terms that cancel elsewhere, of the size of
/// the other columns.
fn of_regressor(set: &ParameterSet, [q, v, a, w]: [&[f64]; 4]) -> [f64; 5] {
    let [q, v, a, w] = [q, v, a, w].map(lift::<Count>);
    let mut regressor = Regressor::<Count>::new(set);
    let bound = |block: &[Count]| 2.0 * bound(block) + of_joints(set.robot(), size(block));
    let tau_theta = regressor.inverse_dynamics(&q, &v, &a).unwrap();
    let (tau, of_w) = (bound(tau_theta.as_slice()), w.len() as f64 * size(&w) * size(tau_theta.as_slice()));
    let w_tau = bound(regressor.adjoint(&q, &v, &a, &w).unwrap()) + of_joints(set.robot(), of_w);
    let sides = regressor.momentum(&q, &v).unwrap();
    let (momentum, force) = (bound(sides.momentum.as_slice()), bound(sides.force.as_slice()));
    let energy = bound(regressor.energy(&q, &v).unwrap());
    [tau, w_tau, momentum, force, energy]
}

/// The same of F_theta, y'F_theta and y'F_x,theta, p = M v rounded; terms that cancel are products with M^-1.
fn of_state_equation(set: &ParameterSet, [q, v, y]: [&[f64]; 3]) -> [f64; 3] {
    let relative = of_inverse(set.robot(), q);
    let [q, v, y] = [q, v, y].map(lift::<Count>);
    let p = costate::hamiltonian::Hamiltonian::<Count>::new(set.robot()).momentum(&q, &v).unwrap().to_vec();
    let mut parameters = HamiltonianParameters::<Count>::new(set);
    let all = parameters.contract(&q, &p, &y).unwrap();
    let of_y = y.len() as f64 * size(&y) * size(all.f_theta().as_slice());
    let blocks = [all.f_theta().as_slice(), all.y_f_theta(), all.y_f_x_theta().as_slice()];
    let terms = [0.0, of_y, of_y];
    std::array::from_fn(|k| 2.0 * bound(blocks[k]) + relative * size(blocks[k]).max(terms[k]))
}

/// The same of a_theta and y'a_theta.
fn of_acceleration(set: &ParameterSet, [q, v, u, y]: [&[f64]; 4]) -> [f64; 2] {
    let relative = of_inverse(set.robot(), q);
    let [q, v, u, y] = [q, v, u, y].map(lift::<Count>);
    let mut parameters = LagrangianParameters::<Count>::new(set);
    let linear = parameters.linearise_forward_dynamics(&q, &v, &u).unwrap();
    let a_theta = linear.a_theta.as_slice();
    let (a_theta, of_a) = (2.0 * bound(a_theta), relative * size(a_theta));
    let y_a = 2.0 * bound(parameters.adjoint_forward_dynamics(&q, &v, &u, &y).unwrap());
    [a_theta + of_a, y_a + y.len() as f64 * size(&y) * of_a]
}

/// Everything that a set can hold: all of the model, what the model has not, a payload and two displacements.
fn everything(case: &Case) -> ParameterSet {
    let frame = FrameSpec::new("tool").on(last(case)).placed(tool(case));
    all_of(&case.robot().with_frame(frame).unwrap(), case)
}

/// The same of a robot with a wrench that turns with its last link, and one that does not.
fn everything_with_wrenches(case: &Case) -> ParameterSet {
    let [a, b, c] = [case.y[0], case.u[0], case.y[1]];
    let follower = Wrench { moment: [2.0, b, -a], force: [c, -3.0, 1.5], axes: WrenchAxes::Local };
    let dead = Wrench { moment: [c, 1.0, a], force: [4.0, a, b], axes: WrenchAxes::Aligned };
    let robot = everything(case).robot().with_wrench("tool", follower).unwrap();
    all_of(&robot.with_wrench("tool", dead).unwrap().with_wrench("j0", dead).unwrap(), case)
}

fn all_of(robot: &Robot, case: &Case) -> ParameterSet {
    let tilted = Displacement::about(DisplacedIn::Parent, [0.3, -0.5, 0.4]);
    let slid = Displacement::along(DisplacedIn::Joint, [0.7, 0.2, -1.0]);
    ParameterSet::new(robot)
        .model()
        .rotations()
        .stiffness()
        .friction()
        .armature()
        .payload("tool", "tool")
        .and_then(|set| set.displacement("tilted", "j0", tilted))
        .and_then(|set| set.displacement("slid", &last(case), slid))
        .unwrap()
}

/// Name of the last joint.
fn last(case: &Case) -> String {
    format!("j{}", case.parts.len() - 1)
}

/// A placement on the last link.
fn tool(case: &Case) -> Placement {
    Placement::from_xyz_rpy(case.parts[0].com, case.parts[0].axis)
}

/// Column of a parameter.
fn column(set: &ParameterSet, name: &str) -> usize {
    set.names().iter().position(|other| other == name).unwrap()
}

/// `A x`.
fn times<S: Scalar>(a: &Matrix<S>, x: &[f64]) -> Vec<S> {
    (0..a.rows()).map(|i| a.row(i).iter().zip(x).fold(S::zero(), |sum, (&a, &x)| sum + a.times(x))).collect()
}
