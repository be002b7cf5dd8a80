//! URDF files: what is refused, with the line and the reason.

use crate::texts::*;
use costate::robot::RobotError as E;
use costate::robot::urdf::parse;
use costate::robot::{LoadOptions, Robot, RobotFormat, Warning};
use std::error::Error;

#[test]
fn the_name_of_a_xacro_file_says_so() {
    for name in ["arm.urdf.xacro", "arm.XACRO"] {
        let error = RobotFormat::of_path(name).unwrap_err();
        assert!(matches!(error, E::IsXacro), "{error:?}");
        assert!(error.to_string().contains("xacro robot.xacro > robot.urdf"), "{error}");
    }
}

/// Ten thousand references to an entity of ten thousand characters.
fn bomb() -> String {
    let (entity, references) = ("a".repeat(10_000), "&a;".repeat(10_000));
    format!("<!DOCTYPE robot [<!ENTITY a '{entity}'>]><robot name='{references}'><link name='a'/></robot>")
}

/// What a xacro file of ROS begins with.
const XACRO: &str = "<robot name=\"bench\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n";

/// Bad inputs, each a test: the text, the line to blame, the kind of error, words that the message must have.
macro_rules! refuses {
    ($($name:ident: $text:expr, line $line:literal, $error:pat, $words:expr;)*) => {$(
        #[test]
        fn $name() {
            let (line, error) = refused(&$text);
            let message = error.to_string();
            assert!(matches!(error, $error), "{error:?}");
            assert_eq!(line, Some($line), "{message}");
            for word in $words {
                assert!(message.contains(word), "'{word}' is not in: {message}");
            }
        }
    )*};
}

refuses! {
    // The text.
    no_text: "", line 1, E::Malformed { .. }, ["empty"];
    not_xml: "<robot name='r'>\n<link name='a'>\n</lin>\n</robot>", line 3, E::Malformed { .. }, ["'lin'", "'link'"];
    cut_off: "<robot name='r'>\n<link name='a'/>\n", line 3, E::Malformed { .. }, ["complete the file"];
    other_root: "<!-- no robot -->\n<sdf/>", line 2, E::Malformed { .. }, ["<sdf>", "<robot>"];
    document_type: "<?xml version='1.0'?>\n<!-- <!DOCTYPE a> -->\n<!DOCTYPE robot>\n<robot/>", line 3, E::DocumentType, ["DOCTYPE", "remove"];
    entities: bomb(), line 1, E::DocumentType, ["DOCTYPE"];
    very_many_attributes: format!("<robot name='r'>{}</robot>", "\n<a b='' c='' d='' e='' f='' g='' h='' i=''/>".repeat(126_000)),
        line 125_001, E::Malformed { .. }, ["1000000 characters `=`"];
    entity_without_document_type: more("<link name=\"&a;\"/>"), line 10, E::Malformed { .. }, ["'a'"];
    attributes: format!("<robot name='r'>\n<link{}/></robot>", (0..300).map(|k| format!(" a{k}=''")).collect::<String>()),
        line 2, E::Malformed { .. }, ["256 attributes"];
    namespaces: format!("<robot name='r'>\n{}</robot>", (0..300).map(|k| format!("<a xmlns:b{k}='c'/>")).collect::<String>()),
        line 2, E::Malformed { .. }, ["256 namespaces"];
    no_joint: "<robot name='still'>\n<link name='a'/></robot>", line 1, E::NoJoints { .. }, ["still"];
    only_fixed_joints: elbow("fixed", ""), line 1, E::NoJoints { .. }, ["bench"];

    // Links.
    link_without_name: more("<link/>"), line 10, E::Malformed { .. }, ["<link>", "no name", "add"];
    link_twice: more("<link name=\"arm\"/>"), line 10, E::DuplicateName { kind: "link", .. }, ["arm"];
    no_mass: arm("<inertial>\n</inertial>"), line 4, E::Malformed { .. }, ["<inertial>", "link 'arm'", "<mass>"];
    mass_without_value: arm("<inertial>\n<mass/></inertial>"), line 5, E::Malformed { .. }, ["<mass>", "arm", "value"];
    mass_is_text: arm(&INERTIAL.replace("\"2\"", "\"2kg\"")), line 4, E::Malformed { .. }, ["<mass>", "arm", "'2kg'"];
    mass_nan: arm(&INERTIAL.replace("\"2\"", "\"nan\"")), line 4, E::Malformed { .. }, ["<mass>", "arm", "NaN", "finite"];
    mass_overflows: arm(&INERTIAL.replace("\"2\"", "\"1e999\"")), line 4, E::Malformed { .. }, ["arm", "inf"];
    negative_mass: arm(&INERTIAL.replace("\"2\"", "\"-2\"")), line 3, E::NegativeMass { .. }, ["arm", "-2"];
    no_inertia: arm("<inertial><mass value=\"1\"/></inertial>"), line 4, E::Malformed { .. }, ["arm", "<inertia>"];
    inertia_entry_missing: arm(&INERTIAL.replace("iyz=\"0\"", "")), line 4, E::Malformed { .. }, ["<inertia>", "arm", "iyz"];
    inertia_infinite: arm(&INERTIAL.replace("iyz=\"0\"", "iyz=\"inf\"")), line 4, E::Malformed { .. }, ["arm", "iyz", "inf"];
    inertia_indefinite: arm(&INERTIAL.replace("iyz=\"0\"", "iyz=\"1\"")), line 3, E::IndefiniteInertia { .. }, ["arm"];
    inertial_twice: arm("<inertial/>\n<inertial/>"), line 5, E::Malformed { .. }, ["<inertial>", "arm", "twice"];
    com_of_two_numbers: arm(&INERTIAL.replace("0.1 0 0.2", "0 1")), line 4, E::Malformed { .. }, ["<origin>", "arm", "give 3"];

    // Joints.
    joint_without_name: more("<joint type=\"fixed\"/>"), line 10, E::Malformed { .. }, ["<joint>", "no name"];
    joint_without_type: more("<joint name=\"j\"/>"), line 10, E::Malformed { .. }, ["'j'", "type"];
    joint_twice: more("<link name=\"tip\"/>\n<joint name=\"elbow\" type=\"fixed\"><parent link=\"arm\"/><child link=\"tip\"/></joint>"),
        line 11, E::DuplicateName { kind: "joint", .. }, ["elbow"];
    unknown_type: elbow("hinge", ""), line 6, E::UnsupportedJoint { .. }, ["elbow", "'hinge'", "revolute"];
    spherical: elbow("spherical", ""), line 6, E::UnsupportedJoint { .. }, ["elbow", "'spherical'"];
    no_parent: elbow("fixed", "").replace("<parent link=\"base\"/>", ""), line 6, E::Malformed { .. }, ["elbow", "<parent>"];
    no_child: elbow("fixed", "").replace("<child link=\"arm\"/>", ""), line 6, E::Malformed { .. }, ["elbow", "<child>"];
    parent_without_link: elbow("fixed", "").replace("link=\"base\"/>", "/>"), line 7, E::Malformed { .. }, ["<parent>", "elbow"];
    parent_twice: elbow("fixed", "<parent link=\"base\"/>"), line 8, E::Malformed { .. }, ["<parent>", "elbow", "twice"];
    unknown_parent: elbow("fixed", "").replace("link=\"base\"", "link=\"bse\""), line 6,
        E::UnknownParent { kind: "link", .. }, ["elbow", "bse"];
    unknown_child: elbow("fixed", "").replace("link=\"arm\"", "link=\"amr\""), line 6, E::UnknownChild { .. }, ["elbow", "amr"];
    two_numbers: elbow("revolute", "<origin xyz=\"0 1\"/>"), line 8, E::Malformed { .. }, ["<origin>", "elbow", "2 numbers", "3"];
    four_numbers: elbow("revolute", "<origin rpy=\"0 0 0 1\"/>"), line 8, E::Malformed { .. }, ["<origin>", "elbow", "4 numbers"];
    commas: elbow("revolute", "<origin xyz=\"0, 0, 1\"/>"), line 8, E::Malformed { .. }, ["<origin>", "elbow", "comma", "blanks"];
    xacro: elbow("revolute", "<origin xyz=\"0 0 ${l / 2}\"/>"), line 8, E::Malformed { .. }, ["<origin>", "elbow", "xacro", "expand"];
    included: XACRO.to_owned() + "<xacro:include filename=\"arm.xacro\"/>\n</robot>", line 1, E::Unexpanded { .. },
        ["'include' in line 2", "pip install xacro", "no moving joint"];
    parts_included: more("<xacro:arm prefix=\"left\"/>\n<link name=\"floor\"/>"), line 11, E::Unexpanded { line: 10, .. },
        ["'arm' in line 10", "xacro robot.xacro > robot.urdf", "'floor'"];
    inertia_by_a_macro: arm("<inertial><xacro:box/><mass value=\"1\"/></inertial>"), line 4, E::Unexpanded { .. },
        ["'box' in line 4", "<inertia>"];
    xacro_with_elements: elbow("revolute", "<xacro:a/><origin xyz=\"0 0 ${l / 2}\"/>"), line 8, E::Malformed { .. }, ["<origin>", "expand"];
    origin_nan: elbow("fixed", "<origin xyz=\"0 nan 0\"/>"), line 8, E::Malformed { .. }, ["<origin>", "elbow", "NaN"];
    origin_twice: elbow("fixed", "<origin/>\n<origin/>"), line 9, E::Malformed { .. }, ["<origin>", "elbow", "twice"];
    axis_without_xyz: elbow("revolute", "<axis/>"), line 8, E::Malformed { .. }, ["<axis>", "elbow", "xyz"];
    axis_zero: elbow("prismatic", "<axis xyz=\"0 0 0\"/>"), line 8, E::BadAxis { .. }, ["elbow"];
    axis_infinite: elbow("continuous", "<axis xyz=\"0 inf 0\"/>"), line 8, E::BadAxis { .. }, ["elbow"];
    axis_zero_of_planar: elbow("planar", "<axis xyz=\"0 0 0\"/>"), line 8, E::BadAxis { .. }, ["elbow"];
    limit_is_text: elbow("revolute", "<limit lower=\"-pi\"/>"), line 8, E::Malformed { .. }, ["<limit>", "elbow", "'-pi'"];
    damping_is_text: elbow("revolute", "<dynamics damping=\"much\"/>"), line 8, E::Malformed { .. }, ["<dynamics>", "elbow"];
    mimic_of_nothing: elbow("revolute", "<mimic joint=\"knee\"/>"), line 8, E::UnknownMimic { .. }, ["elbow", "knee", "one of the joints"];
    mimic_misspelt: elbow("revolute", "<mimic joint=\"elbwo\"/>"), line 8, E::UnknownMimic { .. }, ["'elbwo'", "did you mean 'elbow'?"];
    mimic_of_itself: elbow("revolute", "<mimic joint=\"elbow\"/>"), line 6, E::MimicCycle { .. }, ["'elbow' mimics itself"];
    mimics_in_a_circle: mimics("revolute", "<mimic joint=\"y\"/>", "<mimic joint=\"x\"/>"), line 5, E::MimicCycle { .. }, ["x -> y -> x"];
    mimic_by_nothing: mimics("revolute", "", "<mimic joint=\"x\" multiplier=\"0\"/>"), line 6, E::BadValue { .. }, ["'y'", "ratio", "fixed"];
    mimic_ratio_nan: mimics("revolute", "", "<mimic joint=\"x\" multiplier=\"nan\"/>"), line 6, E::Malformed { .. }, ["multiplier", "NaN", "'y'"];
    mimic_without_joint: mimics("revolute", "", "<mimic/>"), line 6, E::Malformed { .. }, ["<mimic>", "joint"];
    mimic_of_a_floating_joint: mimics("floating", "", "<mimic joint=\"x\"/>"), line 6, E::UnsupportedMimic { .. }, ["'y'", "'x'", "floating"];
    planar_joint_that_mimics: mimics("planar", "<mimic joint=\"y\"/>", ""), line 5, E::UnsupportedMimic { .. }, ["'x'", "planar"];
    angles_and_quaternion: elbow("fixed", "<origin rpy=\"0 0 1\" quat_xyzw=\"0 0 0 1\"/>").replace("bench\"", "bench\" version=\"1.1\""),
        line 8, E::Malformed { .. }, ["<origin>", "elbow", "quat_xyzw"];

    // The tree.
    two_parents: more("<joint name=\"wrist\" type=\"fixed\"><parent link=\"base\"/><child link=\"arm\"/></joint>"),
        line 10, E::TwoParents { .. }, ["arm", "elbow", "wrist"];
    two_roots: more("<link name=\"floor\"/>"), line 10, E::SeveralRoots { .. }, ["base", "floor"];
    moving_link_called_world: more("<link name=\"world\"/><joint name=\"w\" type=\"continuous\"><parent link=\"arm\"/><child link=\"world\"/></joint>"),
        line 10, E::BadName { .. }, ["'world'", "the ground", "another name"];
    own_parent: more("<joint name=\"wrist\" type=\"fixed\"><parent link=\"arm\"/><child link=\"arm\"/></joint>"),
        line 10, E::Cycle { .. }, ["wrist"];
    circle: tree(&["a", "b"], &[("ab", "revolute", "a", "b", ""), ("ba", "fixed", "b", "a", "")]),
        line 5, E::Cycle { .. }, ["ab", "ba"];
    circle_beside_a_tree: tree(
        &["base", "a", "b", "c"],
        &[("ab", "revolute", "a", "b", ""), ("ba", "fixed", "b", "a", ""), ("bc", "revolute", "b", "c", "")],
    ), line 7, E::Cycle { .. }, ["ab", "ba"];
    expansion_collides: tree(
        &["base", "a", "b"],
        &[("j", "floating", "base", "a", ""), ("j_x", "revolute", "a", "b", "")],
    ), line 6, E::DuplicateName { .. }, ["j_x"];
}

#[test]
fn errors_of_a_file_have_its_path_and_line() {
    let path = std::env::temp_dir().join(format!("costate-{}.urdf", std::process::id()));
    std::fs::write(&path, elbow("hinge", "")).unwrap();
    let message = Robot::from_file(&path).unwrap_err().to_string();
    std::fs::write(&path, elbow("revolute", "")).unwrap();
    let robot = Robot::from_file(&path);
    std::fs::remove_file(&path).unwrap();
    assert!(message.starts_with(&format!("{}:6: joint 'elbow'", path.display())), "{message}");
    assert_eq!(robot.unwrap().name(), "bench");
}

/// What strict loading refuses: the line of the first warning, and the warnings.
fn refused_when_strict(text: &str) -> (Option<usize>, Vec<Warning>) {
    let strict = LoadOptions::default().strict(true);
    match parse(text, strict) {
        Err(E::InFile { line, error, .. }) => match *error {
            E::Strict { warnings } => (line, warnings),
            error => panic!("{error}"),
        },
        other => panic!("{other:?}"),
    }
}

/// Odd inputs, each a test: the text, the line to name, words that the warning must have.
macro_rules! warns {
    ($($name:ident: $text:expr, line $line:literal, $warning:pat, $words:expr;)*) => {$(
        #[test]
        fn $name() {
            let text = $text;
            let robot = load(&text);
            let [warning] = robot.warnings() else { panic!("{:?}", robot.warnings()) };
            assert!(matches!(warning, $warning), "{warning:?}");
            assert_eq!(warning.line(), Some($line), "{warning}");
            for word in $words {
                assert!(warning.to_string().contains(word), "'{word}' is not in: {warning}");
            }
            assert_eq!(refused_when_strict(&text), (Some($line), vec![warning.clone()]));
        }
    )*};
}

fn limited(inside_joint: &str) -> String {
    elbow("revolute", &format!("{inside_joint}{LIMIT}"))
}

warns! {
    misspelt_origin: limited("<orign xyz=\"1 0 0\"/>"), line 8, Warning::UnknownName { others: 0, .. },
        ["<orign> in joint 'elbow' (line 8)", "did you mean <origin>?"];
    misspelt_axis: limited("<axes xyz=\"0 0 1\"/>"), line 8, Warning::UnknownName { .. }, ["<axes> in joint 'elbow'", "<axis>"];
    misspelt_limit: elbow("continuous", "<limits lower=\"0\"/>"), line 8, Warning::UnknownName { .. }, ["<limits>", "<limit>"];
    misspelt_inertial: arm(&format!("{INERTIAL}<inertail/>")), line 4, Warning::UnknownName { .. },
        ["<inertail> in link 'arm'", "<inertial>"];
    misspelt_xyz: limited("<origin xzy=\"1 0 0\"/>"), line 8, Warning::UnknownName { .. },
        ["xzy in <origin> of joint 'elbow'", "did you mean xyz?"];
    misspelt_rpy: limited("<origin ryp=\"1 0 0\"/>"), line 8, Warning::UnknownName { .. }, ["ryp", "did you mean rpy?"];
    misspelt_mass: arm(&INERTIAL.replace("value=", "valu=\"1\" value=")), line 4, Warning::UnknownName { .. },
        ["valu in <mass> of <inertial> of link 'arm'", "did you mean value?"];
    misspelt_joint: more("<jiont name=\"a\"/>"), line 10, Warning::UnknownName { .. }, ["<jiont> in <robot>", "<joint>"];
    misspelt_shape: more("").replace("<link name=\"base\"/>", "<link name=\"base\"><visual><geometry><spher/></geometry></visual></link>"),
        line 2, Warning::UnknownName { .. }, ["<spher> in <geometry> of <visual> of link 'base'", "<sphere>"];
    not_urdf: limited("<frobnicate/>"), line 8, Warning::UnknownName { nearest: None, .. }, ["<frobnicate>", "ignored"];
    no_limit: elbow("revolute", ""), line 6, Warning::WithoutLimit { .. }, ["<limit>", "joint elbow", "unlimited"];
    no_limit_of_a_slide: elbow("prismatic", ""), line 6, Warning::WithoutLimit { .. }, ["joint elbow"];
    limits_swapped: elbow("revolute", "<limit lower=\"1\" upper=\"-1\" effort=\"2\" velocity=\"3\"/>"), line 8,
        Warning::SwappedLimits { .. }, ["lower above upper", "joint elbow"];
    limit_of_effort_negative: elbow("continuous", "<limit effort=\"-2\" velocity=\"3\"/>"), line 8,
        Warning::NegativeLimit { .. }, ["negative", "joint elbow"];
    limit_of_velocity_negative: elbow("continuous", "<limit effort=\"2\" velocity=\"-3\"/>"), line 8,
        Warning::NegativeLimit { .. }, ["negative", "joint elbow"];
    massive_base: more(&format!("<link name=\"other\">{INERTIAL}</link><joint name=\"second\" type=\"continuous\">\
        <parent link=\"base\"/><child link=\"other\"/></joint>"))
        .replace("<link name=\"base\"/>", &format!("<link name=\"base\">{INERTIAL}</link>")), line 2,
        Warning::FixedBase { .. }, ["'base'", "2 kg", "held fixed", "floating joint"];
}

#[test]
fn many_unknown_names_are_a_few_warnings() {
    let chain = |inside: &dyn Fn(usize) -> String| {
        let links: Vec<String> = (0..30).map(|k| format!("l{k}")).collect();
        let mut text =
            tree(&links.iter().map(String::as_str).collect::<Vec<_>>(), &[]).replace("</robot>\n", "");
        for k in 1..30 {
            text += &format!(
                "<joint name=\"j{k}\" type=\"continuous\"><parent link=\"l{}\"/><child link=\"l{k}\"/>{}</joint>\n",
                k - 1,
                inside(k)
            );
        }
        load(&(text + "</robot>")).warnings().to_vec()
    };
    let same = chain(&|_| "<orign xyz=\"1 0 0\"/>".into());
    assert!(matches!(&same[..], [Warning::UnknownName { line: 32, others: 28, .. }]), "{same:?}");
    assert!(same[0].to_string().contains("and 28 more"), "{}", same[0]);
    let distinct = chain(&|k| format!("<part{k}/>"));
    assert_eq!(distinct.len(), 9);
    assert_eq!(distinct[8], Warning::MoreUnknownNames { count: 21, line: 40 });
}

/// Names reach a terminal in messages only: nothing in them may act on it, or fill it.
#[test]
fn names_are_harmless_in_messages() {
    let hostile = "a&#10;\u{202e}b&#13;";
    let long = "x".repeat(1_000_000);
    let odd = |name: &str| elbow("hinge", "").replace("elbow", name);
    for text in [
        odd(hostile),
        odd("a&#27;[2J"),
        odd("a\u{1b}[2J"),
        odd(&long),
        elbow(&long, ""),
        elbow("revolute", &format!("<origin xyz=\"{hostile}\"/>")),
        elbow("revolute", &format!("<origin xyz=\"{long}\"/>")),
        elbow("revolute", &format!("<mimic joint=\"{long}\"/>")),
        elbow("fixed", "").replace("link=\"arm\"", &format!("link=\"{hostile}\"")),
        format!("<{long}/>"),
        format!("<robot><{long}></robot>"),
        format!("<robot>&{long};</robot>"),
        elbow("fixed", "").replace("bench", &long),
    ] {
        let message = refused(&text).1.to_string();
        assert!(message.chars().all(|c| !c.is_control() && c != '\u{202e}'), "{message}");
        assert!(message.len() < 2000, "{} bytes", message.len());
    }
    let robot = load(&more(&format!("<{long}/><link name=\"{hostile}\" {long}=\"\"/>")).replace(
        "</robot>",
        &format!("<joint name=\"w\" type=\"fixed\"><parent link=\"arm\"/><child link=\"{hostile}\"/></joint></robot>"),
    ));
    assert!(
        notes(&robot).len() < 2000 && !notes(&robot).contains(['\u{1b}', '\u{202e}']),
        "{}",
        notes(&robot)
    );
    let warned = notes(&load(&arm("").replace("elbow", &long)));
    assert!(warned.contains("kinematics only") && warned.len() < 2000, "{} bytes", warned.len());
}

#[test]
fn long_texts_are_refused() {
    let text = format!("{}{}", more(""), " ".repeat(16 << 20));
    assert!(matches!(parse(&text, LoadOptions::default()), Err(E::TooLong { .. })));
    for (format, limit) in [(RobotFormat::Urdf, "16 MiB"), (RobotFormat::Toml, "4 MiB")] {
        let error = Robot::read(std::io::repeat(b' '), format, LoadOptions::default()).unwrap_err();
        assert!(matches!(error, E::TooLong { .. }) && error.to_string().contains(limit), "{error}");
    }
}

#[test]
fn errors_keep_their_cause() {
    let error = Robot::from_file("robots/nowhere.urdf").unwrap_err();
    let cause = error.source().and_then(|cause| cause.downcast_ref::<std::io::Error>()).unwrap();
    assert_eq!(cause.kind(), std::io::ErrorKind::NotFound);
    assert!(parse("<robot>", LoadOptions::default()).unwrap_err().source().is_some());
    assert!(parse("<robot/>", LoadOptions::default()).unwrap_err().source().is_none());
}
