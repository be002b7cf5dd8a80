//! How links look: the visual models of a URDF, with the meshes of their files.

mod dae;
mod file;
mod mesh;
mod obj;
mod stl;

pub use mesh::Mesh;

use costate::robot::urdf::{Geometry, visuals};
use costate::robot::{Placement, RobotError, printable};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A part of what a link looks like.
#[derive(Clone, Debug, PartialEq)]
pub struct LinkModel {
    /// Name of the link.
    pub link: String,
    /// In the frame of the link (m).
    pub placement: Placement,
    /// Its shape.
    pub shape: ModelShape,
    /// Red, green, blue and opacity, each from 0 to 1; `None` for the colour of the page.
    pub colour: Option<[f64; 4]>,
}

/// The shape of a model, about the origin of its own axes.
#[derive(Clone, Debug, PartialEq)]
pub enum ModelShape {
    /// A box with these sides (m).
    Box([f64; 3]),
    /// A cylinder along z.
    Cylinder {
        /// Radius (m).
        radius: f64,
        /// Length (m).
        length: f64,
    },
    /// A sphere of this radius (m).
    Sphere(f64),
    /// A mesh.
    Mesh {
        /// Its triangles, in its own unit.
        mesh: Arc<Mesh>,
        /// Factors of its coordinates.
        scale: [f64; 3],
    },
}

/// The models that were read, and a sentence for each mesh that could not be: it names the link, the line and
/// the file.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct Models {
    /// Parts of links, in the order of the file.
    pub links: Vec<LinkModel>,
    /// What is missing. A link of which nothing was read is drawn as a capsule.
    pub warnings: Vec<String>,
}

/// The visual models of a URDF with their meshes (STL, binary or text, OBJ, and COLLADA, whose up axis is not
/// applied).
///
/// Relative paths start in `folder`, that of the URDF. Of `package://NAME/PATH` the folder NAME is looked for
/// in each of `packages`, which may also be that folder itself, then beside and above `folder`.
///
/// # Errors
/// [`RobotError`] for text that is no URDF, or has a malformed model. A mesh that cannot be read is no error
/// but one of [`Models::warnings`].
pub fn of_urdf(text: &str, folder: &Path, packages: &[PathBuf]) -> Result<Models, RobotError> {
    let mut models = Models::default();
    let mut meshes: HashMap<PathBuf, Arc<Mesh>> = HashMap::new();
    for visual in visuals(text)? {
        let shape = match visual.geometry {
            Geometry::Box { size } => ModelShape::Box(size),
            Geometry::Cylinder { radius, length } => ModelShape::Cylinder { radius, length },
            Geometry::Sphere { radius } => ModelShape::Sphere(radius),
            Geometry::Mesh { file, scale } => {
                let read = file::find(&file, folder, packages).and_then(|path| match meshes.get(&path) {
                    Some(mesh) => Ok(mesh.clone()),
                    None => {
                        let mesh = Arc::new(file::read(&path)?);
                        meshes.insert(path, mesh.clone());
                        Ok(mesh)
                    }
                });
                match read {
                    Ok(mesh) => ModelShape::Mesh { mesh, scale },
                    Err(reason) => {
                        let (link, line) = (printable(&visual.link), visual.line);
                        let file = printable(&file);
                        models.warnings.push(format!("link '{link}' (line {line}): mesh {file}: {reason}"));
                        continue;
                    }
                }
            }
            _ => continue,
        };
        let (link, placement, colour) = (visual.link, visual.placement, visual.colour);
        models.links.push(LinkModel { link, placement, shape, colour });
    }
    Ok(models)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

    fn urdf(mesh: &str) -> String {
        format!(
            "<robot name=\"arm\"><link name=\"hand\">\n<visual><geometry><mesh filename=\"{mesh}\"/></geometry>\
             </visual><visual><geometry><sphere radius=\"0.1\"/></geometry></visual></link></robot>"
        )
    }

    #[test]
    fn meshes_of_packages_are_found() {
        let folder = std::env::temp_dir().join(format!("costate-models-{}", std::process::id()));
        let (meshes, robots) = (folder.join("arm/meshes"), folder.join("arm/robots"));
        std::fs::create_dir_all(&meshes).unwrap();
        std::fs::create_dir_all(&robots).unwrap();
        std::fs::write(meshes.join("hand.obj"), TRIANGLE).unwrap();
        std::fs::write(meshes.join("bad.stl"), "solid x\nfacet\nvertex 1 2 oh\n").unwrap();
        let elsewhere = PathBuf::from("nowhere");
        for (file, urdf_folder, packages) in [
            ("package://arm/meshes/hand.obj", &elsewhere, vec![folder.clone()]),
            ("package://arm/meshes/hand.obj", &elsewhere, vec![folder.join("arm")]),
            ("package://arm/meshes/hand.obj", &robots, vec![]),
            ("../meshes/hand.obj", &robots, vec![]),
        ] {
            let models = of_urdf(&urdf(file), urdf_folder, &packages).unwrap();
            assert!(models.warnings.is_empty(), "{file}: {:?}", models.warnings);
            let ModelShape::Mesh { mesh, .. } = &models.links[0].shape else { panic!("{models:?}") };
            assert_eq!(mesh.triangles(), 1);
        }
        for (file, words) in [
            ("package://arm/meshes/hand.obj", "--package-path"),
            ("lost.stl", "lost.stl: cannot be read"),
            ("hand.dae", "hand.dae: cannot be read"),
            ("hand.ply", "STL, OBJ and COLLADA"),
        ] {
            let models = of_urdf(&urdf(file), &elsewhere, &[]).unwrap();
            let [warning] = &models.warnings[..] else { panic!("{models:?}") };
            assert!(warning.contains("link 'hand' (line 2)") && warning.contains(words), "{warning}");
            assert_eq!(models.links.len(), 1);
        }
        let models = of_urdf(&urdf("../meshes/bad.stl"), &robots, &[]).unwrap();
        assert!(models.warnings[0].contains("line 3"), "{:?}", models.warnings);
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
