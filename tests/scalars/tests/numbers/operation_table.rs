//! The table of operations: the same at every state, and in order.

use costate::derivative::OperationTable;
use costate::robot::{Friction, JointSpec, LinkInertia, Placement, Robot};
use costate::scalar::Constants::{Folded, Kept};
use nalgebra::Matrix3;

/// Three joints, one of them sliding, one with friction, in general directions.
fn robot() -> Robot {
    let friction = Friction { viscous: 0.3, coulomb: 0.5, coulomb_velocity: 0.1 };
    let link = || LinkInertia::about_com(2.0, [0.1, 0.2, -0.3], Matrix3::identity() * 0.2);
    let place = |turn: f64| Placement::from_xyz_rpy([0.3, 0.1, 0.2], [0.4, turn, 0.6]);
    let joints = [
        JointSpec::revolute("a"),
        JointSpec::prismatic("b").on("a"),
        JointSpec::revolute("c").on("b").friction(friction),
    ];
    let mut builder = Robot::builder("three");
    for (i, joint) in joints.into_iter().enumerate() {
        builder = builder.joint(joint.axis([0.2, -0.4, 0.7]).placed(place(i as f64)).carrying(link()));
    }
    builder.build().unwrap()
}

#[test]
fn counts_do_not_depend_on_the_state() {
    let robot = robot();
    for constants in [Folded, Kept] {
        let table = OperationTable::new(&robot, constants).unwrap();
        let states: [fn(usize) -> f64; 3] =
            [|_| 0.0, |i| 0.3 * i as f64 - 1.1, |i| (-2.0_f64).powi(i as i32)];
        for number in states {
            assert_eq!(OperationTable::counted_at(&robot, constants, &number).unwrap(), table);
        }
    }
}

/// A floating body with a spherical and a revolute joint.
fn flying() -> Robot {
    let body = || LinkInertia::about_com(2.0, [0.1, 0.2, -0.3], Matrix3::identity() * 0.2);
    let place = Placement::from_xyz_rpy([0.3, 0.1, 0.2], [0.4, 0.5, 0.6]);
    Robot::builder("flying")
        .joint(JointSpec::floating("root").placed(place).carrying(body()))
        .joint(JointSpec::spherical("hip").on("root").placed(place).carrying(body()))
        .joint(JointSpec::revolute("knee").on("hip").axis([0.2, -0.4, 0.7]).carrying(body()))
        .build()
        .unwrap()
}

#[test]
fn robots_with_quaternions_have_the_rows_of_methods_that_take_them() {
    for constants in [Folded, Kept] {
        let table = OperationTable::new(&flying(), constants).unwrap();
        let states: [fn(usize) -> f64; 2] = [|i| 0.3 * i as f64 - 1.1, |i| (-2.0_f64).powi(i as i32)];
        for number in states {
            assert_eq!(OperationTable::counted_at(&flying(), constants, &number).unwrap(), table);
        }
        let mul = |quantity, route| table.get(quantity, route).map(|operations| operations.mul);
        for route in ["analytic", "dual", "hyperdual"] {
            for pair in OperationTable::QUANTITIES.windows(2) {
                assert!(
                    mul(pair[0], route).is_some() && mul(pair[0], route) < mul(pair[1], route),
                    "{pair:?}"
                );
            }
        }
        for quantity in ["f_x", "y_f_xx"] {
            assert!(mul(quantity, "dual") > mul(quantity, "analytic"), "{quantity}");
        }
        assert!(mul("y_f_x", "analytic") > mul("f", "analytic") && mul("y_f_xx_d", "analytic").is_some());
        for (quantity, route) in [("f_x", "tensors"), ("y_f_xx", "dual pass"), ("f_xx", "analytic")] {
            assert_eq!(mul(quantity, route), None, "{quantity} {route}");
        }
        let by_hand = OperationTable::by_hand(&flying(), constants).unwrap();
        assert_eq!(by_hand.get("y_f_xx", "analytic"), table.get("y_f_xx", "analytic"));
    }
}

#[test]
fn more_takes_more() {
    let [folded, kept] = [Folded, Kept].map(|constants| OperationTable::new(&robot(), constants).unwrap());
    for table in [&folded, &kept] {
        let mul = |quantity, route| table.get(quantity, route).unwrap().mul;
        for pair in OperationTable::QUANTITIES.windows(2) {
            for route in OperationTable::ROUTES {
                assert!(mul(pair[0], route) < mul(pair[1], route), "{pair:?} {route}");
            }
        }
    }
    for (few, all) in folded.rows().zip(kept.rows()) {
        let (few, all) = (few.operations, all.operations);
        assert!(few.mul <= all.mul && few.add <= all.add && few.less <= all.less);
        assert_eq!((few.sincos, few.exp, few.sqrt, few.other), (all.sincos, all.exp, all.sqrt, 0));
    }
}

#[test]
fn rows_are_found_by_name() {
    let table = OperationTable::new(&robot(), Folded).unwrap();
    assert_eq!(table.rows().count(), 16 + OperationTable::MORE.len());
    for row in table.rows() {
        assert_eq!(table.get(row.quantity, row.route), Some(row.operations));
    }
    assert_eq!(table.get("f_x", "by magic"), None);
    assert_eq!(table.get("f", "dual"), table.get("f", "analytic"));
    assert_eq!(table.get("f", "analytic").map(|o| o.sincos), Some(2));
}

#[test]
fn the_rows_by_hand_are_those_without_automatic_differentiation() {
    let automatic = |quantity: &str, route: &str| {
        matches!(route, "dual" | "hyperdual") && !matches!(quantity, "mass_matrix" | "f")
    };
    for constants in [Folded, Kept] {
        let table = OperationTable::new(&robot(), constants).unwrap();
        let by_hand = OperationTable::by_hand(&robot(), constants).unwrap();
        assert!(table.rows().filter(|row| !automatic(row.quantity, row.route)).eq(by_hand.rows()));
        assert_eq!(by_hand.get("f_xx", "hyperdual"), None);
    }
}
