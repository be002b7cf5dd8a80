//! Every scalar runs the whole pipeline, and its real part is the `f64` result.

use costate::hamiltonian::{FullHessian, Hamiltonian, HamiltonianSecondOrder};
use costate::lagrangian::{Lagrangian, LagrangianSecondOrder};
use costate::matrix::Block;
use costate::robot::{Robot, Tree};
use costate::scalar::{Count, Scalar, Tangent};
use costate::tensors::Christoffel;
use num_dual::{
    Dual, Dual2, Dual2_64, Dual2SVec64, Dual3_64, Dual32, Dual64, DualSVec, DualSVec64, DualStruct,
    HyperDual, HyperDual64, HyperDualSVec64, HyperHyperDual64,
};

/// q = 0 and a general state; friction, springs and a full armature matrix in the robot.
fn robots() -> Vec<Robot> {
    let friction = "name = 'rough'\narmature = [[0.3, 0.1, 0.0], [0.1, 0.4, 0.05], [0.0, 0.05, 0.2]]\n";
    let joint = |name: &str, rest: &str| {
        format!(
            "[[joint]]\nname = '{name}'\nmass = 2.0\ncom = [0.3, 0.1, 0.0]\ninertia = {{ xx = 0.1, yy = 0.2, zz = 0.25 }}\n\
             friction = {{ viscous = 0.4, coulomb = 1.5, coulomb_velocity = 0.2 }}\n\
             spring = {{ stiffness = 3.0, rest = 0.5 }}\n{rest}\n"
        )
    };
    let text = [
        friction.to_string(),
        joint("a", "axis = [0.0, 1.0, 0.0]"),
        joint("b", "placement = { xyz = [0.4, 0.0, 0.1], rpy = [0.3, -0.2, 1.0] }"),
        joint(
            "c",
            "type = 'prismatic'\nparent = 'a'\nplacement = { xyz = [0.0, 0.2, 0.0], rpy = [1.0, 0.5, 0.0] }",
        ),
    ];
    let rough = costate::robot::file::parse(&text.concat(), Default::default()).unwrap();
    let panda = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/panda.urdf")).unwrap();
    vec![rough, panda]
}

fn states(n: usize) -> [Vec<f64>; 2] {
    let general = (0..2 * n).map(|i| 0.7 - 0.31 * i as f64).collect();
    [vec![0.0; 2 * n], general]
}

/// Every quantity of a state, by name.
fn pipeline<S: Scalar>(robot: &Robot, state: &[f64]) -> Vec<(&'static str, Vec<S>)> {
    let n = robot.dof();
    let lift = |x: &[f64]| x.iter().map(|&x| S::from_f64(x)).collect::<Vec<_>>();
    let flat = |block: Block<'_, S>| block.iter_rows().flatten().copied().collect::<Vec<_>>();
    let (q, p, u) = (lift(&state[..n]), lift(&state[n..]), lift(&vec![0.5; n]));
    let y = lift(&(0..2 * n).map(|i| 1.0 - 0.2 * i as f64).collect::<Vec<_>>());
    let mut hamiltonian = Hamiltonian::<S>::new(robot);
    let mut second = HamiltonianSecondOrder::<S>::new(robot);
    let mut all = vec![("F", hamiltonian.evaluate(&q, &p, &u).unwrap().to_vec())];
    let linear = hamiltonian.linearise(&q, &p, &u).unwrap();
    all.push(("F_x", flat(linear.matrix())));
    all.push(("M", linear.mass_matrix().as_slice().to_vec()));
    let energy = hamiltonian.energy(&q, &p).unwrap();
    all.push(("energy", vec![energy.kinetic, energy.potential]));
    all.push(("p", hamiltonian.momentum(&q, &p).unwrap().to_vec()));
    all.push(("v", hamiltonian.velocity(&q, &p).unwrap().to_vec()));
    all.push(("M^-1", hamiltonian.inverse_mass_matrix(&q).unwrap().as_slice().to_vec()));
    let contracted = second.contract(&q, &p, &u, &y).unwrap();
    all.push(("F_x of the second order", flat(contracted.linearisation().matrix())));
    all.push(("y'F_xx", flat(contracted.matrix())));
    all.push(("y'F_x", second.first().adjoint(&q, &p, &u, &y).unwrap().y_f_x.to_vec()));
    all.push(("y'F_xx y", second.hessian_product(&q, &p, &y, &y).unwrap().to_vec()));
    let mut full = FullHessian::<S>::new(robot);
    all.push(("F_xx", full.hessian_tensor(&q, &p).unwrap().packed().to_vec()));
    all
}

/// What other routes and coordinates give.
fn other_pipeline<S: Scalar>(robot: &Robot, state: &[f64]) -> Vec<(&'static str, Vec<S>)> {
    let n = robot.dof();
    let lift = |x: &[f64]| x.iter().map(|&x| S::from_f64(x)).collect::<Vec<_>>();
    let flat = |block: Block<'_, S>| block.iter_rows().flatten().copied().collect::<Vec<_>>();
    let (q, v, u) = (lift(&state[..n]), lift(&state[n..]), lift(&vec![0.5; n]));
    let mut tensors = Hamiltonian::<S, _>::with_route(Tree::from(robot), Christoffel);
    let mut lagrangian = Lagrangian::<S>::new(robot);
    let mut all = vec![("F_x by tensors", flat(tensors.linearise(&q, &v, &u).unwrap().matrix()))];
    all.push(("tau", lagrangian.inverse_dynamics(&q, &v, &u).unwrap().to_vec()));
    all.push(("C", lagrangian.coriolis_matrix(&q, &v).unwrap().as_slice().to_vec()));
    let linear = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
    all.push(("a", linear.acceleration().to_vec()));
    all.push(("a_z", flat(linear.matrix())));
    all
}

fn second_order<S: Scalar>(robot: &Robot, state: &[f64]) -> Vec<(&'static str, Vec<S>)> {
    let n = robot.dof();
    let lift = |x: &[f64]| x.iter().map(|&x| S::from_f64(x)).collect::<Vec<_>>();
    let (q, v, u) = (lift(&state[..n]), lift(&state[n..]), lift(&vec![0.5; n]));
    let y = lift(&(0..n).map(|i| 1.0 - 0.3 * i as f64).collect::<Vec<_>>());
    let mut second = LagrangianSecondOrder::<S>::new(robot);
    let all = second.contract_inverse_dynamics(&q, &v, &u, &y).unwrap();
    let torque = all.zz().as_slice().to_vec();
    let acceleration = second.contract_forward_dynamics(&q, &v, &u, &y).unwrap().to_matrix();
    vec![("w'tau_zz", torque), ("y'a_zz", acceleration.as_slice().to_vec())]
}

/// What one scalar makes of a robot and a state, by name.
type Pipeline<S> = fn(&Robot, &[f64]) -> Vec<(&'static str, Vec<S>)>;

fn real_part_is_the_result_in_f64<S: Scalar>(name: &str, re: impl Fn(&S) -> f64, units: f64) {
    real_parts_agree(name, re, units, (pipeline::<f64>, |x| *x), pipeline::<S>);
}

fn other_real_part_is_the_result_in_f64<S: Scalar>(name: &str, re: impl Fn(&S) -> f64, units: f64) {
    real_parts_agree(name, re, units, (other_pipeline::<f64>, |x| *x), other_pipeline::<S>);
}

/// Beside `Count`, which takes the same forms of the formulas as numbers that carry derivatives and rounds
/// alike.
fn real_part_is_the_counted_one<S: Scalar>(name: &str, re: impl Fn(&S) -> f64) {
    real_parts_agree(name, re, 4.0, (pipeline::<Count>, |x| x.value()), pipeline::<S>);
}

fn other_real_part_is_the_counted_one<S: Scalar>(name: &str, re: impl Fn(&S) -> f64) {
    real_parts_agree(name, re, 4.0, (other_pipeline::<Count>, |x| x.value()), other_pipeline::<S>);
}

/// `f64` and its lanes take other forms of the same formulas ([`Scalar::FUSED`]), which rounds differently;
/// the condition of M multiplies that.
const UNITS: f64 = 1000.0;

/// Within `units` of the last place of the largest entry of each quantity.
fn real_parts_agree<P: Scalar, S: Scalar>(
    name: &str,
    re: impl Fn(&S) -> f64,
    units: f64,
    (plain, value): (Pipeline<P>, fn(&P) -> f64),
    lifted: Pipeline<S>,
) {
    for robot in robots() {
        for state in states(robot.dof()) {
            let (expected, found) = (plain(&robot, &state), lifted(&robot, &state));
            for ((quantity, expected), (_, found)) in expected.iter().zip(&found) {
                let size = expected.iter().fold(0.0_f64, |m, x| m.max(value(x).abs()));
                for (found, expected) in found.iter().map(&re).zip(expected.iter().map(value)) {
                    let allowed = units * S::EPSILON * size;
                    let difference = (found - expected).abs();
                    assert!(difference <= allowed, "{name}, {}: {quantity} {found} {expected}", robot.name());
                }
            }
        }
    }
}

fn dual_number<D: Scalar + DualStruct<Real = f64>>(name: &str) {
    real_part_is_the_counted_one::<D>(name, DualStruct::re);
}

#[test]
fn numbers_of_num_dual() {
    dual_number::<Dual64>("Dual");
    dual_number::<Dual2_64>("Dual2");
    dual_number::<Dual3_64>("Dual3");
    dual_number::<HyperDual64>("HyperDual");
    dual_number::<HyperHyperDual64>("HyperHyperDual");
    dual_number::<DualSVec64<4>>("DualSVec");
    dual_number::<Dual2SVec64<3>>("Dual2SVec");
    dual_number::<HyperDualSVec64<2, 3>>("HyperDualSVec");
}

#[test]
fn second_derivatives_of_velocities_carry_derivatives() {
    let value = |x: &Count| x.value();
    let counted: (Pipeline<Count>, fn(&Count) -> f64) = (second_order::<Count>, value);
    real_parts_agree("Dual", |x: &Dual64| x.re, 4.0, counted, second_order::<Dual64>);
    real_parts_agree("Tangent", |x: &Tangent<f64>| x.re, 4.0, counted, second_order::<Tangent<f64>>);
}

#[test]
fn nested_numbers() {
    dual_number::<Dual<Dual64>>("Dual of Dual");
    dual_number::<Dual<HyperDual64>>("Dual of HyperDual");
    dual_number::<Dual2<Dual64>>("Dual2 of Dual");
    dual_number::<Dual<DualSVec64<3>>>("Dual of DualSVec");
    dual_number::<Dual<Dual<Dual64>>>("Dual of Dual of Dual");
}

#[test]
fn counted_and_single_precision_numbers() {
    real_part_is_the_result_in_f64::<Count>("Count", |x| x.value(), UNITS);
    real_part_is_the_counted_one::<Tangent<f64>>("Tangent", |x| x.re);
    real_part_is_the_counted_one::<Tangent<Count>>("Tangent of Count", |x| x.re.value());
    real_part_is_the_counted_one::<Dual<Count>>("Dual of Count", |x| x.re.value());
    real_part_is_the_counted_one::<HyperDual<Count>>("HyperDual of Count", |x| x.re.value());
    real_part_is_the_counted_one::<Dual<DualSVec<Count, 3>>>("Dual of DualSVec", |x| x.re.re.value());
    // Other roundings from the first operation on, multiplied by the condition of M.
    real_part_is_the_result_in_f64::<f32>("f32", |&x| f64::from(x), 2000.0);
    real_part_is_the_result_in_f64::<Dual32>("Dual32", |x| f64::from(x.re), 2000.0);
}

#[test]
fn every_kind_of_number_in_lagrangian_coordinates_and_by_tensors() {
    other_real_part_is_the_result_in_f64::<Count>("Count", |x| x.value(), UNITS);
    other_real_part_is_the_counted_one::<Dual64>("Dual", |x| x.re);
    other_real_part_is_the_counted_one::<HyperDual64>("HyperDual", |x| x.re);
    other_real_part_is_the_counted_one::<Tangent<Count>>("Tangent of Count", |x| x.re.value());
    other_real_part_is_the_result_in_f64::<f32>("f32", |&x| f64::from(x), 2000.0);
}

/// One lane is the result in `f64`; different states in different lanes: `lanes.rs`.
#[cfg(feature = "wide")]
#[test]
fn lanes_are_the_result_in_f64() {
    use costate::scalar::{F64x4, F64x8};
    real_part_is_the_result_in_f64::<F64x4>("F64x4", |x| x.lane(3), UNITS);
    real_part_is_the_result_in_f64::<F64x8>("F64x8", |x| x.lane(5), UNITS);
    real_part_is_the_result_in_f64::<Tangent<F64x8>>("Tangent of F64x8", |x| x.re.lane(7), UNITS);
    real_part_is_the_result_in_f64::<Dual<F64x4>>("Dual of F64x4", |x| x.re.lane(1), UNITS);
    real_part_is_the_result_in_f64::<HyperDual<F64x4>>("HyperDual of F64x4", |x| x.re.lane(2), UNITS);
    other_real_part_is_the_result_in_f64::<F64x4>("F64x4", |x| x.lane(0), UNITS);
    other_real_part_is_the_result_in_f64::<Dual<F64x8>>("Dual of F64x8", |x| x.re.lane(6), UNITS);
}

/// The contracted Hessian itself can be differentiated: its derivative along p, beside a central difference.
#[test]
fn second_derivatives_can_be_differentiated() {
    fn trace<S: Scalar>(robot: &Robot, state: &[f64], direction: S) -> S {
        let n = robot.dof();
        let lift = |x: &f64| S::from_f64(*x);
        let q: Vec<S> = state[..n].iter().map(lift).collect();
        let mut p: Vec<S> = state[n..].iter().map(lift).collect();
        p[0] += direction;
        let y: Vec<S> = (0..2 * n).map(|i| lift(&(1.0 - 0.2 * i as f64))).collect();
        let u = vec![S::from_f64(0.0); n];
        let mut second = HamiltonianSecondOrder::<S>::new(robot);
        let hessian = second.contract(&q, &p, &u, &y).unwrap();
        (0..2 * n).fold(u[0], |sum, i| sum + hessian.matrix()[(i, i)])
    }
    for robot in robots() {
        let [_, state] = states(robot.dof());
        let dual = trace(&robot, &state, Dual64::new(0.0, 1.0));
        let plain = trace(&robot, &state, 0.0);
        assert!((dual.re - plain).abs() <= 1e-10 * plain.abs().max(1.0), "{} {plain}", dual.re);
        let h = 1e-5;
        let central = (trace(&robot, &state, h) - trace(&robot, &state, -h)) / (2.0 * h);
        assert!((dual.eps - central).abs() <= 1e-6 * central.abs().max(1.0), "{} {central}", dual.eps);
    }
}

/// Rotations made by library constructors would lose their derivative at angle 0; ours must not.
#[test]
fn derivatives_survive_at_angle_zero() {
    let robot = &robots()[1];
    let mut dual = Hamiltonian::<Dual64>::new(robot);
    let mut q = [Dual64::from_re(0.0); 7];
    q[1].eps = 1.0;
    let at_zero = dual.mass_matrix(&q).unwrap()[(0, 0)].eps;
    let mut plain = Hamiltonian::<f64>::new(robot);
    let mut m = |x: f64| plain.mass_matrix(&[0.0, x, 0.0, 0.0, 0.0, 0.0, 0.0]).unwrap()[(0, 0)];
    let central = (m(1e-5) - m(-1e-5)) / 2e-5;
    assert!(at_zero.abs() > 1e-3 && (at_zero - central).abs() < 1e-8, "{at_zero} {central}");
}
