//! What cannot be changed of a robot, and what changes say.

use costate::robot::{
    Friction, JointSpec, Limits, LinkInertia, LoadOptions, Placement, Robot, RobotEdit, RobotError as E,
    Warning, Wrench,
};
use nalgebra::Matrix3;

const NOTHING: [(&str, f64); 0] = [];

/// shoulder - elbow - (finger, thumb); thumb mimics finger.
fn arm() -> Robot {
    let link = LinkInertia::about_com(1.0, [0.3, 0.0, 0.1], Matrix3::identity() * 0.02);
    let joint = |name: &str| {
        let place = Placement::from_xyz_rpy([0.5, 0.1, 0.0], [0.2, 0.0, 0.3]);
        let limits = Limits { lower: -2.0, upper: -0.5, velocity: 3.0, effort: 4.0 };
        JointSpec::revolute(name).placed(place).carrying(link).armature(0.1).limits(limits)
    };
    Robot::builder("arm")
        .joint(joint("shoulder"))
        .joint(joint("elbow").on("shoulder"))
        .joint(joint("finger").on("elbow").limits(Limits::default()))
        .joint(joint("thumb").on("elbow").limits(Limits::default()).mimicking("finger", -1.0, 0.2))
        .build()
        .unwrap()
}

fn says(error: E, words: &[&str]) {
    let message = error.to_string();
    for word in words {
        assert!(message.contains(word), "'{word}' is not in: {message}");
    }
}

#[test]
fn what_cannot_be_locked_is_named() {
    let arm = arm();
    let refused = |joints: &[(&str, f64)]| arm.lock(joints).unwrap_err();
    says(refused(&[("elbwo", -1.0)]), &["'elbwo'", "did you mean 'elbow'?"]);
    says(refused(&[("gripper", -1.0)]), &["'gripper'", "costate info"]);
    says(refused(&[("thumb", 0.0)]), &["'thumb'", "name 'finger' instead"]);
    says(refused(&[("elbow", f64::NAN)]), &["'elbow'", "NaN", "finite"]);
    says(refused(&[("elbow", -1.0), ("elbow", -1.0)]), &["'elbow'", "twice"]);
    let all = refused(&[("shoulder", -1.0), ("elbow", -1.0), ("finger", 0.0)]);
    says(all, &["'shoulder', 'elbow', 'finger'", "leave at least one"]);
    let q = [0.0; 3];
    says(arm.reduced_to(&["shoulderr"], &q).unwrap_err(), &["'shoulder'"]);
    says(arm.reduced_to(&["elbow", "elbow"], &q).unwrap_err(), &["'elbow'", "named twice"]);
    says(arm.reduced_to(&["thumb"], &q).unwrap_err(), &["'finger'"]);
    says(arm.reduced_to(&["elbow"], &q[1..]).unwrap_err(), &["2 positions for 3"]);
    assert!(matches!(arm.reduced_to(&[], &q), Err(E::AllLocked { .. })));
    let locked = arm.lock(&[("elbow", -1.0)]).unwrap();
    for error in [
        locked.reduced_to(&["shoulder", "elbow"], &q[1..]).unwrap_err(),
        locked.lock(&[("elbow", -1.0)]).unwrap_err(),
        locked.with_joint_armature("elbow", 0.1).unwrap_err(),
    ] {
        assert!(matches!(error, E::StillJoint { .. }), "{error}");
        says(error, &["'elbow'", "locked, or fixed in the file"]);
    }
}

#[test]
fn a_lock_outside_the_limits_is_a_warning() {
    let arm = arm();
    let locked = arm.lock(&[("elbow", 0.0)]).unwrap();
    let [warning] = locked.warnings() else { panic!("{:?}", locked.warnings()) };
    assert!(matches!(warning, Warning::LockedOutside { joint, .. } if joint == "elbow"));
    assert_eq!(warning.to_string(), "joint 'elbow' is locked at 0, outside its limits -2 and -0.5");
    assert_eq!(arm.lock(&[("elbow", -1.0)]).unwrap().warnings(), []);
    assert_eq!(arm.lock(&NOTHING).unwrap(), arm);
    let edit = [RobotEdit::Lock(vec![("elbow".into(), 0.0)])];
    assert_eq!(arm.edited(&edit, LoadOptions::default()).unwrap(), locked);
    let strict = arm.edited(&edit, LoadOptions::default().strict(true)).unwrap_err();
    assert!(matches!(strict, E::Strict { ref warnings } if warnings.len() == 1), "{strict}");
}

#[test]
fn what_mimics_a_locked_joint_is_locked_with_it() {
    let locked = arm().lock(&[("finger", 0.7), ("shoulder", -1.0)]).unwrap();
    assert_eq!((locked.joints().len(), locked.dof()), (1, 1));
    assert_eq!(locked.joints()[0].inertia.mass, 3.0);
    assert_eq!(locked.armature_entry(0, 0), 0.1);
    let kept = arm().lock(&[("shoulder", -1.0), ("elbow", -1.0)]).unwrap();
    let [finger, thumb] = kept.joints() else { panic!() };
    assert_eq!((finger.parent, thumb.parent, thumb.mimic.unwrap().joint), (None, None, 0));
    assert_eq!(kept.frame("elbow").unwrap().joint, None);
}

#[test]
fn payloads_that_cannot_be_are_named() {
    let arm = arm();
    let refused = |frame: &str, load: LinkInertia| arm.with_payload(frame, &load).unwrap_err();
    let point = |mass| LinkInertia::point(mass, [0.0, 0.0, 0.1]);
    says(refused("fingre", point(1.0)), &["'fingre'", "'finger'"]);
    says(refused("world", point(1.0)), &["'world'", "beyond a joint"]);
    says(refused("finger", point(-1.0)), &["the payload of frame 'finger'", "-1 kg"]);
    says(refused("finger", point(f64::NAN)), &["the payload of frame 'finger'", "mass"]);
    says(
        refused("finger", LinkInertia::point(1.0, [f64::INFINITY, 0.0, 0.0])),
        &["the payload of frame 'finger'", "centre"],
    );
    let turned_over = LinkInertia::about_com(1.0, [0.0; 3], Matrix3::from_diagonal(&[-1.0, 0.5, 0.5].into()));
    says(refused("finger", turned_over), &["the payload of frame 'finger'", "negative principal moment"]);
    let flat = LinkInertia::about_com(1.0, [0.0; 3], Matrix3::from_diagonal(&[0.1, 0.1, 0.5].into()));
    let warnings = arm.with_payload("finger", &flat).unwrap().warnings().to_vec();
    let [warning] = &warnings[..] else { panic!("{warnings:?}") };
    assert!(warning.to_string().contains("the payload of frame 'finger'"), "{warning}");
    // Once, also on a link that has no mass of its own, and after another edit.
    let bare = JointSpec::revolute("bare").on("finger").armature(0.1);
    let bare = Robot::builder("bare")
        .joint(JointSpec::revolute("finger").carrying(point(1.0)).armature(0.1))
        .joint(bare)
        .build()
        .unwrap();
    let loaded = bare.with_payload("bare", &flat).unwrap();
    for robot in [loaded.with_joint_armature("finger", 0.2).unwrap(), loaded] {
        let [warning] = robot.warnings() else { panic!("{:?}", robot.warnings()) };
        assert!(warning.to_string().contains("the payload of frame 'bare'"), "{warning}");
    }
}

/// What has no effect is not silent.
#[test]
fn idle_wrenches_and_empty_payloads_are_warnings() {
    let strict = LoadOptions::default().strict(true);
    let pull = Wrench { force: [1.0, 0.0, 0.0], ..Wrench::default() };
    let idle = |frame: &str| Warning::IdleWrench { frame: frame.into() };
    let pulled = arm().with_wrench("world", pull).unwrap();
    assert_eq!(pulled.warnings(), [idle("world")]);
    assert_eq!(pulled.with_wrench("world", pull).unwrap().warnings(), [idle("world")]);
    assert_eq!(pulled.without_wrenches(), arm());
    assert!(arm().with_wrench("elbow", pull).unwrap().warnings().is_empty());
    let edit = [RobotEdit::Wrench("world".into(), pull)];
    says(arm().edited(&edit, strict).unwrap_err(), &["'world'", "no effect"]);
    // A joint that is locked no longer moves the frame.
    let held = arm().with_wrench("shoulder", pull).unwrap().lock(&[("shoulder", -1.0)]).unwrap();
    assert_eq!(held.warnings(), [idle("shoulder")]);
    let nothing = LinkInertia::massless();
    let carrying = arm().with_payload("elbow", &nothing).unwrap();
    assert_eq!(carrying.warnings(), [Warning::EmptyPayload { frame: "elbow".into() }]);
    let edit = [RobotEdit::Payload("elbow".into(), nothing)];
    says(arm().edited(&edit, strict).unwrap_err(), &["'elbow'", "neither mass nor inertia"]);
    let rod = LinkInertia::about_com(0.0, [0.0; 3], Matrix3::identity());
    assert!(arm().with_payload("elbow", &rod).unwrap().warnings().is_empty());
}

#[test]
fn figures_of_joints_are_replaced_and_checked() {
    let arm = arm();
    let changed = arm.with_joint_armature("elbow", 0.7).unwrap();
    assert_eq!((changed.armature_entry(1, 1), changed.armature_entry(0, 0)), (0.7, 0.1));
    let law = Friction { viscous: 0.3, ..Friction::none() };
    assert_eq!(arm.with_friction("thumb", law).unwrap().joints()[3].friction, law);
    let limits = Limits { lower: -9.0, ..Limits::default() };
    assert_eq!(arm.with_limits("finger", limits).unwrap().joints()[2].limits, limits);
    for (error, words) in [
        (arm.with_joint_armature("elbo", 0.1), ["'elbo'", "'elbow'"]),
        (arm.with_joint_armature("elbow", -0.1), ["'elbow'", "armature"]),
        (arm.with_friction("elbow", Friction { viscous: f64::NAN, ..law }), ["'elbow'", "viscous"]),
        (arm.with_limits("elbow", Limits { lower: 1.0, upper: 0.0, ..limits }), ["'elbow'", "lower limit"]),
        (arm.with_limits("thumb", limits), ["'thumb'", "'finger'"]),
    ] {
        says(error.unwrap_err(), &words);
    }
    let massless = Robot::builder("rotor").joint(JointSpec::revolute("a").armature(0.1)).build().unwrap();
    let without = massless.with_joint_armature("a", 0.0).unwrap();
    assert!(without.warnings().contains(&Warning::KinematicsOnly { joint: "a".into() }));
}

#[test]
fn edits_are_made_one_after_the_other() {
    let load = LinkInertia::point(2.0, [0.0, 0.0, 0.1]);
    let edits = [
        RobotEdit::Gravity([0.0, 0.0, -1.62]),
        RobotEdit::Armature("shoulder".into(), 0.5),
        RobotEdit::Payload("finger".into(), load),
        RobotEdit::Lock(vec![("elbow".into(), -1.0)]),
        RobotEdit::ReducedTo(vec!["shoulder".into()]),
    ];
    let edited = arm().edited(&edits, LoadOptions::default()).unwrap();
    assert_eq!((edited.dof(), edited.gravity().z, edited.armature_entry(0, 0)), (1, -1.62, 0.5));
    assert_eq!(edited.joints()[0].inertia.mass, 6.0);
}
