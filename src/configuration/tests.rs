//! Configurations against nalgebra and automatic differentiation.

use super::*;
use crate::robot::{JointSpec, LinkInertia};
use num_dual::Dual64;

fn space() -> ConfigurationSpace {
    ConfigurationSpace::new(&robot())
}

fn robot() -> Robot {
    let link = LinkInertia::about_com(1.0, [0.1, 0.0, 0.2], nalgebra::Matrix3::identity());
    Robot::builder("mixed")
        .joint(JointSpec::revolute("a").carrying(link))
        .joint(JointSpec::floating("b").on("a").carrying(link))
        .joint(JointSpec::spherical("c").on("b").carrying(link))
        .joint(JointSpec::prismatic("d").on("c").carrying(link))
        .build()
        .unwrap()
}

const Q: [f64; 13] = [0.3, 1.0, -2.0, 0.5, 0.5, -0.5, 0.5, 0.5, 0.1, -0.7, 0.5, 0.5, -0.4];

#[test]
fn differences_undo_integration() {
    let space = space();
    assert_eq!((space.nq(), space.dof()), (13, 11));
    for size in [0.0, 1e-9, 1e-3, 0.4, 0.99, 1.01, 1.6] {
        let d: Vec<f64> = (0..11).map(|i| size * (1.0 + 1.7 * i as f64).sin()).collect();
        let (mut to, mut back) = ([0.0; 13], [0.0; 11]);
        space.integrate(&Q, &d, &mut to).unwrap();
        space.check(&to).unwrap();
        space.difference(&Q, &to, &mut back).unwrap();
        let error = d.iter().zip(back).fold(0.0, |most, (d, back)| f64::max(most, (d - back).abs()));
        assert!(error < 5e-15, "{size}: {error}");
    }
}

#[test]
fn exponentials_are_those_of_nalgebra() {
    use nalgebra::{Isometry3, Matrix4, UnitQuaternion, Vector3};
    for size in [1e-5, 0.3, 0.9, 1.1, 2.5, 6.0] {
        let (rho, theta) = (Vector3::new(0.3, -1.0, 0.7), Vector3::new(0.6, 0.2, -0.7) * size);
        // The exponential of the 4 x 4 matrix by scaling and squaring of its series.
        let mut twist = Matrix4::zeros();
        twist.fixed_view_mut::<3, 3>(0, 0).copy_from(&theta.cross_matrix());
        twist.fixed_view_mut::<3, 1>(0, 3).copy_from(&rho);
        let expected = twist.exp();
        let array = |v: Vector3<f64>| Vec3::new(v.x, v.y, v.z);
        let turn = exponential::quaternion(array(theta)).to_array();
        let turn = UnitQuaternion::new_unchecked(nalgebra::Quaternion::from_vector(turn.into()));
        let by = exponential::displacement(array(theta), array(rho)).to_array();
        let found = Isometry3::from_parts(Vector3::from(by).into(), turn).to_homogeneous();
        assert!((found - expected).amax() < 2e-14, "{size}: {}", found - expected);
    }
}

#[test]
fn jacobians_are_those_of_dual_numbers() {
    let space = space();
    for size in [0.0, 1e-4, 0.7, 1.2] {
        let d: Vec<f64> = (0..11).map(|i| size * (0.5 + 1.3 * i as f64).cos()).collect();
        let mut to = [0.0; 13];
        space.integrate(&Q, &d, &mut to).unwrap();
        let jacobians = space.integrate_jacobians(&d).unwrap();
        let of_difference = space.difference_jacobians(&Q, &to).unwrap();
        let lift = |a: &[f64]| a.iter().map(|&x| Dual64::from_re(x)).collect::<Vec<_>>();
        for j in 0..11 {
            let mut along = vec![Dual64::from_re(0.0); 11];
            along[j] = along[j].derivative();
            let moved = |from: &[f64]| {
                let mut to = lift(from);
                space.integrate(&lift(from), &along, &mut to).unwrap();
                to
            };
            let apart = |from: &[Dual64], to: &[Dual64]| {
                let mut d = vec![Dual64::from_re(0.0); 11];
                space.difference(from, to, &mut d).unwrap();
                d
            };
            // What the tangent vectors of the result are, seen from the result itself.
            let mut by_first = lift(&Q);
            space.integrate(&moved(&Q), &lift(&d), &mut by_first).unwrap();
            let mut changed = lift(&d);
            changed[j] = changed[j].derivative();
            let mut by_second = lift(&Q);
            space.integrate(&lift(&Q), &changed, &mut by_second).unwrap();
            let columns = [
                (apart(&lift(&to), &by_first), &jacobians.first),
                (apart(&lift(&to), &by_second), &jacobians.second),
                (apart(&moved(&Q), &lift(&to)), &of_difference.first),
                (apart(&lift(&Q), &moved(&to)), &of_difference.second),
            ];
            for (k, (column, matrix)) in columns.iter().enumerate() {
                for i in 0..11 {
                    let error = (column[i].eps - matrix[(i, j)]).abs();
                    assert!(error < 1e-13, "{size}: {k} ({i}, {j}): {error}");
                }
            }
        }
    }
}

#[test]
fn a_quaternion_that_is_not_unit_is_refused_with_its_size() {
    let space = space();
    let mut q = Q;
    q[4] *= 1.01;
    let error = space.check(&q).unwrap_err().to_string();
    assert!(error.contains("'b'") && error.contains("1e-3"), "{error}");
    space.normalize(&mut q).unwrap();
    space.check(&q).unwrap();
    q[8] = f64::NAN;
    assert!(space.check(&q).unwrap_err().to_string().contains("joint 'c'"));
}

#[test]
fn quaternions_of_any_size_are_normalised() {
    let space = space();
    let robot_places = Quaternions::of(&robot());
    for size in [1e-320, 1e-160, 1e-9, 1.0, 1e9, 1e160, 1e307] {
        let mut q = Q;
        q[4..8].iter_mut().for_each(|entry| *entry *= size);
        q[8..12].iter_mut().zip([0.0, 3.0, 0.0, -4.0]).for_each(|(entry, of)| *entry = of * size);
        let [first, second] = [0, 1].map(|k| robot_places.length(k, |k| q[k]) / size);
        // The smallest numbers have few digits.
        let rounding = if size < 1e-310 { 1e-3 } else { 1e-15 };
        assert!(
            (first - 1.0).abs() < rounding && (second / 5.0 - 1.0).abs() < rounding,
            "{size:e}: {first} {second}"
        );
        assert_eq!(robot_places.first_without_direction(|k| q[k]), None, "{size:e}");
        space.normalize(&mut q).unwrap();
        space.check(&q).unwrap();
        let expected = [&Q[4..8], &[0.0, 0.6, 0.0, -0.8]].concat();
        let error = q[4..12].iter().zip(expected).fold(0.0, |most, (q, e)| f64::max(most, (q - e).abs()));
        assert!(error < rounding, "{size:e}: {error:e}");
    }
    for bad in [0.0, f64::NAN, f64::INFINITY] {
        let mut q = Q;
        q[8..12].fill(bad);
        assert_eq!(robot_places.first_without_direction(|k| q[k]), Some(1), "{bad}");
    }
}
