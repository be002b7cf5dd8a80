//! Collision models of the links of a URDF: what a link touches with, no part of its dynamics.

use super::element::Element;
use super::geometry::{Geometry, children, shape};
use super::origin::{placed, version};
use super::xml::{self, Lines};
use crate::robot::error::RobotError;
use crate::robot::link::Placement;
use crate::robot::printable::printable;

/// A `<collision>` of a link.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct CollisionModel {
    /// Name of the link: [`Robot::frame`](crate::robot::Robot::frame) finds its frame.
    pub link: String,
    /// The geometry in the frame of the link (m).
    pub placement: Placement,
    /// Its shape.
    pub geometry: Geometry,
    /// Line of the file, from 1.
    pub line: usize,
}

/// The collision models of all links, in the order of the file.
///
/// ```
/// use costate::robot::urdf::{Geometry, collisions};
///
/// let text = r#"<robot name="arm"><link name="hand"><collision>
///     <origin xyz="0 0 0.1"/><geometry><sphere radius="0.05"/></geometry>
/// </collision></link></robot>"#;
/// let hand = &collisions(text)?[0];
/// assert_eq!((hand.link.as_str(), &hand.geometry), ("hand", &Geometry::Sphere { radius: 0.05 }));
/// # Ok::<(), costate::robot::RobotError>(())
/// ```
///
/// # Errors
/// [`RobotError::InFile`] with the line, for text that is no URDF, and for a collision model whose origin or
/// geometry is malformed, is missing, or has a shape that is not known: what is left out would touch unseen.
pub fn collisions(text: &str) -> Result<Vec<CollisionModel>, RobotError> {
    let text = xml::prepared(text)?;
    let lines = Lines::of(&text);
    let document = xml::parse(&text, &lines)?;
    let has_quaternions = version(document.root_element()) >= (1, 1);
    let mut all = Vec::new();
    for link in children(document.root_element(), "link") {
        let name = link.attribute("name").unwrap_or_default();
        let owner = format!("link '{}'", printable(name));
        for node in children(link, "collision") {
            let element = Element::new(node, &lines, &owner);
            let geometry = element.required_child("geometry")?;
            let shape = shape(&geometry)?;
            let geometry = shape.ok_or_else(|| {
                geometry.refuse("has no <sphere>, <cylinder>, <box> or <mesh>; give one of them")
            })?;
            let placement = placed(&element, has_quaternions)?;
            all.push(CollisionModel { link: name.to_owned(), placement, geometry, line: element.line() });
        }
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn link(content: &str) -> String {
        format!("<robot name=\"arm\">\n<link name=\"hand\">{content}</link></robot>")
    }

    #[test]
    fn models_have_shapes_and_placements_and_visual_models_are_none() {
        let text = link(
            "<visual><geometry><sphere radius=\"1\"/></geometry></visual>\
             <collision><origin xyz=\"1 2 3\" rpy=\"0 0 1.5707963267948966\"/>\
             <geometry><cylinder radius=\"0.1\" length=\"0.4\"/></geometry></collision>\n\
             <collision name=\"palm\"><geometry><box size=\"0.1 0.2 0.3\"/></geometry></collision>",
        );
        let all = collisions(&text).unwrap();
        let placement = Placement::from_xyz_rpy([1.0, 2.0, 3.0], [0.0, 0.0, FRAC_PI_2]);
        let geometry = Geometry::Cylinder { radius: 0.1, length: 0.4 };
        let rod = CollisionModel { link: "hand".into(), placement, geometry, line: 2 };
        let (placement, geometry) = (Placement::identity(), Geometry::Box { size: [0.1, 0.2, 0.3] });
        assert_eq!(all, [rod, CollisionModel { link: "hand".into(), placement, geometry, line: 3 }]);
    }

    #[test]
    fn what_would_touch_unseen_is_refused_with_line_and_link() {
        for (content, words) in [
            ("", "has no <geometry>"),
            ("<geometry/>", "has no <sphere>"),
            ("<geometry><teapot/></geometry>", "has no <sphere>"),
            ("<geometry><sphere radius=\"0\"/></geometry>", "radius = 0"),
            ("<origin xyz=\"1 2\"/><geometry><sphere radius=\"1\"/></geometry>", "give 3"),
        ] {
            let error =
                collisions(&link(&format!("<collision>{content}</collision>"))).unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("link 'hand'"), "{error}");
            assert!(error.contains("line 2"), "{error}");
        }
    }
}
