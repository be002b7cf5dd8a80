//! Properties of the two kernels by themselves.

use costate::kernels::{KernelOne, KernelTwo};
use costate::robot::Tree;
use costate::scalar::{Count, Operations, Scalar, Tangent, count};
use costate_test_support::random_robot::{Case, all_cases};
use costate_test_support::rounding::lift;
use costate_test_support::{properties, rounding};
use proptest::prelude::*;

fn kernel_one<S: Scalar>(tree: &Tree, q: &[S], v: &[S]) -> KernelOne<S> {
    let mut kernel = KernelOne::new(tree);
    kernel.set_position(tree, q).unwrap();
    kernel.set_velocity(tree, v).unwrap();
    kernel.second_order(tree);
    kernel
}

properties! {
    256;

    /// D M, D P and D L_qq by hand and by a dual number through kernel one.
    #[test]
    fn kernel_two_is_the_derivative_of_kernel_one(case in all_cases(12)) {
        let Case { q, v, u: dv, .. } = &case;
        let dq = &case.y[..case.n()];
        let tree = Tree::from(&case.robot());
        rounding!(|S| {
            let [q, v, dq, dv] = [&q[..], v, dq, dv].map(lift::<S>);
            let moving = |x: &[S], d: &[S]| x.iter().zip(d).map(|(&x, &d)| Tangent::new(x, d)).collect::<Vec<_>>();
            let dual = kernel_one(&tree, &moving(&q, &dq), &moving(&v, &dv));
            let mut two = KernelTwo::new(&tree);
            two.differentiate(&tree, &kernel_one(&tree, &q, &v), &dq, &dv).unwrap();
            let pairs = [("D M", two.mass_matrix(), dual.mass_matrix()), ("D P", two.l_vq(), dual.l_vq()), ("D L_qq", two.l_qq(), dual.l_qq())];
            let off = |(name, by_hand, dual): (_, &costate::matrix::Matrix<S>, &costate::matrix::Matrix<Tangent<S>>)| {
                (name, by_hand.as_slice().iter().zip(dual.as_slice()).map(|(&a, b)| a - b.eps).collect())
            };
            pairs.map(off).to_vec()
        })?;
        let mut two = KernelTwo::new(&tree);
        two.differentiate(&tree, &kernel_one(&tree, q, v), dq, dv).unwrap();
        prop_assert_eq!(two.l_qq().view().to_nalgebra(), two.l_qq().view().to_nalgebra().transpose());
        prop_assert_eq!(two.mass_matrix().view().to_nalgebra(), two.mass_matrix().view().to_nalgebra().transpose());
    }
}

/// By hand a direction costs less than what a dual number through kernel one adds to it.
#[test]
fn kernel_two_costs_less_than_a_dual_number() {
    for file in ["ur5.urdf", "puma560.toml", "biped.toml"] {
        let robot = costate::robot::Robot::from_file(format!("robots/{file}")).unwrap();
        let tree = Tree::from(&robot);
        let numbers =
            |size: f64| (0..tree.dof()).map(|i| Count::variable((size * i as f64).cos())).collect::<Vec<_>>();
        let [q, v, dq, dv] = [0.7, 1.9, 2.3, 3.1].map(numbers);
        let (kernel, one) = count(|| kernel_one(&tree, &q, &v));
        let mut kernel_two = KernelTwo::new(&tree);
        let (_, two) = count(|| kernel_two.differentiate(&tree, &kernel, &dq, &dv).unwrap());
        let dual =
            |x: &[Count], d: &[Count]| x.iter().zip(d).map(|(&x, &d)| Tangent::new(x, d)).collect::<Vec<_>>();
        let (_, both) = count(|| kernel_one(&tree, &dual(&q, &dq), &dual(&v, &dv)));
        let total = |o: &Operations| o.mul + o.add;
        println!(
            "{file}: kernel one {one:?}
  two {two:?}
  dual {both:?}"
        );
        let added = total(&both) - total(&one);
        assert!(10 * total(&two) < 9 * added, "{file}: {one:?} {two:?} {both:?}");
        assert_eq!(two.sincos + two.div + two.sqrt, 0);
    }
}
