//! Canonical coordinates against Hamilton's equation by dual numbers, and their derivatives.

use super::tests::{check_driven, sample, trees};
use super::*;
use crate::configuration::samples::{link, random, robots};
use crate::hamiltonian::Hamiltonian;
use crate::robot::JointSpec;
use num_dual::Dual64;

/// (q, P) with quaternions of any length and P along them too, u and y.
fn phase(robot: &Robot) -> [Vec<f64>; 3] {
    let ([mut x, u, _], nq) = (sample(robot), robot.nq());
    x.truncate(nq);
    x.extend((0..nq).map(|i| 2.0 * (0.4 + 1.9 * i as f64).cos()));
    let y = (0..2 * nq).map(|i| (2.0 + 1.7 * i as f64).sin()).collect();
    [x, u, y]
}

#[test]
fn derivatives_are_those_of_hyper_dual_numbers() {
    for robot in robots().into_iter().chain((4..10).map(random)) {
        let [x, u, y] = phase(&robot);
        check_driven(&robot, QuaternionDynamics::canonical(&robot), [&x, &u, &y], &|x, tau| {
            QuaternionDynamics::canonical(&robot).evaluate(x, tau).unwrap().to_vec()
        });
    }
}

/// (q, p) of (q, P), written entry by entry: `pi = vec(conj(a) o P_a) / 2`, `p_v = R' P_r`.
fn of_phase<S: Scalar>(robot: &Robot, x: &[S]) -> [Vec<S>; 2] {
    let nq = robot.nq();
    let (mut q, mut p) = (x[..nq].to_vec(), Vec::new());
    let mut i = 0;
    for free in robot.free_joints() {
        let (first, at) = (free.position, free.quaternion());
        p.extend_from_slice(&x[nq + i..nq + first]);
        let length = q[at..at + 4].iter().fold(S::zero(), |sum, &a| sum + a * a).sqrt();
        q[at..at + 4].iter_mut().for_each(|a| *a = *a / length);
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| q[at + k]);
        if at > first {
            let r = [
                [
                    S::one() - (b * b + c * c).times(2.0),
                    (a * b - c * d).times(2.0),
                    (a * c + b * d).times(2.0),
                ],
                [
                    (a * b + c * d).times(2.0),
                    S::one() - (a * a + c * c).times(2.0),
                    (b * c - a * d).times(2.0),
                ],
                [
                    (a * c - b * d).times(2.0),
                    (b * c + a * d).times(2.0),
                    S::one() - (a * a + b * b).times(2.0),
                ],
            ];
            let column = |j: usize| (0..3).fold(S::zero(), |sum, i| sum + r[i][j] * x[nq + first + i]);
            p.extend([column(0), column(1), column(2)]);
        }
        let [e, f, g, h] = [0, 1, 2, 3].map(|k| x[nq + at + k] * length.times(0.5));
        p.push(d * e - a * h - b * g + c * f);
        p.push(d * f - b * h - c * e + a * g);
        p.push(d * g - c * h - a * f + b * e);
        i = at + 4;
    }
    p.extend_from_slice(&x[nq + i..]);
    [q, p]
}

#[test]
fn f_is_that_of_hamilton() {
    for robot in trees().filter(|robot| robot.joints().iter().all(|joint| joint.friction.is_none())) {
        let ([x, ..], nq) = (phase(&robot), robot.nq());
        let mut energy = Hamiltonian::<Dual64>::new(&robot);
        let slopes: Vec<f64> = (0..2 * nq)
            .map(|k| {
                let number = |(i, &x): (usize, &f64)| Dual64::new(x, f64::from(u8::from(i == k)));
                let moved: Vec<Dual64> = x.iter().enumerate().map(number).collect();
                let [q, p] = of_phase(&robot, &moved);
                energy.hamiltonian(&q, &p).unwrap().eps
            })
            .collect();
        let expected: Vec<f64> =
            slopes[nq..].iter().copied().chain(slopes[..nq].iter().map(|slope| -slope)).collect();
        let mut model = QuaternionDynamics::<f64>::canonical(&robot);
        let found = model.evaluate(&x, &vec![0.0; robot.dof()]).unwrap();
        let most = expected.iter().fold(1.0, |most: f64, entry| most.max(entry.abs()));
        for (k, (found, expected)) in found.iter().zip(&expected).enumerate() {
            let error = (found - expected).abs() / most;
            assert!(error < 1e-12, "{}: {k}: {found} {expected}", robot.name());
        }
    }
}

/// Torques do the work u . v in any coordinates, and none along a.
#[test]
fn controls_do_their_work() {
    for robot in trees() {
        let ([x, u, _], nq) = (phase(&robot), robot.nq());
        let mut model = QuaternionDynamics::<f64>::canonical(&robot);
        let rate = model.evaluate(&x, &u).unwrap()[..nq].to_vec();
        let linear = model.linearise(&x, &u).unwrap();
        let forces: Vec<f64> =
            (0..2 * nq).map(|i| linear.f_u.row(i).iter().zip(&u).map(|(by_u, u)| by_u * u).sum()).collect();
        assert!(forces[..nq].iter().all(|&force| force == 0.0));
        let [q, p] = of_phase(&robot, &x);
        let mut momenta = Hamiltonian::<f64>::new(&robot);
        let v = momenta.velocity(&q, &p).unwrap();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let size = dot(
            &rate.iter().map(|v| v.abs()).collect::<Vec<_>>(),
            &forces[nq..].iter().map(|f| f.abs()).collect::<Vec<_>>(),
        );
        assert!((dot(&rate, &forces[nq..]) - dot(v, &u)).abs() < 1e-12 * (1.0 + size), "{}", robot.name());
        for free in robot.free_joints() {
            let a = free.quaternion();
            assert!(dot(&x[a..a + 4], &forces[nq + a..nq + a + 4]).abs() < 1e-12 * (1.0 + size));
        }
    }
}

/// Without free joints it is the model itself, with f_u constant.
#[test]
fn plain_joints_are_as_they_are() {
    let robot = Robot::builder("hinge").joint(JointSpec::revolute("a").carrying(link(0.3))).build().unwrap();
    let mut plain = QuaternionDynamics::<f64>::new(&robot);
    let mut model = QuaternionDynamics::<f64>::canonical(&robot);
    assert_eq!(model.structure(), plain.structure());
    assert_eq!(model.evaluate(&[0.3, 0.4], &[0.5]), plain.evaluate(&[0.3, 0.4], &[0.5]));
}
