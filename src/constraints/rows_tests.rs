//! Jacobians, Hessians and wrenches of the rows.

use super::super::samples::{looped, state};
use super::*;
use num_dual::{Dual64, HyperDual64};

fn lift<S: Scalar>(q: &[f64]) -> Vec<S> {
    q.iter().map(|&q| S::from_f64(q)).collect()
}

#[test]
fn gradients_and_hessians_are_those_of_hyper_dual_numbers() {
    for robot in looped() {
        let [q, ..] = state(robot.dof());
        let (n, mut ours) = (robot.dof(), Constraints::<f64>::new(&robot));
        let mut judge = Constraints::<HyperDual64>::new(&robot);
        ours.set_position(&q).unwrap();
        let mu: Vec<f64> = (0..ours.count()).map(|i| (1.0 + 0.9 * i as f64).sin()).collect();
        let hessian = ours.hessian(&mu).unwrap().clone();
        for i in 0..n {
            for j in 0..=i {
                let mut seeds: Vec<HyperDual64> = lift(&q);
                seeds[i].eps1 = 1.0;
                seeds[j].eps2 = 1.0;
                judge.set_position(&seeds).unwrap();
                let g = judge.values();
                for (r, value) in g.iter().enumerate() {
                    assert!((value.re - ours.values()[r]).abs() < 1e-14);
                    assert!(
                        (value.eps1 - ours.jacobian()[(r, i)]).abs() < 1e-13,
                        "{}: J {r} {i}",
                        robot.name()
                    );
                }
                let expected: f64 = g.iter().zip(&mu).map(|(g, mu)| g.eps1eps2 * mu).sum();
                for found in [hessian[(i, j)], hessian[(j, i)]] {
                    assert!(
                        (found - expected).abs() < 1e-13,
                        "{}: {i} {j}: {found} {expected}",
                        robot.name()
                    );
                }
            }
        }
    }
}

/// Power of the wrench on the first frame, with the twist of that frame relative to the second.
#[test]
fn wrenches_have_the_power_of_the_multipliers() {
    for robot in looped() {
        let [q, v, lambda, _] = state(robot.dof());
        let mut moving = Constraints::<Dual64>::new(&robot);
        let along: Vec<Dual64> = q.iter().zip(&v).map(|(&q, &v)| Dual64::new(q, v)).collect();
        moving.set_position(&along).unwrap();
        let lambda: Vec<f64> = lambda.iter().cycle().take(moving.count()).copied().collect();
        for k in 0..robot.constraints().len() {
            let rows = moving.rows(k);
            let expected: f64 = rows.map(|r| lambda[r] * moving.values()[r].eps).sum();
            let lifted: Vec<Dual64> = lift(&lambda);
            let Some((force, moment)) = moving.wrench(k, &lifted) else { continue };
            let [at, turning] = moving.held[k].relative_rate();
            let power = |a: [Dual64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a.re * b).sum::<f64>();
            let found = power(force, at) + power(moment, turning);
            assert!((found - expected).abs() < 1e-12, "{}: {found} {expected}", robot.name());
        }
    }
}
