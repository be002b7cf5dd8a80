//! Visual models of the links of a URDF: what a picture of the robot shows, no part of its dynamics.

use super::element::Element;
use super::geometry::{Geometry, children, shape};
use super::origin::{placed, version};
use super::xml::{self, Lines};
use crate::robot::error::RobotError;
use crate::robot::link::Placement;
use crate::robot::printable::printable;
use roxmltree::Document;
use std::collections::HashMap;

/// A `<visual>` of a link.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Visual {
    /// Name of the link: [`Robot::frame`](crate::robot::Robot::frame) finds its frame.
    pub link: String,
    /// The geometry in the frame of the link (m).
    pub placement: Placement,
    /// Its shape.
    pub geometry: Geometry,
    /// Red, green, blue and opacity, each from 0 to 1; `None` if the file gives no colour.
    pub colour: Option<[f64; 4]>,
    /// Line of the file, from 1.
    pub line: usize,
}

/// The visual models of all links, in the order of the file.
///
/// ```
/// use costate::robot::urdf::{Geometry, visuals};
///
/// let text = r#"<robot name="arm"><link name="hand"><visual>
///     <origin xyz="0 0 0.1"/><geometry><sphere radius="0.05"/></geometry>
/// </visual></link></robot>"#;
/// let hand = &visuals(text)?[0];
/// assert_eq!((hand.link.as_str(), &hand.geometry), ("hand", &Geometry::Sphere { radius: 0.05 }));
/// # Ok::<(), costate::robot::RobotError>(())
/// ```
///
/// # Errors
/// [`RobotError::InFile`] with the line, for text that is no URDF, and for a visual model whose origin,
/// geometry or colour is malformed.
pub fn visuals(text: &str) -> Result<Vec<Visual>, RobotError> {
    let text = xml::prepared(text)?;
    let lines = Lines::of(&text);
    let document = xml::parse(&text, &lines)?;
    let has_quaternions = version(document.root_element()) >= (1, 1);
    let colours = colours(&document, &lines)?;
    let mut all = Vec::new();
    for link in children(document.root_element(), "link") {
        let name = link.attribute("name").unwrap_or_default();
        let owner = format!("link '{}'", printable(name));
        for node in children(link, "visual") {
            let element = Element::new(node, &lines, &owner);
            let Some(geometry) = element.child("geometry")? else { continue };
            let Some(geometry) = shape(&geometry)? else { continue };
            let (link, line) = (name.to_owned(), element.line());
            let placement = placed(&element, has_quaternions)?;
            let material = element.child("material")?;
            let own = material.as_ref().map(colour).transpose()?.flatten();
            let named = material.as_ref().and_then(|material| material.attribute("name"));
            let colour = own.or_else(|| colours.get(named?).copied());
            all.push(Visual { link, placement, geometry, colour, line });
        }
    }
    Ok(all)
}

/// The colours of the materials that the robot defines by name.
fn colours<'a>(
    document: &'a Document<'a>,
    lines: &'a Lines,
) -> Result<HashMap<&'a str, [f64; 4]>, RobotError> {
    let mut colours = HashMap::new();
    for node in document.descendants().filter(|node| node.has_tag_name("material")) {
        let rgba = colour(&Element::new(node, lines, ""))?;
        if let (Some(name), Some(rgba)) = (node.attribute("name"), rgba) {
            colours.entry(name).or_insert(rgba);
        }
    }
    Ok(colours)
}

fn colour(material: &Element<'_>) -> Result<Option<[f64; 4]>, RobotError> {
    let Some(colour) = material.child("color")? else { return Ok(None) };
    Ok(colour.numbers::<4>("rgba")?.map(|rgba| rgba.map(|part| part.clamp(0.0, 1.0))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(content: &str) -> String {
        format!(
            "<robot name=\"arm\"><material name=\"red\"><color rgba=\"1 0 0 2\"/></material>\n\
             <link name=\"hand\">{content}</link></robot>"
        )
    }

    #[test]
    fn shapes_have_placements_and_colours() {
        let text = link(
            "<visual><origin xyz=\"1 2 3\" rpy=\"0 0 1.5707963267948966\"/>\
             <geometry><box size=\"0.1 0.2 0.3\"/></geometry><material name=\"red\"/></visual>\
             <visual><geometry><mesh filename=\" package://arm/hand.stl \" scale=\"2\"/></geometry>\
             <material name=\"own\"><color rgba=\"0 0.5 0 1\"/></material></visual>\
             <visual><geometry><cylinder radius=\"0.1\" length=\"0.4\"/></geometry></visual>\
             <visual><geometry><teapot/></geometry></visual><visual/>",
        );
        let all = visuals(&text).unwrap();
        assert_eq!(all.len(), 3);
        assert_eq!(all[0].geometry, Geometry::Box { size: [0.1, 0.2, 0.3] });
        assert_eq!(
            all[0].placement,
            Placement::from_xyz_rpy([1.0, 2.0, 3.0], [0.0, 0.0, std::f64::consts::FRAC_PI_2])
        );
        assert_eq!((all[0].colour, all[0].line), (Some([1.0, 0.0, 0.0, 1.0]), 2));
        let file = "package://arm/hand.stl".to_owned();
        assert_eq!(all[1].geometry, Geometry::Mesh { file, scale: [2.0; 3] });
        assert_eq!(all[1].colour, Some([0.0, 0.5, 0.0, 1.0]));
        assert_eq!(
            (&all[2].geometry, all[2].colour),
            (&Geometry::Cylinder { radius: 0.1, length: 0.4 }, None)
        );
    }

    #[test]
    fn malformed_shapes_are_refused_with_line_and_link() {
        for (shape, words) in [
            ("<sphere radius=\"-1\"/>", "radius = -1"),
            ("<box/>", "no size"),
            ("<mesh/>", "no filename"),
            ("<cylinder radius=\"1\"/>", "no length"),
        ] {
            let text = link(&format!("<visual><geometry>{shape}</geometry></visual>"));
            let error = visuals(&text).unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("link 'hand'"), "{error}");
            assert!(error.contains("line 2"), "{error}");
        }
        assert!(visuals("<robot").is_err());
    }
}
