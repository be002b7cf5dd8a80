//! What constraints contradict, by how much they are missed, and poses that are singular.

use super::samples::four_bar;
use super::*;
use crate::robot::{ConstraintRow, ConstraintSpec, JointSpec, LinkInertia, Placement, Robot};
use std::f64::consts::PI;

fn at(xyz: [f64; 3], rpy: [f64; 3]) -> Placement {
    Placement::from_xyz_rpy(xyz, rpy)
}

/// Two links of 1 m in the plane z = 0; frame "tip" is at the end.
fn arm() -> Robot {
    let body = LinkInertia::about_com(1.0, [0.5, 0.0, 0.0], nalgebra::Matrix3::identity() * 0.1);
    let elbow = JointSpec::revolute("elbow").on("shoulder").placed(at([1.0, 0.0, 0.0], [0.0; 3]));
    Robot::builder("arm")
        .joint(JointSpec::revolute("shoulder").carrying(body))
        .joint(elbow.carrying(body))
        .build()
        .unwrap()
}

/// The end of the second link in the world.
fn tip(name: &str, rows: &[ConstraintRow], to: Placement) -> ConstraintSpec {
    ConstraintSpec::rows(name, "elbow", "world", rows).placed(at([1.0, 0.0, 0.0], [0.0; 3])).to_placed(to)
}

fn refused(robot: &Robot, q: &[f64], held: &[bool]) -> ConstraintError {
    ConstrainedHamiltonian::<f64>::new(robot).close(&mut q.to_vec(), held).unwrap_err()
}

fn contradiction(error: &ConstraintError) -> (&str, f64, &Conflict) {
    let ConstraintError::Contradiction { constraint, miss, because } = error else { panic!("{error}") };
    (constraint, *miss, because)
}

#[test]
fn misses_are_lengths_and_angles() {
    // It reaches 2 m towards a point 7 m away, with a rod of 1 m.
    let far = ConstraintSpec::distance("rod", "elbow", "world", 1.0)
        .placed(at([1.0, 0.0, 0.0], [0.0; 3]))
        .to_placed(at([7.0, 0.0, 0.0], [0.0; 3]));
    let error = refused(&arm().with_constraint(far).unwrap(), &[0.3, -0.5], &[false; 2]);
    assert!(
        matches!(&error, ConstraintError::CannotClose { miss, .. } if (miss - 4.0).abs() < 1e-4),
        "{error}"
    );
    let weld = ConstraintSpec::rigid("weld", "shoulder", "world");
    let welded = arm().with_constraint(weld).unwrap();
    let error = refused(&welded, &[2.0, 0.4], &[true, false]);
    let (constraint, miss, because) = contradiction(&error);
    assert!(constraint == "weld" && (miss - 2.0).abs() < 1e-12, "{error}");
    assert_eq!(because, &Conflict::Held { joints: vec!["shoulder".into()] });
    let mut rows = Constraints::<f64>::new(&welded);
    rows.set_position(&[2.0, 0.4]).unwrap();
    assert!((rows.miss(5) - 2.0).abs() < 1e-12 && rows.miss(0).abs() < 1e-15 && rows.miss(6) == 0.0);
    assert!((rows.values()[5] - 2.0 * f64::sin(1.0)).abs() < 1e-12);
    assert_eq!((rows.component(5), rows.component(6)), (Some(ConstraintRow::TurnZ), None));
    // Shorter than its rod, and of a coupling.
    let rod = ConstraintSpec::distance("rod", "elbow", "world", 2.5);
    let gear = ConstraintSpec::coupling("gear", &[("elbow", 2.0)], 0.5);
    let both = arm().with_constraint(rod).unwrap().with_constraint(gear).unwrap();
    let mut rows = Constraints::<f64>::new(&both);
    rows.set_position(&[0.3, 0.1]).unwrap();
    assert!((rows.miss(0) - 1.5).abs() < 1e-12 && (rows.miss(1) - 0.3).abs() < 1e-12);
    assert_eq!((rows.component(0), rows.component(1)), (None, None));
}

#[test]
fn what_a_constraint_contradicts_is_named() {
    use ConstraintRow::{X, Y, Z};
    // Before it are two constraints, and it is a sum of rows of one of them.
    let gear = ConstraintSpec::coupling("gear", &[("elbow", 1.0)], 0.4);
    let with = |specs: &[ConstraintSpec]| {
        specs.iter().fold(arm(), |robot, spec| robot.with_constraint(spec.clone()).unwrap())
    };
    let twice = ConstraintSpec::coupling("twice", &[("elbow", 2.0)], 1.0);
    let wall = tip("wall", &[X], at([1.2, 0.0, 0.0], [0.0; 3]));
    let error = refused(&with(&[wall, gear, twice]), &[0.3, 0.5], &[false; 2]);
    let (constraint, miss, because) = contradiction(&error);
    assert!(constraint == "twice" && (miss - 0.2).abs() < 1e-9, "{error}");
    assert_eq!(because, &Conflict::Earlier { constraints: vec!["gear".into()] });
    assert!(error.to_string().starts_with("constraint 'twice' contradicts those before it ('gear'): "));
    // The only constraint, above the plane.
    let above = tip("above", &[X, Y, Z], at([1.2, 0.3, 0.2], [0.0; 3]));
    let error = refused(&with(&[above]), &[0.3, 0.5], &[false; 2]);
    let (constraint, miss, because) = contradiction(&error);
    assert!(constraint == "above" && (miss - 0.2).abs() < 1e-9, "{error}");
    assert_eq!(because, &Conflict::Still { row: Some(Z) });
    let text = error.to_string();
    assert!(text.starts_with("row z of constraint 'above' cannot") && !text.contains("before"), "{text}");
    // One joint holds its link on a circle: x and y of a point beside it contradict each other.
    let beside = ConstraintSpec::rows("beside", "elbow", "world", &[X, Y]);
    let beside = beside.to_placed(at([0.5, 0.0, 0.0], [0.0; 3]));
    let error = refused(&with(&[beside]), &[0.3, 0.5], &[false; 2]);
    let (_, miss, because) = contradiction(&error);
    assert!((miss - 0.75_f64.sqrt()).abs() < 1e-9 && because == &Conflict::Itself, "{error}");
}

/// Floating joints are named as a whole, and only those that would move the row.
#[test]
fn held_joints_that_forbid_a_row_are_named() {
    let body = LinkInertia::about_com(3.0, [0.1, 0.0, 0.0], nalgebra::Matrix3::identity());
    let satellite = Robot::builder("satellite")
        .joint(JointSpec::floating("base").carrying(body))
        .joint(JointSpec::revolute("panel").on("base").carrying(body))
        .build()
        .unwrap();
    let pin = ConstraintSpec::pinned("pin", "base", "world").to_placed(at([0.0, 0.0, 0.7], [0.0; 3]));
    let pinned = satellite.with_constraint(pin).unwrap();
    let q = [0.1, -0.2, 0.3, 0.0, 0.0, 0.0, 1.0, 0.4];
    let mut held = [true; 7];
    held[6] = false;
    for all_held in [held, [true; 7]] {
        let error = refused(&pinned, &q, &all_held);
        let (constraint, miss, because) = contradiction(&error);
        assert!(constraint == "pin" && (miss - 0.4).abs() < 1e-12, "{error}");
        assert_eq!(because, &Conflict::Held { joints: vec!["base".into()] });
        assert!(error.to_string().contains("while 'base' is held"), "{error}");
    }
    let mut free = q.to_vec();
    ConstrainedHamiltonian::<f64>::new(&pinned).close(&mut free, &[false; 7]).unwrap();
}

/// The four-bar linkage with its pivot this far ahead (m), and these rows.
fn linkage(ahead: f64, rows: &[ConstraintRow]) -> Robot {
    let spec = ConstraintSpec::rows("pivot", "rocker_tip", "world", rows);
    let spec = spec.to_placed(at([ahead, 0.0, 0.0], [0.0; 3]));
    four_bar().without_constraints().with_constraint(spec).unwrap()
}

#[test]
fn poses_at_which_a_row_depends_on_others_by_chance_are_singular() {
    let (in_plane, pin) = (&ConstraintRow::ALL[..2], &ConstraintRow::ALL[..3]);
    let singular =
        |robot: &Robot, q: &[f64]| ConstrainedHamiltonian::<f64>::new(robot).singular_row(q).unwrap();
    // All rods in one line, exactly or nearly; folded, or stretched as far as they reach.
    for rows in [in_plane, pin, &ConstraintRow::ALL[..5]] {
        let folded = linkage(0.8, rows);
        for angle in [PI, PI + 1e-11, PI + 5e-8] {
            assert_eq!(singular(&folded, &[0.0, 0.0, angle]), Some(0));
        }
        assert_eq!(singular(&linkage(2.6, rows), &[0.0; 3]), Some(0));
        // Elsewhere none is; those out of the plane are redundant everywhere.
        for (ahead, crank) in [(1.3, 1.0), (1.3, 2.6), (0.8, 1.0)] {
            let robot = linkage(ahead, rows);
            let mut q = [crank, -0.6, -2.0];
            ConstrainedHamiltonian::<f64>::new(&robot).close(&mut q, &[true, false, false]).unwrap();
            assert_eq!(singular(&robot, &q), None, "{q:?}");
        }
    }
}

/// Bennett's linkage of four skew revolute joints (G. T. Bennett, "A new mechanism", Engineering 76 (1903)
/// 777-778) moves with one row more than its count allows: `sin(alpha)/a = sin(beta)/b` makes it depend on
/// the others wherever the loop is closed, and nowhere else.
#[test]
fn rows_that_depend_on_others_wherever_the_loop_is_closed_are_not_singular() {
    let ([a, b], alpha) = ([0.4, 0.6], 0.5_f64);
    let beta = (alpha.sin() * b / a).asin();
    let body = LinkInertia::about_com(1.0, [0.2, 0.1, 0.0], nalgebra::Matrix3::identity() * 0.02);
    let links = Robot::builder("bennett")
        .joint(JointSpec::revolute("one").carrying(body))
        .joint(
            JointSpec::revolute("two").on("one").placed(at([a, 0.0, 0.0], [alpha, 0.0, 0.0])).carrying(body),
        )
        .joint(
            JointSpec::revolute("three").on("two").placed(at([b, 0.0, 0.0], [beta, 0.0, 0.0])).carrying(body),
        )
        .build()
        .unwrap();
    let rows = &ConstraintRow::ALL[..5];
    let last = ConstraintSpec::rows("four", "three", "world", rows)
        .placed(at([a, 0.0, 0.0], [alpha, 0.0, 0.0]))
        .to_placed(at([-b, 0.0, 0.0], [-beta, 0.0, 0.0]));
    let robot = links.with_constraint(last).unwrap();
    let ratio = (0.5 * (beta + alpha)).sin() / (0.5 * (beta - alpha)).sin();
    let mut model = ConstrainedHamiltonian::<f64>::new(&robot);
    for angle in [1.9, 2.5_f64] {
        let q = [angle, 2.0 * (ratio / (0.5 * angle).tan()).atan(), -angle];
        model.velocity(&q, &[0.0; 3]).unwrap();
        assert!(
            (0..5).all(|row| model.constraints().miss(row) < 1e-12),
            "{:?}",
            model.constraints().values()
        );
        assert_eq!(model.rank(), 2);
        assert_eq!(model.singular_row(&q).unwrap(), None);
        let apart = [q[0] + 0.1, q[1], q[2]];
        model.velocity(&apart, &[0.0; 3]).unwrap();
        assert_eq!(model.rank(), 3, "only where it is closed");
    }
}
