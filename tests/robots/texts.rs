//! Small URDF texts to load or to refuse.
use costate::robot::RobotError as E;
use costate::robot::urdf::parse;
use costate::robot::{LoadOptions, Robot, Warning};

pub const INERTIAL: &str = r#"<inertial><origin xyz="0.1 0 0.2"/><mass value="2"/><inertia ixx="0.3" ixy="0" ixz="0" iyy="0.3" iyz="0" izz="0.2"/></inertial>"#;

pub const LIMIT: &str = r#"<limit lower="-1" upper="1" effort="1" velocity="1"/>"#;

/// A robot of one joint 'elbow' (line 6) that moves link 'arm' (line 3).
pub fn one_joint(kind: &str, inertial: &str, inside_joint: &str, rest: &str) -> String {
    format!(
        r#"<robot name="bench">
<link name="base"/>
<link name="arm">
{inertial}
</link>
<joint name="elbow" type="{kind}">
<parent link="base"/><child link="arm"/>
{inside_joint}
</joint>
{rest}
</robot>"#
    )
}

pub fn elbow(kind: &str, inside_joint: &str) -> String {
    one_joint(kind, INERTIAL, inside_joint, "")
}

pub fn arm(inertial: &str) -> String {
    one_joint("revolute", inertial, LIMIT, "")
}

pub fn more(rest: &str) -> String {
    one_joint("revolute", INERTIAL, LIMIT, rest)
}

/// A robot of links and joints `name kind parent child [inside]`; the first link named is the root, without
/// mass.
pub fn tree(links: &[&str], joints: &[(&str, &str, &str, &str, &str)]) -> String {
    let mut text = String::from("<robot name=\"tree\">\n");
    for (k, link) in links.iter().enumerate() {
        text += &format!("<link name=\"{link}\">{}</link>\n", if k == 0 { "" } else { INERTIAL });
    }
    for (name, kind, parent, child, inside) in joints {
        let limit = if ["revolute", "prismatic"].contains(kind) { LIMIT } else { "" };
        text += &format!(
            "<joint name=\"{name}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/>{inside}{limit}</joint>\n"
        );
    }
    text + "</robot>\n"
}

/// Joint 'x' (line 5) of a type and joint 'y' (line 6), both with something inside.
pub fn mimics(kind: &str, x: &str, y: &str) -> String {
    tree(&["base", "a", "b"], &[("x", kind, "base", "a", x), ("y", "revolute", "a", "b", y)])
}

pub fn load(text: &str) -> Robot {
    parse(text, LoadOptions::default()).unwrap()
}

pub fn names(robot: &Robot) -> Vec<&str> {
    robot.joints().iter().map(|joint| joint.name.as_str()).collect()
}

pub fn notes(robot: &Robot) -> String {
    robot.warnings().iter().map(Warning::to_string).collect::<Vec<_>>().join("\n")
}

/// Line of the culprit and what is wrong.
pub fn refused(text: &str) -> (Option<usize>, E) {
    match parse(text, LoadOptions::default()) {
        Err(E::InFile { line, error, .. }) => (line, *error),
        Err(error) => (None, error),
        Ok(_) => panic!("loaded: {text}"),
    }
}
