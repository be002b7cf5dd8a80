//! Every relation between the coefficients, by itself.

use super::CASES;
use super::bench::{Bench, quadruples, revolute, serial, triples};
use costate::tensors::{IndexSets, MassMatrixDerivatives};
use costate_test_support::properties;
use costate_test_support::random_robot::all_cases;
use proptest::prelude::*;

properties! {
    CASES;

    /// (28b) Gamma_{i,jk} = -Gamma_{k,ji} for j <= min(i, k).
    #[test]
    fn relation_28b_antisymmetry_under_its_condition(case in all_cases(7)) {
        let bench = Bench::new(&case);
        for [i, j, k] in triples(bench.n()) {
            let (left, right) = (bench.symbol(i, j, k), bench.symbol(k, j, i));
            bench.first_is(bench.ours.gamma(k, i, j), left, "Gamma_{i,jk}", &[i, j, k])?;
            if bench.le(j, i) && bench.le(j, k) {
                bench.first_is(left, -right, "(28b)", &[i, j, k])?;
            }
        }
    }

    /// (36) M,k = Gamma^k + Gamma^k'.
    #[test]
    fn relation_36_derivative_of_mass_matrix(case in all_cases(7)) {
        let bench = Bench::new(&case);
        for [i, j, k] in triples(bench.n()) {
            let sum = bench.ours.gamma(k, i, j) + bench.ours.gamma(k, j, i);
            bench.first_is(sum, bench.m(i, j, k), "(36)", &[i, j, k])?;
        }
    }

    /// (37) M,kl = Gamma^k,l + Gamma^k,l'.
    #[test]
    fn relation_37_second_derivative_of_mass_matrix(case in all_cases(6)) {
        let bench = Bench::new(&case);
        for [i, j, k, l] in quadruples(bench.n()) {
            let sum = bench.ours.gamma_derivative(k, i, j, l) + bench.ours.gamma_derivative(k, j, i, l);
            bench.second_is(sum, bench.mm(i, j, k, l), "(37)", &[i, j, k, l])?;
            let by_dual = bench.gg(k, i, j, l) + bench.gg(k, j, i, l);
            bench.second_is(by_dual, bench.mm(i, j, k, l), "(37) by dual numbers", &[i, j, k, l])?;
        }
    }

    /// (39) M_ii,k, M_ij,k, M_ik,k and M_ij,k (k < j) from Gamma; and what is stored.
    #[test]
    fn relation_39_first_derivatives_from_coefficients(case in all_cases(7)) {
        let bench = Bench::new(&case);
        let g = |k, i, j| bench.ours.gamma(k, i, j);
        let mut count = 0;
        for [i, j, k] in triples(bench.n()) {
            if !(bench.le(i, j) && bench.lt(i, k) && (bench.le(j, k) || bench.le(k, j))) {
                continue;
            }
            let relation = if i == j {
                2.0 * g(i, i, k)
            } else if bench.lt(j, k) {
                g(j, i, k) + g(i, j, k)
            } else if j == k {
                g(k, i, k)
            } else {
                g(k, i, j) - g(i, k, j)
            };
            bench.first_is(relation, bench.m(i, j, k), "(39)", &[i, j, k])?;
            bench.first_is(bench.ours.mass_first(i, j, k), bench.m(i, j, k), "stored M_ij,k", &[i, j, k])?;
            count += 1;
        }
        prop_assert_eq!(count, bench.ours.stored_mass_first().len());
    }

    /// (40) Gamma from M,k: i < k, i < k < j, k < j, k < i < j.
    #[test]
    fn relation_40_coefficients_from_first_derivatives(case in all_cases(7)) {
        let bench = Bench::new(&case);
        for [i, j, k] in triples(bench.n()) {
            if !(bench.lt(i, j) && bench.le(k, j)) {
                continue;
            }
            let relation = if k == j {
                bench.m(i, k, k)
            } else if bench.lt(i, k) {
                0.5 * (bench.m(i, k, j) + bench.m(i, j, k))
            } else if i == k {
                0.5 * bench.m(k, k, j)
            } else {
                0.5 * (bench.m(k, i, j) - bench.m(k, j, i))
            };
            bench.first_is(bench.ours.gamma(k, i, j), relation, "(40)", &[i, j, k])?;
        }
    }

    /// (41) M_ij,kl from Gamma^k_ij,l by dual numbers; and what is stored.
    #[test]
    fn relation_41_second_derivatives_from_derivatives_of_coefficients(case in all_cases(6)) {
        let bench = Bench::new(&case);
        let g = |k, i, j, l| bench.gg(k, i, j, l);
        let mut count = 0;
        for [i, j, k, l] in quadruples(bench.n()) {
            let related = bench.le(j, l) || bench.le(l, j);
            let j_and_k = bench.le(j, k) || bench.le(k, j);
            if !(bench.le(i, j) && bench.lt(i, k) && bench.le(k, l) && related && j_and_k) {
                continue;
            }
            let relation = if i == j {
                2.0 * g(i, i, k, l)
            } else if bench.lt(j, k) {
                g(j, i, k, l) + g(i, j, k, l)
            } else if j == k {
                g(k, i, k, l)
            } else {
                g(k, i, j, l) - g(i, k, j, l)
            };
            bench.second_is(relation, bench.mm(i, j, k, l), "(41)", &[i, j, k, l])?;
            let stored = bench.ours.mass_second(i, j, k, l);
            bench.second_is(stored, bench.mm(i, j, k, l), "stored M_ij,kl", &[i, j, k, l])?;
            count += 1;
        }
        prop_assert_eq!(count, bench.ours.stored_mass_second().len());
    }

    /// (42) the relations (40), differentiated.
    #[test]
    fn relation_42_derivatives_of_coefficients_from_second_derivatives(case in all_cases(6)) {
        let bench = Bench::new(&case);
        for [i, j, k, l] in quadruples(bench.n()) {
            if !(bench.lt(i, j) && bench.le(k, j)) {
                continue;
            }
            let relation = if k == j {
                bench.mm(i, k, k, l)
            } else if bench.lt(i, k) {
                0.5 * (bench.mm(i, k, j, l) + bench.mm(i, j, k, l))
            } else if i == k {
                0.5 * bench.mm(k, k, j, l)
            } else {
                0.5 * (bench.mm(k, i, j, l) - bench.mm(k, j, i, l))
            };
            bench.second_is(bench.gg(k, i, j, l), relation, "(42)", &[k, i, j, l])?;
            let ours = bench.ours.gamma_derivative(k, i, j, l);
            bench.second_is(ours, relation, "Gamma^k_ij,l", &[k, i, j, l])?;
        }
    }

    /// (43) Gamma^k_ij,l = Gamma^k_il,j + Gamma^i_kl,j - Gamma^i_kj,l for k < i < l < j.
    #[test]
    fn relation_43_dependent_derivatives(case in all_cases(7).prop_map(serial)) {
        let bench = Bench::new(&case);
        let g = |k, i, j, l| bench.gg(k, i, j, l);
        for [i, j, k, l] in quadruples(bench.n()) {
            if bench.lt(k, i) && bench.lt(i, l) && bench.lt(l, j) {
                let relation = g(k, i, l, j) + g(i, k, l, j) - g(i, k, j, l);
                bench.second_is(g(k, i, j, l), relation, "(43)", &[k, i, j, l])?;
                let stored = |k, i, j, l| bench.ours.gamma_derivative(k, i, j, l);
                let relation = stored(k, i, l, j) + stored(i, k, l, j) - stored(i, k, j, l);
                bench.second_is(g(k, i, j, l), relation, "(43) from what is stored", &[k, i, j, l])?;
            }
        }
    }

    /// (44) Gamma^k_ij,i = Gamma^i_ki,j - Gamma^i_kj,i for k < i < j.
    #[test]
    fn relation_44_dependent_derivatives(case in all_cases(7)) {
        let bench = Bench::new(&case);
        let g = |k, i, j, l| bench.gg(k, i, j, l);
        for [i, j, k] in triples(bench.n()) {
            if bench.lt(k, i) && bench.lt(i, j) {
                bench.second_is(g(k, i, j, i), g(i, k, i, j) - g(i, k, j, i), "(44)", &[k, i, j])?;
                let stored = |k, i, j, l| bench.ours.gamma_derivative(k, i, j, l);
                let relation = stored(i, k, i, j) - stored(i, k, j, i);
                bench.second_is(g(k, i, j, i), relation, "(44) from what is stored", &[k, i, j])?;
            }
        }
    }

    /// (45), (59), (60): the independent derivatives, as they are stored, are derivatives of the
    /// coefficients.
    #[test]
    fn relation_45_independent_derivatives(case in all_cases(7)) {
        let bench = Bench::new(&case);
        let sets = IndexSets::new(&bench.tree);
        for ([k, i, j, l], &stored) in
            sets.gamma_derivatives().into_iter().zip(bench.ours.stored_gamma_derivatives())
        {
            let first = bench.lt(i, k) && bench.le(k, j) && bench.le(j, l);
            let second = bench.le(k, i) && bench.lt(i, j) && bench.le(j, l);
            let third = bench.lt(i, k) && bench.le(k, l) && bench.lt(l, j);
            prop_assert!(u8::from(first) + u8::from(second) + u8::from(third) == 1, "{:?}", [k, i, j, l]);
            bench.second_is(stored, bench.gg(k, i, j, l), "Gamma^k_ij,l", &[k, i, j, l])?;
        }
    }
}

/// Without its condition (28b) is wrong: Gamma_{i,jk} = -Gamma_{k,ji} fails for j beyond i or k.
#[test]
fn relation_28b_needs_its_condition() {
    let tree = revolute(3, |i| i.checked_sub(1));
    let mut ours = MassMatrixDerivatives::<f64>::new(&tree);
    ours.update(&tree, &[0.3, -0.7, 1.1]).unwrap();
    let gamma = |i: usize, j: usize, k: usize| ours.gamma(j, i, k);
    for [i, j, k] in triples(3) {
        let sum = (gamma(i, j, k) + gamma(k, j, i)).abs();
        assert_eq!(sum <= 1e-14, j <= i.min(k), "Gamma_{{{i},{j}{k}}}: {sum}");
    }
}
