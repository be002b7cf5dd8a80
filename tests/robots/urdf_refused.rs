//! URDF files: what is refused, with the line and the reason.

use crate::texts::*;
use costate::robot::Robot;
use costate::robot::RobotError as E;

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
    no_text: "", line 1, E::Malformed { .. }, ["XML"];
    not_xml: "<robot name='r'>\n<link name='a'>\n</lin>\n</robot>", line 3, E::Malformed { .. }, ["'lin'", "'link'"];
    cut_off: "<robot name='r'>\n<link name='a'/>\n", line 3, E::Malformed { .. }, ["complete the file"];
    other_root: "<!-- no robot -->\n<sdf/>", line 2, E::Malformed { .. }, ["<sdf>", "<robot>"];
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
    origin_nan: elbow("fixed", "<origin xyz=\"0 nan 0\"/>"), line 8, E::Malformed { .. }, ["<origin>", "elbow", "NaN"];
    origin_twice: elbow("fixed", "<origin/>\n<origin/>"), line 9, E::Malformed { .. }, ["<origin>", "elbow", "twice"];
    axis_without_xyz: elbow("revolute", "<axis/>"), line 8, E::Malformed { .. }, ["<axis>", "elbow", "xyz"];
    axis_zero: elbow("prismatic", "<axis xyz=\"0 0 0\"/>"), line 8, E::BadAxis { .. }, ["elbow"];
    axis_infinite: elbow("continuous", "<axis xyz=\"0 inf 0\"/>"), line 8, E::BadAxis { .. }, ["elbow"];
    axis_zero_of_planar: elbow("planar", "<axis xyz=\"0 0 0\"/>"), line 8, E::BadAxis { .. }, ["elbow"];
    limit_is_text: elbow("revolute", "<limit lower=\"-pi\"/>"), line 8, E::Malformed { .. }, ["<limit>", "elbow", "'-pi'"];
    damping_is_text: elbow("revolute", "<dynamics damping=\"much\"/>"), line 8, E::Malformed { .. }, ["<dynamics>", "elbow"];
    mimic: elbow("revolute", "<mimic joint=\"knee\"/>"), line 8, E::Mimic { .. }, ["elbow", "knee"];
    angles_and_quaternion: elbow("fixed", "<origin rpy=\"0 0 1\" quat_xyzw=\"0 0 0 1\"/>").replace("bench\"", "bench\" version=\"1.1\""),
        line 8, E::Malformed { .. }, ["<origin>", "elbow", "quat_xyzw"];
    moves_nothing: more("<link name=\"tip\"/>\n<joint name=\"spin\" type=\"revolute\"><parent link=\"arm\"/><child link=\"tip\"/></joint>"),
        line 11, E::MovesNothing { .. }, ["spin", "fixed"];
    kinematics_only: arm(""), line 6, E::KinematicsOnly { .. }, ["elbow", "kinematics only", "<inertial>"];
    floats_nothing: one_joint("floating", "", "", ""), line 6, E::KinematicsOnly { .. }, ["elbow_x"];

    // The tree.
    two_parents: more("<joint name=\"wrist\" type=\"fixed\"><parent link=\"base\"/><child link=\"arm\"/></joint>"),
        line 10, E::TwoParents { .. }, ["arm", "elbow", "wrist"];
    two_roots: more("<link name=\"floor\"/>"), line 10, E::SeveralRoots { .. }, ["base", "floor"];
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
