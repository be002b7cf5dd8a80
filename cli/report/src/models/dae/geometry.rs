//! The triangles of a geometry.

use super::elements::{Named, child, numbers};
use roxmltree::Node;
use std::collections::HashMap;

/// The corners of triangles, three for each, in the coordinates of the geometry.
pub struct Geometry(pub Vec<[f64; 3]>);

/// What primitives look up: elements by their `id`.
pub type Ids<'a, 'b> = HashMap<&'a str, Node<'a, 'b>>;

/// The element of a reference such as `#part`.
pub fn referred<'a, 'b>(ids: &Ids<'a, 'b>, reference: Option<&str>) -> Option<Node<'a, 'b>> {
    ids.get(reference?.strip_prefix('#')?).copied()
}

impl Geometry {
    /// Of an element `<geometry>`; without triangles where it has no mesh.
    ///
    /// # Errors
    /// What is wrong, with the name of the geometry.
    pub fn read(of: Node<'_, '_>, ids: &Ids<'_, '_>) -> Result<Self, String> {
        let name = of.attribute("id").or(of.attribute("name")).unwrap_or_default();
        let mut corners = Vec::new();
        let primitives = child(of, "mesh").into_iter().flat_map(|mesh| mesh.children());
        for primitive in primitives.filter(Node::is_element) {
            add(primitive, ids, &mut corners).map_err(|error| format!("geometry '{name}': {error}"))?;
        }
        Ok(Self(corners))
    }
}

/// Adds the triangles of `<triangles>`, `<polylist>` and the like; of other elements none.
fn add(of: Node<'_, '_>, ids: &Ids<'_, '_>, corners: &mut Vec<[f64; 3]>) -> Result<(), String> {
    let kind = of.tag_name().name();
    if !["triangles", "polylist", "polygons", "trifans", "tristrips"].contains(&kind) {
        return Ok(());
    }
    let positions = Positions::read(of, ids)?;
    let lists = of.descendants().filter(|node| node.has_tag_name_of("p"));
    for list in lists {
        let indices: Vec<usize> = numbers(list)?;
        let face: Result<Vec<_>, _> =
            indices.chunks_exact(positions.stride).map(|of| positions.at(of)).collect();
        let face = face?;
        match kind {
            "triangles" => corners.extend(&face[..face.len() / 3 * 3]),
            "polylist" => {
                let counts: Vec<usize> = child(of, "vcount").map(numbers).transpose()?.unwrap_or_default();
                let mut rest = face.as_slice();
                for count in counts {
                    let Some((polygon, others)) = rest.split_at_checked(count) else {
                        return Err("<vcount> asks for more corners than <p> has; write it again".into());
                    };
                    fan(polygon, corners);
                    rest = others;
                }
            }
            "tristrips" => {
                for (k, corner) in face.windows(3).enumerate() {
                    let [a, b, c] = [corner[0], corner[1], corner[2]];
                    corners.extend(if k % 2 == 0 { [a, b, c] } else { [b, a, c] });
                }
            }
            _ => fan(&face, corners),
        }
    }
    Ok(())
}

/// A polygon as triangles about its first corner.
fn fan(polygon: &[[f64; 3]], corners: &mut Vec<[f64; 3]>) {
    if let [first, rest @ ..] = polygon {
        corners.extend(rest.windows(2).flat_map(|pair| [*first, pair[0], pair[1]]));
    }
}

/// Where the corners of a primitive are.
struct Positions {
    numbers: Vec<f64>,
    /// The first number of the first position, and numbers from one to the next.
    first: usize,
    step: usize,
    /// Indices for one corner, and which of them is that of the position.
    stride: usize,
    offset: usize,
}

impl Positions {
    fn read(of: Node<'_, '_>, ids: &Ids<'_, '_>) -> Result<Self, String> {
        let missing = || "its positions are missing; write it again".to_owned();
        let inputs = || of.children().filter(|node| node.has_tag_name_of("input"));
        let place = |input: Node<'_, '_>| input.attribute("offset").map_or(Some(0), |text| text.parse().ok());
        let offsets: Option<Vec<usize>> = inputs().map(place).collect();
        let stride = offsets.ok_or_else(missing)?.into_iter().max().unwrap_or(0).saturating_add(1);
        let vertex = inputs().find(|input| input.attribute("semantic") == Some("VERTEX"));
        let (offset, vertices) = vertex
            .and_then(|input| Some((place(input)?, referred(ids, input.attribute("source"))?)))
            .ok_or_else(missing)?;
        let mut inputs = vertices.children().filter(|node| node.has_tag_name_of("input"));
        let position = inputs.find(|input| input.attribute("semantic") == Some("POSITION"));
        let source =
            position.and_then(|input| referred(ids, input.attribute("source"))).ok_or_else(missing)?;
        let accessor = child(source, "technique_common").and_then(|common| child(common, "accessor"));
        let number = |name: &str, usual: usize| {
            let given = accessor.and_then(|accessor| accessor.attribute(name));
            given.map_or(Ok(usual), |text| text.parse().map_err(|_| missing()))
        };
        let array = accessor.and_then(|accessor| referred(ids, accessor.attribute("source")));
        let array = array.or(child(source, "float_array")).ok_or_else(missing)?;
        let (first, step) = (number("offset", 0)?, number("stride", 3)?);
        Ok(Self { numbers: numbers(array)?, first, step, stride, offset })
    }

    /// The position of a corner with these indices.
    fn at(&self, indices: &[usize]) -> Result<[f64; 3], String> {
        let start = indices[self.offset].checked_mul(self.step).and_then(|at| at.checked_add(self.first));
        let found = start.and_then(|start| self.numbers.get(start..start.checked_add(3)?));
        match found {
            Some(&[x, y, z]) => Ok([x, y, z]),
            _ => Err("a corner has a position that is not there; write it again".into()),
        }
    }
}
