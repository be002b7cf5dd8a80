//! Robots in TOML: what is refused, with the line and the reason, and what is loaded.

use costate::robot::RobotError as E;
use costate::robot::{
    JointKind, LoadOptions, Placement, Robot, RobotFormat, Warning, WrenchAxes, file::parse,
};

const BODY: &str = "mass = 2.0\ncom = [0.3, 0.0, 0.0]\ninertia = { xx = 0.1, yy = 0.2, zz = 0.25 }";

/// The name of joint 'a' is in line 3, what is added to it in line 4; that of 'b' is in line 9.
fn two(extra_a: &str, extra_b: &str) -> String {
    format!("name = 'pair'\n[[joint]]\nname = 'a'\n{BODY}\n[[joint]]\nname = 'b'\n{BODY}\n{extra_b}\n")
        .replacen("name = 'a'", &format!("name = 'a'\n{extra_a}"), 1)
}

fn refused(text: &str) -> (Option<usize>, E) {
    match parse(text, LoadOptions::default()) {
        Err(E::InFile { line, error, .. }) => (line, *error),
        other => panic!("{other:?}"),
    }
}

macro_rules! refuses {
    ($($name:ident: $text:expr, $line:expr, $error:pat, $words:expr;)*) => {$(
        #[test]
        fn $name() {
            let (line, error) = refused(&$text);
            let message = error.to_string();
            assert!(matches!(error, $error), "{error:?}");
            assert_eq!(line, $line, "{message}");
            for word in $words {
                assert!(message.contains(word), "'{word}' is not in: {message}");
            }
        }
    )*};
}

refuses! {
    malformed: "name = 'x'\n[[joint]\nname = 'a'\n", Some(2), E::Malformed { .. }, ["]"];
    unknown_key: two("masss = 1.0", ""), Some(4), E::Malformed { .. }, ["masss", "mass"];
    unknown_key_in_a_table: two("", "friction = { viscus = 1.0 }"), Some(13), E::Malformed { .. }, ["viscus", "viscous"];
    unknown_key_of_the_robot: "nam = 'x'", Some(1), E::Malformed { .. }, ["nam", "name"];
    unknown_type: two("type = 'planar'", ""), Some(4), E::Malformed { .. }, ["planar", "revolute", "spherical"];
    text_for_a_number: two("armature = 'big'", ""), Some(4), E::Malformed { .. }, ["`armature`", "big", "a number such as"];
    number_for_a_text: two("", "parent = 3"), Some(13), E::Malformed { .. }, ["`parent`", "3", "a text in quotes"];
    number_for_an_array: two("axis = 3", ""), Some(4), E::Malformed { .. }, ["`axis`", "3", "an array"];
    two_numbers: two("axis = [0.0, 1.0]", ""), Some(4), E::Malformed { .. }, ["`axis`", "2 entries", "3 numbers"];
    text_in_an_array: two("axis = [0.0, 1.0, 'z']", ""), Some(4), E::Malformed { .. }, ["z", "a number such as"];
    number_for_a_table: two("limits = 3.0", ""), Some(4), E::Malformed { .. }, ["`limits`", "3.0", "a table"];
    key_twice: two("", "com = [0.0, 0.0, 0.0]"), Some(13), E::Malformed { .. }, ["`com`", "twice", "line 11"];
    key_twice_in_a_table: two("limits = { lower = 1.0, lower = 2.0 }", ""), Some(4), E::Malformed { .. }, ["`lower`", "twice"];
    deep_arrays: format!("name = {}{}", "[".repeat(9000), "]".repeat(9000)), Some(1), E::Malformed { .. }, ["nested"];
    deep_tables: format!("name = {}1{}", "{a=".repeat(9000), "}".repeat(9000)), Some(1), E::Malformed { .. }, ["nested"];
    empty_robot: "name = 'nothing'", None, E::NoJoints { .. }, ["nothing", "revolute"];
    unknown_parent: two("", "parent = 'c'"), Some(9), E::UnknownParent { .. }, ["'b'", "'c'", "joint"];
    duplicate: two("", "").replace("'b'", "'a'"), Some(9), E::DuplicateName { kind: "joint", .. }, ["'a'"];
    blank_joint: two("", "").replace("'b'", "' '"), Some(9), E::BadName { kind: "joint", .. }, ["not blank"];
    blank_frame: two("", "\n[[frame]]\nname = ''"), Some(15), E::BadName { kind: "frame", .. }, ["not blank"];
    cycle: two("parent = 'b'", "parent = 'a'"), Some(3), E::Cycle { .. }, ["a -> b", "world"];
    its_own_parent: two("parent = 'a'", ""), Some(3), E::Cycle { .. }, ["a"];
    called_world: two("", "").replace("'a'", "'world'"), Some(3), E::Malformed { .. }, ["'world'", "another name"];
    no_name: "[[joint]]\nmass = 1.0", Some(1), E::Malformed { .. }, ["missing key `name`; add it"];
    negative_mass: two("", "").replacen("2.0", "-2.0", 1), Some(3), E::NegativeMass { .. }, ["'a'", "-2 kg"];
    mass_nan: two("", "").replacen("2.0", "nan", 1), Some(3), E::NonFiniteInertia { .. }, ["'a'", "mass"];
    com_infinite: two("", "").replacen("0.3", "inf", 1), Some(3), E::NonFiniteInertia { .. }, ["'a'", "centre"];
    indefinite: two("", "").replacen("zz = 0.25", "zz = 0.25, xy = 3.0", 1), Some(3), E::IndefiniteInertia { .. }, ["'a'"];
    no_axis: two("axis = [0.0, 0.0, 0.0]", ""), Some(3), E::BadAxis { .. }, ["'a'", "0 0 1"];
    placement_nan: two("placement = { xyz = [nan, 0.0, 0.0] }", ""), Some(3), E::BadPlacement { .. }, ["'a'"];
    gravity_nan: two("", "").replacen("[[", "gravity = [0.0, nan, 0.0]\n[[", 1), Some(2), E::BadGravity, ["gravity"];
    negative_friction: two("friction = { viscous = -1.0 }", ""), Some(3), E::BadValue { .. }, ["viscous", "'a'", "-1"];
    zero_transition: two("friction = { coulomb = 1.0, coulomb_velocity = 0.0 }", ""), Some(3), E::BadValue { .. }, ["'a'"];
    negative_armature: two("armature = -0.1", ""), Some(3), E::BadValue { .. }, ["armature", "'a'"];
    huge_armature: two("armature = 1e200", ""), Some(3), E::BadValue { .. }, ["armature", "'a'", "1e200", "1e75"];
    tiny_armature: two("armature = 1e-200", ""), Some(3), E::BadValue { .. }, ["armature", "'a'", "1e-75"];
    huge_friction: two("friction = { viscous = 1e200 }", ""), Some(3), E::BadValue { .. }, ["viscous", "'a'", "1e75"];
    huge_spring: two("spring = { stiffness = -1e200 }", ""), Some(3), E::BadValue { .. }, ["stiffness", "'a'", "1e75"];
    limit_nan: two("limits = { lower = nan }", ""), Some(3), E::BadValue { .. }, ["lower limit", "'a'", "NaN", "give a number"];
    huge_placement: two("placement = { xyz = [1e200, 0.0, 0.0] }", ""), Some(3), E::BadPlacement { .. }, ["'a'", "1e75"];
    huge_gravity: two("", "").replacen("[[", "gravity = [0.0, 0.0, -1e80]\n[[", 1), Some(2), E::BadGravity, ["gravity", "1e75"];
    huge_coupling: two("", "").replacen("[[", "armature = [[1.0, 1e80], [1e80, 1.0]]\n[[", 1), Some(2), E::BadArmature { .. }, ["1e80"];
    huge_frame: two("", "\n[[frame]]\nname = 'f'\nplacement = { xyz = [0, -1e80, 0] }"), Some(15), E::BadFramePlacement { .. }, ["'f'", "1e75"];
    huge_wrench: two("", "\n[[wrench]]\nframe = 'b'\nforce = [0, 1e80, 0]"), Some(15), E::BadWrench { .. }, ["'b'", "1e75"];
    huge_mimic_offset: two("", "mimic = { joint = 'a', offset = -1e80 }"), Some(9), E::BadValue { .. }, ["'b'", "offset", "1e75"];
    huge_mimic_ratio: two("", "mimic = { joint = 'a', ratio = 1e80 }"), Some(9), E::BadValue { .. }, ["'b'", "ratio", "1e75"];
    mimic_of_nothing: two("", "mimic = { joint = 'c' }"), Some(9), E::UnknownMimic { .. }, ["'b'", "'c'"];
    mimics_in_a_circle: two("mimic = { joint = 'b' }", "mimic = { joint = 'a' }"), Some(3), E::MimicCycle { .. }, ["a -> b -> a"];
    mimic_by_nothing: two("", "mimic = { joint = 'a', ratio = 0.0 }"), Some(9), E::BadValue { .. }, ["'b'", "ratio", "0"];
    mimic_ratio_nan: two("", "mimic = { joint = 'a', ratio = nan }"), Some(9), E::BadValue { .. }, ["'b'", "ratio", "NaN"];
    mimic_offset_infinite: two("", "mimic = { joint = 'a', offset = inf }"), Some(9), E::BadValue { .. }, ["'b'", "offset", "inf"];
    mimic_without_joint: two("", "mimic = { ratio = 2.0 }"), Some(13), E::Malformed { .. }, ["joint"];
    mimic_with_an_unknown_key: two("", "mimic = { joint = 'a', multiplier = 2.0 }"), Some(13), E::Malformed { .. }, ["`multiplier`", "ratio"];
    limits_swapped: two("limits = { lower = 1.0, upper = -1.0 }", ""), Some(3), E::BadValue { .. }, ["lower limit", "'a'"];
    dh_without_convention: two("dh = { a = 1.0 }", ""), Some(3), E::Malformed { .. }, ["dh", "modified-dh", "'a'"];
    axis_in_a_dh_table: two("axis = [1.0, 0.0, 0.0]", "").replacen("[[", "convention = 'modified-dh'\n[[", 1), Some(4), E::Malformed { .. }, ["axis", "placements"];
    armature_ragged: two("", "").replacen("[[", "armature = [[1.0, 0.0], [0.0]]\n[[", 1), Some(2), E::BadArmature { n: 2, .. }, ["row of 1"];
    armature_size: two("", "").replacen("[[", "armature = [[1.0]]\n[[", 1), Some(2), E::BadArmature { n: 2, .. }, ["1 x 1", "2 x 2"];
    armature_skew: two("", "").replacen("[[", "armature = [[1.0, 0.5], [0.0, 1.0]]\n[[", 1), Some(2), E::BadArmature { .. }, ["symmetric"];
    armature_indefinite: two("", "").replacen("[[", "armature = [[1.0, 2.0], [2.0, 1.0]]\n[[", 1), Some(2), E::BadArmature { .. }, ["eigenvalue"];
}

#[test]
fn a_missing_file_and_an_unknown_extension_are_named() {
    let error = Robot::from_file("robots/nowhere.toml").unwrap_err();
    assert!(error.to_string().starts_with("robots/nowhere.toml: does not exist"), "{error}");
    for (path, reason) in [
        ("LICENSE-MIT", ".urdf or .toml"),
        ("LICENSE-MIT", "--format"),
        ("robots", "is a folder"),
        ("robots/none", "does not exist"),
    ] {
        let error = Robot::from_file(path).unwrap_err();
        assert!(error.to_string().contains(reason), "{error}");
    }
    for (text, format, reason) in [
        ("<robot/>", RobotFormat::Toml, "looks like URDF"),
        ("name = 'a'\n[[joint]]", RobotFormat::Urdf, "looks like TOML"),
        (" \n", RobotFormat::Toml, "line 1: the file is empty"),
        ("\u{feff}", RobotFormat::Urdf, "line 1: the file is empty"),
    ] {
        let error = Robot::read(text.as_bytes(), format, LoadOptions::default()).unwrap_err();
        assert!(error.to_string().contains(reason), "{error}");
    }
}

/// Products of such numbers overflow or vanish in the middle of a computation.
#[test]
fn masses_and_inertias_of_extreme_size_are_refused_by_link() {
    let load = |numbers: &str| {
        let text = format!("name = 'a'\n[[joint]]\nname = 'elbow'\n{numbers}");
        Robot::from_toml_str(&text, LoadOptions::default())
    };
    for numbers in [
        "mass = 1e-150",
        "mass = 1e150",
        "mass = 1.0\ncom = [1e50, 0.0, 0.0]",
        "mass = 1.0\ninertia = { xx = 1e-80, yy = 1e-80, zz = 1e-80 }",
    ] {
        let message = load(numbers).unwrap_err().to_string();
        assert!(message.contains("link 'elbow'") && message.contains("between 1e-75 and 1e75"), "{message}");
        assert!(message.len() < 250, "{message}");
    }
    assert!(load("mass = 1e75\ncom = [0.1, 0.0, 0.0]").is_ok());
}

#[test]
fn limits_that_look_like_degrees_are_a_warning() {
    let load = |kind: &str| {
        let text = format!(
            "name = 'a'\n[[joint]]\nname = 'elbow'\ntype = '{kind}'\nmass = 1.0\ncom = [1.0, 0.0, 0.0]\n\
             limits = {{ lower = -180.0, upper = 1.0 }}"
        );
        let robot = Robot::from_toml_str(&text, LoadOptions::default()).unwrap();
        robot.warnings().iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert!(
        load("revolute")[0].contains("-180 rad): joint elbow; are they degrees?"),
        "{:?}",
        load("revolute")
    );
    assert!(load("prismatic").is_empty());
}

#[test]
fn bytes_that_are_not_utf_8_are_refused_with_their_line() {
    let bytes = [b"name = 'x'\n# 90".as_slice(), b"\xb0\n"].concat();
    let error = Robot::read(&bytes[..], RobotFormat::Toml, LoadOptions::default()).unwrap_err();
    assert!(
        matches!(&error, E::InFile { line: Some(2), error, .. } if matches!(**error, E::NotUtf8)),
        "{error}"
    );
    assert!(error.to_string().contains("UTF-8"), "{error}");
}

#[test]
fn long_and_hostile_text_is_harmless_in_messages() {
    let long = "x".repeat(100_000);
    let hostile = "a\\u001b[2J\\u202e\\n";
    for text in [
        two(&format!("{long} = 1.0"), ""),
        two(&format!("type = '{long}'"), ""),
        two(&format!("armature = '{long}'"), ""),
        two(&format!("\"{hostile}\" = 1.0"), ""),
        two(&format!("type = \"{hostile}\""), ""),
        two("", &format!("parent = \"{hostile}\"")),
        two("dh = { a = 1.0 }", "").replace("'a'", &format!("\"{hostile}\"")),
        two("", "").replace("'a'", &format!("'{long}'")).replace("mass = 2.0", "mass = -2.0"),
    ] {
        let message = refused(&text).1.to_string();
        assert!(message.chars().all(|c| !c.is_control() && c != '\u{202e}'), "{message}");
        assert!(message.len() < 2000, "{} bytes: {}", message.len(), &message[..200]);
    }
}

#[test]
fn texts_are_recognised_by_their_beginning() {
    let format = |path: &str| RobotFormat::of_path(path).ok();
    assert_eq!((format("a.URDF"), format("a.toml")), (Some(RobotFormat::Urdf), Some(RobotFormat::Toml)));
    assert_eq!((format("a"), format("a.xacro")), (None, None));
    assert_eq!(RobotFormat::of_text("\u{feff}\n <robot/>"), RobotFormat::Urdf);
    assert_eq!(RobotFormat::of_text(&two("", "")), RobotFormat::Toml);
    assert_eq!(Robot::from_toml_str(&two("", ""), LoadOptions::default()).unwrap().name(), "pair");
}

#[test]
fn errors_in_a_file_start_with_path_and_line() {
    let path = std::env::temp_dir().join(format!("costate-{}.toml", std::process::id()));
    std::fs::write(&path, two("masss = 1.0", "")).unwrap();
    let message = Robot::from_file(&path).unwrap_err().to_string();
    std::fs::remove_file(&path).unwrap();
    assert!(message.starts_with(&format!("{}:4: ", path.display())), "{message}");
}

#[test]
fn a_violated_triangle_inequality_is_a_warning_and_strict_makes_it_an_error() {
    let odd = two("", "").replacen("zz = 0.25", "zz = 0.9", 1);
    let robot = parse(&odd, LoadOptions::default()).unwrap();
    assert!(matches!(robot.warnings(), [Warning::TriangleInequality { body, .. }] if body.name() == "a"));
    let strict = LoadOptions::default().strict(true);
    let error = parse(&odd, strict).unwrap_err();
    assert!(error.to_string().contains("'a'"), "{error}");
    assert!(parse(&two("", ""), strict).is_ok());
    let pulled = two("", "\n[[wrench]]\nframe = 'world'\nforce = [0, 1, 0]");
    assert!(matches!(
        parse(&pulled, LoadOptions::default()).unwrap().warnings(),
        [Warning::IdleWrench { frame }] if frame == "world"
    ));
    assert!(matches!(parse(&pulled, strict), Err(E::Strict { .. })));
}

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
