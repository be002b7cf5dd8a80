//! Floating and spherical joints against automatic differentiation through the retraction, against chains of
//! joints away from their singular pose, and by what motions conserve.

use crate::configuration::ConfigurationSpace;
use crate::configuration::samples::{link, placed, robots, state};
use crate::hamiltonian::{Hamiltonian, HamiltonianSecondOrder};
use crate::robot::{Friction, JointSpec, Robot};
use crate::scalar::Scalar;
use nalgebra::{DMatrix, DVector, Rotation3, UnitQuaternion, Vector3};
use num_dual::{Dual64, HyperDual64};

/// F at (q (+) xi, p + dp).
fn displaced<S: Scalar>(robot: &Robot, [q, p, u]: [&[f64]; 3], x: &[S]) -> Vec<S> {
    let space = ConfigurationSpace::new(robot);
    let lift = |a: &[f64]| a.iter().map(|&a| S::from_f64(a)).collect::<Vec<S>>();
    let (xi, dp) = x.split_at(space.dof());
    let mut moved = lift(q);
    space.integrate(&lift(q), xi, &mut moved).unwrap();
    let p: Vec<S> = p.iter().zip(dp).map(|(&p, &dp)| dp.plus(p)).collect();
    Hamiltonian::<S>::new(robot).evaluate(&moved, &p, &lift(u)).unwrap().to_vec()
}

#[test]
fn derivatives_are_those_of_hyper_dual_numbers_through_the_retraction() {
    for robot in robots() {
        let [q, p, u, y] = state(&ConfigurationSpace::new(&robot));
        let n = p.len();
        let mut second = HamiltonianSecondOrder::<f64>::new(&robot);
        let all = second.contract(&q, &p, &u, &y).unwrap();
        let (f, f_x) = (all.linearisation().f().to_vec(), all.linearisation().matrix().to_nalgebra());
        let y_f_xx = all.matrix().to_nalgebra();
        let mut expected_x = DMatrix::zeros(2 * n, 2 * n);
        let mut expected = DMatrix::zeros(2 * n, 2 * n);
        for i in 0..2 * n {
            for j in 0..=i {
                let seed = |k: usize| {
                    HyperDual64::new(0.0, f64::from(u8::from(k == i)), f64::from(u8::from(k == j)), 0.0)
                };
                let x: Vec<_> = (0..2 * n).map(seed).collect();
                let found = displaced(&robot, [&q, &p, &u], &x);
                let value = found.iter().zip(&y).map(|(f, y)| y * f.eps1eps2).sum();
                (expected[(i, j)], expected[(j, i)]) = (value, value);
                found.iter().enumerate().for_each(|(k, f)| expected_x[(k, i)] = f.eps1);
                if (i, j) == (0, 0) {
                    let error = found.iter().zip(&f).map(|(a, b)| (a.re - b).abs()).fold(0.0, f64::max);
                    let size = f.iter().fold(1.0, |most: f64, f| most.max(f.abs()));
                    assert!(error < 1e-12 * size, "{}: F: {error} of {size}", robot.name());
                }
            }
        }
        for (name, found, expected) in [("F_x", &f_x, &expected_x), ("y'F_xx", &y_f_xx, &expected)] {
            let (error, size) = ((found - expected).amax(), expected.amax());
            assert!(error < 1e-11 * size, "{}: {name}: {error} of {size}", robot.name());
        }
        let first = second.first().linearise(&q, &p, &u).unwrap();
        assert!((first.matrix().to_nalgebra() - &f_x).amax() < 1e-13 * f_x.amax());
        // Beyond 12 joints by another kernel.
        let size = f.iter().fold(1.0, |most: f64, f| most.max(f.abs()));
        assert!(first.f().iter().zip(&f).all(|(a, b)| (a - b).abs() < 1e-13 * size), "{}", robot.name());
        let by_y = DVector::from_column_slice(second.first().adjoint(&q, &p, &u, &y).unwrap().y_f_x);
        let y = DVector::from_vec(y);
        assert!((by_y - f_x.transpose() * &y).amax() < 1e-12 * f_x.amax());
        let d: Vec<f64> = (0..2 * n).map(|i| (0.7 + i as f64).cos()).collect();
        let by_d = DVector::from_column_slice(second.hessian_product(&q, &p, y.as_slice(), &d).unwrap());
        assert!((by_d - &y_f_xx * DVector::from_vec(d)).amax() < 1e-12 * y_f_xx.amax());
    }
}

/// `A` of the chain x, y, z, about x, y and z: twist of the moved frame in its axes from rates.
fn twist_map<S: Scalar + nalgebra::Scalar>(angles: [S; 3]) -> [[S; 6]; 6] {
    let [(sa, ca), (sb, cb), (sc, cc)] = angles.map(S::sin_cos);
    let zero = S::zero();
    let r = [
        [cb * cc, -(cb * sc), sb],
        [ca * sc + sa * sb * cc, ca * cc - sa * sb * sc, -(sa * cb)],
        [sa * sc - ca * sb * cc, sa * cc + ca * sb * sc, ca * cb],
    ];
    let w = [[cb * cc, sc, zero], [-(cb * sc), cc, zero], [sb, zero, S::one()]];
    let mut map = [[zero; 6]; 6];
    for i in 0..3 {
        for j in 0..3 {
            map[i][j] = r[j][i];
            map[3 + i][3 + j] = w[i][j];
        }
    }
    map
}

#[test]
fn the_state_equation_is_that_of_a_chain_of_six_joints() {
    let axes = [("x", 0), ("y", 1), ("z", 2)];
    let mut builder = Robot::builder("chain").joint(JointSpec::revolute("a").carrying(link(0.3)));
    let mut whole = builder.clone();
    let mut before = "a".to_owned();
    for (place, kind) in ["prismatic", "revolute"].into_iter().enumerate() {
        for (name, axis) in axes {
            let name = format!("{kind}_{name}");
            let spec = if place == 0 { JointSpec::prismatic(&name) } else { JointSpec::revolute(&name) };
            let mut along = [0.0; 3];
            along[axis] = 1.0;
            let mut spec = spec.on(&before).axis(along);
            if place == 0 && axis == 0 {
                spec = spec.placed(placed(0.4));
            }
            if place == 1 && axis == 2 {
                spec = spec.carrying(link(0.9));
            }
            before = name;
            builder = builder.joint(spec);
        }
    }
    whole = whole.joint(JointSpec::floating("load").on("a").placed(placed(0.4)).carrying(link(0.9)));
    let tip = |on: &str| JointSpec::revolute("tip").on(on).placed(placed(-0.2)).carrying(link(0.5));
    let chain = builder.joint(tip(&before)).build().unwrap();
    let whole = whole.joint(tip("load")).build().unwrap();
    let angles = [0.4, -0.7, 1.9];
    let q_chain = [0.3, 0.5, -1.2, 0.8, angles[0], angles[1], angles[2], 0.6];
    let turn = |axis: Vector3<f64>, angle: f64| Rotation3::new(axis * angle);
    let r = turn(Vector3::x(), angles[0]) * turn(Vector3::y(), angles[1]) * turn(Vector3::z(), angles[2]);
    let mut q = vec![0.3, 0.5, -1.2, 0.8];
    q.extend(UnitQuaternion::from_rotation_matrix(&r).coords.iter());
    q.push(0.6);
    let pi = DVector::from_fn(8, |i, _| (1.3 * i as f64 - 0.4).cos());
    let mut a = DMatrix::identity(8, 8);
    let map = twist_map(angles);
    (0..6).for_each(|i| (0..6).for_each(|j| a[(1 + i, 1 + j)] = map[i][j]));
    let p_chain = a.transpose() * &pi;
    let none = [0.0; 8];
    let mut of_chain = Hamiltonian::<f64>::new(&chain);
    let f = DVector::from_column_slice(of_chain.evaluate(&q_chain, p_chain.as_slice(), &none).unwrap());
    let (v, force) = (f.rows(0, 8).into_owned(), f.rows(8, 8).into_owned());
    let moving = [0, 1, 2].map(|k| Dual64::new(angles[k], v[4 + k]));
    let map = twist_map(moving);
    let mut rate = DMatrix::zeros(8, 8);
    (0..6).for_each(|i| (0..6).for_each(|j| rate[(1 + i, 1 + j)] = map[i][j].eps));
    let expected_rate = a.transpose().lu().solve(&(force - rate.transpose() * &pi)).unwrap();
    let expected_twist = &a * v;
    let mut of_whole = Hamiltonian::<f64>::new(&whole);
    let found = of_whole.evaluate(&q, pi.as_slice(), &none).unwrap();
    let found = DVector::from_column_slice(found);
    assert!((found.rows(0, 8) - &expected_twist).amax() < 1e-12 * expected_twist.amax());
    assert!((found.rows(8, 8) - &expected_rate).amax() < 1e-12 * expected_rate.amax());
    let inverse = a.clone().try_inverse().unwrap();
    let expected =
        inverse.transpose() * of_chain.mass_matrix(&q_chain).unwrap().view().to_nalgebra() * inverse;
    let mass = of_whole.mass_matrix(&q).unwrap().view().to_nalgebra();
    assert!((&mass - &expected).amax() < 1e-13 * expected.amax());
    let product = of_whole.inverse_mass_matrix(&q).unwrap().view().to_nalgebra() * &mass;
    assert!((product - DMatrix::identity(8, 8)).amax() < 1e-12);
    let energies = [of_whole.energy(&q, pi.as_slice()), of_chain.energy(&q_chain, p_chain.as_slice())];
    let [found, expected] = energies.map(|energy| energy.unwrap());
    assert!((found.kinetic - expected.kinetic).abs() < 1e-12 * expected.kinetic);
    assert!((found.potential - expected.potential).abs() < 1e-12 * expected.potential.abs());
    let v = of_whole.velocity(&q, pi.as_slice()).unwrap().to_vec();
    let back = DVector::from_column_slice(of_whole.momentum(&q, &v).unwrap());
    assert!((back - pi).amax() < 1e-12);
}

/// Without gravity the spatial momentum `Ad(g)^-T pi` of a free robot is constant, and H is always.
#[test]
fn motions_conserve_energy_and_momentum() {
    let robot = robots().remove(2);
    for (gravity, robot) in [(true, robot.clone()), (false, robot.with_gravity([0.0; 3]).unwrap())] {
        let robot = robot.with_friction("b", Friction::none()).unwrap();
        let [q, p, ..] = state(&ConfigurationSpace::new(&robot));
        let n = p.len();
        let mut first = Hamiltonian::<f64>::new(&robot);
        let rate = first.evaluate(&q, &p, &vec![0.0; n]).unwrap().to_vec();
        let space = ConfigurationSpace::new(&robot);
        let lift = |a: &[f64]| a.iter().map(|&a| Dual64::from_re(a)).collect::<Vec<_>>();
        let along: Vec<Dual64> = rate.iter().map(|&rate| Dual64::new(0.0, rate)).collect();
        let mut moved = lift(&q);
        space.integrate(&lift(&q), &along[..n], &mut moved).unwrap();
        let p: Vec<Dual64> = p.iter().zip(&along[n..]).map(|(&p, &dp)| dp.plus(p)).collect();
        let energy = Hamiltonian::<Dual64>::new(&robot).hamiltonian(&moved, &p).unwrap();
        assert!(energy.eps.abs() < 1e-12 * energy.re.abs(), "{energy}");
        // The momentum about the origin of the frame that the joint stands in.
        let turn = crate::spatial::Quaternion::new([moved[3], moved[4], moved[5], moved[6]]).rotation();
        let vector = |k: usize| crate::spatial::Vec3::new(p[k], p[k + 1], p[k + 2]);
        let at = crate::spatial::Vec3::new(moved[0], moved[1], moved[2]);
        let linear = turn.apply(vector(0));
        let angular = turn.apply(vector(3)) + at.cross(linear);
        let still = linear.to_array().into_iter().chain(angular.to_array()).all(|p| p.eps.abs() < 1e-13);
        assert_eq!(still, !gravity, "{linear:?} {angular:?}");
    }
}

/// Moving and turning the whole robot about the direction of gravity changes nothing but the position.
#[test]
fn the_state_equation_is_left_invariant() {
    let robot = robots().remove(2).with_gravity([0.0, 0.0, -9.81]).unwrap();
    let [q, p, u, _] = state(&ConfigurationSpace::new(&robot));
    // Seen from where the joint stands.
    let up = placed(0.0).rotation.transpose() * Vector3::z();
    let turn = UnitQuaternion::from_scaled_axis(up * 1.1);
    let of = UnitQuaternion::new_unchecked(nalgebra::Quaternion::new(q[6], q[3], q[4], q[5]));
    let mut moved = q.clone();
    moved[3..7].copy_from_slice((turn * of).coords.as_slice());
    let at = turn * Vector3::new(q[0], q[1], q[2]) + Vector3::new(3.0, -5.0, 2.0);
    moved[..3].copy_from_slice(at.as_slice());
    let mut first = Hamiltonian::<f64>::new(&robot);
    let expected = first.evaluate(&q, &p, &u).unwrap().to_vec();
    let found = first.evaluate(&moved, &p, &u).unwrap();
    assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-11), "{found:?} {expected:?}");
}
