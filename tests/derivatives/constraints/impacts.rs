//! Impacts, and accelerations with forces, on random trees with random constraints.

use super::{choices, closed};
use costate::constraints::{ConstrainedLagrangian, ConstrainedLagrangianSecondOrder, Impact};
use costate::scalar::{Scalar, Tangent};
use costate_test_support::random_robot::cases;
use costate_test_support::rounding::{apart, lift, rows, times};
use costate_test_support::{properties, rounding};
use proptest::prelude::*;

properties! {
    96;

    /// The impulses change the momentum as they act, the constraints hold after them, and energy is lost.
    #[test]
    fn impacts_balance_and_lose_energy(case in cases(8), choices in choices(3)) {
        let robot = closed(&case, &choices, true);
        rounding!(|S| {
            let [q, v] = [&case.q[..], &case.v].map(lift::<S>);
            let mut impact = Impact::<S>::new(&robot);
            let p = impact.hamiltonian().momentum(&q, &v).unwrap().to_vec();
            let after = impact.evaluate(&q, &p).unwrap();
            let (v_after, p_after, loss) = (after.velocity.to_vec(), after.momentum.to_vec(), after.loss);
            let moved = apart(&p_after, impact.hamiltonian().momentum(&q, &v_after).unwrap());
            let rates = impact.hamiltonian().constraint_rate(&q, &v_after).unwrap().to_vec();
            // Half of the product of the change of the velocity and of the impulse.
            let twice = |sum: S, (&p, &v): (&S, &S)| sum + p * v;
            let before = p.iter().zip(&v).fold(S::zero(), twice);
            let lost = before - p_after.iter().zip(&v_after).fold(S::zero(), twice);
            vec![("p+ - M v+", moved), ("J v+", rates), ("loss", vec![lost.times(0.5) - loss])]
        })?;
        let mut impact = Impact::<f64>::new(&robot);
        let p = impact.hamiltonian().momentum(&case.q, &case.v).unwrap().to_vec();
        let loss = impact.evaluate(&case.q, &p).unwrap().loss;
        prop_assert!(loss >= 0.0, "{loss}");
    }

    /// First and second derivatives along two directions, by dual numbers in dual numbers.
    #[test]
    fn accelerations_and_forces_have_exact_derivatives(
        case in cases(6),
        choices in choices(2),
        seed in 0.0..10.0_f64,
    ) {
        let robot = closed(&case, &choices, true);
        let n = robot.dof();
        let wave = |from: f64, count: usize| -> Vec<f64> {
            (0..count).map(|i| (from + seed + 1.3 * i as f64).sin()).collect()
        };
        rounding!(|S| {
            let z = lift::<S>(&[&case.q[..], &case.v, &case.u].concat());
            let mut second = ConstrainedLagrangianSecondOrder::<S>::new(&robot);
            let k = second.constrained().constraints().count();
            let [e, c, along, across] =
                [(0.2, n), (1.2, k), (2.1, 3 * n), (0.7, 3 * n)].map(|(from, count)| lift::<S>(&wave(from, count)));
            let all = second.contract([&z[..n], &z[n..2 * n], &z[2 * n..]], &e, &c).unwrap();
            let linear = all.linearisation();
            let found = [linear.acceleration(), linear.lambda()].concat();
            let slopes = times(&[rows(linear.a_z()), rows(linear.lambda_z())].concat(), &along);
            let bent = times(&rows(all.matrix()), &across);
            let seed = |i: usize| Tangent::new(Tangent::new(z[i], along[i]), Tangent::new(across[i], S::zero()));
            let seeds: Vec<_> = (0..3 * n).map(seed).collect();
            let mut judge = ConstrainedLagrangian::<Tangent<Tangent<S>>>::new(&robot);
            let (a, lambda) = judge.evaluate(&seeds[..n], &seeds[n..2 * n], &seeds[2 * n..]).unwrap();
            let expected = [a, lambda].concat();
            let of = |part: fn(&Tangent<Tangent<S>>) -> S| expected.iter().map(part).collect::<Vec<S>>();
            let weights = [e, c].concat();
            let curvature = along.iter().zip(&bent).fold(S::zero(), |sum, (&d, &bent)| sum + d * bent);
            let bends = of(|x| x.eps.eps).into_iter().zip(&weights);
            vec![
                ("a, lambda", apart(&found, &of(|x| x.re.re))),
                ("a_z d, lambda_z d", apart(&slopes, &of(|x| x.re.eps))),
                ("d'(e'a + c'lambda)_zz d", vec![bends.fold(curvature, |rest, (x, &w)| rest - x * w)]),
            ]
        })?;
    }
}
