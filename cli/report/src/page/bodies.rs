//! Bodies on the stage: models of links, capsules in their place.

use super::values::{number, placement, shown, vector};
use crate::entries::{Mover, is_floating, is_last, movers};
use crate::models::{LinkModel, Mesh, ModelShape};
use crate::motion::Motion;
use crate::shape::{SHORTEST, end_of, equal_box, is_trunk, moves_freely};
use crate::soles::{Sole, soles};
use crate::tools::ToolFrame;
use costate::robot::{Joint, JointKind, Placement, Robot};
use serde_json::{Value, json};
use std::sync::Arc;

/// Radius of a capsule near the base and at the end, in parts of the length of the robot.
const RADII: [f64; 2] = [0.042, 0.022];

/// Meshes, each once.
#[derive(Default)]
pub struct Meshes(Vec<Arc<Mesh>>);

impl Meshes {
    fn number(&mut self, mesh: &Arc<Mesh>) -> usize {
        let found = self.0.iter().position(|other| Arc::ptr_eq(other, mesh));
        found.unwrap_or_else(|| {
            self.0.push(mesh.clone());
            self.0.len() - 1
        })
    }

    /// Bounds, and vertices and triangles in base 64.
    pub fn json(&self) -> Vec<Value> {
        let mesh = |mesh: &Arc<Mesh>| {
            let ([low, high], [vertices, triangles]) =
                (mesh.corners(), mesh.bytes().map(|bytes| base64(&bytes)));
            json!({ "low": low, "high": high, "vertices": vertices, "triangles": triangles })
        };
        self.0.iter().map(mesh).collect()
    }
}

/// The bodies of all links.
pub fn bodies(motion: &Motion<'_>, tools: &[ToolFrame], meshes: &mut Meshes) -> Vec<Value> {
    let robot = motion.robot();
    let mut bodies = Vec::new();
    let mut has_model = vec![false; robot.joints().len() + 1];
    for model in &motion.options.models {
        let Ok(frame) = robot.frame(&model.link) else { continue };
        has_model[frame.joint.map_or(0, |joint| joint + 1)] = true;
        bodies.push(json!({
            "joint": frame.joint,
            "at": placement(&frame.placement.then(&model.placement)),
            "shape": shape_of(model, meshes),
            "colour": model.colour,
            "link": shown(&model.link),
        }));
    }
    let capsules = Capsules::new(motion, tools);
    capsules.base(&mut bodies, !has_model[0]);
    for joint in 0..robot.joints().len() {
        if !has_model[joint + 1] {
            capsules.link(joint, &mut bodies);
        }
    }
    let soles = soles(motion.problem);
    bodies.extend(soles.iter().filter(|sole| !has_model[sole.joint + 1]).map(|sole| capsules.sole(sole)));
    bodies
}

fn shape_of(model: &LinkModel, meshes: &mut Meshes) -> Value {
    match &model.shape {
        ModelShape::Box(size) => json!({ "kind": "box", "size": vector(*size) }),
        ModelShape::Cylinder { radius, length } => {
            json!({ "kind": "cylinder", "radius": number(*radius), "length": number(*length) })
        }
        ModelShape::Sphere(radius) => json!({ "kind": "sphere", "radius": number(*radius) }),
        ModelShape::Mesh { mesh, scale } => {
            json!({ "kind": "mesh", "mesh": meshes.number(mesh), "scale": scale })
        }
    }
}

/// Capsules in the place of links without a model.
struct Capsules<'a> {
    robot: &'a Robot,
    tools: &'a [ToolFrame],
    /// The longest way from the base to an end (m).
    reach: f64,
    /// The radius that the problem gives to all links.
    radius: Option<f64>,
    /// Joints between each one and the base.
    depths: Vec<usize>,
    /// Least and largest position of each joint along the motion.
    ranges: Vec<[f64; 2]>,
}

impl<'a> Capsules<'a> {
    fn new(motion: &Motion<'a>, tools: &'a [ToolFrame]) -> Self {
        let robot = motion.robot();
        let joints = robot.joints();
        let (mut ways, mut depths) = (vec![0.0; joints.len()], vec![0; joints.len()]);
        // A floating or spherical joint counts as one.
        let step = |joint: &Joint| usize::from(joint.free.as_ref().is_none_or(is_last));
        for (i, joint) in joints.iter().enumerate() {
            let (way, depth) =
                joint.parent.map_or((0.0, 0), |parent| (ways[parent], depths[parent] + step(joint)));
            (ways[i], depths[i]) = (way + joint.placement.translation.norm(), depth);
        }
        let ends = tools
            .iter()
            .map(|tool| tool.joint.map_or(0.0, |joint| ways[joint]) + tool.placement.translation.norm());
        let reach = ends.chain(ways.iter().copied()).fold(0.0, f64::max);
        let range = |mover: &Mover| {
            let Mover::Position { at, ratio, offset } = *mover else { return [0.0, 0.0] };
            let values = motion.points.iter().filter_map(|point| Some(ratio * point.q.get(at)? + offset));
            values.fold([0.0, 0.0], |[low, high]: [f64; 2], x| [low.min(x), high.max(x)])
        };
        let radius = motion.problem.task.collision.as_ref().and_then(|collision| collision.along_links);
        let ranges = movers(robot).iter().map(range).collect();
        Self { robot, tools, reach: if reach > 0.0 { reach } else { 1.0 }, radius, depths, ranges }
    }

    fn radius(&self, joint: usize) -> f64 {
        let deepest = self.depths.iter().copied().max().unwrap_or(0).max(1) as f64;
        let part = self.depths[joint] as f64 / deepest;
        self.radius.unwrap_or(self.reach * (RADII[0] + part * (RADII[1] - RADII[0])))
    }

    /// A capsule in the frame of a joint.
    fn capsule(joint: Option<usize>, from: [f64; 3], to: [f64; 3], radius: f64, link: &str) -> Value {
        json!({
            "joint": joint,
            "at": placement(&Placement::identity()),
            "shape": { "kind": "capsule", "from": vector(from), "to": vector(to), "radius": number(radius) },
            "colour": Value::Null,
            "link": shown(link),
        })
    }

    /// From the origin of the world to the first joints, and the rails of those that slide on it.
    fn base(&self, bodies: &mut Vec<Value>, has_capsules: bool) {
        for (i, joint) in self.robot.joints().iter().enumerate().filter(|(_, joint)| joint.parent.is_none()) {
            let to = joint.placement.translation;
            if has_capsules && to.norm() > SHORTEST && !is_floating(joint) {
                bodies.push(Self::capsule(None, [0.0; 3], to.into(), 1.15 * self.radius(i), "base"));
            }
            if has_capsules {
                self.rail(i, bodies);
            }
        }
    }

    /// From a joint to those beyond it, or to the tools and frames of a last link.
    fn link(&self, joint: usize, bodies: &mut Vec<Value>) {
        let name = &self.robot.joints()[joint].link;
        let children =
            self.robot.joints().iter().enumerate().filter(|(_, child)| child.parent == Some(joint));
        let mut ends = Vec::new();
        for (i, child) in children {
            if !is_floating(child) {
                ends.push(child.placement.translation);
            }
            self.rail(i, bodies);
        }
        let is_body = self.body(joint, bodies);
        if (ends.is_empty() && !is_body) || is_trunk(self.robot, joint) {
            let tools = self.tools.iter().filter(|tool| tool.joint == Some(joint));
            ends.extend(tools.map(|tool| tool.placement.translation));
            ends.push(end_of(self.robot, joint).into());
        }
        let mut drawn: Vec<[f64; 3]> = Vec::new();
        for end in ends.into_iter().map(<[f64; 3]>::from) {
            let norm = end.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm > SHORTEST && !drawn.contains(&end) {
                bodies.push(Self::capsule(Some(joint), [0.0; 3], end, self.radius(joint), name));
                drawn.push(end);
            }
        }
    }

    /// The box, or the ball, of a link that floats; whether it has one.
    fn body(&self, joint: usize, bodies: &mut Vec<Value>) -> bool {
        let moved = &self.robot.joints()[joint];
        let is_own = is_floating(moved) && moved.free.as_ref().is_some_and(is_last);
        if !is_own || moved.inertia.mass <= 0.0 {
            return false;
        }
        let shape = match equal_box(&moved.inertia) {
            Some(edges) => json!({ "kind": "box", "size": vector(edges) }),
            None => json!({ "kind": "sphere", "radius": number(1.6 * self.radius(joint)) }),
        };
        let at = Placement { translation: moved.inertia.com, ..Placement::identity() };
        bodies.push(json!({
            "joint": joint,
            "at": placement(&at),
            "shape": shape,
            "colour": Value::Null,
            "link": shown(&moved.link),
        }));
        true
    }

    /// A sole stands on the ground: a plate in space, a capsule in the plane.
    fn sole(&self, sole: &Sole) -> Value {
        let [heel, toe] = sole.ends;
        let radius = self.radius(sole.joint).min(0.5 * (toe - heel));
        let place = |x: f64| {
            let place = Placement::from_xyz_rpy([x, 0.0, radius], [0.0; 3]);
            sole.placement.then(&place)
        };
        if sole.width > 0.0 {
            let size = json!([number(toe - heel), number(sole.width), number(2.0 * radius)]);
            return json!({
                "joint": sole.joint,
                "at": placement(&place(0.5 * (heel + toe))),
                "shape": { "kind": "box", "size": size },
                "colour": Value::Null,
                "link": "sole",
            });
        }
        let [from, to] = [heel + radius, toe - radius].map(|x| place(x).translation.into());
        Self::capsule(Some(sole.joint), from, to, radius, "sole")
    }

    /// What a prismatic joint slides on, as long as its way. A base that moves freely slides on nothing.
    fn rail(&self, joint: usize, bodies: &mut Vec<Value>) {
        let slide = &self.robot.joints()[joint];
        if slide.kind != JointKind::Prismatic || moves_freely(self.robot, joint) {
            return;
        }
        let margin = 0.05 * self.reach;
        let axis = slide.placement.rotation * slide.axis;
        let [low, high] = self.ranges[joint];
        let [from, to] = [low - margin, high + margin].map(|q| slide.placement.translation + axis * q);
        bodies.push(Self::capsule(slide.parent, from.into(), to.into(), 0.4 * self.radius(joint), "rail"));
    }
}

/// Bytes in base 64 (RFC 4648).
fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let byte = |k: usize| u32::from(three.get(k).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for k in 0..4 {
            let digit = DIGITS[(bits >> (18 - 6 * k) & 63) as usize];
            text.push(if k <= three.len() { char::from(digit) } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{Capsules, base64};
    use crate::ReportOptions;
    use crate::motion::Motion;
    use crate::soles::soles;
    use costate::robot::LoadOptions;
    use costate_control::{ProblemFile, Solver, Verify};
    use std::time::Duration;

    /// The lower sides of plates are where the feet touch the ground.
    #[test]
    fn soles_are_plates() {
        let path = "../../examples/problems/biped_walk.toml";
        let file = ProblemFile::read(path, LoadOptions::default()).unwrap();
        let problem = file.problem;
        // What the search begins with is enough.
        let options = file.options.with_time_limit(Duration::from_nanos(1)).with_verify(Verify::None);
        let solution = Solver::new(&problem, options).unwrap().solve();
        let options = ReportOptions::default();
        let motion = Motion::new(&problem, &solution, &options);
        let capsules = Capsules::new(&motion, &[]);
        let [left, right] = ["left_ankle_roll", "right_ankle_roll"]
            .map(|name| problem.robot.joints().iter().position(|joint| joint.name == name).unwrap());
        let all = soles(&problem);
        assert_eq!(all.iter().map(|sole| sole.joint).collect::<Vec<_>>(), [right, left]);
        for sole in &all {
            let plate = capsules.sole(sole);
            let height = 2.0 * capsules.radius(sole.joint);
            assert_eq!(plate["shape"]["kind"], "box");
            let sizes = plate["shape"]["size"].as_array().unwrap();
            let sizes: Vec<f64> = sizes.iter().filter_map(|size| size.as_f64()).collect();
            let expected = [0.1371 + 0.0488, 0.0958, height];
            // Numbers of the page have seven digits.
            assert!(sizes.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-9), "{sizes:?}");
            let z = plate["at"][11].as_f64().unwrap();
            assert!((z - 0.5 * height + 0.067899).abs() < 1e-9, "{plate}");
        }
    }

    /// The examples of RFC 4648.
    #[test]
    fn bytes_become_letters() {
        let text = ["", "f", "fo", "foo", "foob", "fooba", "foobar"].map(|text| base64(text.as_bytes()));
        assert_eq!(text, ["", "Zg==", "Zm8=", "Zm9v", "Zm9vYg==", "Zm9vYmE=", "Zm9vYmFy"]);
    }
}
