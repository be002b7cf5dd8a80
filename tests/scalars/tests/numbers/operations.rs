//! Numbers that count: the values of every route are those of `f64`, and what is counted is what it should
//! be.

use costate::derivative::{
    CHUNK, Hessian, InnerNumber, Jacobian, NestedHessian, OperationTable, PhaseVelocity,
};
use costate::hamiltonian::{DualPass, FullHessian, Hamiltonian, HamiltonianSecondOrder};
use costate::kernels::{Contracted, Route};
use costate::matrix::Block;
use costate::robot::{JointSpec, LinkInertia, Placement, Robot, Tree};
use costate::scalar::{Constants, Count, Operations, Scalar, count, count_with};
use costate::tensors::Christoffel;
use costate_test_support::robots;
use std::f64::consts::FRAC_PI_2;

fn robots() -> [Robot; 3] {
    ["robots/puma560.toml", "robots/panda.urdf", "tests/fixtures/friction_tree.toml"]
        .map(|path| Robot::from_file(format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"))).unwrap())
}

/// x = (q, p) and y: q = 0 and p = 0, or general.
fn states(n: usize) -> [[Vec<f64>; 2]; 3] {
    let numbers = |from: f64, step: f64| (0..2 * n).map(|i| from + step * i as f64).collect::<Vec<_>>();
    [
        [vec![0.0; 2 * n], numbers(1.0, -0.2)],
        [numbers(0.7, -0.31), numbers(-0.4, 0.3)],
        [numbers(-2.0, 0.5), numbers(0.0, 1.0)],
    ]
}

/// What a route gives, by name.
type Results<T> = Vec<(&'static str, Vec<T>)>;

fn flat<S: Scalar>(block: Block<'_, S>) -> Vec<S> {
    block.iter_rows().flatten().copied().collect()
}

fn by_hand<S: Scalar, R: Route>(robot: &Robot, route: R, x: &[S], u: &[S], y: &[S]) -> Results<S> {
    let (q, p) = x.split_at(robot.dof());
    let tree = Tree::from(robot);
    let mut first = Hamiltonian::<S, R>::with_route(tree.clone(), route.clone());
    let mut second = DualPass::<S, R>::with_route(tree, route);
    let mut results = vec![("M", first.mass_matrix(q).unwrap().as_slice().to_vec())];
    results.push(("F", first.evaluate(q, p, u).unwrap().to_vec()));
    results.push(("F_x", flat(first.linearise(q, p, u).unwrap().matrix())));
    results.push(("y'F_xx", flat(second.contract(q, p, u, y).unwrap().matrix())));
    results
}

fn by_rule<S: Scalar>(robot: &Robot, x: &[S], u: &[S], y: &[S]) -> Results<S> {
    let (q, p) = x.split_at(robot.dof());
    let mut second = HamiltonianSecondOrder::<S>::new(robot);
    let mut full = FullHessian::<S>::new(robot);
    let mut results = vec![("y'F_xx", flat(second.contract(q, p, u, y).unwrap().matrix()))];
    results.push(("y'F_x", second.first().adjoint(q, p, u, y).unwrap().y_f_x.to_vec()));
    results.push(("y'F_xx y", second.hessian_product(q, p, y, y).unwrap().to_vec()));
    results.push(("F_xx", full.hessian_tensor(q, p).unwrap().packed().to_vec()));
    results
}

fn by_dual_numbers<T: InnerNumber>(robot: &Robot, x: &[T], y: &[T]) -> Results<T> {
    let function = || PhaseVelocity::new(robot).under(&vec![0.5; robot.dof()]);
    let mut jacobian = Jacobian::<_, CHUNK, T>::over(function());
    let first = jacobian.linearise(x).unwrap();
    let mut results = vec![("F", first.value.to_vec()), ("F_x", first.jacobian.as_slice().to_vec())];
    let mut nested = NestedHessian::<_, CHUNK, T>::over(function());
    results.push(("y'F_xx", nested.contract(x, y).unwrap().as_slice().to_vec()));
    results
}

fn by_hyper_dual_numbers<T: InnerNumber>(robot: &Robot, x: &[T], y: &[T]) -> Results<T> {
    let mut hessian = Hessian::<_, T>::over(PhaseVelocity::new(robot).under(&vec![0.5; robot.dof()]));
    let contracted = hessian.contract(x, y).unwrap().as_slice().to_vec();
    let last = hessian.last();
    vec![("F", last.value().to_vec()), ("F_x", last.jacobian().as_slice().to_vec()), ("y'F_xx", contracted)]
}

/// Every route over one number type, made of `f64` by `lift`.
fn routes<T: InnerNumber>(
    robot: &Robot,
    [x, y]: &[Vec<f64>; 2],
    lift: fn(f64) -> T,
    mut run: impl FnMut(&'static str, &mut dyn FnMut() -> Results<T>),
) {
    let lifted = |values: &[f64]| values.iter().map(|&value| lift(value)).collect::<Vec<T>>();
    let (x, u, y) = (lifted(x), lifted(&vec![0.5; robot.dof()]), lifted(y));
    run("tensors", &mut || by_hand(robot, Christoffel, &x, &u, &y));
    run("dual pass", &mut || by_hand(robot, Contracted, &x, &u, &y));
    run("analytic", &mut || by_rule(robot, &x, &u, &y));
    run("dual", &mut || by_dual_numbers(robot, &x, &y));
    run("hyperdual", &mut || by_hyper_dual_numbers(robot, &x, &y));
}

#[test]
fn values_of_numbers_that_count_are_those_of_f64() {
    for robot in robots() {
        for state in states(robot.dof()) {
            let mut expected = Vec::new();
            routes(&robot, &state, |value| value, |_, evaluate| expected.push(evaluate()));
            let mut expected = expected.into_iter();
            routes(&robot, &state, Count::variable, |route, evaluate| {
                for ((quantity, found), (_, expected)) in evaluate().iter().zip(expected.next().unwrap()) {
                    let size = expected.iter().fold(0.0_f64, |size, value| size.max(value.abs()));
                    for (found, expected) in found.iter().zip(&expected) {
                        let difference = (found.value() - expected).abs();
                        assert!(
                            difference <= 1e-14 * size,
                            "{} {route} {quantity}: {difference:.1e}",
                            robot.name()
                        );
                    }
                }
            });
        }
    }
}

#[test]
fn counts_do_not_depend_on_the_state() {
    for robot in robots() {
        for constants in [Constants::Folded, Constants::Kept] {
            let counts = states(robot.dof()).map(|state| {
                let mut counts: Vec<Operations> = Vec::new();
                routes(&robot, &state, Count::variable, |_, evaluate| {
                    counts.push(count_with(constants, || drop(evaluate())).1);
                });
                counts
            });
            assert!(counts[0] == counts[1] && counts[1] == counts[2], "{}", robot.name());
            assert!(counts[0].iter().all(|o| o.mul > 0 && o.other == 0));
        }
    }
}

/// What generated code for F, F_x and M^-1 may take; the prototype took 1145, 1647 and 8001 multiplications.
#[test]
fn the_jacobian_takes_few_multiplications() {
    let puma = robots::file("puma560.toml");
    let general = |n| robots::random("general", n, 1);
    for (robot, most) in [(puma, 1000), (general(6), 1500), (general(12), 7500)] {
        let n = robot.dof();
        let numbers = |from: f64| (0..n).map(|i| Count::variable(from + 0.3 * i as f64)).collect::<Vec<_>>();
        let mut hamiltonian = Hamiltonian::<Count>::new(&robot);
        let (_, o) = count(|| hamiltonian.linearise(&numbers(0.1), &numbers(0.4), &numbers(0.2)).map(drop));
        assert!(o.mul <= most, "{}: {o:?}", robot.name());
    }
}

/// What second derivatives add: less by the 2n+1 rule than by one dual pass, products less than the matrix.
#[test]
fn second_derivatives_take_few_multiplications() {
    for robot in [robots::file("puma560.toml"), robots::file("biped.toml"), robots::random("general", 6, 1)] {
        for constants in [Constants::Folded, Constants::Kept] {
            let table = OperationTable::new(&robot, constants).unwrap();
            let of = |quantity, route| table.get(quantity, route).unwrap().mul as f64;
            let analytic = |quantity| of(quantity, "analytic");
            let name = robot.name();
            assert!(analytic("y_f_xx") < of("y_f_xx", "dual pass"), "{name}: the rule");
            assert!(analytic("y_f_xx") < 2.9 * analytic("f_x"), "{name}: beside F, F_x");
            assert!(analytic("y_f_x") < 2.5 * analytic("f"), "{name}: adjoint product beside F");
            assert!(analytic("y_f_x") < analytic("f_x"), "{name}: adjoint product beside F_x");
            assert!(analytic("y_f_xx_d") < 0.8 * analytic("y_f_xx"), "{name}: product");
            assert!(analytic("f_xx") < robot.dof() as f64 * analytic("y_f_xx"), "{name}: whole tensor");
            assert!(of("y_f_xx", "hyperdual") > 25.0 * analytic("y_f_xx"), "{name}: hyper-dual numbers");
        }
    }
}

/// A chain of six joints whose frames are turned by `rpy` from one to the next.
fn chain(rpy: [f64; 3], offset: [f64; 3]) -> Robot {
    let mut builder = Robot::builder("chain");
    for i in 0..6 {
        let inertia = LinkInertia::about_com(2.0, [0.1, 0.2, 0.3], nalgebra::Matrix3::identity() * 0.3);
        let mut joint = JointSpec::revolute(format!("{i}")).placed(Placement::from_xyz_rpy(offset, rpy));
        if i > 0 {
            joint = joint.on(format!("{}", i - 1));
        }
        builder = builder.joint(joint.carrying(inertia));
    }
    builder.build().unwrap()
}

/// Parallel, orthogonal, general axes, in the order of what they take; unfolded they all take the same.
#[test]
fn parallel_and_orthogonal_axes_take_less() {
    let robots = [
        chain([0.0; 3], [0.4, 0.0, 0.0]),
        chain([FRAC_PI_2, 0.0, 0.0], [0.4, 0.0, 0.0]),
        chain([0.3, -0.5, 0.7], [0.4, 0.3, -0.2]),
    ];
    let tables = |constants| robots.each_ref().map(|robot| OperationTable::new(robot, constants).unwrap());
    let (folded, kept) = (tables(Constants::Folded), tables(Constants::Kept));
    for quantity in OperationTable::QUANTITIES {
        for route in OperationTable::ROUTES {
            let [parallel, orthogonal, general] =
                folded.each_ref().map(|table| table.get(quantity, route).unwrap());
            assert!(parallel.mul < orthogonal.mul && orthogonal.mul < general.mul, "{quantity} {route}");
            assert!(parallel.add < orthogonal.add && orthogonal.add < general.add, "{quantity} {route}");
        }
    }
    for (folded, kept) in folded.iter().zip(&kept) {
        for (few, all) in folded.rows().zip(kept.rows()) {
            let (few, all) = (few.operations, all.operations);
            assert!(
                few.mul <= all.mul && few.add <= all.add && few.div <= all.div && few.sincos <= all.sincos
            );
        }
    }
}

/// One joint: what stays of the algebra when everything constant is folded.
#[test]
fn a_pendulum_takes_what_it_must() {
    let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/../../robots/pendulum.toml")).unwrap();
    let table = OperationTable::new(&robot, Constants::Folded).unwrap();
    for row in table.rows() {
        let o = row.operations;
        assert_eq!(
            (o.div, o.sqrt, o.exp, o.less),
            (0, 0, 0, 0),
            "{} {}: M is a constant",
            row.quantity,
            row.route
        );
    }
    let f = table.get("f", "analytic").unwrap();
    assert!((f.sincos, f.mul) == (1, 2) && f.add <= 4, "weight and actuation: {f:?}");
    let mut hamiltonian = Hamiltonian::<Count>::new(&robot);
    let [q, p, u] = [0.4, 0.5, 0.6].map(|value| [Count::variable(value)]);
    let (_, again) = count(|| hamiltonian.evaluate(&q, &p, &u).map(drop));
    assert_eq!(f, again);
}
