//! How many numbers are computed, where they are stored, and how they are asked for.

use super::CASES;
use super::bench::{Bench, quadruples, revolute, serial, triples};
use costate::robot::Tree;
use costate::tensors::{IndexSets, MassMatrixDerivatives};
use costate_test_support::properties;
use costate_test_support::random_robot::all_cases;
use proptest::prelude::*;

/// How many numbers of a storage have been computed: what has not is not a number.
fn computed(stored: &[f64]) -> usize {
    stored.iter().filter(|x| !x.is_nan()).count()
}

properties! {
    CASES;

    /// N1, N2 and (46), counted: slots that hold a number, and indices that are listed.
    #[test]
    fn counts_on_serial_chains(case in all_cases(12).prop_map(serial)) {
        let (tree, n) = (Tree::from(&case.robot()), case.parts.len());
        let mut ours = MassMatrixDerivatives::<f64>::new(&tree);
        prop_assert_eq!(computed(ours.stored_mass_second()), 0);
        ours.update(&tree, &case.q).unwrap();
        let n1 = (n - 1) * n * (n + 1) / 3;
        let n2 = (n - 1) * n * (n + 1) * (3 * n + 2) / 24;
        for (stored, count) in [
            (ours.stored_gamma(), n1),
            (ours.stored_mass_first(), n1),
            (ours.stored_gamma_derivatives(), n2),
            (ours.stored_mass_second(), n2),
        ] {
            prop_assert_eq!((computed(stored), stored.len()), (count, count));
        }
        let derivatives = IndexSets::new(&tree).gamma_derivatives();
        let [mut a, mut b, mut c] = [0; 3];
        for [k, i, j, l] in derivatives {
            if l < j { c += 1 } else if i < k { a += 1 } else { b += 1 }
        }
        prop_assert_eq!(a, (n - 1) * n * (n + 1) * (n + 2) / 24);
        prop_assert_eq!(b, a);
        prop_assert_eq!(c, (n.max(2) - 2) * (n - 1) * n * (n + 1) / 24);
    }

    /// Every listed index once, in the order of storage, and every accessor in every order of its indices.
    #[test]
    fn accessors_take_every_index(case in all_cases(6)) {
        let bench = Bench::new(&case);
        let (n, ours, sets) = (bench.n(), &bench.ours, IndexSets::new(&bench.tree));
        for ([k, i, j], &x) in sets.gamma().iter().zip(ours.stored_gamma()) {
            prop_assert_eq!(ours.gamma(*k, *i, *j), x);
        }
        for ([i, j, k], &x) in sets.mass_first().iter().zip(ours.stored_mass_first()) {
            prop_assert_eq!(ours.mass_first(*i, *j, *k), x);
        }
        for ([k, i, j, l], &x) in sets.gamma_derivatives().iter().zip(ours.stored_gamma_derivatives()) {
            prop_assert_eq!(ours.gamma_derivative(*k, *i, *j, *l), x);
        }
        for ([i, j, k, l], &x) in sets.mass_second().iter().zip(ours.stored_mass_second()) {
            prop_assert_eq!(ours.mass_second(*i, *j, *k, *l), x);
        }
        fn distinct<T: Ord>(mut set: Vec<T>, stored: &[f64]) -> bool {
            set.sort();
            set.dedup();
            set.len() == stored.len()
        }
        prop_assert!(distinct(sets.gamma(), ours.stored_gamma()));
        prop_assert!(distinct(sets.mass_first(), ours.stored_mass_first()));
        prop_assert!(distinct(sets.gamma_derivatives(), ours.stored_gamma_derivatives()));
        prop_assert!(distinct(sets.mass_second(), ours.stored_mass_second()));
        let one_branch = |joints: &[usize]| {
            joints.iter().all(|&a| joints.iter().all(|&b| bench.le(a, b) || bench.le(b, a)))
        };
        for at @ [i, j, k] in triples(n) {
            bench.first_is(ours.mass_first(i, j, k), bench.m(i, j, k), "M_ij,k", &at)?;
            bench.first_is(ours.christoffel_symbol(i, j, k), bench.symbol(k, i, j), "[ij,k]", &at)?;
            prop_assert_eq!(ours.mass_first(i, j, k), ours.mass_first(j, i, k));
            prop_assert_eq!(ours.christoffel_symbol(i, j, k), ours.christoffel_symbol(j, i, k));
            prop_assert!(one_branch(&at) || (ours.mass_first(i, j, k) == 0.0 && ours.gamma(k, i, j) == 0.0));
        }
        for at @ [i, j, k, l] in quadruples(n) {
            let second = ours.mass_second(i, j, k, l);
            bench.second_is(second, bench.mm(i, j, k, l), "M_ij,kl", &at)?;
            bench.second_is(ours.gamma_derivative(k, i, j, l), bench.gg(k, i, j, l), "Gamma^k_ij,l", &at)?;
            prop_assert_eq!(second, ours.mass_second(j, i, k, l));
            prop_assert_eq!(second, ours.mass_second(i, j, l, k));
            prop_assert_eq!(ours.gamma_derivative(k, i, j, l), ours.gamma_derivative(j, i, k, l));
            prop_assert!(one_branch(&at) || (second == 0.0 && ours.gamma_derivative(k, i, j, l) == 0.0));
        }
    }
}

/// Numbers of M,k and M,kl that are computed.
fn numbers(tree: &Tree) -> [usize; 2] {
    let mut ours = MassMatrixDerivatives::<f64>::new(tree);
    let q: Vec<f64> = (0..tree.dof()).map(|i| 0.3 + i as f64).collect();
    ours.update(tree, &q).unwrap();
    [computed(ours.stored_mass_first()), computed(ours.stored_mass_second())]
}

#[test]
fn counts_of_the_paper_and_fewer_on_trees() {
    assert_eq!(numbers(&revolute(6, |i| i.checked_sub(1))), [70, 175]);
    assert_eq!(numbers(&revolute(12, |i| i.checked_sub(1))), [572, 2717]);
    // Two arms of three joints on a trunk of six; twelve joints side by side.
    let arms = |i: usize| if i == 9 { Some(5) } else { i.checked_sub(1) };
    let [first, second] = numbers(&revolute(12, arms));
    assert!(first < 572 && second < 2717, "{first} {second}");
    // Those of two chains of nine less those of the trunk, which both share.
    assert_eq!([first, second], [2 * 240 - 70, 2 * 870 - 175]);
    assert_eq!(numbers(&revolute(12, |_| None)), [0, 0]);
}

#[test]
#[should_panic(expected = "index out of bounds")]
fn an_index_beyond_the_last_joint_panics() {
    let tree = revolute(3, |i| i.checked_sub(1));
    MassMatrixDerivatives::<f64>::new(&tree).mass_second(0, 1, 2, 3);
}
