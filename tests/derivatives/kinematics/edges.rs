//! Large and small numbers, robots without mass, frames of the world, wrong arguments.

use super::apart;
use super::judge::{ANGULAR, CENTRE, Judged, POSITION, Quantities};
use costate::kinematics::{Kinematics, ReferenceFrame};
use costate::robot::{JointSpec, LinkInertia, Robot};
use nalgebra::Rotation3;

/// What is large or small keeps its digits: angles of many turns, tiny and huge masses.
#[test]
fn extreme_angles_and_masses_lose_nothing() {
    for (mass, turns) in [(1e-6, 1e6), (1e6, 1e6), (1e-6, 0.0), (1e6, -3.0)] {
        let body = |com| LinkInertia::point(mass, com);
        let robot = Robot::builder("arm")
            .joint(JointSpec::revolute("a").axis([0.3, 1.0, -0.2]).carrying(body([0.1, 0.2, 0.3])))
            .joint(JointSpec::prismatic("b").on("a").axis([1.0, 0.2, 0.1]).carrying(body([0.0, 0.2, 0.1])))
            .joint(JointSpec::revolute("c").on("b").axis([0.0, 0.6, 0.8]).carrying(body([0.4, 0.0, -0.3])))
            .build()
            .unwrap();
        let (frame, desired) = (robot.frame_index("c").unwrap(), Rotation3::identity());
        let quantities = Quantities { robot, frame, desired };
        let (q, v, w) = ([turns, 0.4, 0.7 - turns], [1.0, -0.5, 0.2], [0.3, -1.0, 0.6]);
        let judged = Judged::at(&quantities, &q, &v);
        let mut kinematics = quantities.kinematics(&q, &v);
        // Three links within 1 m of each other: terms of at most a few, of fewer than 1000 operations.
        let bound = 1e3 * f64::EPSILON;
        let hessian = kinematics.centre_of_mass_hessian(&w).unwrap().view().to_nalgebra();
        assert!(apart(&hessian, &judged.contracted_q(CENTRE, &w)) < bound);
        let hessian = kinematics.position_hessian(frame, &w).unwrap().view().to_nalgebra();
        assert!(apart(&hessian, &judged.contracted_q(POSITION, &w)) < bound);
        let found = kinematics.momentum_hessian(&w, &w).unwrap().view().to_nalgebra() / mass;
        let expected = judged.contracted(ANGULAR, &[w, w].concat()) / mass;
        assert!(apart(&found, &expected) < 10.0 * bound);
    }
}

#[test]
fn a_robot_without_mass_has_no_centre_of_mass() {
    let robot = Robot::builder("rotor").joint(JointSpec::revolute("a").armature(1.0)).build().unwrap();
    let mut kinematics = Kinematics::<f64>::new(&robot);
    assert!(kinematics.centre_of_mass().unwrap_err().to_string().contains("no link that moves has a mass"));
    assert!(kinematics.momentum().is_err() && kinematics.centre_of_mass_hessian(&[1.0; 3]).is_err());
    assert!(kinematics.jacobian(1, ReferenceFrame::Local).is_ok());
}

#[test]
fn bad_arguments_are_refused() {
    let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/two_link.toml")).unwrap();
    let mut kinematics = Kinematics::<f64>::new(&robot);
    let error = kinematics.pose(99).unwrap_err().to_string();
    assert!(error.contains("no frame 99"), "{error}");
    let error = kinematics.set_state(&[0.0, f64::NAN], &[0.0; 2]).unwrap_err().to_string();
    assert!(error.contains("q[1]"), "{error}");
    assert!(kinematics.set_motion(&[0.0; 2], &[0.0; 3], &[0.0; 2]).is_err());
    assert!(kinematics.position_hessian_product(1, &[1.0; 3], &[0.0; 2], &mut [0.0; 1]).is_err());
}

#[test]
fn frames_of_the_world_do_not_move() {
    let robot = Robot::from_file(concat!(env!("CARGO_MANIFEST_DIR"), "/robots/two_link.toml")).unwrap();
    let mut kinematics = Kinematics::<f64>::new(&robot);
    kinematics.set_state(&[0.3, 0.4], &[1.0, 2.0]).unwrap();
    assert_eq!(kinematics.pose(0).unwrap().position, [0.0; 3]);
    for axes in ReferenceFrame::ALL {
        assert_eq!(kinematics.twist(0, axes).unwrap().linear.to_array(), [0.0; 3]);
        assert!(kinematics.jacobian(0, axes).unwrap().as_slice().iter().all(|entry| *entry == 0.0));
    }
    assert!(kinematics.position_hessian(0, &[1.0; 3]).unwrap().as_slice().iter().all(|entry| *entry == 0.0));
}
