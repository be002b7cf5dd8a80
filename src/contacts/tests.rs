//! Contact forces against the balance of momentum, derivatives against automatic differentiation.

use super::samples::{at, biped, biped_state, floating_hopper, hopper, hopper_state, lift, toe};
use super::*;
use crate::Coordinates;
use crate::configuration::ConfigurationSpace;
use crate::constraints::{ConstrainedHamiltonian, ConstrainedLagrangian};
use crate::kinematics::Kinematics;
use crate::robot::Placement;
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use num_dual::HyperDual64;

/// The forces of a stance at (q, M v), the momentum's balance and the positions of the contacts.
fn balances(stance: &Stance, [q, v, u]: [&[f64]; 3], frames: &[(&str, Placement)]) {
    let robot = stance.robot();
    let mut hamiltonian = ConstrainedHamiltonian::<f64>::new(robot);
    let p = hamiltonian.momentum(q, v).unwrap().to_vec();
    let linear = hamiltonian.linearise(q, &p, u).unwrap();
    let (v, a, lambda) =
        (linear.velocity().to_vec(), linear.acceleration().to_vec(), linear.lambda().to_vec());
    let mut kinematics = Kinematics::<f64>::new(robot);
    kinematics.set_motion(q, &v, &a).unwrap();
    let centre = kinematics.centre_of_mass().unwrap();
    let (mass, centre) = (centre.mass, Vector3::from(centre.position));
    let momentum = kinematics.momentum().unwrap();
    let (force, moment) = (Vector3::from(momentum.linear_rate), Vector3::from(momentum.angular_rate));
    let mut sum = [Vector3::new(0.0, 0.0, -9.81 * mass), Vector3::zeros()];
    for (k, (frame, placement)) in frames.iter().enumerate() {
        let pose = kinematics.pose(robot.frame_index(frame).unwrap()).unwrap();
        let rotation = Matrix3::from_fn(|i, j| pose.rotation[i][j]);
        let point = Vector3::from(pose.position) + rotation * placement.translation;
        let (f, m) = stance.wrench(k, &lambda);
        sum[0] += Vector3::from(f);
        sum[1] += Vector3::from(m) + (point - centre).cross(&Vector3::from(f));
    }
    let size = force.norm().max(100.0);
    assert!((sum[0] - force).amax() < 1e-11 * size, "{} {force}", sum[0]);
    assert!((sum[1] - moment).amax() < 1e-11 * size, "{} {moment}", sum[1]);
}

#[test]
fn contact_forces_balance_the_momentum_of_a_biped() {
    let [q, v, u] = biped_state();
    let frames = ["left_knee", "right_knee"].map(|knee| (knee, at([0.0, 0.0, -0.4])));
    for planar in [false, true] {
        let kind = |contact: Contact| if planar { contact.planar() } else { contact };
        let both = Stance::new(&biped(), &[kind(toe("left")), kind(toe("right"))]).unwrap();
        balances(&both, [&q, &v, &u], &frames);
        let one = Stance::new(&biped(), &[kind(toe("left"))]).unwrap();
        balances(&one, [&q, &v, &u], &frames[..1]);
        let mut hamiltonian = ConstrainedHamiltonian::<f64>::new(both.robot());
        hamiltonian.velocity(&q, &[0.0; 7]).unwrap();
        assert_eq!((hamiltonian.rank(), both.count()), (4, if planar { 4 } else { 6 }));
        let redundant: Vec<&str> = hamiltonian.redundant().collect();
        assert_eq!(redundant, if planar { vec![] } else { vec!["left", "right"] });
    }
}

#[test]
fn forces_and_moments_of_a_foot_balance_the_momentum_of_a_body() {
    let (robot, foot, placement) = hopper();
    let stance = Stance::new(&robot, &[foot]).unwrap();
    let [q, v, u] = hopper_state();
    balances(&stance, [&q, &v, &u], &[("ankle", placement)]);
}

/// Forces and margins through v(q, p) and the accelerations, for hyper-dual numbers: at a state displaced
/// by z.
fn judge(
    stance: &Stance,
    coordinates: Coordinates,
    [q, rate, u]: [&[f64]; 3],
    z: &[HyperDual64],
) -> [Vec<HyperDual64>; 2] {
    let (n, mut moved) = (rate.len(), lift(q));
    ConfigurationSpace::new(stance.robot()).integrate(&lift(q), &z[..n], &mut moved).unwrap();
    let add = |to: &[f64], by: &[HyperDual64]| -> Vec<HyperDual64> {
        to.iter().zip(by).map(|(&to, &by)| by + to).collect()
    };
    let (q, rate, u) = (&moved, &add(rate, &z[n..2 * n]), &add(u, &z[2 * n..]));
    let v = match coordinates {
        Coordinates::Lagrangian => rate.to_vec(),
        Coordinates::Hamiltonian => {
            let mut hamiltonian = ConstrainedHamiltonian::<HyperDual64>::new(stance.robot());
            hamiltonian.velocity(q, rate).unwrap().0.to_vec()
        }
    };
    let mut lagrangian = ConstrainedLagrangian::<HyperDual64>::new(stance.robot());
    let lambda = lagrangian.evaluate(q, &v, u).unwrap().1.to_vec();
    let margins = stance.margins().iter().map(|margin| margin.value(&lambda)).collect();
    [lambda, margins]
}

#[test]
fn derivatives_of_forces_and_margins_are_those_of_hyper_dual_numbers() {
    let standing = [toe("left"), toe("right").planar()];
    let biped = (Stance::new(&biped(), &standing).unwrap(), biped_state());
    let (robot, foot, _) = hopper();
    let hopper = (Stance::new(&robot, &[foot]).unwrap(), hopper_state());
    let (robot, foot, state) = floating_hopper();
    let floating = (Stance::new(&robot, &[foot]).unwrap(), state);
    for (stance, [q, v, u]) in [biped, hopper, floating] {
        let n = v.len();
        for coordinates in Coordinates::ALL {
            let rate = match coordinates {
                Coordinates::Lagrangian => v.clone(),
                Coordinates::Hamiltonian => {
                    let mut h = ConstrainedHamiltonian::<f64>::new(stance.robot());
                    h.momentum(&q, &v).unwrap().to_vec()
                }
            };
            let wave = |count: usize| (0..count).map(|i| (0.3 + 1.7 * i as f64).sin()).collect::<Vec<f64>>();
            let (w, e) = (wave(stance.margins().len()), wave(stance.count()));
            let mut forces = ContactForces::<f64>::new(&stance, coordinates);
            let first = forces.linearise(&q, &rate, &u).unwrap();
            let jacobians = [first.lambda_z().to_nalgebra(), first.margins_z().to_nalgebra()];
            let values = [first.lambda().to_vec(), first.margins().to_vec()];
            let all = forces.contract([&q, &rate, &u], &w, &e).unwrap();
            let linear = all.linearisation();
            let again = [linear.lambda_z().to_nalgebra(), linear.margins_z().to_nalgebra()];
            let zz = all.matrix().to_nalgebra();
            for (again, before) in again.iter().zip(&jacobians) {
                assert!((again - before).amax() < 1e-12 * before.amax());
            }
            let mut expected_zz = DMatrix::zeros(3 * n, 3 * n);
            for i in 0..3 * n {
                for j in 0..=i {
                    let mut z: Vec<HyperDual64> = lift(&vec![0.0; 3 * n]);
                    z[i].eps1 = 1.0;
                    z[j].eps2 = 1.0;
                    let mut entry = 0.0;
                    for (part, found) in judge(&stance, coordinates, [&q, &rate, &u], &z).iter().enumerate() {
                        let weights = [&e, &w][part];
                        let size = 1.0 + jacobians[part].amax();
                        for (l, found) in found.iter().enumerate() {
                            assert!((found.re - values[part][l]).abs() < 1e-11 * size, "{part} {l}");
                            assert!(
                                (found.eps1 - jacobians[part][(l, i)]).abs() < 1e-11 * size,
                                "{part} {l} {i}"
                            );
                            entry += weights[l] * found.eps1eps2;
                        }
                    }
                    (expected_zz[(i, j)], expected_zz[(j, i)]) = (entry, entry);
                }
            }
            let worst = (&zz - &expected_zz).amax();
            assert!(worst < 1e-11 * expected_zz.amax(), "{coordinates}: {worst} of {}", expected_zz.amax());
            assert_eq!(zz, zz.transpose());
        }
    }
}

/// Moments of a foot whose heading is not that of its ground are not its multipliers: a check says so, and
/// the rows have them.
#[test]
fn feet_that_are_turned_are_found() {
    let (robot, foot, _) = hopper();
    let [q, _, u] = hopper_state();
    let still = [0.0; 7];
    for heading in [0.0, 0.5] {
        let ground = Placement::from_xyz_rpy([0.0; 3], [0.0, 0.0, heading]);
        let stance = Stance::new(&robot, &[foot.clone().on(ground)]).unwrap();
        let mut hamiltonian = ConstrainedHamiltonian::<f64>::new(stance.robot());
        let lambda = hamiltonian.linearise(&q, &still, &u).unwrap().lambda().to_vec();
        let (_, moment) = hamiltonian.constraints().wrench(0, &lambda).unwrap();
        let (_, told) = stance.wrench(0, &lambda);
        let off = (Vector3::from(told) - Vector3::from(moment)).amax();
        match stance.check_feet(&q).unwrap() {
            Ok(()) => assert!(heading == 0.0 && off < 1e-10 * Vector3::from(moment).amax(), "{off}"),
            Err(error) => assert!(heading == 0.5 && off > 1e-2 && error.to_string().contains("'foot'")),
        }
    }
}

/// The same body, described in both ways.
#[test]
fn forces_on_a_floating_base_are_those_on_a_chain_of_six() {
    let (robot, foot, [q, _, u]) = floating_hopper();
    let floating = Stance::new(&robot, &[foot]).unwrap();
    let (robot, foot, _) = hopper();
    let chain = Stance::new(&robot, &[foot]).unwrap();
    let [q_chain, ..] = hopper_state();
    let still = [0.0; 7];
    let mut forces = [&floating, &chain].map(|of| ContactForces::<f64>::new(of, Coordinates::Lagrangian));
    let found = forces[0].linearise(&q, &still, &u).unwrap();
    let found = (found.lambda().to_vec(), found.margins().to_vec(), found.lambda_z().to_nalgebra());
    let expected = forces[1].linearise(&q_chain, &still, &u).unwrap();
    let all = found.0.iter().chain(&found.1).zip(expected.lambda().iter().chain(expected.margins()));
    all.for_each(|(a, b)| assert!((a - b).abs() < 1e-10 * (1.0 + b.abs()), "{a} {b}"));
    // The torque of the ankle is the same coordinate in both.
    let by_torque = expected.lambda_z().to_nalgebra().column(20) - found.2.column(20);
    assert!(by_torque.amax() < 1e-10, "{by_torque}");
}

/// A body that stands still with upright legs presses with its weight, evenly.
#[test]
fn a_standing_biped_presses_with_its_weight() {
    let robot = biped();
    let stance = Stance::new(&robot, &[toe("left").planar(), toe("right").planar()]).unwrap();
    // Legs mirrored about the vertical line through the hips: the centre of mass is 0.01 m before it.
    let q = [0.0, 0.7, 0.0, -0.5, 0.4, 0.5, -0.4];
    let mut lagrangian = crate::lagrangian::Lagrangian::<f64>::new(&robot);
    let gravity = DVector::from_column_slice(lagrangian.gravity(&q).unwrap());
    let mut hamiltonian = ConstrainedHamiltonian::<f64>::new(stance.robot());
    hamiltonian.velocity(&q, &[0.0; 7]).unwrap();
    let j = hamiltonian.constraints().jacobian().view().to_nalgebra();
    // Forces without a tangential sum that carry the unactuated base, with 10 N of squeeze.
    let toes = [0, 2].map(|row| j[(row + 1, 2)]);
    let weight = gravity[1];
    // Moment about the pitch axis: gravity[2] = toes . normal forces + moment of tangential ones.
    let squeeze = 10.0;
    let levers = [j[(0, 2)], j[(2, 2)]];
    let moment = gravity[2] - squeeze * (levers[0] - levers[1]);
    let right = (moment - toes[0] * weight) / (toes[1] - toes[0]);
    let expected = [squeeze, weight - right, -squeeze, right];
    let u = &gravity - j.transpose() * DVector::from_column_slice(&expected);
    assert!(u.rows(0, 3).amax() < 1e-10, "the base has no motor: {u}");
    let linear = hamiltonian.linearise(&q, &[0.0; 7], u.as_slice()).unwrap();
    assert!(linear.acceleration().iter().all(|a| a.abs() < 1e-10));
    let lambda = linear.lambda().to_vec();
    assert!(lambda.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{lambda:?} {expected:?}");
    assert!((lambda[1] + lambda[3] - 36.0 * 9.81).abs() < 1e-9);
    assert!(stance.margins().iter().all(|margin| margin.value(&lambda) > 0.0));
}

/// Ground whose normal is not z: the force along the normal is what the axes of the world say.
#[test]
fn the_ground_has_its_own_axes() {
    let up = [1.0, 0.0, 2.0];
    let slope = Stance::new(&biped(), &[toe("left").up(up), toe("right").up(up)]).unwrap();
    let level = Stance::new(&biped(), &[toe("left"), toe("right")]).unwrap();
    let [q, _, u] = biped_state();
    let forces = [&slope, &level].map(|stance| {
        let mut hamiltonian = ConstrainedHamiltonian::<f64>::new(stance.robot());
        let lambda = hamiltonian.linearise(&q, &[0.0; 7], &u).unwrap().lambda().to_vec();
        [0, 1].map(|k| Vector3::from(stance.wrench(k, &lambda).0))
    });
    let z = Vector3::from(up).normalize();
    let x = Vector3::new(2.0, 0.0, -1.0).normalize();
    for (slope, level) in forces[0].iter().zip(&forces[1]) {
        let expected = Vector3::new(x.dot(level), 0.0, z.dot(level));
        assert!((slope - expected).amax() < 1e-9, "{slope} {expected}");
    }
}
