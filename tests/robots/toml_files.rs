//! Robots in TOML: what is refused, with the line and the reason.

use costate::robot::RobotError as E;
use costate::robot::{LoadOptions, Robot, RobotFormat, Warning, file::parse};

pub const BODY: &str = "mass = 2.0\ncom = [0.3, 0.0, 0.0]\ninertia = { xx = 0.1, yy = 0.2, zz = 0.25 }";

/// The name of joint 'a' is in line 3, what is added to it in line 4; that of 'b' is in line 9.
pub fn two(extra_a: &str, extra_b: &str) -> String {
    format!("name = 'pair'\n[[joint]]\nname = 'a'\n{BODY}\n[[joint]]\nname = 'b'\n{BODY}\n{extra_b}\n")
        .replacen("name = 'a'", &format!("name = 'a'\n{extra_a}"), 1)
}

pub fn refused(text: &str) -> (Option<usize>, E) {
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
