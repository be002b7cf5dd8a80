//! Meshes in COLLADA files: the triangles and polygons of the scene, in metres. Colours, skins, lights and all
//! else are left out.
//!
//! `<up_axis>` is not applied: coordinates count as they are written. So do RViz and other programs that show
//! URDFs, for which the meshes of robots are placed.

mod geometry;
mod scene;

use super::mesh::Mesh;
use geometry::Geometry;
use roxmltree::{Document, Node};
use scene::{Scene, Transform};

pub fn read(bytes: &[u8]) -> Result<Mesh, String> {
    let text = String::from_utf8_lossy(bytes);
    let document =
        Document::parse(&text).map_err(|error| format!("is no COLLADA: {error}; write it again"))?;
    let root = document.root_element();
    if root.tag_name().name() != "COLLADA" {
        return Err("is no COLLADA: its element is another one; write it again".into());
    }
    let unit = child(root, "asset").and_then(|asset| child(asset, "unit")?.attribute("meter"));
    let unit = match unit.map(str::parse::<f64>) {
        None => 1.0,
        Some(Ok(unit)) if unit.is_finite() && unit > 0.0 => unit,
        Some(_) => return Err("its unit is no positive number of metres; correct <unit meter>".into()),
    };
    let scaled = Transform::scale([unit; 3]);
    Mesh::of_corners(Scene::new(root).corners(&scaled)?.into_iter())
}

/// The first child of this name.
fn child<'a, 'b>(node: Node<'a, 'b>, name: &str) -> Option<Node<'a, 'b>> {
    node.children().find(|child| child.has_tag_name_of(name))
}

/// Names of elements without their space of names.
trait Named {
    fn has_tag_name_of(&self, name: &str) -> bool;
}

impl Named for Node<'_, '_> {
    fn has_tag_name_of(&self, name: &str) -> bool {
        self.is_element() && self.tag_name().name() == name
    }
}

/// The numbers of an element.
fn numbers<T: std::str::FromStr>(node: Node<'_, '_>) -> Result<Vec<T>, String> {
    let words = node.text().unwrap_or_default().split_ascii_whitespace();
    let found: Result<Vec<T>, _> = words.map(str::parse).collect();
    found.map_err(|_| {
        format!("<{}> has a word that is no such number; write it again", node.tag_name().name())
    })
}

#[cfg(test)]
mod tests;
