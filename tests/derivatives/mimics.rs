//! Robots with mimic joints against the same joints, all independent: `L(q, v) = L_full(G q + b, G v)`, and
//! against the same joints coupled by constraints.

use costate::constraints::{ConstrainedHamiltonianSecondOrder, ConstrainedLagrangian};
use costate::derivative::largest;
use costate::hamiltonian::HamiltonianSecondOrder;
use costate::kernels::KernelOne;
use costate::kernels::KernelTwo;
use costate::lagrangian::Lagrangian;
use costate::robot::{ConstraintSpec, Robot, Tree};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, all_cases, cases, condition};
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
fn kernels(tree: &Tree, q: &[f64], v: &[f64], dq: &[f64], dv: &[f64]) -> (KernelOne<f64>, KernelTwo<f64>) {
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
        let (dq, dv) = (&case.u, &case.y[..case.n()]);
        let (dq_full, dv_full) = (&g * column(dq), &g * column(dv));
        let (tree, full_tree) = (Tree::from(&robot), Tree::from(&full.robot()));
        let (one, two) = kernels(&tree, &case.q, &case.v, dq, dv);
        let (one_full, two_full) =
            kernels(&full_tree, &full.q, &full.v, dq_full.as_slice(), dv_full.as_slice());
        let square = |what: &str, found: &costate::matrix::Matrix<f64>, all: &costate::matrix::Matrix<f64>| {
            let (found, all) = (found.view().to_nalgebra(), all.view().to_nalgebra());
            let size = g.abs().transpose() * all.abs() * g.abs();
            let off = largest(&(found - g.transpose() * all * &g)) / largest(&size).max(1e-300);
            prop_assert!(off <= 1e-13, "{what}: {off:.1e}");
            Ok(())
        };
        square("M", one.mass_matrix(), one_full.mass_matrix())?;
        square("P", one.l_vq(), one_full.l_vq())?;
        square("L_qq", one.l_qq(), one_full.l_qq())?;
        square("D M", two.mass_matrix(), two_full.mass_matrix())?;
        square("D P", two.l_vq(), two_full.l_vq())?;
        square("D L_qq", two.l_qq(), two_full.l_qq())?;
        let row = |what: &str, found: &[f64], all: &[f64]| {
            let size = g.abs().transpose() * column(all).abs();
            let off = largest(&(column(found) - g.transpose() * column(all))) / largest(&size).max(1e-300);
            prop_assert!(off <= 1e-13, "{what}: {off:.1e}");
            Ok(())
        };
        row("p", one.momentum(), one_full.momentum())?;
        row("L_q", one.l_q(), one_full.l_q())?;
        let (potential, of_all) = (one.potential(&tree), one_full.potential(&full_tree));
        prop_assert!((potential - of_all).abs() <= 1e-12 * (1.0 + of_all.abs()), "V");

        let (a, a_full) = (dv, dv_full.as_slice());
        let tau = Lagrangian::new(&robot).inverse_dynamics(&case.q, &case.v, a).unwrap().to_vec();
        let mut all = Lagrangian::new(&full.robot());
        row("tau", &tau, all.inverse_dynamics(&full.q, &full.v, a_full).unwrap())?;
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
