//! Robots in TOML: what is loaded.

use crate::toml_files::{BODY, refused, two};
use costate::robot::{JointKind, LoadOptions, Placement, WrenchAxes, file::parse};

#[test]
fn every_key_arrives() {
    let text = two(
        "type = 'prismatic'\nplacement = { xyz = [1.0, 2.0, 3.0], rpy = [0.1, 0.2, 0.3] }\naxis = [0.0, 3.0, 4.0]\n\
         armature = 0.7\nspring = { stiffness = 5.0, rest = 0.1 }\nlimits = { upper = 2.0, effort = 9.0 }\n\
         friction = { viscous = 0.2, coulomb = 0.3, coulomb_velocity = 0.4 }",
        "parent = 'world'\ninertia_about = 'frame'",
    );
    let text = text.replacen(
        "[[",
        "gravity = [1.0, 0.0, 0.0]\narmature = [[0.5, 0.1], [0.1, 0.6]]\nsources = ['x']\n[[",
        1,
    );
    let robot = parse(&text, LoadOptions::default()).unwrap();
    let (a, b) = (&robot.joints()[0], &robot.joints()[1]);
    assert_eq!((a.kind, a.parent, b.parent), (JointKind::Prismatic, None, None));
    assert_eq!((a.placement.translation.z, a.axis.y, a.axis.z), (3.0, 0.6, 0.8));
    assert_eq!((robot.armature_entry(0, 0), robot.armature_entry(1, 0)), (0.5 + 0.7, 0.1));
    assert_eq!((a.spring.stiffness, a.spring.rest, a.friction.coulomb_velocity), (5.0, 0.1, 0.4));
    assert_eq!((a.limits.lower, a.limits.upper, a.limits.effort), (f64::NEG_INFINITY, 2.0, 9.0));
    assert_eq!((b.inertia.inertia[(0, 0)], robot.gravity().x), (0.1, 1.0));
    assert!((b.inertia.inertia[(2, 2)] - (0.25 - 2.0 * 0.09)).abs() < 1e-15);
}

/// A branched standard table with a prismatic joint, compared with the placements it means.
#[test]
fn standard_tables_branch() {
    let table = format!(
        "name = 't'\nconvention = 'standard-dh'\n\
         [[joint]]\nname = 'a'\ndh = {{ alpha = 0.3, a = 0.5, d = 0.2, theta = 0.1 }}\n{BODY}\n\
         [[joint]]\nname = 'b'\ntype = 'prismatic'\ndh = {{ alpha = -0.4, a = 0.1, d = 0.7, theta = 0.6 }}\n{BODY}\n\
         [[joint]]\nname = 'c'\nparent = 'a'\ndh = {{ a = 0.2, theta = -1.0 }}\n{BODY}\n"
    );
    let robot = parse(&table, LoadOptions::default()).unwrap();
    let about = |x: f64, z: f64| Placement::from_xyz_rpy([0.0; 3], [x, 0.0, z]);
    let along = |x: f64, z: f64| Placement::from_xyz_rpy([x, 0.0, z], [0.0; 3]);
    let far = along(0.5, 0.0).then(&about(0.3, 0.0));
    let expected = [
        about(0.0, 0.1).then(&along(0.0, 0.2)),
        far.then(&about(0.0, 0.6)).then(&along(0.0, 0.7)),
        far.then(&about(0.0, -1.0)),
    ];
    for (joint, expected) in robot.joints().iter().zip(expected) {
        let found = joint.placement;
        assert!((found.rotation - expected.rotation).amax() < 1e-15, "{}", joint.name);
        assert!((found.translation - expected.translation).amax() < 1e-15, "{}", joint.name);
    }
    assert_eq!(robot.joints()[2].parent, Some(0));
    assert!((robot.joints()[2].inertia.com.x - 0.5).abs() < 1e-15, "0.3 in frame 3, which is 0.2 further");
}

/// Rows of the armature matrix are in the order of the file, which parents may change.
#[test]
fn the_armature_matrix_follows_reordered_joints() {
    let joint =
        |name: &str, parent: &str| format!("[[joint]]\nname = '{name}'\nparent = '{parent}'\n{BODY}\n");
    let text = [
        "name = 'r'\narmature = [[1.0, 0.2], [0.2, 3.0]]\n".into(),
        joint("hand", "arm"),
        joint("arm", "world"),
    ];
    let robot = parse(&text.concat(), LoadOptions::default()).unwrap();
    assert_eq!(
        (robot.joints()[0].name.as_str(), robot.armature_entry(0, 0), robot.armature_entry(1, 0)),
        ("arm", 3.0, 0.2)
    );
}

#[test]
fn joints_keep_the_order_of_the_file_after_their_parents() {
    let joint =
        |name: &str, parent: &str| format!("[[joint]]\nname = '{name}'\nparent = '{parent}'\n{BODY}\n");
    let text =
        ["name = 'r'\n".into(), joint("hand", "arm"), joint("leg", "world"), joint("arm", "world")].concat();
    let robot = parse(&text, LoadOptions::default()).unwrap();
    let names: Vec<&str> = robot.joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["leg", "arm", "hand"]);
    assert_eq!(robot.joints()[2].parent, Some(1));
}

#[test]
fn frames_and_wrenches_are_read_in_their_order() {
    let attached = "[[frame]]\nname = 'tool'\nparent = 'b'\nplacement = { xyz = [0.1, 0.0, 0.2] }\n\
        [[frame]]\nname = 'tip'\nparent = 'tool'\nplacement = { xyz = [0.0, 0.0, 0.3] }\n\
        [[frame]]\nname = 'mark'\nplacement = { xyz = [1.0, 2.0, 3.0] }\n\
        [[wrench]]\nframe = 'tip'\nforce = [1.0, 2.0, 3.0]\naxes = 'aligned'\n\
        [[wrench]]\nframe = 'a'\nmoment = [0.0, 0.0, 4.0]\n";
    let robot = parse(&two("", attached), LoadOptions::default()).unwrap();
    let (tip, mark) = (robot.frame("tip").unwrap(), robot.frame("mark").unwrap());
    assert_eq!((tip.joint, mark.joint), (Some(1), None));
    assert!((tip.placement.translation - nalgebra::Vector3::new(0.1, 0.0, 0.5)).amax() < 1e-15);
    let [first, second] = robot.wrenches() else { panic!("{:?}", robot.wrenches()) };
    assert_eq!(first.frame, robot.frame_index("tip").unwrap());
    assert_eq!((first.wrench.force, first.wrench.axes), ([1.0, 2.0, 3.0], WrenchAxes::Aligned));
    assert_eq!(second.frame, robot.frame_index("a").unwrap());
    assert_eq!((second.wrench.moment, second.wrench.axes), ([0.0, 0.0, 4.0], WrenchAxes::Local));
}

#[test]
fn wrong_frames_and_wrenches_are_refused_with_their_line() {
    let line_of = |text: &str, what: &str| text.lines().position(|line| line.contains(what)).map(|at| at + 1);
    for (attached, line, says) in [
        ("[[frame]]\nname = 'tool'\nparent = 'bb'\n", "'tool'", "no frame 'bb'"),
        (
            "[[frame]]\nname = 'tool'\n[[frame]]\nname = 'tool' # again\n",
            "again",
            "two frames are called 'tool'",
        ),
        ("[[wrench]]\nframe = 'tol'\n", "'tol'", "no frame 'tol'"),
        ("[[wrench]]\nframe = 'a' # there\nforce = [inf, 0.0, 0.0]\n", "there", "not finite"),
        ("[[wrench]]\nframe = 'a'\naxes = 'base'\n", "'base'", "unknown value `base`"),
        ("[[wrench]]\nframe = 'a'\nforces = [1.0, 0.0, 0.0]\n", "forces", "unknown key `forces`"),
    ] {
        let text = two("", attached);
        let (line_found, error) = refused(&text);
        assert!(error.to_string().contains(says), "{error}");
        assert_eq!(line_found, line_of(&text, line), "{attached}");
    }
}

/// As masses do, frames of a standard table belong to the far frame of their link.
#[test]
fn frames_of_a_standard_table_are_in_the_link_frame() {
    let text = format!(
        "name = 'r'\nconvention = 'standard-dh'\n[[joint]]\nname = 'a'\ndh = {{ a = 0.5, alpha = 1.0 }}\n{BODY}\n\
         [[frame]]\nname = 'com'\nparent = 'a'\nplacement = {{ xyz = [0.3, 0.0, 0.0] }}\n"
    );
    let robot = parse(&text, LoadOptions::default()).unwrap();
    let frame = robot.frame("com").unwrap();
    assert!((frame.placement.translation - robot.joints()[0].inertia.com).amax() < 1e-15);
    assert!(frame.placement.rotation[(1, 1)] < 0.9, "turned by alpha");
}
