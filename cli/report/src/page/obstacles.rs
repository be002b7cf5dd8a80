//! Obstacles on the stage.

use super::values::{number, placement, shown, vector};
use costate::robot::Placement;
use costate_control::{Problem, Shape};
use serde_json::{Value, json};

/// What the motion keeps away from.
pub fn obstacles(problem: &Problem) -> Vec<Value> {
    let obstacle = |name: &str, at: &Placement, shape: Value| json!({ "name": shown(name), "at": placement(at), "shape": shape });
    let world = Placement::identity();
    let all = problem.task.obstacles.iter().filter_map(|each| {
        Some(match &each.shape {
            Shape::Sphere { centre, radius } => {
                let at = Placement::from_xyz_rpy(*centre, [0.0; 3]);
                obstacle(&each.name, &at, json!({ "kind": "sphere", "radius": number(*radius) }))
            }
            Shape::Capsule { from, to, radius } => {
                let shape = json!({
                    "kind": "capsule", "from": vector(*from), "to": vector(*to), "radius": number(*radius),
                });
                obstacle(&each.name, &world, shape)
            }
            Shape::Box { placement, size } => {
                obstacle(&each.name, placement, json!({ "kind": "box", "size": vector(*size) }))
            }
            Shape::HalfSpace { through, normal } => {
                let shape =
                    json!({ "kind": "plane", "through": vector(*through), "normal": vector(*normal) });
                obstacle(&each.name, &world, shape)
            }
            _ => return None,
        })
    });
    all.collect()
}
