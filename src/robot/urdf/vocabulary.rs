//! The elements and attributes that URDF knows: anything else is likely misspelt.
//!
//! Elements of a namespace, and what is inside extensions of simulators and controllers, are not checked.

use super::xml::Lines;
use crate::robot::nearest::nearest;
use crate::robot::printable::printable;
use crate::robot::warning::Warning;
use roxmltree::Node;

/// An element, its attributes and the elements inside it.
struct Known {
    name: &'static str,
    attributes: &'static [&'static str],
    children: &'static [&'static str],
}

const fn known(
    name: &'static str,
    attributes: &'static [&'static str],
    children: &'static [&'static str],
) -> Known {
    Known { name, attributes, children }
}

/// URDF 1.0 to 1.2, with what the usual readers accept, and the loops of its extensions. The same name means
/// the same everywhere, but for `<material>`.
const KNOWN: [Known; 36] = [
    known("robot", &["name", "version"], &["link", "joint", "material", "loop", "loop_joint", "coupling"]),
    known("link", &["name", "type"], &["inertial", "visual", "collision"]),
    known("inertial", &[], &["origin", "mass", "inertia"]),
    known("origin", &["xyz", "rpy", "quat_xyzw"], &[]),
    known("mass", &["value"], &[]),
    known("inertia", &["ixx", "ixy", "ixz", "iyy", "iyz", "izz"], &[]),
    known("visual", &["name"], &["origin", "geometry", "material"]),
    known("collision", &["name"], &["origin", "geometry", "material", "verbose"]),
    known("geometry", &["name"], &["box", "cylinder", "sphere", "capsule", "mesh", "plane"]),
    known("box", &["size"], &[]),
    known("cylinder", &["radius", "length"], &[]),
    known("sphere", &["radius"], &[]),
    known("capsule", &["radius", "length"], &[]),
    known("mesh", &["filename", "scale"], &[]),
    known("plane", &["normal", "size"], &[]),
    known("verbose", &["value"], &[]),
    known("material", &["name"], &["color", "texture"]),
    known("color", &["rgba"], &[]),
    known("texture", &["filename"], &[]),
    known(
        "joint",
        // `independent` is that of URDF+: here positions of all joints are coordinates.
        &["name", "type", "independent"],
        &[
            "origin",
            "parent",
            "child",
            "axis",
            "calibration",
            "dynamics",
            "limit",
            "mimic",
            "safety_controller",
        ],
    ),
    known("parent", &["link"], &[]),
    known("child", &["link"], &[]),
    known("axis", &["xyz"], &[]),
    known("calibration", &["rising", "falling", "reference_position"], &[]),
    known("dynamics", &["damping", "friction"], &[]),
    known("limit", &["lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"], &[]),
    known("mimic", &["joint", "multiplier", "offset"], &[]),
    known("loop", &["name", "type"], &["predecessor", "successor", "axis"]),
    known("predecessor", &["link"], &["origin"]),
    known("successor", &["link"], &["origin"]),
    known("loop_joint", &["name", "type"], &["link1", "link2", "axis"]),
    known("link1", &["link", "rpy", "xyz"], &[]),
    known("link2", &["link", "rpy", "xyz"], &[]),
    // Older files write `type="rolling"`, which means nothing.
    known("coupling", &["name", "type"], &["predecessor", "successor", "ratio"]),
    known("ratio", &["value"], &[]),
    known("safety_controller", &["soft_lower_limit", "soft_upper_limit", "k_position", "k_velocity"], &[]),
];

/// Extensions in common use, wherever they are: neither checked nor reported.
const EXTENSIONS: [&str; 26] = [
    "transmission",
    "gazebo",
    "sensor",
    "ros2_control",
    "mujoco",
    "plugin",
    "controller",
    "actuator",
    "contact",
    "contact_coefficients",
    "self_collision_checking",
    "joint_properties",
    "hardwareInterface",
    "gripper",
    "group",
    "group_state",
    "end_effector",
    "virtual_joint",
    "passive_joint",
    "disable_collisions",
    "chain",
    "map",
    "include",
    "static",
    "frame",
    "xacro",
];

/// Kinds of unknown names that are reported one by one; the others are counted.
const REPORTED: usize = 8;

/// Collects unknown names, those of the same kind in one warning.
#[derive(Default)]
pub(super) struct Unknown {
    found: Vec<(&'static str, Warning)>,
    others: usize,
    first_other: usize,
}

impl Unknown {
    /// Checks an element of URDF and all that is inside it; `owner` is how messages call it.
    pub(super) fn check(&mut self, element: Node<'_, '_>, owner: &str, lines: &Lines) {
        let Some(known) = KNOWN.iter().find(|known| known.name == element.tag_name().name()) else { return };
        for attribute in element.attributes().filter(|attribute| attribute.namespace().is_none()) {
            if !known.attributes.contains(&attribute.name()) {
                let name = printable(attribute.name()).to_string();
                self.add(known.name, name, owner, lines.line(element), known.attributes);
            }
        }
        let namespace = element.tag_name().namespace();
        let children = element.children().filter(|child| child.is_element());
        for child in children.filter(|child| child.tag_name().namespace() == namespace) {
            let name = child.tag_name().name();
            if known.children.contains(&name) {
                // Links, joints, loops and materials of the robot are checked with an owner of their own.
                if known.name != "robot" {
                    self.check(child, &format!("<{name}> of {owner}"), lines);
                }
            } else if !EXTENSIONS.contains(&name) {
                let name = format!("<{}>", printable(name));
                self.add(known.name, name, owner, lines.line(child), known.children);
            }
        }
    }

    fn add(
        &mut self,
        inside: &'static str,
        name: String,
        owner: &str,
        line: usize,
        known: &'static [&'static str],
    ) {
        let reported = self.found.len();
        let same = self.found.iter_mut().find(|(other_inside, warning)| {
            *other_inside == inside
                && matches!(warning, Warning::UnknownName { name: other, .. } if *other == name)
        });
        match same {
            Some((_, Warning::UnknownName { others, .. })) => *others += 1,
            _ if reported < REPORTED => {
                let nearest = nearest(name.trim_matches(['<', '>']), known);
                let owner = owner.to_owned();
                self.found.push((inside, Warning::UnknownName { name, owner, line, others: 0, nearest }));
            }
            _ => {
                if self.others == 0 {
                    self.first_other = line;
                }
                self.others += 1;
            }
        }
    }

    /// The warnings, in the order of the file.
    pub(super) fn warnings(self) -> impl Iterator<Item = Warning> {
        let more = (self.others > 0)
            .then_some(Warning::MoreUnknownNames { count: self.others, line: self.first_other });
        let mut found: Vec<(&'static str, Warning)> = Vec::new();
        for (inside, warning) in self.found {
            match found.last_mut() {
                Some((other, last)) if *other == inside && are_together(last, &warning) => {
                    if let (Warning::UnknownName { name, .. }, Warning::UnknownName { name: next, .. }) =
                        (last, warning)
                    {
                        *name = format!("{name}, {next}");
                    }
                }
                _ => found.push((inside, warning)),
            }
        }
        found.into_iter().map(|(_, warning)| warning).chain(more)
    }
}

/// Whether two unknown names resemble no known one and stand in the same elements: one warning names both.
fn are_together(a: &Warning, b: &Warning) -> bool {
    let place = |warning: &Warning| match warning {
        Warning::UnknownName { owner, line, others, nearest: None, .. } => {
            Some((owner.clone(), *line, *others))
        }
        _ => None,
    };
    place(a).is_some_and(|a| place(b) == Some(a))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn misspelt_names_are_recognised_and_others_are_not() {
        let children = |name: &str| KNOWN.iter().find(|known| known.name == name).unwrap().children;
        for (word, inside, meant) in [
            ("orign", "joint", Some("origin")),
            ("axes", "joint", Some("axis")),
            ("limits", "joint", Some("limit")),
            ("inertail", "link", Some("inertial")),
            ("Link", "robot", Some("link")),
            ("jont", "robot", Some("joint")),
            ("frobnicate", "robot", None),
            ("speed", "joint", None),
        ] {
            assert_eq!(nearest(word, children(inside)), meant, "{word}");
        }
        assert_eq!(nearest("xzy", &["xyz", "rpy", "quat_xyzw"]), Some("xyz"));
        assert_eq!(nearest("ryp", &["xyz", "rpy", "quat_xyzw"]), Some("rpy"));
    }

    #[test]
    fn the_table_is_complete() {
        for child in KNOWN.iter().flat_map(|known| known.children) {
            assert!(KNOWN.iter().any(|known| known.name == *child), "{child}");
        }
    }
}
