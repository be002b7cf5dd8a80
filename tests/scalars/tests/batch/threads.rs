//! Threads of a pool.

use crate::arrays::{Arrays, agree, gimbal, robot};
use costate::batch::{Batch, Model, Packed};
use costate::hamiltonian::HamiltonianSecondOrder;
use std::f64::consts::FRAC_PI_2;

/// The number of threads changes not a bit, nor do bad nodes depend on it.
#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    fn check<S: Packed<Lane = f64>>() {
        let robot = gimbal();
        for nodes in [0, 1, 5, 64, 333] {
            let mut arrays = Arrays::new(6, 3, nodes);
            for k in (0..nodes).step_by(50) {
                arrays.x[6 * k + 1] = FRAC_PI_2;
            }
            let mut expected = arrays.clone();
            let failures =
                expected.evaluate(&mut Batch::<S, _>::new(Model(HamiltonianSecondOrder::new(&robot))));
            assert_eq!(failures.len(), nodes.div_ceil(50));
            for threads in [1, 2, 3, 8] {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| {
                    let mut batch = Batch::<S, _>::parallel(|| Model(HamiltonianSecondOrder::new(&robot)));
                    assert_eq!(batch.threads(), threads);
                    for _ in 0..3 {
                        let mut found = arrays.clone();
                        assert_eq!(found.evaluate(&mut batch), failures);
                        let bits = |arrays: &Arrays| -> Vec<u64> {
                            arrays
                                .results
                                .iter()
                                .chain(&arrays.adjoint)
                                .flatten()
                                .map(|x| x.to_bits())
                                .collect()
                        };
                        assert!(bits(&found) == bits(&expected), "{nodes} nodes on {threads} threads");
                    }
                });
            }
        }
    }
    check::<f64>();
    #[cfg(feature = "wide")]
    check::<costate::scalar::F64x4>();
}

/// Built in one pool, called in a larger one and from outside: slower, never wrong.
#[test]
fn a_batch_may_be_called_from_another_pool() {
    let robot = robot("two_link.toml");
    let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let mut batch =
        pool(2).install(|| Batch::<f64, _>::parallel(|| Model(HamiltonianSecondOrder::new(&robot))));
    let mut arrays = Arrays::new(4, 2, 500);
    assert!(pool(5).install(|| arrays.evaluate(&mut batch)).is_empty());
    agree(&mut HamiltonianSecondOrder::new(&robot), &arrays, 0.0);
    assert!(arrays.evaluate(&mut batch).is_empty());
    agree(&mut HamiltonianSecondOrder::new(&robot), &arrays, 0.0);
}
