//! Constraints.

use crate::robot;
use costate::constraints::{ConstrainedHamiltonianSecondOrder, Constraints};
use costate_test_support::allocations::allocations;

#[test]
fn constraints_do_not_allocate() {
    for name in ["four_bar.toml", "delta.toml"] {
        let robot = robot(name);
        let n = robot.dof();
        let (q, p, y) = (vec![0.3; n], vec![0.7; n], vec![0.4; 2 * n]);
        let mut second = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
        let mut rows = Constraints::<f64>::new(&robot);
        let mu = vec![0.2; rows.count()];
        let count = allocations(|| {
            second.contract(&q, &p, &p, &y).unwrap();
            second.hessian_product(&q, &p, &y, &y).unwrap();
            let first = second.first();
            first.evaluate(&q, &p, &p).unwrap();
            first.linearise(&q, &p, &p).unwrap();
            first.adjoint(&q, &p, &p, &y).unwrap();
            first.energy(&q, &p).unwrap();
            first.velocity(&q, &p).unwrap();
            first.momentum(&q, &p).unwrap();
            first.drift(&q, &p).unwrap();
            first.constraint_rate(&q, &p).unwrap();
            rows.set_position(&q).unwrap();
            rows.hessian(&mu).unwrap();
            rows.wrench(0, &mu).unwrap();
        });
        assert_eq!(count, 0, "{name}");
    }
}
