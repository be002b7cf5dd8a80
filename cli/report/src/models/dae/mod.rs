//! Meshes in COLLADA files: the triangles and polygons of the scene, in metres. Colours, skins, lights and
//! all else are left out.
//!
//! `<up_axis>` is not applied: coordinates count as they are written. So do RViz and other programs that show
//! URDFs, for which the meshes of robots are placed.

mod elements;
mod geometry;
mod scene;

use super::mesh::Mesh;
use elements::child;
use roxmltree::Document;
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

#[cfg(test)]
mod tests;
