//! Robots with mimic joints against the same joints, all independent: `L(q, v) = L_full(G q + b, G v)`, and
//! against the same joints coupled by constraints.

use costate::constraints::{ConstrainedHamiltonianSecondOrder, ConstrainedLagrangian};
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::kernels::KernelOne;
use costate::kernels::KernelTwo;
use costate::lagrangian::Lagrangian;
use costate::matrix::{Block, Matrix};
use costate::robot::{ConstraintSpec, Robot, Tree};
use costate::scalar::Scalar;
use costate_test_support::random_robot::{Case, all_cases, cases, condition};
use costate_test_support::rounding::{Differences, apart, lift, lift_rounded, product, rows};
use costate_test_support::{properties, rounding};
use nalgebra::DMatrix;
use proptest::prelude::*;
use std::ops::Range;

/// G, N x n.
fn map(robot: &Robot) -> DMatrix<f64> {
    let columns = robot.independent_indices();
    DMatrix::from_fn(robot.joints().len(), robot.dof(), |i, k| match robot.joints()[i].mimic {
        Some(mimic) if mimic.joint == columns[k] => mimic.ratio,
        None if i == columns[k] => 1.0,
        _ => 0.0,
    })
}

/// All joints independent, with a coupling in the place of each mimicry.
fn coupled(robot: &Robot, open: Robot) -> Robot {
    robot.joints().iter().fold(open, |open, joint| {
        let Some(mimic) = joint.mimic else { return open };
        let terms = [(&*joint.name, 1.0), (&*robot.joints()[mimic.joint].name, -mimic.ratio)];
        open.with_constraint(ConstraintSpec::coupling(&joint.name, &terms, mimic.offset)).unwrap()
    })
}

/// All stages of kernel one, and kernel two along (dq, dv).
fn kernels<S: Scalar>(tree: &Tree, [q, v, dq, dv]: [&[S]; 4]) -> (KernelOne<S>, KernelTwo<S>) {
    let (mut one, mut two) = (KernelOne::new(tree), KernelTwo::new(tree));
    one.set_position(tree, q).unwrap();
    one.set_velocity(tree, v).unwrap();
    one.second_order(tree);
    two.differentiate(tree, &one, dq, dv).unwrap();
    (one, two)
}

properties! {
    192;

    #[test]
    fn every_quantity_is_a_congruence(case in all_cases(10)) {
        let (robot, full) = (case.robot(), case.all_independent());
        let g = map(&robot);
        let (open, tree) = (full.robot(), Tree::from(&robot));
        let open_tree = Tree::from(&open);
        rounding!(|S| {
            let [q, v, dq, dv] = [&case.q[..], &case.v, &case.u, &case.y[..case.n()]].map(lift::<S>);
            // The factors of G are constants of both robots.
            let down = |x: &[S]| -> Vec<S> {
                let sum = |i: usize| (0..g.ncols()).fold(S::zero(), |sum, k| sum + x[k].times(g[(i, k)]));
                (0..g.nrows()).map(sum).collect()
            };
            let up = |x: &[S]| -> Vec<S> {
                let sum = |k: usize| (0..g.nrows()).fold(S::zero(), |sum, i| sum + x[i].times(g[(i, k)]));
                (0..g.ncols()).map(sum).collect()
            };
            let [q_all, v_all] = [&full.q, &full.v].map(|x| lift::<S>(x));
            let (dq_all, dv_all) = (down(&dq), down(&dv));
            let (one, two) = kernels(&tree, [&q, &v, &dq, &dv]);
            let (one_all, two_all) = kernels(&open_tree, [&q_all, &v_all, &dq_all, &dv_all]);
            // G'A G, rows first.
            let square = |found: &Matrix<S>, all: &Matrix<S>| {
                let half: Vec<Vec<S>> = (0..all.rows()).map(|i| up(all.row(i))).collect();
                let column = |k: usize| up(&half.iter().map(|row| row[k]).collect::<Vec<S>>());
                let columns: Vec<Vec<S>> = (0..found.rows()).map(column).collect();
                let n = found.rows();
                (0..n * n).map(|e| found[(e / n, e % n)] - columns[e % n][e / n]).collect::<Vec<S>>()
            };
            let mut blocks = vec![("M", square(one.mass_matrix(), one_all.mass_matrix()))];
            blocks.push(("P", square(one.l_vq(), one_all.l_vq())));
            blocks.push(("L_qq", square(one.l_qq(), one_all.l_qq())));
            blocks.push(("D M", square(two.mass_matrix(), two_all.mass_matrix())));
            blocks.push(("D P", square(two.l_vq(), two_all.l_vq())));
            blocks.push(("D L_qq", square(two.l_qq(), two_all.l_qq())));
            blocks.push(("p", apart(one.momentum(), &up(one_all.momentum()))));
            blocks.push(("L_q", apart(one.l_q(), &up(one_all.l_q()))));
            blocks.push(("V", vec![one.potential(&tree) - one_all.potential(&open_tree)]));
            let tau = Lagrangian::new(&robot).inverse_dynamics(&q, &v, &dv).unwrap().to_vec();
            let mut all = Lagrangian::new(&open);
            blocks.push(("tau", apart(&tau, &up(all.inverse_dynamics(&q_all, &v_all, &dv_all).unwrap()))));
            blocks
        })?;
    }

    /// Poses follow the mimic joints.
    #[test]
    fn poses_are_those_of_all_joints(case in all_cases(8)) {
        let full = case.all_independent();
        let (poses, expected) = (case.robot().poses(&case.q).unwrap(), full.robot().poses(&full.q).unwrap());
        prop_assert_eq!(poses, expected);
    }

    /// A mimicry is a coupling whose force is not computed: the same accelerations, F and derivatives for all
    /// motions of the independent joints, whatever the torques and momenta of the others.
    #[test]
    fn a_coupling_moves_as_a_mimicry_does(case in cases(7)) {
        let full = case.all_independent();
        let (robot, open) = (case.robot(), full.robot());
        // All joints together may be redundant where those of the robot are not.
        if robot.dof() == open.dof() || !(0.0..1e9).contains(&condition(&open, &full.q)) {
            return Ok(());
        }
        let (g, coupled) = (map(&robot), coupled(&robot, open));
        rounding!(|S| along_the_map::<S>(&g, [&robot, &coupled], [&case, &full]))?;
    }
}

/// Rows and columns of a matrix.
fn part<S: Scalar>(matrix: Block<'_, S>, rows: Range<usize>, columns: Range<usize>) -> Vec<S> {
    rows.flat_map(|i| matrix.row(i)[columns.clone()].to_vec()).collect()
}

/// Derivatives of a robot with mimic joints and of one whose joints are coupled, along G.
fn along_the_map<S: Scalar>(
    g: &DMatrix<f64>,
    [robot, coupled]: [&Robot; 2],
    [case, full]: [&Case; 2],
) -> Differences<S> {
    let (n, all) = (robot.dof(), full.n());
    // Row by row.
    let (g, g_t) = (lift::<S>(g.transpose().as_slice()), lift::<S>(g.as_slice()));
    let down = |a: &[S]| product(&g_t, a, all);
    let up = |a: &[S]| product(&g, a, n);
    let to_robot = |a: &[S]| product(a, &g, all);
    let to_all = |a: &[S]| product(a, &g_t, n);
    let mut blocks = Vec::new();

    // u_full is any; only G'u_full moves the robot. Along G both have the same derivatives.
    let [q, v] = [&case.q, &case.v].map(|x| lift::<S>(x));
    let [q_all, v_all] = [&full.q, &full.v].map(|x| lift_rounded::<S>(x));
    let [u_all, y_all] = [&full.u, &full.y].map(|x| lift::<S>(x));
    let u = down(&u_all);
    let mut lagrangian = Lagrangian::<S>::new(robot);
    let expected = lagrangian.linearise_forward_dynamics(&q, &v, &u).unwrap();
    let mut constrained = ConstrainedLagrangian::<S>::new(coupled);
    let found = constrained.linearise(&q_all, &v_all, &u_all).unwrap();
    blocks.push(("a", apart(found.acceleration(), &up(expected.acceleration()))));
    let a = |k: usize| part(found.a_z(), 0..all, k * all..(k + 1) * all);
    blocks.push(("a_q", apart(&to_robot(&a(0)), &up(&rows(expected.a_q())))));
    blocks.push(("a_v", apart(&to_robot(&a(1)), &up(&rows(expected.a_v())))));
    blocks.push(("a_u", apart(&a(2), &to_all(&up(&rows(expected.a_u()))))));

    // p_full is any, too: p = G'p_full. Costates y_p of the robot are G y_p of all joints.
    let (y_q, p_all) = y_all.split_at(all);
    let (p, y_p) = (down(p_all), lift::<S>(&case.y[n..]));
    let (y, y_all) = ([down(y_q), y_p.clone()].concat(), [y_q, &up(&y_p)].concat());
    let mut second = HamiltonianSecondOrder::<S>::new(robot);
    let expected = second.contract(&q, &p, &u, &y).unwrap();
    let mut second_full = ConstrainedHamiltonianSecondOrder::<S>::new(coupled);
    let found = second_full.contract(&q_all, p_all, &u_all, &y_all).unwrap();
    let (f, f_all) = (expected.linearisation().f(), found.linearisation().f());
    blocks.push(("F^q", apart(&f_all[..all], &up(&f[..n]))));
    blocks.push(("F^p", apart(&down(&f_all[all..]), &f[n..])));
    // The state of all joints by that of the robot, and F of the robot by that of all joints.
    let block = |matrix: Block<'_, S>, i: usize, j: usize, size: usize| {
        part(matrix, i * size..(i + 1) * size, j * size..(j + 1) * size)
    };
    let of = |i, j| block(expected.linearisation().matrix(), i, j, n);
    let of_all = |i, j| block(found.linearisation().matrix(), i, j, all);
    blocks.push(("F^q_q", apart(&to_robot(&of_all(0, 0)), &up(&of(0, 0)))));
    blocks.push(("F^q_p", apart(&of_all(0, 1), &to_all(&up(&of(0, 1))))));
    blocks.push(("F^p_q", apart(&to_robot(&down(&of_all(1, 0))), &of(1, 0))));
    blocks.push(("F^p_p", apart(&down(&of_all(1, 1)), &to_all(&of(1, 1)))));
    let of = |i, j| block(expected.matrix(), i, j, n);
    let of_all = |i, j| block(found.matrix(), i, j, all);
    blocks.push(("y'F_qq", apart(&to_robot(&down(&of_all(0, 0))), &of(0, 0))));
    blocks.push(("y'F_qp", apart(&down(&of_all(0, 1)), &to_all(&of(0, 1)))));
    blocks.push(("y'F_pp", apart(&of_all(1, 1), &to_all(&up(&of(1, 1))))));
    blocks
}

/// Every kind of mimicry occurs: of a mimic, of a later joint, with a negative ratio, with an offset.
#[test]
fn random_robots_have_mimics_of_all_kinds() {
    use proptest::strategy::ValueTree;
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    let mut found = [0; 5];
    for _ in 0..200 {
        let case: Case = all_cases(10).new_tree(&mut runner).unwrap().current();
        let (robot, specs) = (case.robot(), &case.parts);
        for (i, joint) in robot.joints().iter().enumerate() {
            let Some(mimic) = joint.mimic else { continue };
            let master = case.mimicked(i).unwrap();
            let (_, ratio, offset) = specs[i].mimic.unwrap();
            let kinds = [true, master != mimic.joint, mimic.joint > i, ratio < 0.0, offset != 0.0];
            found.iter_mut().zip(kinds).for_each(|(count, is)| *count += i32::from(is));
        }
    }
    assert!(found.iter().all(|&count| count > 5), "{found:?}");
}
