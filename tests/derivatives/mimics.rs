//! Robots with mimic joints against the same joints, all independent: `L(q, v) = L_full(G q + b, G v)`, and
//! against the same joints coupled by constraints.

use costate::constraints::{ConstrainedHamiltonianSecondOrder, ConstrainedLagrangian};
use costate::derivative::largest;
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::kernels::KernelOne;
use costate::kernels::KernelTwo;
use costate::lagrangian::Lagrangian;
use costate::matrix::Matrix;
use costate::robot::{ConstraintSpec, Robot, Tree};
use costate::scalar::Scalar;
use costate_test_support::random_robot::{Case, all_cases, cases, condition};
use costate_test_support::rounding::{apart, lift};
use costate_test_support::{properties, rounding};
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;

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

fn column(values: &[f64]) -> DVector<f64> {
    DVector::from_column_slice(values)
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
        let cond = condition(&open, &full.q);
        if robot.dof() == open.dof() || !(0.0 < cond && cond < 1e8) {
            return Ok(());
        }
        let bound = 1e-10 * (cond / 1e4).max(1.0);
        let (g, coupled) = (map(&robot), coupled(&robot, open));
        let (n, all) = (robot.dof(), full.n());
        let equal = |what: &str, found: DMatrix<f64>, expected: DMatrix<f64>| {
            let off = largest(&(&found - &expected)) / largest(&expected).max(1.0);
            prop_assert!(off <= bound, "{what}: {off:.1e} of {bound:.1e}");
            Ok(())
        };
        let vector = |values: &[f64]| DMatrix::from_column_slice(values.len(), 1, values);

        // u_full is any; only G'u_full moves the robot. Along G both have the same derivatives.
        let u = g.transpose() * column(&full.u);
        let mut lagrangian = Lagrangian::<f64>::new(&robot);
        let expected = lagrangian.linearise_forward_dynamics(&case.q, &case.v, u.as_slice()).unwrap();
        let mut constrained = ConstrainedLagrangian::<f64>::new(&coupled);
        let found = constrained.linearise(&full.q, &full.v, &full.u).unwrap();
        equal("a", vector(found.acceleration()), &g * vector(expected.acceleration()))?;
        let a_z = found.a_z().to_nalgebra();
        let part = |k: usize| a_z.columns(k * all, all).into_owned();
        equal("a_q", part(0) * &g, &g * expected.a_q().to_nalgebra())?;
        equal("a_v", part(1) * &g, &g * expected.a_v().to_nalgebra())?;
        equal("a_u", part(2), &g * expected.a_u().to_nalgebra() * g.transpose())?;

        // p_full is any, too: p = G'p_full. Costates y_p of the robot are G y_p of all joints.
        let p_full = &full.y[all..];
        let p = g.transpose() * column(p_full);
        let [y_q, y_p] = [&full.y[..all], &case.y[n..]];
        let y: Vec<f64> = (g.transpose() * column(y_q)).iter().chain(y_p).copied().collect();
        let y_full: Vec<f64> = y_q.iter().copied().chain((&g * column(y_p)).iter().copied()).collect();
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let expected = second.contract(&case.q, p.as_slice(), u.as_slice(), &y).unwrap();
        let mut second_full = ConstrainedHamiltonianSecondOrder::<f64>::new(&coupled);
        let found = second_full.contract(&full.q, p_full, &full.u, &y_full).unwrap();
        let (f, f_full) = (expected.linearisation().f(), found.linearisation().f());
        equal("F^q", vector(&f_full[..all]), &g * vector(&f[..n]))?;
        equal("F^p", g.transpose() * vector(&f_full[all..]), vector(&f[n..]))?;
        // The state of all joints by that of the robot, and F of the robot by that of all joints.
        let block = |matrix: &DMatrix<f64>, i: usize, j: usize, size: usize| {
            matrix.view((i * size, j * size), (size, size)).into_owned()
        };
        let f_x = expected.linearisation().matrix().to_nalgebra();
        let f_x_full = found.linearisation().matrix().to_nalgebra();
        equal("F^q_q", block(&f_x_full, 0, 0, all) * &g, &g * block(&f_x, 0, 0, n))?;
        equal("F^q_p", block(&f_x_full, 0, 1, all), &g * block(&f_x, 0, 1, n) * g.transpose())?;
        equal("F^p_q", g.transpose() * block(&f_x_full, 1, 0, all) * &g, block(&f_x, 1, 0, n))?;
        equal("F^p_p", g.transpose() * block(&f_x_full, 1, 1, all), block(&f_x, 1, 1, n) * g.transpose())?;
        let (h, h_full) = (expected.matrix().to_nalgebra(), found.matrix().to_nalgebra());
        equal("y'F_qq", g.transpose() * block(&h_full, 0, 0, all) * &g, block(&h, 0, 0, n))?;
        equal("y'F_qp", g.transpose() * block(&h_full, 0, 1, all), block(&h, 0, 1, n) * g.transpose())?;
        equal("y'F_pp", block(&h_full, 1, 1, all), &g * block(&h, 1, 1, n) * g.transpose())?;
    }
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
