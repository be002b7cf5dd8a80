//! Quaternions as plain states against automatic differentiation of f, and f against the retraction.

use super::*;
use crate::configuration::ConfigurationSpace;
use crate::configuration::samples::{random, robots, state};
use crate::hamiltonian::Hamiltonian;
use nalgebra::DVector;
use num_dual::{Dual64, HyperDual64};

/// x with quaternions of other lengths than 1, u and y.
pub(super) fn sample(robot: &Robot) -> [Vec<f64>; 3] {
    let [q, p, u, _] = state(&ConfigurationSpace::new(robot));
    let mut x = [q, p].concat();
    for (k, free) in robot.free_joints().iter().enumerate() {
        let at = free.position + free.kind.slides();
        x[at..at + 4].iter_mut().for_each(|entry| *entry *= 1.3 - 0.2 * k as f64);
    }
    let y = (0..x.len()).map(|i| (2.0 + 1.7 * i as f64).sin()).collect();
    [x, u, y]
}

fn at<S: Scalar>(robot: &Robot, x: &[S], u: &[f64]) -> Vec<S> {
    let u: Vec<S> = u.iter().map(|&u| S::from_f64(u)).collect();
    QuaternionDynamics::<S>::new(robot).evaluate(x, &u).unwrap().to_vec()
}

/// The same in rates.
fn rates_at<S: Scalar>(robot: &Robot, x: &[S], u: &[S]) -> Vec<S> {
    QuaternionDynamics::in_rates(robot).evaluate(x, u).unwrap().to_vec()
}

/// Trees with free joints anywhere, and random ones.
pub(super) fn trees() -> impl Iterator<Item = Robot> {
    robots().into_iter().chain((4..40).map(random))
}

#[test]
fn derivatives_are_those_of_dual_and_hyper_dual_numbers() {
    for robot in trees() {
        let [x, u, y] = sample(&robot);
        let mut model = QuaternionDynamics::<f64>::new(&robot);
        let all = model.contract(&x, &u, &y).unwrap();
        let (f, f_x, xx) = (all.first.f.to_vec(), all.first.f_x.to_nalgebra(), all.xx.to_nalgebra());
        let linear = model.linearise(&x, &u).unwrap();
        // Beyond 12 joints by another kernel.
        let of_f = f.iter().fold(1.0, |most: f64, f| most.max(f.abs()));
        assert!(linear.f.iter().zip(&f).all(|(a, b)| (a - b).abs() < 1e-12 * of_f), "{}", robot.name());
        assert!((linear.f_x.to_nalgebra() - &f_x).amax() < 1e-12 * f_x.amax(), "{}", robot.name());
        let size = x.len();
        let (mut jacobian, mut hessian) = (DMatrix::zeros(size, size), DMatrix::zeros(size, size));
        for i in 0..size {
            for j in 0..=i {
                let mut moved: Vec<HyperDual64> = x.iter().map(|&x| HyperDual64::from_re(x)).collect();
                moved[i].eps1 = 1.0;
                moved[j].eps2 = 1.0;
                let value = at(&robot, &moved, &u);
                hessian[(i, j)] = value.iter().zip(&y).map(|(f, y)| y * f.eps1eps2).sum();
                hessian[(j, i)] = hessian[(i, j)];
                for (k, f) in value.iter().enumerate() {
                    jacobian[(k, i)] = f.eps1;
                }
            }
        }
        let close = |found: &DMatrix<f64>, expected: &DMatrix<f64>| {
            let error = (found - expected).amax() / expected.amax().max(1.0);
            assert!(error < 3e-12, "{}: {error:.1e}", robot.name());
        };
        close(&f_x, &jacobian);
        close(&xx, &hessian);
        let expected = DMatrix::from_column_slice(size, 1, &at(&robot, &x, &u));
        close(&DMatrix::from_column_slice(size, 1, &f), &expected);
    }
}

/// In rates, with controls that act on several coordinates: f_u and y'f_ux too.
#[test]
fn derivatives_in_rates_are_those_of_hyper_dual_numbers() {
    for robot in robots() {
        let [x, u, y] = sample(&robot);
        let dual = |x: &[HyperDual64], tau: &[HyperDual64]| rates_at(&robot, x, tau);
        check_driven(&robot, QuaternionDynamics::in_rates(&robot), [&x, &u, &y], &dual);
    }
}

/// f of hyper-dual x and tau.
type Dual<'a> = &'a dyn Fn(&[HyperDual64], &[HyperDual64]) -> Vec<HyperDual64>;

/// All first and second derivatives of a model with controls that act on several coordinates.
pub(super) fn check_driven<M: TangentModel<f64>>(
    robot: &Robot,
    model: QuaternionDynamics<f64, M>,
    [x, u, y]: [&[f64]; 3],
    dual: Dual<'_>,
) {
    let (n, size) = (robot.dof(), x.len());
    let b = DMatrix::from_fn(n, n, |i, j| if i == j { 1.0 } else { 0.3 * ((i + 2 * j) as f64).sin() });
    let mut model = model.with_actuation(&b).unwrap();
    let all = model.contract(x, u, y).unwrap();
    let whole = size + n;
    let (mut jacobian, mut hessian) = (vec![0.0; size * whole], vec![0.0; whole * whole]);
    all.first.jacobian(&mut jacobian);
    all.hessian(&mut hessian);
    let f = all.first.f.to_vec();
    let linear = model.linearise(x, u).unwrap();
    let mut again = vec![0.0; size * whole];
    linear.jacobian(&mut again);
    let largest = jacobian.iter().fold(1.0, |most: f64, entry| most.max(entry.abs()));
    assert!(again.iter().zip(&jacobian).all(|(a, b)| (a - b).abs() < 1e-11 * largest), "{}", robot.name());
    let found =
        [DMatrix::from_row_slice(size, whole, &jacobian), DMatrix::from_row_slice(whole, whole, &hessian)];
    let mut expected = [DMatrix::zeros(size, whole), DMatrix::zeros(whole, whole)];
    for (i, j) in (0..whole).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let mut z: Vec<HyperDual64> = x.iter().chain(u).map(|&z| HyperDual64::from_re(z)).collect();
        z[i].eps1 = 1.0;
        z[j].eps2 = 1.0;
        let tau: Vec<HyperDual64> =
            (0..n).map(|i| (0..n).map(|k| z[size + k] * b[(i, k)]).fold(z[0] * 0.0, |a, b| a + b)).collect();
        let value = dual(&z[..size], &tau);
        assert!(value.iter().zip(&f).all(|(a, b)| (a.re - b).abs() < 1e-10 * (1.0 + b.abs())));
        for (k, value) in value.iter().enumerate() {
            expected[0][(k, i)] = value.eps1;
        }
        expected[1][(i, j)] = value.iter().zip(y).map(|(f, y)| y * f.eps1eps2).sum();
        expected[1][(j, i)] = expected[1][(i, j)];
    }
    for (found, expected) in found.iter().zip(&expected) {
        let error = (found - expected).amax() / expected.amax().max(1.0);
        assert!(error < 1e-10, "{}: {error:.1e}", robot.name());
    }
}

/// q' is the velocity of the retraction, and p' that of the tangent space; a longer quaternion is the same.
#[test]
fn rates_are_those_of_the_tangent_space() {
    for robot in trees() {
        let space = ConfigurationSpace::new(&robot);
        let [q, p, u, _] = state(&space);
        let n = p.len();
        let rate = Hamiltonian::<f64>::new(&robot).evaluate(&q, &p, &u).unwrap().to_vec();
        let along: Vec<Dual64> = rate[..n].iter().map(|&rate| Dual64::new(0.0, rate)).collect();
        let lifted: Vec<Dual64> = q.iter().map(|&q| Dual64::from_re(q)).collect();
        let mut moved = lifted.clone();
        space.integrate(&lifted, &along, &mut moved).unwrap();
        let expected = moved.iter().map(|q| q.eps).chain(rate[n..].iter().copied());
        let expected = DVector::from_iterator(q.len() + n, expected);
        let found = DVector::from_vec(at(&robot, &[&q[..], &p].concat(), &u));
        assert!((&found - &expected).amax() < 1e-13 * expected.amax().max(1.0), "{}", robot.name());
        let [x, ..] = sample(&robot);
        let longer = at(&robot, &x, &u);
        for free in robot.free_joints() {
            let a = free.position + free.kind.slides();
            let length = x[a..a + 4].iter().map(|a| a * a).sum::<f64>().sqrt();
            let turned = (a..a + 4).map(|i| (longer[i] - length * expected[i]).abs()).fold(0.0, f64::max);
            // |a| does not change.
            let grows: f64 = (a..a + 4).map(|i| longer[i] * x[i]).sum();
            let most = 1e-12 * expected.amax().max(1.0);
            assert!(turned < most && grows.abs() < most, "{}: {turned:.1e} {grows:.1e}", robot.name());
        }
    }
}

#[test]
fn controls_act_by_their_columns() {
    let robot = robots().remove(2);
    let n = robot.dof();
    let [x, u, y] = sample(&robot);
    let b = DMatrix::from_fn(n, 3, |i, j| ((i + 2 * j) as f64).sin());
    let mut whole = QuaternionDynamics::<f64>::new(&robot);
    let mut some = QuaternionDynamics::<f64>::new(&robot).with_actuation(&b).unwrap();
    assert_eq!((some.states(), some.controls(), some.nq(), some.dof()), (x.len(), 3, robot.nq(), n));
    let tau = (&b * DVector::from_column_slice(&u[..3])).as_slice().to_vec();
    let expected = whole.evaluate(&x, &tau).unwrap().to_vec();
    let all = some.contract(&x, &u[..3], &y).unwrap();
    assert!(all.first.f.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
    assert_eq!(all.first.f_u.to_nalgebra().rows(robot.nq(), n), b);
    assert!(whole.evaluate(&x, &u[..3]).is_err() && whole.evaluate(&x[1..], &u).is_err());
    assert!(QuaternionDynamics::<f64>::new(&robot).with_actuation(&b.rows(0, 2).into_owned()).is_err());
    let nothing = vec![0.0; x.len()];
    assert!(matches!(whole.evaluate(&nothing, &u), Err(EvalError::NonFinite { .. })));
}

/// f does not depend on the length of a quaternion but for a', which is proportional to it.
#[test]
fn quaternions_of_any_size_are_taken() {
    let robot = robots().remove(1);
    let [q, p, u, _] = state(&ConfigurationSpace::new(&robot));
    let expected = at(&robot, &[&q[..], &p].concat(), &u);
    for size in [1e-160, 1e160] {
        let mut x = [&q[..], &p].concat();
        let mut scaled = expected.clone();
        for free in robot.free_joints() {
            let a = free.quaternion();
            x[a..a + 4].iter_mut().chain(&mut scaled[a..a + 4]).for_each(|entry| *entry *= size);
        }
        let found = at(&robot, &x, &u);
        for (k, (found, expected)) in found.iter().zip(&scaled).enumerate() {
            let error = (found - expected).abs() / expected.abs().max(size.min(1.0));
            assert!(error < 1e-12, "{size:e}: {k}: {found} {expected}");
        }
        // The slopes by a are those at length 1 over its length.
        let f_x = QuaternionDynamics::<f64>::new(&robot).linearise(&x, &u).unwrap().f_x.to_nalgebra();
        assert!(f_x.iter().all(|slope| slope.is_finite()), "{size:e}");
        let a = robot.free_joints()[0].quaternion();
        assert!(f_x[(robot.nq(), a)].abs() > 0.0, "{size:e}");
    }
}
