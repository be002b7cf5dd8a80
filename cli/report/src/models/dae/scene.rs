//! The scene: nodes with their transforms, which place geometries.

use super::elements::{Named, child, numbers};
use super::geometry::{Geometry, Ids, referred};
use roxmltree::Node;
use std::collections::HashMap;
use std::rc::Rc;

/// Most corners of triangles (a mesh for a page is made coarser than that), most nodes one in another, and
/// most nodes: files may refer to one of them again and again.
const MOST_CORNERS: usize = 12_000_000;
const DEEPEST: usize = 64;
const MOST_NODES: usize = 100_000;

/// x to A x + b: the rows of (A b).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform([[f64; 4]; 3]);

impl Transform {
    pub fn scale([x, y, z]: [f64; 3]) -> Self {
        Self([[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]])
    }

    /// About an axis, by an angle in degrees.
    fn turn([x, y, z, degrees]: [f64; 4]) -> Self {
        let length = (x * x + y * y + z * z).sqrt();
        let [x, y, z] = if length > 0.0 { [x / length, y / length, z / length] } else { [0.0, 0.0, 1.0] };
        let (sin, cos) = degrees.to_radians().sin_cos();
        let t = 1.0 - cos;
        Self([
            [t * x * x + cos, t * x * y - sin * z, t * x * z + sin * y, 0.0],
            [t * x * y + sin * z, t * y * y + cos, t * y * z - sin * x, 0.0],
            [t * x * z - sin * y, t * y * z + sin * x, t * z * z + cos, 0.0],
        ])
    }

    /// The other one first.
    fn after(&self, other: &Self) -> Self {
        let entry = |i: usize, j: usize| {
            let turned: f64 = (0..3).map(|k| self.0[i][k] * other.0[k][j]).sum();
            if j == 3 { turned + self.0[i][3] } else { turned }
        };
        Self([0, 1, 2].map(|i| [0, 1, 2, 3].map(|j| entry(i, j))))
    }

    fn of(&self, x: [f64; 3]) -> [f32; 3] {
        self.0.map(|row| (row[0] * x[0] + row[1] * x[1] + row[2] * x[2] + row[3]) as f32)
    }

    /// Whether it turns what is seen from outside inside.
    fn mirrors(&self) -> bool {
        let [a, b, c] = self.0;
        let determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
            + a[2] * (b[0] * c[1] - b[1] * c[0]);
        determinant < 0.0
    }

    /// That of an element of a node; `None` for elements that are no transforms.
    fn read(of: Node<'_, '_>) -> Result<Option<Self>, String> {
        let kind = of.tag_name().name();
        if !["matrix", "translate", "rotate", "scale", "skew", "lookat"].contains(&kind) {
            return Ok(None);
        }
        let row = |of: &[f64]| [of[0], of[1], of[2], of[3]];
        Ok(Some(match (kind, numbers::<f64>(of)?.as_slice()) {
            ("matrix", m) if m.len() == 16 => Self([row(&m[..4]), row(&m[4..8]), row(&m[8..12])]),
            ("translate", &[x, y, z]) => Self([[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]]),
            ("rotate", &[x, y, z, angle]) => Self::turn([x, y, z, angle]),
            ("scale", &[x, y, z]) => Self::scale([x, y, z]),
            ("skew" | "lookat", _) => {
                return Err(format!("a node has a <{kind}>, which is not read; give a <matrix>"));
            }
            _ => return Err(format!("a <{kind}> has another count of numbers; write it again")),
        }))
    }
}

/// The elements of a file.
pub struct Scene<'a, 'b> {
    root: Node<'a, 'b>,
    ids: Ids<'a, 'b>,
    geometries: HashMap<Option<&'a str>, Rc<Geometry>>,
    corners: Vec<[f32; 3]>,
    nodes: usize,
}

impl<'a, 'b> Scene<'a, 'b> {
    pub fn new(root: Node<'a, 'b>) -> Self {
        let known = root.descendants().filter_map(|node| Some((node.attribute("id")?, node)));
        Self { root, ids: known.collect(), geometries: HashMap::new(), corners: Vec::new(), nodes: 0 }
    }

    /// The corners of all triangles of the scene; of all geometries where there is none.
    ///
    /// # Errors
    /// What is wrong and what to do.
    pub fn corners(mut self, unit: &Transform) -> Result<Vec<[f32; 3]>, String> {
        let instance = child(self.root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
        let shown = instance.and_then(|instance| referred(&self.ids, instance.attribute("url")));
        let first = || child(child(self.root, "library_visual_scenes")?, "visual_scene");
        match shown.or_else(first) {
            Some(scene) => self.children(scene, unit, 0)?,
            None => {
                let all = child(self.root, "library_geometries").into_iter().flat_map(|all| all.children());
                for geometry in all.filter(|node| node.has_tag_name_of("geometry")) {
                    self.geometry(geometry, unit)?;
                }
            }
        }
        Ok(self.corners)
    }

    /// All nodes in one, or in the scene.
    fn children(&mut self, of: Node<'a, 'b>, transform: &Transform, depth: usize) -> Result<(), String> {
        for part in of.children().filter(Node::is_element) {
            let node = match part.tag_name().name() {
                "node" => Some(part),
                "instance_node" => referred(&self.ids, part.attribute("url")),
                "instance_geometry" => {
                    if let Some(geometry) = referred(&self.ids, part.attribute("url")) {
                        self.geometry(geometry, transform)?;
                    }
                    None
                }
                _ => None,
            };
            let Some(node) = node else { continue };
            self.nodes += 1;
            if depth == DEEPEST || self.nodes > MOST_NODES {
                return Err("its nodes refer to each other without end; write it again".into());
            }
            let mut inner = *transform;
            for part in node.children().filter(Node::is_element) {
                if let Some(next) = Transform::read(part)? {
                    inner = inner.after(&next);
                }
            }
            self.children(node, &inner, depth + 1)?;
        }
        Ok(())
    }

    /// Adds a geometry.
    fn geometry(&mut self, of: Node<'a, 'b>, transform: &Transform) -> Result<(), String> {
        let id = of.attribute("id");
        let known = self.geometries.get(&id).filter(|_| id.is_some()).cloned();
        let geometry = match known {
            Some(known) => known,
            None => Rc::new(Geometry::read(of, &self.ids)?),
        };
        self.geometries.insert(id, geometry.clone());
        if self.corners.len() + geometry.0.len() > MOST_CORNERS {
            return Err(format!("has more than {} triangles; give a coarser mesh", MOST_CORNERS / 3));
        }
        let mirrors = transform.mirrors();
        for triangle in geometry.0.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| transform.of(triangle[k]));
            self.corners.extend(if mirrors { [a, c, b] } else { [a, b, c] });
        }
        Ok(())
    }
}
