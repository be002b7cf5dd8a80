//! Robots with mimic joints against the same joints, all independent: `L(q, v) = L_full(G q + b, G v)`.

use costate::derivative::largest;
use costate::kernels::KernelOne;
use costate::kernels::KernelTwo;
use costate::lagrangian::Lagrangian;
use costate::robot::{Robot, Tree};
use costate_test_support::properties;
use costate_test_support::random_robot::{Case, all_cases};
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
