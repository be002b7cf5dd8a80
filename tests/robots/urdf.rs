//! URDF files: what is loaded.

use crate::texts::*;
use costate::robot::RobotError as E;
use costate::robot::urdf::parse;
use costate::robot::{Friction, Joint, JointKind, LinkInertia, LoadOptions, Placement, Robot, Warning};
use nalgebra::{Matrix3, Vector3};

/// Inertia of `INERTIAL`.
fn body() -> LinkInertia {
    LinkInertia::about_com(2.0, [0.1, 0.0, 0.2], Matrix3::from_diagonal(&Vector3::new(0.3, 0.3, 0.2)))
}

fn assert_close(a: &LinkInertia, b: &LinkInertia, tolerance: f64) {
    let gap = (a.inertia - b.inertia).amax().max((a.com - b.com).amax()).max((a.mass - b.mass).abs());
    assert!(gap <= tolerance, "{a:?} is not {b:?}");
}

#[test]
fn fixed_links_are_merged() {
    let [first, second] = [("0.1 0.2 0.3", "0.4 -0.5 0.6"), ("-0.3 0.1 0", "1.1 0.2 -2")];
    let origin = |(xyz, rpy)| format!("<origin xyz=\"{xyz}\" rpy=\"{rpy}\"/>");
    let text = tree(
        &["base", "stand", "arm", "flange", "tool", "finger"],
        &[
            ("mount", "fixed", "base", "stand", &origin(first)),
            ("elbow", "revolute", "stand", "arm", &origin(second)),
            ("flange", "fixed", "arm", "flange", &origin(first)),
            (
                "tool",
                "fixed",
                "flange",
                "tool",
                &(origin(second) + "<axis xyz=\"0 0 0\"/><mimic joint=\"elbow\"/>"),
            ),
            ("grip", "prismatic", "tool", "finger", &origin(first)),
        ],
    );
    let robot = load(&text);
    let a = Placement::from_xyz_rpy([0.1, 0.2, 0.3], [0.4, -0.5, 0.6]);
    let b = Placement::from_xyz_rpy([-0.3, 0.1, 0.0], [1.1, 0.2, -2.0]);
    assert_eq!(names(&robot), ["elbow", "grip"]);
    let merged = body().merged(&body().placed(&a)).merged(&body().placed(&a.then(&b)));
    assert_close(&robot.joints()[0].inertia, &merged, 1e-15);
    assert_eq!(robot.joints()[0].placement, a.then(&b));
    assert_eq!(robot.joints()[1].inertia, body());
    assert_eq!((robot.joints()[1].parent, robot.joints()[1].placement), (Some(0), a.then(&b).then(&a)));
    assert_eq!(robot.warnings(), []);
}

#[test]
fn the_frame_of_an_inertial_rotates_its_inertia() {
    let rotated = INERTIAL.replace("0.2\"/>", "0.2\" rpy=\"0.3 0.7 -0.2\"/>");
    let rotation = Placement::from_xyz_rpy([0.0; 3], [0.3, 0.7, -0.2]).rotation;
    let expected = LinkInertia { inertia: rotation * body().inertia * rotation.transpose(), ..body() };
    assert_close(&load(&arm(&rotated)).joints()[0].inertia, &expected, 1e-16);
}

#[test]
fn links_without_inertia_and_odd_base_links_are_fine() {
    let odd = INERTIAL.replace("izz=\"0.2\"", "izz=\"9\"").replace("iyz=\"0\"", "iyz=\"7\"");
    let text = more(
        "<link name=\"tool0\"/><joint name=\"t\" type=\"fixed\"><parent link=\"arm\"/><child link=\"tool0\"/></joint>",
    );
    let robot = load(&text.replace("<link name=\"base\"/>", &format!("<link name=\"base\">{odd}</link>")));
    assert_eq!(robot.joints()[0].inertia, body());
    // The base of an arm: a note. That of a robot with several branches may be meant to move.
    assert!(matches!(&robot.warnings()[0], Warning::Note { text } if text.contains("'base' (line 2), 2 kg")));
    assert_eq!(robot.warnings().len(), 1);
    let (line, error) = refused(&more("").replace(
        "<link name=\"base\"/>",
        &format!("<link name=\"base\">{}</link>", INERTIAL.replace("\"2\"", "\"-1\"")),
    ));
    assert!(line == Some(2) && matches!(error, E::NegativeMass { .. }), "{error}");
}

#[test]
fn branches_and_order() {
    let links = ["torso", "left", "hand", "right"];
    let robot = load(&tree(
        &links,
        &[
            ("right", "revolute", "torso", "right", ""),
            ("hand", "revolute", "left", "hand", ""),
            ("left", "prismatic", "torso", "left", ""),
        ],
    ));
    assert_eq!(names(&robot), ["right", "left", "hand"]);
    assert_eq!(robot.joints().iter().map(|j| j.parent).collect::<Vec<_>>(), [None, None, Some(1)]);
    let kept = [
        ("left", "revolute", "torso", "left", ""),
        ("right", "revolute", "torso", "right", ""),
        ("hand", "revolute", "left", "hand", ""),
    ];
    assert_eq!(names(&load(&tree(&links, &kept))), ["left", "right", "hand"]);
}

#[test]
fn floating_joint() {
    let text = tree(
        &["world", "trunk", "leg"],
        &[
            ("hip", "revolute", "trunk", "leg", ""),
            (
                "free",
                "floating",
                "world",
                "trunk",
                "<origin xyz=\"0 0 1\" rpy=\"0 0 0.5\"/><axis xyz=\"0 0 0\"/>",
            ),
        ],
    );
    let robot = load(&text);
    assert_eq!(names(&robot), ["free_x", "free_y", "free_z", "free_rz", "free_ry", "free_rx", "hip"]);
    let axes = [Vector3::x(), Vector3::y(), Vector3::z(), Vector3::z(), Vector3::y(), Vector3::x()];
    for (k, joint) in robot.joints()[..6].iter().enumerate() {
        let kind = if k < 3 { JointKind::Prismatic } else { JointKind::Revolute };
        assert_eq!((joint.kind, joint.axis, joint.parent), (kind, axes[k], k.checked_sub(1)));
        assert_eq!(joint.inertia, if k == 5 { body() } else { LinkInertia::massless() });
        let placement = if k == 0 {
            Placement::from_xyz_rpy([0.0, 0.0, 1.0], [0.0, 0.0, 0.5])
        } else {
            Placement::identity()
        };
        assert_eq!(joint.placement, placement);
    }
    assert_eq!(robot.joints()[6].parent, Some(5));
    assert_eq!(robot.warnings(), [Warning::Expanded { joint: "free".into(), kind: "floating" }]);
}

#[test]
fn planar_joint() {
    let robot = load(&elbow("planar", "<axis xyz=\"0 0 2\"/><dynamics damping=\"1\"/>"));
    assert_eq!(names(&robot), ["elbow_x", "elbow_y", "elbow_rz"]);
    let kinds: Vec<_> = robot.joints().iter().map(|joint| joint.kind).collect();
    assert_eq!(kinds, [JointKind::Prismatic, JointKind::Prismatic, JointKind::Revolute]);
    let axes = |robot: &Robot| robot.joints().iter().map(|joint| joint.axis).collect::<Vec<_>>();
    assert_eq!(axes(&robot), [Vector3::x(), Vector3::y(), Vector3::z()]);
    assert_eq!((robot.joints()[1].inertia, robot.joints()[2].inertia), (LinkInertia::massless(), body()));
    assert!(robot.warnings().contains(&Warning::Expanded { joint: "elbow".into(), kind: "planar" }));
    assert!(notes(&robot).contains("<dynamics> of joint 'elbow'"), "{}", notes(&robot));
    for axis in ["1 0 0", "0 -3 0", "0.2 -0.5 0.1", "-5 0.1 0.1", "0 0 -1"] {
        let axes = axes(&load(&elbow("planar", &format!("<axis xyz=\"{axis}\"/>"))));
        let frame = Matrix3::from_columns(&axes);
        assert!((frame.transpose() * frame - Matrix3::identity()).amax() < 1e-15, "{axis}");
        assert!((frame.determinant() - 1.0).abs() < 1e-15, "{axis}");
    }
}

#[test]
fn joint_types_axes_and_limits() {
    let limit = "<limit lower=\"-1\" upper=\"2\" effort=\"3\" velocity=\"4\"/>";
    let joint = |text: &str| load(text).joints()[0].clone();
    let revolute = joint(&elbow("revolute", limit));
    let all = |joint: &Joint| {
        let limits = joint.limits;
        [limits.lower, limits.upper, limits.effort, limits.velocity]
    };
    let inf = f64::INFINITY;
    assert_eq!(
        (revolute.kind, revolute.axis, all(&revolute)),
        (JointKind::Revolute, Vector3::x(), [-1.0, 2.0, 3.0, 4.0])
    );
    let continuous = joint(&elbow("continuous", limit));
    assert_eq!((continuous.kind, all(&continuous)), (JointKind::Revolute, [-inf, inf, 3.0, 4.0]));
    let prismatic = joint(&elbow("prismatic", "<axis xyz=\"0 -3 4\"/>"));
    assert_eq!((prismatic.kind, all(&prismatic)), (JointKind::Prismatic, [-inf, inf, inf, inf]));
    assert_eq!(prismatic.axis, Vector3::new(0.0, -0.6, 0.8));
    let no_velocity = load(&elbow("revolute", "<limit lower=\"-1\" effort=\"3\"/>"));
    assert_eq!(all(&no_velocity.joints()[0]), [-1.0, 0.0, 3.0, inf]);
    assert!(notes(&no_velocity).contains("unlimited: joint elbow"), "{}", notes(&no_velocity));
    let stuck = load(&elbow("revolute", "<limit effort=\"3\" velocity=\"4\"/>"));
    assert_eq!(all(&stuck.joints()[0]), [0.0, 0.0, 3.0, 4.0]);
    assert!(notes(&stuck).contains("neither lower nor upper"), "{}", notes(&stuck));
    let version = |text: String| text.replace("bench\"", "bench\" version=\"1.2\"");
    let newer = load(&version(elbow("revolute", "<limit upper=\"1\"/>")));
    assert_eq!((all(&newer.joints()[0]), newer.warnings()), ([-inf, 1.0, inf, inf], &[][..]));
}

#[test]
fn quaternions_since_version_1_1() {
    let text = elbow("continuous", "<origin quat_xyzw=\"0 0 0.6 0.8\"/>");
    let old = load(&text);
    assert_eq!(old.joints()[0].placement, Placement::identity());
    assert!(
        notes(&old).contains("quat_xyzw of <origin> of joint 'elbow' (line 8) was ignored"),
        "{}",
        notes(&old)
    );
    let new = load(&text.replace("bench\"", "bench\" version=\"1.1\""));
    let expected = Matrix3::new(0.28, -0.96, 0.0, 0.96, 0.28, 0.0, 0.0, 0.0, 1.0);
    assert!((new.joints()[0].placement.rotation - expected).amax() < 1e-15 && new.warnings().is_empty());
}

#[test]
fn friction_on_request() {
    let text = elbow("continuous", "<dynamics damping=\"0.5\" friction=\"0.1\"/>");
    let ignored = load(&text);
    assert!(ignored.joints()[0].friction.is_none());
    assert_eq!(ignored.warnings(), [Warning::FrictionIgnored { joints: vec!["elbow".into()] }]);
    let options = LoadOptions::default().friction(true);
    let loaded = parse(&text, options).unwrap();
    let coulomb_velocity = Friction::DEFAULT_COULOMB_VELOCITY;
    assert_eq!(loaded.joints()[0].friction, Friction { viscous: 0.5, coulomb: 0.1, coulomb_velocity });
    assert_eq!(loaded.warnings(), []);
    assert_eq!(load(&elbow("continuous", "<dynamics damping=\"0\"/>")).warnings(), []);
    let bad = parse(&text.replace("0.5", "-0.5"), options).unwrap_err();
    assert!(matches!(bad, E::InFile { line: Some(6), .. }), "{bad}");
}
