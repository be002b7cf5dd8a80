//! Robots with floating and spherical joints that stand: automatic differentiation through the retraction,
//! and the same robot on a chain of six joints.

use super::free_samples::{at, quadruped, standing};
use super::*;
use crate::configuration::ConfigurationSpace;
use crate::configuration::samples::{robots, state};
use crate::hamiltonian::Hamiltonian;
use crate::robot::{ConstraintRow, ConstraintSpec, Placement, Robot};
use crate::scalar::Scalar;
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, UnitQuaternion, Vector3};
use num_dual::{Dual64, HyperDual64};

fn lift<S: Scalar>(a: &[f64]) -> Vec<S> {
    a.iter().map(|&a| S::from_f64(a)).collect()
}

/// Robots with all kinds of free joints, held in several ways.
pub(super) fn held() -> Vec<Robot> {
    let mut all: Vec<Robot> = robots()
        .into_iter()
        .enumerate()
        .map(|(k, robot)| {
            let last = robot.frames().last().unwrap().name.clone();
            let first = robot.free_joints()[0].name.clone();
            let turned = Placement::from_xyz_rpy([0.3, -0.2, 0.1], [0.4, 0.2, -0.3]);
            let rows: &[ConstraintRow] = match k % 3 {
                0 => &[ConstraintRow::X, ConstraintRow::Z],
                1 => &[ConstraintRow::Y, ConstraintRow::TurnX],
                _ => &[ConstraintRow::X, ConstraintRow::Y, ConstraintRow::TurnZ],
            };
            let spec = ConstraintSpec::rows("hold", &last, "world", rows).placed(turned);
            let rod = ConstraintSpec::distance("rod", &first, "world", 0.7).placed(turned);
            let robot = robot.with_constraint(spec).unwrap();
            if k % 2 == 0 { robot.with_constraint(rod).unwrap() } else { robot }
        })
        .collect();
    all.push(standing(quadruped(true), &["lf", "rh"]));
    all
}

/// F and mu at (q (+) xi, p + dp).
fn displaced<S: Scalar>(robot: &Robot, [q, p, u]: [&[f64]; 3], x: &[S]) -> (Vec<S>, Vec<S>) {
    let space = ConfigurationSpace::new(robot);
    let (xi, dp) = x.split_at(space.dof());
    let mut moved = lift(q);
    space.integrate(&lift(q), xi, &mut moved).unwrap();
    let p: Vec<S> = p.iter().zip(dp).map(|(&p, &dp)| dp.plus(p)).collect();
    let mut hamiltonian = ConstrainedHamiltonian::<S>::new(robot);
    let rate = hamiltonian.evaluate(&moved, &p, &lift(u)).unwrap();
    (rate.f.to_vec(), rate.mu.to_vec())
}

#[test]
fn derivatives_are_those_of_hyper_dual_numbers_through_the_retraction() {
    for robot in held() {
        let [q, p, u, y] = state(&ConfigurationSpace::new(&robot));
        let n = p.len();
        let mut second = ConstrainedHamiltonianSecondOrder::<f64>::new(&robot);
        let all = second.contract(&q, &p, &u, &y).unwrap();
        let linear = all.linearisation();
        let (f, f_x) = (linear.f().to_vec(), linear.matrix().to_nalgebra());
        let (mu, mu_x) = (linear.mu().to_vec(), linear.mu_x().to_nalgebra());
        let y_f_xx = all.matrix().to_nalgebra();
        let mut expected_x = DMatrix::zeros(2 * n, 2 * n);
        let mut expected_mu = DMatrix::zeros(mu.len(), 2 * n);
        let mut expected = DMatrix::zeros(2 * n, 2 * n);
        for i in 0..2 * n {
            for j in 0..=i {
                let one = |on: bool| f64::from(u8::from(on));
                let x: Vec<_> =
                    (0..2 * n).map(|k| HyperDual64::new(0.0, one(k == i), one(k == j), 0.0)).collect();
                let (found, found_mu) = displaced(&robot, [&q, &p, &u], &x);
                let value = found.iter().zip(&y).map(|(f, y)| y * f.eps1eps2).sum();
                (expected[(i, j)], expected[(j, i)]) = (value, value);
                found.iter().enumerate().for_each(|(k, f)| expected_x[(k, i)] = f.eps1);
                found_mu.iter().enumerate().for_each(|(k, mu)| expected_mu[(k, i)] = mu.eps1);
                if (i, j) == (0, 0) {
                    let off = |a: &[HyperDual64], b: &[f64]| {
                        a.iter().zip(b).map(|(a, b)| (a.re - b).abs()).fold(0.0, f64::max)
                    };
                    let size = f.iter().chain(&mu).fold(1.0, |most: f64, f| most.max(f.abs()));
                    assert!(off(&found, &f).max(off(&found_mu, &mu)) < 1e-11 * size, "{}: F", robot.name());
                }
            }
        }
        let compared =
            [("F_x", &f_x, &expected_x), ("mu_x", &mu_x, &expected_mu), ("y'F_xx", &y_f_xx, &expected)];
        for (name, found, expected) in compared {
            let (error, size) = ((found - expected).amax(), expected.amax().max(1.0));
            assert!(error < 1e-11 * size, "{}: {name}: {error} of {size}", robot.name());
        }
        let lambda = linear_of(&mut second, [&q, &p, &u], &f_x, &mu_x);
        assert!(lambda < 1e-11, "{lambda}");
        let by_y = DVector::from_column_slice(second.first().adjoint(&q, &p, &u, &y).unwrap().y_f_x);
        let y = DVector::from_vec(y);
        assert!((by_y - f_x.transpose() * &y).amax() < 1e-12 * f_x.amax());
        let d: Vec<f64> = (0..2 * n).map(|i| (0.7 + i as f64).cos()).collect();
        let by_d = DVector::from_column_slice(second.hessian_product(&q, &p, y.as_slice(), &d).unwrap());
        assert!((by_d - &y_f_xx * DVector::from_vec(d)).amax() < 1e-12 * y_f_xx.amax());
    }
}

/// By how much `linearise` differs from `contract`, and a and lambda from the products with F.
fn linear_of(
    second: &mut ConstrainedHamiltonianSecondOrder<f64>,
    [q, p, u]: [&[f64]; 3],
    f_x: &DMatrix<f64>,
    mu_x: &DMatrix<f64>,
) -> f64 {
    let linear = second.first().linearise(q, p, u).unwrap();
    let f = DVector::from_column_slice(linear.f());
    let (a, lambda) = (f_x.rows(0, p.len()) * &f, mu_x * &f);
    let off_a = (a - DVector::from_column_slice(linear.acceleration())).amax();
    let pairs = lambda.iter().zip(linear.lambda());
    let off_lambda = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    let same = (linear.matrix().to_nalgebra() - f_x).amax() + (linear.mu_x().to_nalgebra() - mu_x).amax();
    let scale = 1.0 + f.amax() * (f_x.amax() + mu_x.amax());
    (off_a + off_lambda + same) / scale
}

/// The floating trunk and the chain of six joints: one motion, one set of forces.
#[test]
fn a_quadruped_on_a_floating_joint_is_that_on_a_chain_of_six() {
    let angles = [0.2, -0.3, 0.5];
    let turn = |axis: Vector3<f64>, angle: f64| Rotation3::new(axis * angle);
    let r = turn(Vector3::x(), angles[0]) * turn(Vector3::y(), angles[1]) * turn(Vector3::z(), angles[2]);
    let legs: Vec<f64> = (0..12).map(|i| 0.4 * (0.8 + 1.9 * f64::from(i)).sin()).collect();
    let position = [0.1, -0.2, 0.45];
    let mut q = position.to_vec();
    q.extend(UnitQuaternion::from_rotation_matrix(&r).coords.iter());
    q.extend(&legs);
    let q_chain = [&position[..], &angles, &legs].concat();
    // Twist of the trunk in its axes, and the rates of the chain.
    let twist = [0.3, -0.5, 0.2, 0.7, -0.4, 0.6];
    let (linear, angular) = (Vector3::new(0.3, -0.5, 0.2), Vector3::new(0.7, -0.4, 0.6));
    let columns = [
        (turn(Vector3::y(), angles[1]) * turn(Vector3::z(), angles[2])).inverse() * Vector3::x(),
        turn(Vector3::z(), angles[2]).inverse() * Vector3::y(),
        Vector3::z(),
    ];
    let rates = Matrix3::from_columns(&columns).lu().solve(&angular).unwrap();
    let along = r * linear;
    let leg_rates: Vec<f64> = (0..12).map(|i| (0.3 + 1.1 * f64::from(i)).cos()).collect();
    let v = [&twist[..], &leg_rates].concat();
    let v_chain = [along.as_slice(), rates.as_slice(), &leg_rates].concat();
    let mut u = vec![0.0; 18];
    (6..18).for_each(|i| u[i] = 3.0 * (i as f64).sin());
    let legs = ["lf", "rf", "lh", "rh"];
    let [mut floating, mut chain] = [true, false]
        .map(|floating| ConstrainedHamiltonian::<f64>::new(&standing(quadruped(floating), &legs)));
    let p = floating.momentum(&q, &v).unwrap().to_vec();
    let p_chain = chain.momentum(&q_chain, &v_chain).unwrap().to_vec();
    let energies = [floating.energy(&q, &p).unwrap(), chain.energy(&q_chain, &p_chain).unwrap()];
    assert!((energies[0].kinetic - energies[1].kinetic).abs() < 1e-11 * energies[1].kinetic);
    let found = floating.linearise(&q, &p, &u).unwrap();
    let (f, lambda, a) = (found.f().to_vec(), found.lambda().to_vec(), found.acceleration().to_vec());
    let expected = chain.linearise(&q_chain, &p_chain, &u).unwrap();
    let size = expected.lambda().iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    for i in 6..18 {
        assert!((f[i] - expected.velocity()[i]).abs() < 1e-10 * size, "v {i}");
        assert!((a[i] - expected.acceleration()[i]).abs() < 1e-10 * size, "a {i}");
    }
    for (i, (found, expected)) in lambda.iter().zip(expected.lambda()).enumerate() {
        assert!((found - expected).abs() < 1e-10 * size, "lambda {i}: {found} {expected}");
    }
    assert_eq!(floating.rank(), 12);
    // J v = 0 for the velocities of the state, in the tangent space, too.
    let v = f[..18].to_vec();
    assert!(floating.constraint_rate(&q, &v).unwrap().iter().all(|rate| rate.abs() < 1e-12));
}

/// g and H_c are constant along motions; J is the derivative of g in the tangent space.
#[test]
fn constraints_and_energy_stay() {
    let robot = standing(quadruped(true), &["lf", "rh", "rf"]);
    let space = ConfigurationSpace::new(&robot);
    let [q, p, ..] = state(&space);
    let n = p.len();
    let mut first = ConstrainedHamiltonian::<f64>::new(&robot);
    let rate = first.evaluate(&q, &p, &vec![0.0; n]).unwrap().f.to_vec();
    let along: Vec<Dual64> = rate.iter().map(|&rate| Dual64::new(0.0, rate)).collect();
    let mut moved = lift(&q);
    space.integrate(&lift(&q), &along[..n], &mut moved).unwrap();
    let p_moved: Vec<Dual64> = p.iter().zip(&along[n..]).map(|(&p, &dp)| dp.plus(p)).collect();
    let mut moving = ConstrainedHamiltonian::<Dual64>::new(&robot);
    let energy = moving.energy(&moved, &p_moved).unwrap();
    let total = energy.kinetic + energy.potential;
    assert!(total.eps.abs() < 1e-10 * (1.0 + energy.kinetic.re), "{total}");
    assert!(moving.constraints().values().iter().all(|g| g.eps.abs() < 1e-12));
    let direction: Vec<f64> = (0..n).map(|i| (0.4 + 1.3 * i as f64).sin()).collect();
    let seeds: Vec<Dual64> = direction.iter().map(|&d| Dual64::new(0.0, d)).collect();
    space.integrate(&lift(&q), &seeds, &mut moved).unwrap();
    let mut rows = Constraints::<Dual64>::new(&robot);
    rows.set_position(&moved).unwrap();
    let rates = first.constraint_rate(&q, &direction).unwrap();
    for (g, rate) in rows.values().iter().zip(rates) {
        assert!((g.eps - rate).abs() < 1e-13, "{g} {rate}");
    }
}

/// Feet are brought to where they are to stand, and drift is removed, with unit quaternions.
#[test]
fn positions_are_closed_and_projected() {
    let legs = ["lf", "rf", "lh", "rh"];
    let feet = [[0.3, 0.17], [0.3, -0.13], [-0.3, 0.17], [-0.3, -0.13]];
    let robot = legs.iter().zip(feet).fold(quadruped(true), |robot, (leg, [x, y])| {
        let spec =
            ConstraintSpec::pinned(*leg, &format!("{leg}_knee"), "world").placed(at([0.0, 0.0, -0.25]));
        robot.with_constraint(spec.to_placed(at([x, y, 0.0]))).unwrap()
    });
    let space = ConfigurationSpace::new(&robot);
    let mut first = ConstrainedHamiltonian::<f64>::new(&robot);
    let mut q = space.neutral();
    q[2] = 0.4;
    q[3] = 0.05;
    (0..4).for_each(|leg| (q[7 + 3 * leg + 1], q[7 + 3 * leg + 2]) = (0.4, -0.8));
    space.normalize(&mut q).unwrap();
    first.close(&mut q, &[false; 18]).unwrap();
    space.check(&q).unwrap();
    assert!(first.constraints().values().iter().all(|g| g.abs() < 1e-10));
    let start = q.clone();
    let v: Vec<f64> = (0..18).map(|i| (1.0 + 0.7 * f64::from(i)).sin()).collect();
    let mut p = first.momentum(&q, &v).unwrap().to_vec();
    let push: Vec<f64> = v.iter().map(|v| 1e-3 * v).collect();
    let mut moved = q.clone();
    space.integrate(&q, &push, &mut moved).unwrap();
    first.project(&mut moved, &mut p, &start).unwrap();
    space.check(&moved).unwrap();
    assert!(first.drift(&moved, &start).unwrap().iter().all(|g| g.abs() < 1e-12));
    let (v, mu) = first.velocity(&moved, &p).unwrap();
    let v = v.to_vec();
    assert!(mu.iter().all(|mu| mu.abs() < 1e-10));
    assert!(first.constraint_rate(&moved, &v).unwrap().iter().all(|rate| rate.abs() < 1e-12));
    // An impact of the whole body on its feet, against the law with dense matrices.
    let v: Vec<f64> = (0..18).map(|i| (0.2 + 0.9 * f64::from(i)).cos()).collect();
    let mut impact = Impact::<f64>::new(&robot);
    let p = impact.hamiltonian().momentum(&start, &v).unwrap().to_vec();
    let after = impact.evaluate(&start, &p).unwrap();
    let (after_v, impulse, loss) =
        (DVector::from_column_slice(after.velocity), DVector::from_column_slice(after.impulse), after.loss);
    let mut open = Hamiltonian::<f64>::new(&robot.without_constraints());
    let m = open.mass_matrix(&start).unwrap().view().to_nalgebra();
    let j = impact.hamiltonian().constraints().jacobian().view().to_nalgebra();
    let change = &m * (&after_v - DVector::from_column_slice(&v));
    assert!((change - j.transpose() * impulse).amax() < 1e-10 && (j * &after_v).amax() < 1e-11);
    let kinetic = |v: &DVector<f64>| 0.5 * v.dot(&(&m * v));
    assert!((kinetic(&DVector::from_vec(v)) - kinetic(&after_v) - loss).abs() < 1e-10 && loss > 0.0);
    // Its derivatives, p+ of the judge by M v+.
    let linear = impact.linearise(&start, &p).unwrap();
    let jacobians = [linear.velocity_x(), linear.momentum_x(), linear.impulse_x()].map(|x| x.to_nalgebra());
    let mut judge = ConstrainedHamiltonian::<Dual64>::new(&robot);
    for i in 0..36 {
        let seeds: Vec<Dual64> = (0..36).map(|k| Dual64::new(0.0, f64::from(u8::from(k == i)))).collect();
        let mut at = lift(&start);
        space.integrate(&lift(&start), &seeds[..18], &mut at).unwrap();
        let p: Vec<Dual64> = p.iter().zip(&seeds[18..]).map(|(&p, dp)| dp.plus(p)).collect();
        let (v, mu) = judge.velocity(&at, &p).unwrap();
        let (v, mu) = (v.to_vec(), mu.to_vec());
        let momentum = judge.momentum(&at, &v).unwrap().to_vec();
        for (expected, found) in [v, momentum, mu].iter().zip(&jacobians) {
            for (l, expected) in expected.iter().enumerate() {
                assert!((expected.eps - found[(l, i)]).abs() < 1e-11 * (1.0 + found.amax()), "{l} {i}");
            }
        }
    }
}
