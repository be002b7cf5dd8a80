//! Robots with quaternions as plain states.

use crate::robot;
use costate::dynamics::{Dynamics, QuaternionDynamics};
use costate_test_support::allocations::allocations;

#[test]
fn quaternions_as_states_do_not_allocate() {
    let robot = robot("../tests/fixtures/free_tree.toml");
    let mut model = QuaternionDynamics::<f64>::new(&robot);
    let (size, n) = (model.states(), model.dof());
    let (x, u, y) = (vec![0.3; size], vec![0.1; n], vec![0.4; size]);
    let count = allocations(|| {
        model.evaluate(&x, &u).unwrap();
        model.linearise(&x, &u).unwrap();
        model.contract(&x, &u, &y).unwrap();
    });
    assert_eq!(count, 0);
}
