//! Shapes of visual and collision models.

use super::element::Element;
use crate::robot::error::RobotError;
use roxmltree::Node;

/// The shape of a visual or collision model, about the origin of its own axes.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Geometry {
    /// A box with these sides along x, y and z (m).
    Box {
        /// Sides (m).
        size: [f64; 3],
    },
    /// A cylinder along z.
    Cylinder {
        /// Radius (m).
        radius: f64,
        /// Length (m).
        length: f64,
    },
    /// A sphere.
    Sphere {
        /// Radius (m).
        radius: f64,
    },
    /// A mesh of a file.
    Mesh {
        /// Its name as the file gives it: a path, `file://...`, or `package://NAME/...`.
        file: String,
        /// Factors of its coordinates.
        scale: [f64; 3],
    },
}

/// The child elements of that name.
pub(super) fn children<'a>(node: Node<'a, 'a>, name: &'a str) -> impl Iterator<Item = Node<'a, 'a>> {
    node.children().filter(move |child| child.is_element() && child.tag_name().name() == name)
}

/// The first shape of a `<geometry>`; `None` if there is none that is known.
pub(super) fn shape(geometry: &Element<'_>) -> Result<Option<Geometry>, RobotError> {
    let positive = |shape: &Element<'_>, name: &str| match shape.required_number(name)? {
        x if x > 0.0 => Ok(x),
        x => Err(shape.refuse(format_args!("has {name} = {x}; give a positive number"))),
    };
    if let Some(shape) = geometry.child("box")? {
        let size = shape.numbers::<3>("size")?;
        let size = size.ok_or_else(|| shape.refuse("has no size; add size=\"...\""))?;
        return Ok(Some(Geometry::Box { size: size.map(f64::abs) }));
    }
    for name in ["cylinder", "capsule"] {
        let Some(shape) = geometry.child(name)? else { continue };
        let (radius, length) = (positive(&shape, "radius")?, positive(&shape, "length")?);
        return Ok(Some(Geometry::Cylinder { radius, length }));
    }
    if let Some(shape) = geometry.child("sphere")? {
        return Ok(Some(Geometry::Sphere { radius: positive(&shape, "radius")? }));
    }
    if let Some(shape) = geometry.child("mesh")? {
        let file = shape.attribute("filename").unwrap_or_default().trim().to_owned();
        if file.is_empty() {
            return Err(shape.refuse("has no filename; add filename=\"...\""));
        }
        let scale = match shape.attribute("scale").map(|text| text.split_whitespace().count()) {
            Some(1) => shape.number("scale")?.map(|scale| [scale; 3]),
            _ => shape.numbers::<3>("scale")?,
        };
        return Ok(Some(Geometry::Mesh { file, scale: scale.unwrap_or([1.0; 3]) }));
    }
    Ok(None)
}
